"""`ospace list`: every robot, scenario and code of a finding, each with what it is, whole."""

from __future__ import annotations

import json

import pytest

from ospace import models
from ospace.cli.main import main
from ospace.urdf.lint.rules import RULES

WHAT = {"robots": map(models.summary, models.names()), "scenarios": map(models.scenario_summary, models.scenarios())}
WHAT["examples"] = map(models.example_summary, models.examples())
WHAT["findings"] = (rule.summary for rule in RULES.values())
NAMES = {
    "robots": models.names(),
    "scenarios": models.scenarios(),
    "examples": [str(file) for file in models.examples()],
    "findings": list(RULES),
}


@pytest.mark.parametrize("kind", NAMES)
def test_a_kind_is_listed_by_name_with_what_each_is(capsys, kind):
    assert main(["list", kind]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines if line[0] != " "] == NAMES[kind]
    assert all(len(line) <= 80 for line in lines)
    text = " ".join(" ".join(lines).split())
    assert all(what in text for what in WHAT[kind])


def test_all_kinds_are_listed_below_their_names(capsys):
    assert main(["list"]) == 0
    parts = capsys.readouterr().out.split("\n\n")
    assert [part.split()[0] for part in parts] == list(NAMES)


def test_as_json_nothing_is_cut_short(capsys):
    assert main(["list", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert {kind: [one["name"] for one in listed[kind]] for kind in listed} == NAMES
    summaries = {one["name"]: one["summary"] for one in listed["findings"]}
    assert summaries["unknown-attribute"] == f"warning: {RULES['unknown-attribute'].summary}"
    assert summaries["no-file"].startswith("refused: ")
    assert all(one["summary"] for kind in listed.values() for one in kind)


def test_another_kind_is_wrong_usage(capsys):
    with pytest.raises(SystemExit) as end:
        main(["list", "arms"])
    assert end.value.code == 2

"""One register of codes: the page, the schema, the command and the reader say the same."""

from __future__ import annotations

import ast
import json
from importlib import resources
from pathlib import Path

import pytest

import ospace
from ospace.cli.dialect import shell
from ospace.cli.main import main
from ospace.urdf.lint import explain
from ospace.urdf.lint.rules import GROUPS, RULES

ROOT = Path(ospace.__file__).parents[1]


def test_the_page_is_the_register():
    assert (ROOT / "docs" / "findings.md").read_text(encoding="utf-8") == explain.page()


def test_the_schema_knows_every_finding():
    text = resources.files("ospace.validation").joinpath("report.schema.json").read_text(encoding="utf-8")
    known = json.loads(text)["$defs"]["finding"]["properties"]["code"]["enum"]
    assert known == sorted(code.name for code in RULES.values() if not code.unreadable)


def test_no_code_is_there_twice():
    assert sum(map(len, GROUPS.values())) == len(RULES)


@pytest.mark.parametrize("code", RULES.values(), ids=RULES)
def test_each_code_is_explained(capsys, code):
    assert main(["check", "--explain", code.name]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert all(shell(part) in out for part in (code.name, code.summary, code.reason, code.remedy, code.example))
    assert all(text.endswith((".", ">.")) for text in (code.summary, code.reason, code.remedy)), code


def test_an_unknown_code_is_answered_with_the_nearest(capsys):
    assert main(["check", "--explain", "axis-zer"]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "'axis-zero'" in err


def test_every_code_of_the_register_is_used_in_the_sources():
    """And no other: a code that nothing gives, or a finding that nothing explains, would be found here."""
    strings: set[str] = set()
    for file in (ROOT / "ospace").rglob("*.py"):
        if "rules" not in file.parts:
            tree = ast.parse(file.read_text(encoding="utf-8"))
            strings |= {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and node.value in RULES}
    assert RULES.keys() - strings == {"damping-negative", "friction-negative"}  # put together from the names

"""`ospace check` as its users meet it: exit status, table, JSON, terminal, pipe, Ctrl-C; and that it finds mistakes."""

from __future__ import annotations

import contextlib
import dataclasses
import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from importlib import resources
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yourdfpy

import ospace
from ospace.cli.main import main
from ospace.dynamics import batch, evaluator
from ospace.validation import agreement, quantities, sample

ROOT = Path(ospace.__file__).parents[1]
INERTIAL = (
    '<inertial><origin xyz="0.1 0 0.2"/><mass value="2"/>'
    '<inertia ixx="1" iyy="1.2" izz="0.9" ixy="0.1" ixz="0" iyz="0"/></inertial>'
)
ESCAPE = "\x1b["
SECONDS = 60


def link(name, inertial=INERTIAL):
    return f'<link name="{name}">{inertial}</link>'


def joint(name, kind, child, parent="base", more=""):
    limit = '<limit lower="-1" upper="1" effort="1" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.3 0 0.1"/><axis xyz="{"0 0 1" if kind == "planar" else "0 1 0"}"/>{limit}{more}</joint>'
    )


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """What the command says while it compiles kernels is said once for a machine; here it has been said."""
    main(["check", "target", "--samples", "1"])


@pytest.fixture
def urdf(tmp_path):
    """Write a URDF of given parts."""

    def write(*parts, name="made"):
        file = tmp_path / f"{name}.urdf"
        file.write_text(f'<robot name="{name}">{"".join(parts)}</robot>')
        return str(file)

    return write


@pytest.fixture
def run(capsys):
    """Run the command in this process; exit status, output, standard error but for kernels that are compiled."""

    def call(*arguments):
        try:
            status = main([str(one) for one in arguments])
        except SystemExit as leaving:  # argparse
            status = leaving.code
        out, err = capsys.readouterr()
        return status, out, "".join(line for line in err.splitlines(True) if "compiling" not in line)

    return call


@pytest.fixture
def document(run):
    """Run ``check --json``; exit status and document, which has no number that JSON lacks."""

    def call(*arguments):
        status, out, _ = run("check", *arguments, "--json")

        def refuse(name):
            raise AssertionError(f"{name} is no JSON")

        return status, json.loads(out, parse_constant=refuse)

    return call


def command(*arguments, **options):
    """Start the command in a process of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TERM": "xterm-256color", **options.pop("env", {})}
    for name in ("NO_COLOR", "FORCE_COLOR", "COLUMNS"):
        environment.pop(name, None)
    given = [sys.executable, "-W", "error", "-m", "ospace.cli", *arguments]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.Popen(given, env=environment, cwd=ROOT, **pipes)


def captured(*arguments):
    """Run a program to its end."""
    return subprocess.run(arguments, check=False, cwd=ROOT, capture_output=True, text=True, timeout=SECONDS)


def finished(process, seconds=SECONDS):
    """Exit status and both texts of a process."""
    out, err = process.communicate(timeout=seconds)
    return process.returncode, (out or b"").decode(errors="replace"), (err or b"").decode(errors="replace")


# -- robots that are sound ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("by", ["name", "path"])
@pytest.mark.parametrize("name", ospace.models.names())
def test_every_model_is_sound(run, name, by):
    given = name if by == "name" else ospace.models.path(name)
    status, out, err = run("check", given, "--samples", 4)
    assert (status, err) == (0, "")
    assert re.search(r"^(\d+) of \1 rows agree over 4 states", out, re.MULTILINE)
    assert out.splitlines()[-1] == f"sound: {given}: 0 errors, 0 warnings"
    assert ESCAPE not in out


@pytest.mark.parametrize("seed", range(20))
def test_every_model_is_sound_whatever_the_seed(document, seed):
    for name in ospace.models.names():
        status, report = document(name, "--samples", 10, "--seed", seed)
        assert [row for row in report["agreement"] if row["verdict"] != "agrees"] == []
        assert status == 0


BODY = '<inertial><mass value="{0}"/><inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial>'
UNIT = BODY.format(1, 1)
IN_ITS_CENTRE = joint("hinge", "revolute", "arm").replace('<origin xyz="0.3 0 0.1"/>', "")
SIMPLE = {
    "cube": [link("base", UNIT)],
    "sphere": [link("base", BODY.format(500, 83.3))],
    "off centre": [link("base")],
    "wheel in its centre": [link("base", UNIT), link("arm", UNIT), IN_ITS_CENTRE],
    "wheel": [link("base", UNIT), link("arm", UNIT), joint("hinge", "continuous", "arm")],
    "slider": [link("base", UNIT), link("arm", UNIT), joint("slide", "prismatic", "arm")],
    "point mass on an arm": [link("base"), link("arm", BODY.format(1, 0)), joint("slide", "prismatic", "arm")],
    "planar": [link("base"), link("arm"), joint("table", "planar", "arm")],
    "floating": [link("base"), link("arm"), joint("free", "floating", "arm")],
    "arm on a planar joint": [
        link("base"),
        link("arm"),
        link("hand"),
        joint("table", "planar", "arm"),
        joint("wrist", "revolute", "hand", "arm"),
    ],
    "fixed": [link("base"), link("arm"), joint("weld", "fixed", "arm")],
    "finger of a servicer": [
        link("base", BODY.format(5e3, 9e3)),
        link("arm", BODY.format(0.05, 1e-5)),
        joint("hinge", "revolute", "arm"),
    ],
    "fly on an elephant": [
        link("base", BODY.format(5e3, 9e3)),
        link("arm", BODY.format(1e-3, 1e-7)),
        joint("hinge", "revolute", "arm"),
    ],
}


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("parts", SIMPLE.values(), ids=SIMPLE)
def test_simple_robots_are_sound(document, urdf, parts, seed):
    """Where a quantity is zero, as the gyroscopic torque of a cube, rounding is no disagreement."""
    status, report = document(urdf(*parts), "--samples", 8, "--seed", seed)
    assert [row for row in report["agreement"] if row["verdict"] == "differs"] == []
    assert [finding for finding in report["findings"] if finding["severity"] == "error"] == []
    assert status == 0


SMALL_WHEEL = BODY.format(0.05, 1e-6)
SMALL_WHEELS = [
    link("base", UNIT),
    *(link(f"wheel_{k}", SMALL_WHEEL) for k in range(2)),
    *(joint(f"spin_{k}", "continuous", f"wheel_{k}").replace("0.3 0 0.1", f"0 {0.15 - 0.3 * k} 0") for k in range(2)),
    "".join(link(f"sensor_{k}", "") for k in range(3)),
    *(joint(f"at_{k}", "fixed", f"sensor_{k}").replace("0.3 0 0.1", f"0.{k} 0.1 0.2") for k in range(3)),
]
"""Λ⁻¹ at a wheel is 1e12 times that at a sensor: no digit is left of its inverse on the range."""


@pytest.mark.parametrize("seed", range(20))
def test_an_undecided_robot_is_neither_sound_nor_unsound(run, document, schema, urdf, page, seed):
    file = urdf(*SMALL_WHEELS)
    given = (file, *(f"--point={name}" for name in ("sensor_0", "sensor_1", "sensor_2", "wheel_0")), "--samples", 3)
    status, report = document(*given, "--seed", seed)
    rows = [row["verdict"] for row in report["agreement"]]
    assert (status, report["verdict"], rows.count("differs")) == (0, "undecided", 0)
    jsonschema.Draft202012Validator(schema).validate(report)
    for wrong in ("sound", "unsound"):
        assert not jsonschema.Draft202012Validator(schema).is_valid({**report, "verdict": wrong})
    status, out, _ = run("check", *given, "--seed", seed, "--html", page)
    undecided, warnings = rows.count("undecided"), "1 warning"  # its inertia is the unit matrix
    assert 0 < undecided < len(rows)
    last = f"undecided: {file}: 0 errors, {warnings}, {undecided} of {len(rows)} rows undecided"
    assert (status, out.splitlines()[-2]) == (0, last)
    assert f'<span class="verdict open">undecided</span> {file}: {last.partition(f"{file}: ")[2]}' in page.read_text()


def test_the_table_has_every_quantity(run):
    _, out, _ = run("check", "chaser_24dof", "--samples", 2, "--point", "right_hand", "--point", "head")
    lines = out[out.index("quantity (equations)") :].splitlines()
    assert max(map(len, lines)) <= 80
    for quantity in quantities.TABLE:
        heading = lines.index(f"{quantity.name} ({quantity.equation}): {quantity.checked_against}")
        below = lines[heading + 1 :]
        rows = below[: next(k for k, line in enumerate(below) if not line.startswith("  "))]
        row = rf"  {re.escape(quantity.computed_by)} +\d\.\de[-+]\d\d +\d\.\de-\d\d  agrees"
        assert [line for line in rows if re.fullmatch(row, line)], quantity
    assert re.search(r"^placements of \d+ links \(14\): yourdfpy\n  Pinocchio .* agrees$", out, re.MULTILINE)


def test_the_table_has_every_way_in():
    """All that the evaluator and the batch offer, every method, and the sweeps of a state."""
    taken = {way: set() for way in ("state", "evaluator", "batch")}
    for quantity in quantities.TABLE:
        way = quantity.computed_by.rpartition(", ")[2]
        taken.setdefault(way, set()).add(quantity.name)
    assert set(taken) == {"state", "evaluator", "batch", "forward chain", "inverted chain"}
    one_each = {row for names in FIELDS.values() for row in names.values()} | {"momentum M_0"}
    assert one_each | {"response H^-1 J_e^T"} <= taken["state"]
    assert {EVERYWHERE[name] for name in evaluator.QUANTITIES} | {"response H^-1 J_e^T"} <= taken["evaluator"]
    assert {EVERYWHERE[name] for name in batch.QUANTITIES} == taken["batch"]


def test_the_facts_of_the_model(run):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    _, out, _ = run("check", "chaser_24dof", "--samples", 1, "--point", "right_hand")
    for fact in (
        rf"bodies +{robot.model.njoints - 1}\b",
        r"joints +18 revolute",
        r"degrees of freedom +24\b",
        rf"total mass +{robot.total_mass:g} kg",
        r"arm-to-base mass ratio +0\.\d+",
        r"principal inertias +[\d.]+, [\d.]+, [\d.]+ kg m²",
        r"centre of mass +",
        r"condition of H_b +\d",
        r"gravity +0 m/s²",
        r"units +SI: m, kg, s, rad",
        r"operational points +right_hand \(6 rows\)$",
    ):
        assert re.search(rf"^  {fact}", out, re.MULTILINE), fact


def test_points_are_the_leaf_links_without_any(document):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    _, report = document("chaser_24dof", "--samples", 1)
    assert [point["frame"] for point in report["model"]["points"]] == robot.leaf_links


def test_a_point_given_twice_is_no_error(document):
    status, report = document("chaser_7dof", "--samples", 2, "--point", "base", "--point", "base")
    assert (status, report["verdict"]) == (0, "sound")


def test_a_file_goes_before_a_model_of_its_name(run, urdf, monkeypatch, tmp_path):
    urdf(link("base"), name="target")
    (tmp_path / "target.urdf").rename(tmp_path / "target")
    monkeypatch.chdir(tmp_path)
    _, out, _ = run("check", "target", "--samples", 1)
    assert "total mass              2 kg" in out


def test_files_with_any_name(run, urdf, tmp_path):
    plain = Path(urdf(link("base")))
    for name in ("a b.urdf", "[bold]ü[red].urdf", "机器人 100%.urdf"):
        status, out, _ = run("check", plain.rename(tmp_path / name), "--samples", 1)
        assert status == 0
        assert out.splitlines()[-1] == f"sound: {tmp_path / name}: 0 errors, 0 warnings"
        plain = tmp_path / name


def test_names_in_brackets_are_no_markup(run, urdf):
    file = urdf(link("[red]base"), link("[/]"), joint("[bold]", "revolute", "[/]", "[red]base"), name="[blink]")
    status, out, _ = run("check", file, "--samples", 1)
    assert status == 0
    assert "[blink]\n" in out
    assert "[/] (6 rows)" in out


def test_a_mimic_joint_gives_its_warning(run, document, urdf):
    file = urdf(
        link("base"),
        link("left"),
        link("right"),
        joint("lead", "revolute", "left"),
        joint("follow", "revolute", "right", more='<mimic joint="lead" multiplier="-0.5" offset="0.1"/>'),
    )
    status, out, _ = run("check", file, "--samples", 2, "--free-mimic")
    assert status == 0
    assert re.search(r"warning +mimic-freed: joint 'follow', line 1: mimics 'lead'", out)
    assert out.splitlines()[-1].endswith("0 errors, 1 warning")
    status, report = document(file, "--samples", 2)
    assert status == 0
    assert "mimic" in {finding["code"] for finding in report["findings"]}
    assert {row["verdict"] for row in report["agreement"]} == {"agrees"}
    assert not [row for row in report["agreement"] if "chain" in row["computed_by"]]


# -- JSON --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def schema():
    text = resources.files("ospace.validation").joinpath("report.schema.json").read_text(encoding="utf-8")
    jsonschema.Draft202012Validator.check_schema(json.loads(text))
    return json.loads(text)


UNSOUND = {
    "massless-base": [link("base", "")],
    "massless-subtree": [link("base"), link("arm", ""), joint("hinge", "revolute", "arm")],
    "negative-mass": [link("base", INERTIAL.replace('"2"', '"-2"'))],
    "inertia-indefinite": [link("base", INERTIAL.replace('ixx="1"', 'ixx="-1"'))],
    "inertial-unreadable": [link("base"), link("arm", INERTIAL.replace('"2"', '"2 kg"')), joint("j", "fixed", "arm")],
    "singular-inertia": [
        link("base"),
        link("ring", ""),
        link("arm"),
        joint("outer", "revolute", "ring"),
        joint("inner", "revolute", "arm", "ring").replace('<origin xyz="0.3 0 0.1"/>', ""),
    ],
}


@pytest.mark.parametrize("name", [*ospace.models.names(), *UNSOUND])
def test_the_document_follows_its_schema(document, schema, urdf, name):
    given = urdf(*UNSOUND[name]) if name in UNSOUND else name
    status, report = document(given, "--samples", 2, "--seed", 7)
    jsonschema.Draft202012Validator(schema).validate(report)
    assert report["seed"] == 7
    assert status == (1 if name in UNSOUND else 0)


def test_the_schema_refuses_what_is_no_report(document, schema):
    """So that the test above says something."""
    _, report = document("target", "--samples", 1)
    validator = jsonschema.Draft202012Validator(schema)
    for wrong in ({"verdict": "fine"}, {"agreement": [{}]}, {"samples": "many"}, {"extra": 1}, {"findings": None}):
        assert not validator.is_valid({**report, **wrong}), wrong
    for key in report:
        assert not validator.is_valid({name: report[name] for name in report if name != key}), key


def test_the_document_has_every_quantity(document):
    _, report = document("chaser_7dof", "--samples", 3)
    names = ("quantity", "equation", "computed_by", "checked_against")
    rows = [tuple(row[name] for name in names) for row in report["agreement"]]
    assert rows[: len(quantities.TABLE)] == [quantity[:4] for quantity in quantities.TABLE]
    assert all(row["states"] == 3 and row["error"] <= row["bound"] for row in report["agreement"])


def test_same_seed_same_document_other_seed_other_numbers(document):
    first, again, other = (document("ets_vii", "--samples", 3, "--seed", seed)[1] for seed in (5, 5, 6))
    assert first == again
    errors, others = ([row["error"] for row in one["agreement"]] for one in (first, other))
    assert errors != others


# -- the page ----------------------------------------------------------------------------------------------------


@pytest.fixture
def page(tmp_path):
    return tmp_path / "report.html"


def test_the_page_is_written_beside_what_is_printed(run, page):
    before = run("check", "planar_2r", "--samples", 2)
    status, out, err = run("check", "planar_2r", "--samples", 2, "--html", page)
    assert (status, out, err) == (before[0], f"{before[1]}wrote {page}\n", "")
    assert page.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_the_page_beside_the_document(run, page):
    before = run("check", "planar_2r", "--samples", 2, "--json")
    assert run("check", "planar_2r", "--samples", 2, "--json", "--html", page) == before
    assert page.stat().st_size > 500_000


@pytest.mark.parametrize("code", UNSOUND)
def test_an_unsound_model_has_its_page(run, urdf, page, code):
    status, out, err = run("check", urdf(*UNSOUND[code]), "--html", page)
    assert (status, err) == (1, "")
    assert out.endswith(f"wrote {page}\n")
    assert f'id="code-{code}"' in page.read_text(encoding="utf-8")


@pytest.mark.parametrize("other", [["--fix", "out.urdf"], ["--explain", "massless-base"]], ids=["fix", "explain"])
def test_a_page_is_of_a_check_alone(run, page, other):
    status, out, err = run("check", "target", *other, "--html", page)
    assert (status, out) == (2, "")
    assert "give it without --fix and --explain" in err
    assert not page.exists()


def test_a_page_that_cannot_be_written_is_found_before_the_work(run, monkeypatch, tmp_path):
    monkeypatch.setattr("ospace.validation.report.check", lambda *given, **options: pytest.fail("has worked"))
    (tmp_path / "closed").mkdir()
    for path in (tmp_path / "nowhere" / "report.html", tmp_path / "closed", "/dev/null/report.html"):
        status, out, err = run("check", "target", "--html", path)
        assert (status, out) == (2, "")
        assert err.splitlines()[-1].startswith(("ospace check: error:", "ospace: error:"))


@pytest.mark.parametrize("content", [b"", b"<robot name='made'/>"], ids=["empty", "no links"])
def test_without_a_robot_there_is_no_page(run, tmp_path, page, content):
    file = tmp_path / "robot.urdf"
    file.write_bytes(content)
    for before in (None, "what was there"):
        if before is not None:
            page.write_text(before)
        assert run("check", file, "--html", page)[0] == 2
        assert (page.read_text() if page.exists() else None) == before


def test_a_page_does_not_overwrite_the_robot(run, urdf):
    file = Path(urdf(link("base")))
    before = file.read_bytes()
    status, out, err = run("check", file, "--html", file)
    assert (status, out) == (2, "")
    assert f"{file}: is what is read, {file}; give another file" in err
    assert file.read_bytes() == before


@pytest.mark.parametrize("options", [[], ["--json"]], ids=["tables", "document"])
def test_what_was_found_outlives_a_page_that_cannot_be_written(run, options):
    before = run("check", "planar_2r", "--samples", 2, *options)
    after = run("check", "planar_2r", "--samples", 2, *options, "--html", "/dev/full")
    assert after == (2, before[1], "ospace: error: /dev/full: no report: No space left on device\n")


def test_what_was_found_outlives_ctrl_c_while_the_page_is_drawn(run, page, monkeypatch):
    def interrupted(*given, **options):
        raise KeyboardInterrupt

    before = run("check", "planar_2r", "--samples", 2)
    monkeypatch.setattr("ospace.visual.check_report.render", interrupted)
    after = run("check", "planar_2r", "--samples", 2, "--html", page)
    assert after == (130, before[1], "ospace: interrupted\n")
    assert list(page.parent.iterdir()) == []


def test_without_the_extra_it_is_told_how_to_get_it(run, monkeypatch, page):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    status, out, err = run("check", "target", "--html", page)
    assert (status, out) == (2, "")
    assert err == "ospace: error: a report needs MeshCat: pip install -e '.[visual]'\n"
    assert not page.exists()


# -- what is refused ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "arguments",
    [
        ["chek", "target"],
        ["check"],
        ["check", "target", "--verbose"],
        ["check", "target", "--point"],
        *(["check", "target", "--samples", text] for text in ("0", "-1", "100001", "1.5", "many", "", "9" * 5000)),
        *(["check", "target", "--seed", text] for text in ("-1", "1.5", "x", "", "0x1", "9" * 5000)),
    ],
    ids=lambda arguments: " ".join(arguments)[:40],
)
def test_check_refuses_wrong_usage(run, arguments):
    status, out, err = run(*arguments)
    assert (status, out) == (2, "")
    assert err.startswith("usage: ospace")
    assert "error:" in err.splitlines()[-1]


@pytest.mark.parametrize("arguments", [["--samples", "1"], ["--seed", str(2**64 + 1), "--samples", "1"]])
def test_bounds_of_numbers_are_inside(run, arguments):
    assert run("check", "target", *arguments)[0] == 0


@pytest.mark.parametrize("content", [None, b"", b"<sdf/>", b"\0", b"<robot name='made'>"])
def test_a_file_that_cannot_be_read(run, tmp_path, content):
    file = tmp_path / "robot.urdf"
    if content is not None:
        file.write_bytes(content)
    for options in ([], ["--json"]):
        status, out, err = run("check", file, *options)
        assert (status, out) == (2, "")
        assert err.startswith(f"ospace: error: {file}: ")
        assert err.count("\n") == 1


def test_a_name_that_is_neither_file_nor_model(run):
    status, out, err = run("check", "chaser24dof")
    assert (status, out) == (2, "")
    assert "chaser_24dof" in err


def test_an_unknown_point_is_refused(run):
    status, out, err = run("check", "chaser_24dof", "--point", "right_hand", "--point", "left_hnd")
    assert (status, out) == (2, "")
    assert "'left_hnd'" in err
    assert "did you mean 'left_hand'" in err


def test_a_package_folder_that_is_none(run, tmp_path):
    status, out, err = run("check", "target", "--package-dir", tmp_path / "nowhere")
    assert (status, out) == (2, "")
    assert "nowhere" in err
    assert run("check", "target", "--samples", 1, "--package-dir", tmp_path)[0] == 0


@pytest.mark.parametrize("code", UNSOUND)
def test_an_unsound_model(run, document, urdf, code):
    file = urdf(*UNSOUND[code])
    status, out, err = run("check", file, "--samples", 2)
    assert (status, err) == (1, "")
    assert re.search(rf"error +{code}: (link|joint) '\w+'(, line 1)?: ", out)
    assert out.splitlines()[-1].startswith(f"unsound: {file}: ")
    status, report = document(file, "--samples", 2)
    assert (status, report["verdict"]) == (1, "unsound")
    assert code in {finding["code"] for finding in report["findings"]}


@pytest.mark.parametrize(
    "parts",
    [
        [link("base", BODY.format(1, 0))],
        [link("base", BODY.format(1e-300, 1e-300))],
        [link("base", BODY.format(1e300, 1e300))],
        [link("base"), link("arm", BODY.format(1e-300, 1e-300)), joint("hinge", "revolute", "arm")],
        [link("base"), link("arm"), joint("hinge", "revolute", "arm").replace("0 1 0", "0 0 0")],
        [link("base"), link("arm"), joint("hinge", "revolute", "arm").replace("0.3 0 0.1", "1e9 0 0")],
        [link("base"), link("arm"), joint("hinge", "revolute", "arm").replace("0.3 0 0.1", "1e200 0 0")],
        [link("base"), link("arm", BODY.format(1, 0)), IN_ITS_CENTRE],
    ],
    ids=["point", "light", "heavy", "light arm", "no axis", "far", "very far", "point mass on its axis"],
)
@pytest.mark.parametrize("options", [[], ["--json"]], ids=["text", "json"])
def test_models_beyond_all_numbers_end_with_a_word(run, urdf, parts, options):
    """Whatever is said of them, no warning, no error of NumPy and no NaN comes through."""
    status, out, err = run("check", urdf(*parts), "--samples", 2, *options)
    assert status in (0, 1, 2)
    assert (status == 2) == err.startswith("ospace: error: ")
    assert "Traceback" not in err
    assert not re.search(r"\bnan\b|NaN|Infinity", out)


@pytest.mark.parametrize(
    "parts",
    [
        [link("base"), link("arm"), joint("hinge", "revolute", "arm", "arm")],
        [link("base"), link("a"), link("b"), joint("ab", "fixed", "b", "a"), joint("ba", "fixed", "a", "b")],
    ],
)
def test_links_that_hang_from_themselves_do_not_hang_the_check(urdf, parts):
    process = command("check", urdf(*parts), "--samples", "1")
    try:
        status, _, err = finished(process, 20)
    finally:
        process.kill()
    assert status in (1, 2)
    assert "Traceback" not in err


# -- a process of its own ----------------------------------------------------------------------------------------


def test_check_runs_in_a_process_of_its_own():
    status, out, err = finished(command("check", "chaser_7dof", "--samples", "2"))
    assert (status, out.splitlines()[-1]) == (0, "sound: chaser_7dof: 0 errors, 0 warnings")
    assert ESCAPE not in out + err
    status, _, err = finished(command("check", "chaser_7dof", "--point", "nothing"))
    assert status == 2
    assert "Traceback" not in err


@pytest.mark.parametrize("arguments", [["--version"], ["--help"], ["check", "--help"], ["check"]])
def test_help_loads_nothing_heavy(arguments):
    program = f"""
import sys
from ospace.cli.main import main
try:
    main({arguments!r})
except SystemExit as leaving:
    status = leaving.code
heavy = {{"pinocchio", "numba", "numpy", "yourdfpy", "rich", "lxml"}} & set(sys.modules)
print("loaded:", sorted(heavy), "status:", status, file=sys.stderr)
"""
    done = captured(sys.executable, "-c", program)
    assert done.stderr.endswith(f"loaded: [] status: {2 if arguments == ['check'] else 0}\n")
    if arguments == ["--version"]:
        assert done.stdout == f"ospace {ospace.__version__}\n"
    if "--help" in arguments:
        assert done.stdout.startswith("usage: ospace")


def test_help_tells_exit_statuses_and_defaults(run):
    _, out, _ = run("check", "--help")
    text = " ".join(out.split())
    assert "0 sound, 1 findings of level error, 2 unreadable input, unwritable output or wrong usage" in text
    assert all(option in text for option in ("--point", "--samples", "--seed", "--json", "--package-dir"))


def read_until(terminal, text):
    """What the program writes to a pseudo-terminal until `text` comes, or it ends."""
    seen, end = b"", time.monotonic() + SECONDS
    while text not in seen and time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                more = os.read(terminal, 4096)
            except OSError:  # Linux's way to say that the other side is closed
                break
            if not more:
                break
            seen += more
    return seen


@pytest.fixture
def terminal():
    ours, theirs = pty.openpty()
    yield ours, theirs
    for descriptor in (ours, theirs):
        with contextlib.suppress(OSError):
            os.close(descriptor)


def test_a_terminal_has_colour(terminal):
    ours, theirs = terminal
    process = command("check", "target", "--samples", "2", stdout=theirs, stderr=theirs)
    os.close(theirs)
    seen = read_until(ours, b"no such text").decode()
    assert process.wait(timeout=SECONDS) == 0
    assert ESCAPE in seen
    assert re.search(r"\x1b\[[\d;]*32m(sound|agrees)", seen)  # green
    assert re.search(r"(\d+) of \1 rows agree", seen)


@pytest.mark.parametrize("environment", [{"TERM": "dumb"}, {"NO_COLOR": "1"}])
def test_a_terminal_that_wants_no_colour_has_none(terminal, environment):
    ours, theirs = terminal
    process = subprocess.Popen(
        [sys.executable, "-m", "ospace.cli", "check", "target", "--samples", "1"],
        env={**os.environ, **environment},
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=subprocess.DEVNULL,
    )
    os.close(theirs)
    seen = read_until(ours, b"no such text").decode()
    assert process.wait(timeout=SECONDS) == 0
    assert not re.search(r"\x1b\[[\d;]*3[0-7]m", seen)


@pytest.mark.parametrize("options", [[], ["--json"]], ids=["text", "json"])
def test_ctrl_c_in_a_long_run(terminal, options):
    ours, theirs = terminal
    process = command("check", "chaser_24dof", "--samples", "100000", *options, stderr=theirs)
    os.close(theirs)
    seen = read_until(ours, b"comparing states")
    assert b"comparing states" in seen  # on the way: kernels are being loaded, or states compared
    time.sleep(0.2)
    process.send_signal(signal.SIGINT)
    seen += read_until(ours, b"no such text")
    out, _ = process.communicate(timeout=SECONDS)
    assert (process.returncode, out) == (130, b"")
    assert b"Traceback" not in seen
    assert seen.endswith(b"ospace: interrupted\r\n")


@pytest.mark.parametrize("module", ["rich.console", "pinocchio", "scipy.sparse", "numba", "yourdfpy"])
def test_ctrl_c_while_libraries_load(module):
    """An import that swallows the interrupt, as eigenpy's of SciPy does, must not make the run go on."""
    program = f"""
import os, signal, sys
class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            sys.meta_path.remove(self)
            print("interrupting", file=sys.stderr, flush=True)
            os.kill(os.getpid(), signal.SIGINT)
signal.signal(signal.SIGINT, signal.default_int_handler)
sys.meta_path.insert(0, Interrupt())
from ospace.cli.main import main
sys.exit(main(["check", "target", "--samples", "20"]))
"""
    done = captured(sys.executable, "-c", program)
    if "interrupting" not in done.stderr:
        pytest.skip(f"{module} is not loaded")
    assert "Traceback" not in done.stderr
    assert (done.returncode, done.stdout) == (130, "")


@pytest.mark.parametrize("arguments", [["target"], ["target", "--json"], ["chaser_24dof"]], ids=" ".join)
def test_a_reader_that_goes_away(arguments):
    """As with ``| head -1``: no traceback, and no exit status that says that the robot is unsound."""
    process = command("check", *arguments, "--samples", "1")
    process.stdout.close()
    process.stdout = None
    status, _, err = finished(process)
    assert err == ""
    assert status != 1


def test_head_takes_the_first_line():
    program = f"{sys.executable} -m ospace.cli check chaser_24dof --samples 1 | head -1"
    done = captured("bash", "-c", program)
    assert (done.stdout, done.stderr) == ("chaser_24dof\n", "")


@pytest.mark.parametrize("options", [[], ["--json"]], ids=["text", "json"])
def test_a_full_disk_is_reported(options):
    with open("/dev/full", "w") as full:
        status, _, err = finished(command("check", "target", "--samples", "1", *options, stdout=full))
    assert status == 2
    assert "Traceback" not in err
    assert "No space left" in err


def test_a_full_disk_while_the_robot_is_unsound(urdf):
    with open("/dev/full", "w") as full:
        status, _, err = finished(command("check", str(urdf(link("base", ""))), stdout=full))
    assert (status, err) == (2, "ospace: error: cannot write the result: No space left on device\n")


def test_names_are_shown_as_they_are(run, urdf):
    name = ":robot: [bold]\x9b31m\u202e"
    status, out, err = run(
        "check", urdf(link("base"), link(name), joint(":robot:", "continuous", name)), "--samples", 1
    )
    assert status == 0, out + err
    shown = ":robot: [bold]\\x9b31m\\u202e"
    assert shown in out
    assert "\x9b" not in out


def test_names_in_errors_are_shown_as_they_are(run, urdf):
    status, out, err = run("check", urdf(link("base\x9b"), link("base\x9b")))
    assert (status, out) == (2, "")
    assert "link 'base\\x9b' is not unique" in err


@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "utf-8"])
@pytest.mark.parametrize("options", [[], ["--json"]], ids=["text", "json"])
def test_terminals_that_know_few_letters(encoding, options):
    arguments = ("check", "target", "--samples", "1", *options)
    status, _, err = finished(command(*arguments, env={"PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}))
    assert "Traceback" not in err
    assert status == 0


# -- mistakes are found ------------------------------------------------------------------------------------------

FIELDS = {
    "joint_space_dynamics": {
        "base_inertia": "base inertia H_b",
        "coupling_inertia": "coupling inertia H_bm",
        "manipulator_inertia": "manipulator inertia H_m",
        "base_bias": "base bias c_b",
        "manipulator_bias": "manipulator bias c_m",
    },
    "generalized_dynamics": {
        "generalized_inertia": "generalized inertia H_m*",
        "generalized_bias": "generalized bias c_m*",
    },
    "generalized_jacobian": {
        "base_generalized_jacobian": "base generalized Jacobian J_b*",
        "generalized_jacobian": "generalized Jacobian J_m*",
        "momentum_velocity": "point velocity",
        "base_momentum_velocity": "base velocity",
    },
    "operational_space": {
        "inertia": "operational inertia",
        "inertia_inverse": "inverse inertia, all blocks",
        "bias_force": "bias force",
        "bias_acceleration": "bias acceleration",
        "jacobian": "point Jacobian J_e",
        "response": "dynamically consistent inverse J_e+",
    },
    "free_floating": {
        "floating_inertia_inverse": "floating inverse inertia",
        "base_inertia_inverse": "base inverse inertia",
        "floating_inertia": "floating inertia",
        "bias_acceleration": "floating bias acceleration",
        "torque_map": "torque map J_m* H_m*^-1",
    },
}
EVERYWHERE = {  # rows of the evaluator and the batch
    **{name: row for names in FIELDS.values() for name, row in names.items() if name != "response"},
    **FIELDS["operational_space"],
    "momentum": "momentum M_0",
    "inertia_inverse_packed": "inverse inertia, lower rows",
    "singular_values": "singular values of J_m*",
    "smallest_singular_value": "smallest singular value of J_m*",
    "base_generalized_jacobian": "base generalized Jacobian J_b*",
    "centre_of_mass": "centre of mass",
    "placement": "placements of the points",
}
ALL = [(function, name, row) for function, names in FIELDS.items() for name, row in names.items()]
POINTS = ("chaser_24dof", "--point", "right_hand", "--point", "head", "--samples", "3")


def differing(report):
    return {row["quantity"] for row in report["agreement"] if row["verdict"] == "differs"}


def broken(monkeypatch, function, name, change):
    """Let one result of a public function be changed before it is compared."""
    honest = getattr(sample, function)

    def dishonest(*given, **options):
        result = honest(*given, **options)
        result = dataclasses.replace(result)
        vars(result)[name] = change(getattr(result, name))
        return result

    monkeypatch.setattr(sample, function, dishonest)


def test_without_a_mistake_none_is_found(document):
    status, report = document(*POINTS)
    assert (status, differing(report)) == (0, set())


def test_the_cases_are_all_that_is_computed():
    """A result that is added later must get a mistake of its own above."""
    not_compared = {"rank", "generalized_jacobian"}  # the latter twice: it is the one of `generalized_jacobian`
    for function, names in FIELDS.items():
        result = getattr(sample, getattr(sample, function).__annotations__["return"])
        public = {field.name for field in dataclasses.fields(result) if not field.name.startswith("_")}
        assert public - names.keys() <= not_compared, function


@pytest.mark.parametrize("size", [1e-6, -1e-6])
@pytest.mark.parametrize(("function", "name", "row"), ALL, ids=[f"{case[0]}.{case[1]}" for case in ALL])
def test_a_millionth_too_much_is_found(monkeypatch, document, function, name, row, size):
    broken(monkeypatch, function, name, lambda array: array * (1.0 + size))
    status, report = document(*POINTS)
    assert row in differing(report)
    assert (status, report["verdict"]) == (1, "unsound")


@pytest.mark.parametrize(
    ("module", "function", "rows"),
    [
        (sample, "momentum", {"momentum M_0"}),
        (quantities, "inverse_dynamics", {"rate of momentum", "forces of a motion"}),
    ],
    ids=["momentum", "inverse_dynamics"],
)
def test_a_millionth_too_much_of_a_vector_is_found(monkeypatch, document, module, function, rows):
    honest = getattr(module, function)
    monkeypatch.setattr(module, function, lambda *given: honest(*given) * (1.0 + 1e-6))
    status, report = document(*POINTS)
    assert differing(report) == rows
    assert status == 1


@pytest.mark.parametrize("size", [1e-6, -1e-6])
@pytest.mark.parametrize("name", evaluator.QUANTITIES)
def test_a_millionth_too_much_of_the_evaluator_is_found(monkeypatch, document, name, size):
    honest = vars(evaluator.OperationalSpaceEvaluator)[name]
    monkeypatch.setattr(
        evaluator.OperationalSpaceEvaluator, name, property(lambda run: honest.__get__(run, type(run)) * (1.0 + size))
    )
    _, report = document(*POINTS)
    wrong = {row["computed_by"] for row in report["agreement"] if row["verdict"] == "differs"}
    assert EVERYWHERE[name] in differing(report)
    assert {text.rpartition(", ")[2] for text in wrong} == {"evaluator"}


@pytest.mark.parametrize("size", [1e-6, -1e-6])
@pytest.mark.parametrize("name", batch.QUANTITIES)
def test_a_millionth_too_much_of_the_batch_is_found(monkeypatch, document, name, size):
    honest = agreement.interpreted_batch

    def dishonest(*given):
        result = honest(*given)
        return dataclasses.replace(result, **{name: getattr(result, name) * (1.0 + size)})

    monkeypatch.setattr(agreement, "interpreted_batch", dishonest)
    _, report = document(*POINTS)
    wrong = {row["computed_by"] for row in report["agreement"] if row["verdict"] == "differs"}
    assert EVERYWHERE[name] in differing(report)
    assert {text.rpartition(", ")[2] for text in wrong} == {"batch"}


def test_the_batch_is_compiled_for_all_states_when_asked(document):
    """Of robots with more points, too."""
    given = ("chaser_7dof", "--point", "end_effector", "--point", "base", "--point", "link_4", "--samples", 5)
    for options, states in (((), 3), (("--batch",), 5)):
        status, report = document(*given, *options)
        rows = [row for row in report["agreement"] if row["computed_by"].endswith("batch")]
        assert (status, {row["states"] for row in rows}, len(rows)) == (0, {states}, len(batch.QUANTITIES))


def test_all_joint_types_of_a_urdf_agree(document):
    file = Path(__file__).parents[1] / "validation/every_joint.urdf"
    status, report = document(file, "--point", "hand", "--point", "tip")
    assert set(report["model"]["joints"]) == {"revolute", "continuous", "prismatic", "planar", "floating"}
    assert (status, report["verdict"]) == (0, "sound")
    assert {row["verdict"] for row in report["agreement"]} == {"agrees"}


@pytest.mark.parametrize("k", range(18))
def test_a_millionth_of_one_joint_s_inertia_is_found(monkeypatch, document, k):
    """Also at the wrists, whose inertia is a thousandth of the shoulders'."""

    def change(H_m):
        H_m = H_m.copy()
        H_m[k, k] *= 1.0 + 1e-6
        return H_m

    broken(monkeypatch, "joint_space_dynamics", "manipulator_inertia", change)
    assert differing(document(*POINTS)[1]) == {"manipulator inertia H_m"}


@pytest.mark.parametrize("k", range(12))
def test_a_millionth_of_one_row_s_inertia_is_found(monkeypatch, document, k):
    def change(Gamma_e_inv):
        Gamma_e_inv = Gamma_e_inv.copy()
        if len(Gamma_e_inv) == 12:  # both points, not each by itself
            Gamma_e_inv[k, k] *= 1.0 + 1e-6
        return Gamma_e_inv

    broken(monkeypatch, "operational_space", "inertia_inverse", change)
    assert "inverse inertia, all blocks" in differing(document(*POINTS)[1])


def test_a_cross_block_that_is_missing_is_found(monkeypatch, document):
    def change(Gamma_e_inv):
        Gamma_e_inv = Gamma_e_inv.copy()
        if len(Gamma_e_inv) == 12:
            Gamma_e_inv[:6, 6:] = Gamma_e_inv[6:, :6] = 0.0
        return Gamma_e_inv

    broken(monkeypatch, "operational_space", "inertia_inverse", change)
    assert "inverse inertia, all blocks" in differing(document(*POINTS)[1])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_numbers_that_are_none_are_found(monkeypatch, document, run, value):
    broken(monkeypatch, "joint_space_dynamics", "manipulator_bias", lambda array: np.full_like(array, value))
    status, report = document(*POINTS)
    assert differing(report) == {"manipulator bias c_m"}
    assert status == 1
    status, out, err = run("check", *POINTS)
    assert (status, err) == (1, "")
    assert re.search(r"^manipulator bias c_m .*\n .* differs", out, re.MULTILINE)


def test_a_mistake_is_told_in_the_table_and_the_last_line(monkeypatch, run):
    broken(monkeypatch, "joint_space_dynamics", "manipulator_inertia", lambda array: array * (1.0 + 1e-6))
    status, out, _ = run("check", *POINTS)
    assert status == 1
    assert re.search(r"^manipulator inertia H_m .*\n .* 1\.0e-06 .* differs", out, re.MULTILINE)
    assert re.search(rf"^{len(quantities.TABLE)} of {len(quantities.TABLE) + 1} rows agree", out, re.MULTILINE)
    assert out.splitlines()[-1] == "unsound: chaser_24dof: 1 error, 0 warnings"


def test_a_robot_put_together_otherwise_is_found(monkeypatch, document):
    """The second reader: the whole of its robot turned by a millionth of a radian."""
    honest = yourdfpy.URDF.get_transform
    turn = np.eye(4)
    turn[0, 1], turn[1, 0] = -1e-6, 1e-6
    monkeypatch.setattr(yourdfpy.URDF, "get_transform", lambda *given: honest(*given) @ turn)
    status, report = document(*POINTS)
    (row,) = differing(report)
    assert row.startswith("placements of ")
    assert status == 1


ENDLESS = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="${max(range(10**12))}"/></robot>"""


@pytest.mark.parametrize("limit", dataclasses.fields(ospace.Limits), ids=lambda limit: limit.name)
def test_every_limit_has_an_option(limit, tmp_path, capsys):
    name, value = str(ospace.models.path("target")), str(limit.default)
    assert main(["check", name, f"--max-{limit.name}", value, "--samples", "1"]) == 0
    if limit.name in ("seconds", "memory"):
        (tmp_path / "r.xacro").write_text(ENDLESS)
        name = str(tmp_path / "r.xacro")
    smallest = main(["check", name, f"--max-{limit.name}", "1", "--samples", "1"])
    assert (smallest, f"--max-{limit.name}" in capsys.readouterr().err) == (2, True)

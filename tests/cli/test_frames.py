"""`ospace check FILE --frames`: links, joints and limits as a table, also of a robot that is unsound."""

from __future__ import annotations

import json

import pytest
from urdf.corpus.parts import AXIS, joint, link, robot

from ospace import models
from ospace.cli.main import main

LONG = "a_joint_whose_name_is_longer_than_its_column"
ROBOT = robot(
    link("base"),
    link("arm"),
    link("tip", ""),
    link("finger"),
    link("slide"),
    joint(),
    joint("grip", "fixed", "arm", "tip", ""),
    joint(LONG, "continuous", "tip", "finger", AXIS + '<limit effort="0.5" velocity="1"/>'),
    joint("twin", "prismatic", "tip", "slide", AXIS + '<mimic joint="hinge" multiplier="-0.5" offset="2"/>'),
)


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "r.urdf").write_text(ROBOT)
    return "r.urdf"


def test_links_joints_and_limits_as_a_table(file, capsys):
    assert main(["check", file, "--frames", "--free-mimic"]) == 0
    assert capsys.readouterr().out == (
        "link (mass kg)\n"
        "  joint                                   type        lower  upper  rate  effort\n"
        "base (2), the base\n"
        "arm (2) on base\n"
        "  hinge                                   revolute       -1      1     1      10\n"
        "tip (0) on arm\n"
        "  grip                                    fixed\n"
        "finger (2) on tip\n"
        f"  {LONG}\n"
        "                                          continuous   none   none     1     0.5\n"
        "slide (2) on tip\n"
        "  twin                                    prismatic    none   none  none    none\n"
        "    mimics hinge: -0.5 times its position, plus 2\n"
        "5 links, 4 joints; limits in rad or m, rad/s or m/s, N m or N\n"
        "read: r.urdf: 0 errors, 2 warnings\n"
    )


def test_the_document_holds_the_same(file, capsys):
    assert main(["check", file, "--frames", "--free-mimic", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert (listed["robot"], listed["base"]) == ("made", "base")
    assert listed["links"][:3] == [
        {"name": "base", "mass": 2.0},
        {"name": "arm", "mass": 2.0},
        {"name": "tip", "mass": 0.0},
    ]
    hinge, _, _, twin = listed["joints"]
    assert hinge == {
        "name": "hinge", "type": "revolute", "parent": "base", "child": "arm", "xyz": [0.3, 0, 0], "rpy": [0, 0, 0],
        "axis": [0, 1, 0], "lower": -1, "upper": 1, "velocity": 1, "effort": 10, "mimic": None}  # fmt: skip
    assert twin["mimic"] == {"joint": "hinge", "multiplier": -0.5, "offset": 2.0}
    assert (twin["lower"], twin["effort"]) == (None, None)


def test_an_unsound_robot_is_listed_with_status_1(file, capsys, tmp_path):
    (tmp_path / "r.urdf").write_text(ROBOT.replace('xyz="0 1 0"', 'xyz="0 0 nan"'))
    for more in ([], ["--json"]):
        assert main(["check", file, "--frames", *more]) == 1
        assert LONG in capsys.readouterr().out
    assert main(["check", file, "--frames"]) == 1
    assert capsys.readouterr().out.splitlines()[-1].startswith("unsound: r.urdf: ")


@pytest.mark.parametrize("name", models.names())
def test_the_table_fits_a_terminal(name, capsys):
    assert main(["check", name, "--frames"]) == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80


@pytest.mark.parametrize("other", [["--html", "o.html"], ["--fix", "o.urdf"], ["--explain", "no-file"]])
def test_it_is_not_mixed_with_what_does_other_things(file, capsys, other):
    with pytest.raises(SystemExit) as end:
        main(["check", file, "--frames", *other])
    assert end.value.code == 2
    assert "--frames lists what the file holds" in capsys.readouterr().err

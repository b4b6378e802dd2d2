"""`ospace compose` as its users meet it: which option is whose, the table, exit status, what it never writes over."""

from __future__ import annotations

import math
import re
import shlex
import shutil
from pathlib import Path

import pinocchio as pin
import pytest
import trimesh
from lxml import etree
from urdf.corpus.parts import ARM, joint, link, robot

from ospace.cli.main import main

BUS = "box:1x1x1m,100kg"
UR5 = Path(pin.__file__).parents[4] / "share/example-robot-data/robots/ur_description/urdf/ur5_robot.urdf"
DOCS = Path(__file__).parents[2] / "docs/compose.md"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder to work in, with two arms."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.urdf").write_text(ARM)
    (tmp_path / "b.urdf").write_text(ARM)
    return tmp_path


def composed(capsys, *words, status=0):
    """What is printed, and the file."""
    assert main(["compose", *words, "--out", "out.urdf"]) == status
    text = capsys.readouterr().out
    assert max(map(len, text.partition("Findings")[0].splitlines())) <= 80
    return text, etree.parse("out.urdf").getroot()


def mounts(root):
    """Where each arm stands: its base link, the link below it, xyz and rpy."""
    return {
        one.find("child").get("link"): (
            one.find("parent").get("link"),
            *(
                tuple(map(float, one.find("origin").get(key).split())) if one.find("origin") is not None else None
                for key in ("xyz", "rpy")
            ),
        )
        for one in root.iterfind("joint[@type='fixed']")
    }


BEHIND_EACH = (
    "a.urdf",
    "--at",
    "1,0,0",
    "--prefix",
    "l_",
    "b.urdf",
    "--prefix",
    "r_",
    "--at",
    "-1,0,.5",
    "--on",
    "l_arm",
)
IN_A_ROW = (
    "a.urdf",
    "b.urdf",
    "--at",
    "1,0,0",
    "--prefix=l_",
    "--at=-1,0,.5",
    "--prefix",
    "r_",
    "--on",
    "bus",
    "--on",
    "l_arm",
)


@pytest.mark.parametrize("words", [BEHIND_EACH, IN_A_ROW])
def test_options_belong_to_the_arm_that_they_follow_or_in_order_to_each_of_a_row(here, capsys, words):
    _, root = composed(capsys, BUS, *words)
    no_turn = (0.0, 0.0, 0.0)
    assert mounts(root) == {
        "l_base": ("bus", (1.0, 0.0, 0.0), no_turn),
        "r_base": ("l_arm", (-1.0, 0.0, 0.5), no_turn),
    }


def test_options_of_the_whole_may_stand_anywhere(here, capsys):
    words = [
        "compose",
        "--out",
        "o.urdf",
        "--payload",
        "l_arm",
        "2kg",
        BUS,
        "a.urdf",
        "--package-dir",
        ".",
        "--prefix",
        "l_",
    ]
    assert main(words) == 0
    assert etree.parse("o.urdf").xpath("link/@name") == ["bus", "l_base", "l_arm", "payload"]


@pytest.mark.parametrize(
    ("text", "angles"),
    [
        ("0,90,-45deg", (0.0, math.pi / 2, -math.pi / 4)),
        ("-.5,0,1e-1rad", (-0.5, 0.0, 0.1)),
        ("1 2 3", (1.0, 2.0, 3.0)),
    ],
)
def test_angles_in_radians_or_degrees(here, capsys, text, angles):
    _, root = composed(capsys, BUS, "a.urdf", "--rpy", text)
    assert mounts(root)["base"][2] == angles


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "give a BUS"),
        (["--at", "1,0,0", BUS, "a.urdf"], "--at stands before BUS"),
        (["x:=1", BUS, "a.urdf"], "x:=1 stands before BUS"),
        ([BUS, "--prefix", "x_", "a.urdf"], "--prefix follows BUS, which stands on nothing"),
        (
            [BUS, "a.urdf", "b.urdf", "--prefix", "x_"],
            "--prefix is given once for 2 ARMs (a.urdf, b.urdf): give one for each",
        ),
        (
            [BUS, "a.urdf", "--at", "1,0,0", "--at", "2,0,0"],
            "--at is given 2 times for 1 ARM (a.urdf): give one for each",
        ),
        ([BUS, "a.urdf", "b.urdf", "--remove", "arm"], "--remove follows 2 ARMs (a.urdf, b.urdf)"),
        ([BUS, "a.urdf", "--at", "1,0"], "'1,0' has 2 numbers instead of 3: write 0.5,0,0.4"),
        ([BUS, "a.urdf", "--rpy", "1,0,x"], "'1,0,x' is not a number: write 0,1.5708,0 or 0,90,0deg"),
        ([BUS, "a.urdf", "--at"], "argument --at: expected one argument"),
        ([BUS, "a.urdf", "--at", "--prefix", "x_"], "argument --at: expected one argument"),
        ([BUS, "--payload", "bus"], "argument --payload: expected 2 arguments"),
    ],
)
def test_words_that_fit_nothing_are_reported_with_the_usage(here, capsys, words, said):
    with pytest.raises(SystemExit) as end:
        main(["compose", *words, "--out", "out.urdf"])
    assert end.value.code == 2
    error = capsys.readouterr().err
    assert said in error
    assert "usage: ospace compose BUS ARM" in error
    assert not (here / "out.urdf").exists()


def test_an_option_is_not_shortened(here, capsys):
    with pytest.raises(SystemExit):
        main(["compose", BUS, "a.urdf", "--pre", "x_", "--out", "out.urdf"])
    assert "unrecognized arguments: --pre" in capsys.readouterr().err


def test_the_usage_fits_a_terminal(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit):
        main(["compose", "--help"])
    text = capsys.readouterr().out
    assert max(map(len, text.splitlines())) <= 80
    assert "--part" not in text


def test_the_table_has_parts_places_masses_and_the_centre(here, capsys):
    stand = robot(link("table"), link("base"), link("arm"), joint("bolt", "fixed", "table", "base", ""), joint())
    (here / "s.urdf").write_text(stand)
    text, _ = composed(
        capsys, BUS, "s.urdf", "--remove", "table", "--at", "0.5,0,0", "--prefix", "l_", "--payload", "l_arm", "4kg"
    )
    assert text == (
        "part              links  joints  mass kg\n"
        "box:1x1x1m,100kg      1       0      100\n"
        "s.urdf                2       1        4\n"
        "  l_ on bus at 0.5, 0, 0 m, rpy 0, 0, 0 rad\n"
        "  without table\n"
        "body:4kg              1       0        4\n"
        "  on l_arm at 0, 0, 0 m, rpy 0, 0, 0 rad\n"
        "together              4       1      108\n"
        "centre of mass 0.0574074, 0, 0.00185185 m from 'bus', joints at zero\n"
        "\n"
        "Findings on body:4kg\n"
        "  info     point-mass: link 'payload', line 25: 4 kg in one point: the tensor is zero\n"
        "\n"
        "wrote out.urdf: 0 errors, 0 warnings\n"
    )


def test_an_error_is_on_its_part_and_makes_status_1(here, capsys):
    (here / "odd.urdf").write_text(ARM.replace('xyz="0 1 0"', 'xyz="0 0 0"'))
    text, _ = composed(capsys, BUS, "a.urdf", "--prefix", "a_", "odd.urdf", "--prefix", "odd_", status=1)
    assert "Findings on odd_\n  error    axis-zero: joint 'odd_hinge'" in text
    assert "Findings on a_" not in text
    assert text.endswith("wrote out.urdf: 1 error, 0 warnings\n")
    assert main(["check", "out.urdf"]) == 1


XACRO = """<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="1"/>
<xacro:arg name="tip" default="tip"/><!-- kept --><link name="base"><inertial><mass value="$(arg mass)"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><link name="$(arg tip)"/>
<joint name="j" type="fixed"><parent link="base"/><child link="$(arg tip)"/></joint></robot>"""


def test_arguments_of_a_xacro_belong_to_the_part_that_they_follow(here, capsys):
    (here / "x.urdf.xacro").write_text(XACRO)
    words = (
        "x.urdf.xacro",
        "mass:=7",
        "x.urdf.xacro",
        "x.urdf.xacro",
        "mass:=2",
        "tip:=top",
        "--prefix",
        "a_",
        "--prefix",
        "b_",
    )
    _, root = composed(capsys, *words)
    assert root.xpath("//mass/@value") == ["7", "1", "2"]
    assert root.xpath("link/@name") == ["base", "tip", "a_base", "a_tip", "b_base", "b_top"]
    assert "<!-- kept -->" in (here / "out.urdf").read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("x.urdf.xacro", "mass:=${"), "x.urdf.xacro: "),
        (("a.urdf", "mass:=2"), "a.urdf: is not a xacro and takes no argument 'mass'"),
    ],
)
def test_a_xacro_that_cannot_be_expanded_is_named(here, capsys, words, said):
    (here / "x.urdf.xacro").write_text(XACRO)
    assert main(["compose", *words, "--out", "out.urdf"]) == 2
    assert said in capsys.readouterr().err


def test_robots_that_come_with_ospace_are_parts_by_their_names(here, capsys):
    text, root = composed(capsys, "target", "planar_2r", "--prefix", "arm_")
    assert "target.urdf" in text
    assert "arm_base" in root.xpath("link/@name")


@pytest.mark.parametrize("words", [[BUS, "out.urdf"], ["out.urdf"], ["out.stl,5kg"]])
def test_what_is_read_is_not_written(here, capsys, words):
    name = words[-1].partition(",")[0]
    (here / name).write_text(ARM)
    assert main(["compose", *words, "--out", name]) == 2
    assert "is what is read" in capsys.readouterr().err
    assert (here / name).read_text() == ARM


def test_clashes_and_files_that_are_not_there_are_status_2(here, capsys):
    for words, said in {
        (BUS, "a.urdf", "b.urdf"): "give the second a prefix, such as --prefix b_",
        (BUS, "none.urdf"): "none.urdf: no such file",
        (BUS, "none"): "'none' is neither a file nor a model that comes with ospace",
        (BUS, "a.urdf", "--package-dir", "none"): "--package-dir none: no such folder",
        (BUS, "a.urdf", "--on", "bas"): "no link 'bas' to put it on among the parts before it",
    }.items():
        assert main(["compose", *words, "--out", "out.urdf"]) == 2
        assert said in capsys.readouterr().err
        assert not (here / "out.urdf").exists()


def test_the_example_of_the_docs_prints_what_they_show(here, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    shutil.copy(UR5, here)
    page = DOCS.read_text(encoding="utf-8")
    command, shown = re.search(
        r"```text\n\$ (ospace compose (?:[^\n]*\\\n)*[^\n]*)\n(.*?)```", page, re.DOTALL
    ).groups()
    assert main(shlex.split(command.replace("\\\n", " "))[1:]) == 0
    assert capsys.readouterr().out == shown


@pytest.mark.parametrize("row", re.findall(r"^\| `(.*?)` \| .*", DOCS.read_text(encoding="utf-8"), re.MULTILINE))
def test_words_of_the_docs_are_read(here, row):
    if row.startswith("--"):
        assert f"{row.split()[0]} " in DOCS.read_text(encoding="utf-8").partition("```")[0]
        return
    trimesh.creation.box((1, 1, 1)).export(here / "bus.stl")
    assert main(["compose", BUS, "--payload", "bus", row, "--out", "out.urdf"]) == 0

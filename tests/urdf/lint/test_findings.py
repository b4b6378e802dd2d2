"""Each finding from the smallest model that has it: code, severity, the link or joint by name, and a remedy."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import yourdfpy

import ospace
from ospace.urdf.lint import inertia as inertias
from ospace.validation import report

LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
SOUND = (1.0, 1.2, 0.9)


def link(name, mass=2.0, moments=SOUND):
    ixx, iyy, izz = moments
    return (
        f'<link name="{name}"><inertial><origin xyz="0.1 0 0.2"/><mass value="{mass}"/>'
        f'<inertia ixx="{ixx}" iyy="{iyy}" izz="{izz}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def bare(name):
    return f'<link name="{name}"/>'


def joint(name, child, parent="base", kind="revolute", more=""):
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="0.3 0 0"/><axis xyz="0 1 0"/>{LIMIT if kind == "revolute" else ""}{more}</joint>'
    )


@pytest.fixture
def found(tmp_path):
    """Return the findings of a URDF of given parts, of a robot that is refused as of one that is not."""

    def read(*parts, **options):
        file = tmp_path / "robot.urdf"
        file.write_text(f'<robot name="made">{"".join(parts)}</robot>')
        try:
            return ospace.SpaceRobot.from_urdf(file, **options).findings
        except ospace.UnsoundModelError as error:
            refusal = error
        for finding in refusal.findings:
            assert (str(finding) in str(refusal)) == (finding.severity == "error")
        return refusal.findings

    return read


POINT = (0.0, 0.0, 0.0)
CASES = {
    "massless base": ([bare("base"), link("arm"), joint("hinge", "arm")], "massless-base", "error", "link 'base'"),
    "single massless body": ([bare("base")], "massless-base", "error", "link 'base'"),
    "massless hand": (
        [link("base"), link("arm"), bare("hand"), joint("hinge", "arm"), joint("wrist", "hand", "arm")],
        "massless-subtree",
        "error",
        "joint 'wrist'",
    ),
    "negative mass of the base": ([link("base", -3.0)], "negative-mass", "error", "link 'base'"),
    "negative mass of a link": (
        [link("base"), link("arm", -0.5), joint("hinge", "arm")],
        "negative-mass",
        "error",
        "link 'arm'",
    ),
    "negative mass of a fixed link": (
        [link("base"), link("arm", -0.5), joint("weld", "arm", kind="fixed")],
        "negative-mass",
        "error",
        "link 'arm'",
    ),
    "negative moment of the base": (
        [link("base", moments=(1.0, -0.1, 1.0)), link("arm"), joint("hinge", "arm")],
        "inertia-indefinite",
        "error",
        "link 'base'",
    ),
    "negative moment of a link": (
        [link("base"), link("arm", moments=(-1e-3, 1.0, 1.0)), joint("hinge", "arm")],
        "inertia-indefinite",
        "error",
        "link 'arm'",
    ),
    "negative moment of a fixed link": (
        [link("base"), link("arm", moments=(-0.1, 1.0, 1.0)), joint("weld", "arm", kind="fixed")],
        "inertia-indefinite",
        "warning",  # the body that both links make is sound
        "link 'arm'",
    ),
    "triangle inequality": (
        [link("base"), link("arm", moments=(1.0, 1.0, 2.1)), joint("hinge", "arm")],
        "inertia-triangle",
        "warning",
        "link 'arm'",
    ),
    "mass in words": (
        [link("base"), link("arm", "2 kg"), joint("weld", "arm", kind="fixed")],
        "inertial-unreadable",
        "error",
        "link 'arm'",
    ),
    "mimic": (
        [
            link("base"),
            link("left"),
            link("right"),
            joint("lead", "left"),
            joint("follow", "right", more='<mimic joint="lead" multiplier="-1"/>'),
        ],
        "mimic",
        "info",
        "joint 'follow'",
    ),
}


@pytest.mark.parametrize(("parts", "code", "severity", "subject"), CASES.values(), ids=CASES)
def test_each_finding_from_the_smallest_model(found, parts, code, severity, subject):
    (finding,) = found(*parts)
    assert (finding.code, finding.severity, finding.subject) == (code, severity, subject)
    assert len(finding.message) > 20
    assert len(finding.remedy) > 10
    assert all(part in str(finding) for part in (code, severity, subject, finding.message, finding.remedy))
    assert finding.as_dict() == {
        "code": code,
        "severity": severity,
        "subject": subject,
        "message": finding.message,
        "remedy": finding.remedy,
        "line": 1,
        "value": finding.value,
        "file": None,
        "pose": None,
    }


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (CASES["massless hand"][0], ["'hand'", "<inertial>", "fixed"]),
        (CASES["negative mass of a link"][0], ["-0.5 kg"]),
        (CASES["negative moment of a link"][0], ["-0.001 kg m²"]),
        (CASES["triangle inequality"][0], ["1, 1, 2.1 kg m²"]),
        (CASES["mimic"][0], ["-1 times 'lead'", "one degree of freedom", "free_mimic=True"]),
    ],
)
def test_values_and_neighbours_are_named(found, parts, words):
    (finding,) = found(*parts)
    assert all(word in str(finding) for word in words), str(finding)


@pytest.mark.parametrize(
    "parts",
    [
        [link("base")],
        [bare("base"), link("bus"), joint("weld", "bus", kind="fixed")],
        [link("base"), bare("frame"), joint("weld", "frame", kind="fixed")],
        [link("base"), bare("arm"), link("hand"), joint("hinge", "arm"), joint("weld", "hand", "arm", "fixed")],
        [link("base", moments=(1.0, 1.0, 2.0))],
        [link("base"), link("arm", moments=(0.0, 1.0, 1.0)), joint("hinge", "arm")],
        [link("base"), link("arm", moments=(1.0, 1.0, 2.0 + 1e-12)), joint("hinge", "arm")],
    ],
    ids=["body", "base with its mass welded on", "frame", "hand welded on", "disc", "rod", "rounding"],
)
def test_nothing_is_found_where_nothing_is_wrong(found, parts):
    assert found(*parts) == ()


def test_mimicry_is_freed_on_demand_alone(found):
    (finding,) = found(*CASES["mimic"][0], free_mimic=True)
    assert (finding.code, finding.severity, finding.value) == ("mimic-freed", "warning", "lead")
    assert "independent" in finding.message


def test_all_errors_are_reported_at_once(found):
    parts = [bare("base"), link("arm", -1.0), bare("hand"), joint("hinge", "arm"), joint("wrist", "hand", "arm")]
    assert {one.code for one in found(*parts)} == {"massless-base", "negative-mass", "massless-subtree"}


def test_what_is_drawn_does_not_make_a_robot_unsound(found):
    """Pinocchio's parser complains of the colour and reads all that moves: worth a warning, no reason to refuse."""
    (finding, *_) = drawn = found(link("base"), '<material name="m"><color rgba="red"/></material>')
    assert {one.severity for one in drawn} == {"warning"}
    assert "rgba" in finding.message


def test_a_base_that_cannot_be_turned_is_no_base(found):
    """A point mass alone, or a rod alone, has a singular H_b whatever the state."""
    for moments in (POINT, (0.0, 1.0, 1.0)):
        (finding,) = (
            one
            for one in found(
                f'<link name="base"><inertial><mass value="1"/><inertia ixx="{moments[0]}" iyy="{moments[1]}" '
                f'izz="{moments[2]}" ixy="0" ixz="0" iyz="0"/></inertial></link>'
            )
            if one.severity != "info"
        )
        assert finding.code == "massless-base"
        assert "'base'" in finding.subject


def test_mass_that_is_not_finite():
    """No URDF has one, as numbers that are not finite do not parse; a Pinocchio model may."""
    model = pin.Model()
    model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    inertia = pin.Inertia.Random()
    inertia.lever = np.array([0.0, np.nan, 0.0])
    model.inertias[1] = inertia
    (finding,) = inertias.check_model(model, {})
    assert (finding.code, finding.severity) == ("inertia-not-finite", "error")


def test_the_line_is_that_in_which_the_tag_starts(found):
    (finding,) = found(
        link("base"), "\n", link("arm").replace('<mass value="2.0"', '<mass\n\nvalue="2 kg"'), joint("j", "arm")
    )
    assert (finding.code, finding.line) == ("inertial-unreadable", 2)


def test_each_scale_of_a_mesh_is_looked_at(found):
    mesh = '<visual><geometry><mesh filename="m.stl" scale="{}"/></geometry></visual>'
    shapes = mesh.format("1 1 1") + mesh.format("1 1 -1")
    findings = found(link("base").replace("</link>", shapes + "</link>"))
    assert sorted(one.code for one in findings) == ["mesh-missing", "mesh-scale"]


def test_a_robot_without_a_name_is_called_as_its_file(tmp_path):
    file = tmp_path / "chaser.urdf"
    file.write_text(f"<robot>{link('base')}</robot>")
    robot = ospace.SpaceRobot.from_urdf(file)
    assert robot.name == "chaser"
    assert [(one.code, one.severity) for one in robot.findings] == [("no-robot-name", "warning")]


# -- findings of the check itself --------------------------------------------------------------------------------


def check(tmp_path, *parts):
    file = tmp_path / "robot.urdf"
    file.write_text(f'<robot name="made">{"".join(parts)}</robot>')
    robot = ospace.SpaceRobot.from_urdf(file)
    return report.check(robot, [robot.point(name) for name in robot.leaf_links], samples=2)


COAXIAL = [
    link("base"),
    bare("ring"),
    link("arm"),
    joint("outer", "ring"),
    '<joint name="inner" type="continuous"><parent link="ring"/><child link="arm"/><axis xyz="0 1 0"/></joint>',
]


def test_two_joints_about_one_axis_with_nothing_between(tmp_path):
    found = check(tmp_path, *COAXIAL)
    (finding,) = (one for one in found.findings if one.severity != "info")
    assert (finding.code, finding.severity, finding.subject) == ("singular-inertia", "error", "joint 'outer'")
    assert found.verdict == "unsound"


@pytest.mark.parametrize("method", ["forward", "inverted", "dense"])
def test_two_joints_about_one_axis_are_named_by_every_method(tmp_path, method):
    file = tmp_path / "robot.urdf"
    file.write_text(f'<robot name="made">{"".join(COAXIAL)}</robot>')
    robot = ospace.SpaceRobot.from_urdf(file)
    state = robot.state(robot.configuration({"outer": 0.3}))
    with pytest.raises(ospace.SingularInertiaError, match=r"'(inner|outer)'") as caught:
        ospace.operational_space(state, robot.point("arm"), method)
    assert caught.value.joint in ("outer", "inner")


def test_a_file_that_the_second_reader_rejects(tmp_path, monkeypatch):
    def reject(*given, **options):
        raise KeyError("made for the test")

    monkeypatch.setattr(yourdfpy.URDF, "load", reject)
    found = check(tmp_path, link("base"), link("arm"), joint("hinge", "arm"))
    (finding,) = (one for one in found.findings if one.severity != "info")
    assert (finding.code, finding.severity) == ("second-reader", "warning")
    assert "yourdfpy" in finding.message
    assert found.verdict == "sound"

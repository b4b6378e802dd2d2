"""Pinocchio's model is held against the file: whatever differs is found, and nothing where they agree."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from urdf.corpus.parts import ARM, AXIS, HAND, LIMIT, inertial, joint, link, robot

import ospace
from ospace.urdf import bodies, build, parity, parse, reader, source, tree
from ospace.urdf.description import Limit, Pose

LIMITS = ospace.Limits()
SIX = robot(
    link("base"),
    link("bus", inertial("7", origin="0.3 0.2 0.1")),
    link("arm", inertial("1.5", products=("0.001", "-0.002", "0.003"))),
    link("hand"),
    link("tool", inertial("0.25")),
    link("slide"),
    joint("weld", "fixed", "base", "bus", "", "0.5 0 0"),
    joint("hinge", more='<axis xyz="0 0.6 0.8"/>' + LIMIT + '<dynamics damping="0.5"/>'),
    HAND,
    joint("tip", "fixed", "hand", "tool", "", "0 0 0.1").replace('xyz="0 0 0.1"', 'xyz="0 0 0.1" rpy="0.1 0.2 0.3"'),
    joint("rail", "prismatic", "bus", "slide"),
)


def read(content):
    path = Path("made.urdf")
    root = source.parse(path, content.encode(), LIMITS)
    description = tree.span(path, parse.parse(root, path.stem)[0]).description
    return description, bodies.bodies_of(description), build.build(path, description)[0]


def test_what_agrees_is_let_through():
    _, merged, model = read(SIX)
    parity.check_built(Path("made.urdf"), merged, model)
    assert [body.link.name for body in merged] == ["base", "slide", "arm", "hand"]
    assert merged[0].mass == 9.0
    assert model.inertias[1].mass == 9.0


def set_inertia(model, j, **change):
    body = model.inertias[j]
    values = {"mass": body.mass, "lever": body.lever.copy(), "inertia": body.inertia.copy(), **change}
    model.inertias[j] = pin.Inertia(values["mass"], values["lever"], values["inertia"])


def set_frame(model, name, placement):
    model.frames[model.getFrameId(name, pin.FrameType.BODY)].placement = placement


def swap_axis(model, j):
    return model.joints.__setitem__(j, pin.JointModelRevoluteUnaligned(np.array([0.0, 0.8, 0.6])))


MISTAKES = {
    "mass of the base": (lambda m: set_inertia(m, 1, mass=9.0 + 1e-8), "total mass"),
    "mass moved": (lambda m: (set_inertia(m, 1, mass=8.0), set_inertia(m, m.getJointId("hinge"), mass=2.5)), "mass"),
    "centre": (lambda m: set_inertia(m, m.getJointId("hinge"), lever=np.array([0.1, 0.0, 0.05 + 1e-8])), "centre"),
    "tensor": (
        lambda m: set_inertia(m, m.getJointId("wrist"), inertia=m.inertias[m.getJointId("wrist")].inertia * (1 + 1e-8)),
        "inertia",
    ),
    "no inertial": (lambda m: set_inertia(m, m.getJointId("rail"), mass=0.0), "mass"),
    "placement": (
        lambda m: m.jointPlacements.__setitem__(m.getJointId("rail"), pin.SE3(np.eye(3), np.array([0.8, 0, 1e-8]))),
        "lies at",
    ),
    "rotation": (
        lambda m: m.jointPlacements.__setitem__(
            m.getJointId("hinge"), pin.SE3(pin.exp3(np.array([1e-8, 0, 0])), np.array([0.3, 0.0, 0.0]))
        ),
        "lies at",
    ),
    "lower limit": (lambda m: m.lowerPositionLimit.__setitem__(-1, -0.9), "lower"),
    "effort": (lambda m: m.effortLimit.__setitem__(-1, 9.0), "effort"),
    "velocity": (lambda m: m.velocityLimit.__setitem__(-1, 9.0), "velocity"),
    "damping": (lambda m: m.damping.__setitem__(m.idx_vs[m.getJointId("hinge")], 0.0), "damping"),
    "friction": (lambda m: m.friction.__setitem__(m.idx_vs[m.getJointId("hinge")], 0.5), "friction"),
    "link": (lambda m: set_frame(m, "tool", pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.1]))), "link 'tool' lies at"),
    "name": (lambda m: m.names.__setitem__(2, "other"), "no joint"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_what_differs_is_found(name):
    mistake, word = MISTAKES[name]
    _, merged, model = read(SIX)
    mistake(model)
    with pytest.raises(ospace.UrdfError, match=word) as caught:
        parity.check_built(Path("made.urdf"), merged, model)
    assert caught.value.code == "parity"


@pytest.mark.parametrize(
    ("change", "word"),
    [
        (lambda text: text.replace('type="continuous"', 'type="revolute"'), "type"),
        (lambda text: text.replace("0.0 0.6 0.8", "0.6 0.0 0.8"), "axis"),
        (lambda text: text.replace("0.0 0.6 0.8", "0.0 -0.6 -0.8"), "axis"),
        (lambda text: text.replace('type="continuous"', 'type="fixed"'), "joints instead of"),
        (lambda text: text.replace('<parent link="arm"/>', '<parent link="slide"/>'), "hangs from"),
        (lambda text: text.replace('mass value="0.25"', 'mass value="0.25 "'), "mass"),
    ],
)  # fmt: skip
def test_a_parser_that_reads_something_else_is_found(monkeypatch, tmp_path, capfd, change, word):
    """As Pinocchio's own, which makes the last link massless for a space behind its mass."""
    honest = build.to_xml
    assert change(honest(read(SIX)[0])) != honest(read(SIX)[0])
    monkeypatch.setattr(build, "to_xml", lambda description: change(honest(description)))
    file = tmp_path / "robot.urdf"
    file.write_text(SIX)
    with pytest.raises(ospace.UrdfError, match=word) as caught:
        reader.read(file)
    assert caught.value.code == "parity"
    assert capfd.readouterr() == ("", "")


def test_a_joint_of_the_name_of_the_free_flyer_welds_nothing(tmp_path):
    """Pinocchio's default would put the mass of the arm on the base."""
    file = tmp_path / "robot.urdf"
    file.write_text(ARM.replace("hinge", "root_joint"))
    model = ospace.SpaceRobot.from_urdf(file).model
    assert [inertia.mass for inertia in model.inertias] == [0.0, 2.0, 2.0]
    assert list(model.names) == ["universe", "root_joint_", "root_joint"]


def test_every_digit_survives(tmp_path):
    mass, lever, moment = 0.1 + 0.2, 1.0 / 3.0, 2.0 / 3.0
    text = inertial(repr(mass), (repr(moment), repr(moment), repr(moment)), origin=f"{lever!r} 0 0")
    file = tmp_path / "robot.urdf"
    file.write_text(robot(link("base"), link("arm", text), joint(more=AXIS + LIMIT.replace("-1", repr(-lever)))))
    model = ospace.SpaceRobot.from_urdf(file).model
    body = model.inertias[2]
    assert (body.mass, body.lever[0], body.inertia[0, 0]) == (mass, lever, moment)
    assert model.lowerPositionLimit[7] == -lever


def test_a_floating_root_joint_is_not_doubled(tmp_path):
    file = tmp_path / "robot.urdf"
    world = joint("free", "floating", "world", "base", "")
    file.write_text(robot('<link name="world"/>', link("base"), link("arm"), joint(), world))
    made = ospace.SpaceRobot.from_urdf(file)
    assert (made.nv, made.description.root, made.leaf_links) == (7, "base", ["arm"])
    assert made.model.inertias[1].mass == 2.0


# -- against the file as it stands -------------------------------------------------------------------------------


def altered(description, name, **change):
    """Return the description with another joint, or another inertial of a link."""
    if name in description.joint:
        joints = [replace(one, **change) if one.name == name else one for one in description.joints]
        return replace(description, joints=tuple(joints))
    links = [
        replace(one, inertial=replace(one.inertial, **change)) if one.name == name else one for one in description.links
    ]
    return replace(description, links=tuple(links))


LOST = {
    "mass": (lambda d: altered(d, "tool", mass=0.5), "mass"),
    "tensor": (lambda d: altered(d, "arm", tensor=(0.02, 0.0, 0.0, 0.03, 0.0, 0.04)), "inertia"),
    "centre": (lambda d: altered(d, "arm", pose=Pose()), "centre"),
    "placement": (lambda d: altered(d, "rail", pose=Pose((0.3, 0.0, 0.1))), "lies at"),
    "orientation": (lambda d: altered(d, "hinge", pose=Pose((0.3, 0.0, 0.0), (0.0, 0.1, 0.0))), "lies at"),
    "orientation of what is fixed": (lambda d: altered(d, "tip", pose=Pose((0.0, 0.0, 0.1))), "centre"),
    "axis": (lambda d: altered(d, "hinge", axis=(0.0, 0.8, 0.6)), "axis"),
    "type": (lambda d: altered(d, "rail", kind="revolute"), "type"),
    "limit": (lambda d: altered(d, "hinge", limit=Limit(None, -1.0, 2.0, 10.0, 1.0)), "upper"),
    "effort": (lambda d: altered(d, "rail", limit=Limit(None, -1.0, 1.0, math.inf, 1.0)), "effort"),
    "damping": (lambda d: altered(d, "hinge", damping=0.0), "damping"),
    "friction": (lambda d: altered(d, "hinge", friction=0.25), "friction"),
    "joint": (lambda d: altered(d, "rail", kind="fixed"), "joints instead of"),
}


def misread(monkeypatch, change):
    """Let ospace lose something on the way from the file to its description, which the first proof cannot see."""
    honest = reader.parse

    def parse_otherwise(root, file_name):
        description, findings = honest(root, file_name)
        return change(description), findings

    monkeypatch.setattr(reader, "parse", parse_otherwise)


@pytest.mark.parametrize("name", LOST)
def test_what_ospace_loses_is_found_in_the_original(monkeypatch, tmp_path, name):
    change, word = LOST[name]
    file = tmp_path / "robot.urdf"
    file.write_text(SIX)
    assert reader.read(file).model is not None
    misread(monkeypatch, change)
    reading = reader.read(file)
    assert reading.model is None
    (finding,) = (one for one in reading.findings if one.severity == "error")
    assert finding.code == "original-differs"
    assert word in finding.message


def test_a_quaternion_that_is_lost_is_found_in_the_original(monkeypatch, tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(quaternion_for(SIX))
    assert reader.read(file).model is not None
    monkeypatch.setattr(parse, "quaternion_to_rpy", lambda quaternion: (0.0, 0.0, 0.0))
    assert "original-differs" in {one.code for one in reader.read(file).findings}


def quaternion_for(content):
    """The same robot in URDF 1.2, with a quaternion for the one rpy it has."""
    x, y, z, w = pin.Quaternion(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3)).coeffs().tolist()
    assert content.count('rpy="0.1 0.2 0.3"') == 1
    written = content.replace('rpy="0.1 0.2 0.3"', f'quat_xyzw="{x!r} {y!r} {z!r} {w!r}"')
    return written.replace("<robot", '<robot version="1.2"')


def test_a_finding_explains_what_it_is_about_and_nothing_else(monkeypatch, tmp_path):
    """Pinocchio drops the <inertial> with a space in it; of that link the warning tells, of the others it does not."""
    file = tmp_path / "robot.urdf"
    file.write_text(SIX.replace('value="0.25"', 'value="0.25 "'))
    reading = reader.read(file)
    assert [one.code for one in reading.findings if one.severity != "info"] == ["number-spaces"]
    assert sum(inertia.mass for inertia in reading.model.inertias) == 14.75
    misread(monkeypatch, lambda d: altered(d, "rail", pose=Pose((0.3, 0.0, 0.1))))
    assert "original-differs" in {one.code for one in reader.read(file).findings}


@pytest.mark.parametrize("free", ["free", "root_joint", "universe"])
def test_a_floating_root_is_compared_too(monkeypatch, tmp_path, free):
    file = tmp_path / "robot.urdf"
    ground = '<link name="world"/><link name="frame"/>' + joint("post", "fixed", "world", "frame", "")
    file.write_text(SIX.replace("</robot>", ground + joint(free, "floating", "frame", "base", "") + "</robot>"))
    assert {one.code for one in reader.read(file).findings} == {"floating-root"}
    misread(monkeypatch, lambda d: altered(d, "tool", mass=0.5))
    assert "original-differs" in {one.code for one in reader.read(file).findings}


def test_a_name_with_a_line_end_is_the_same_name(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(SIX.replace('"hinge"', '"the\nhinge"').replace('"tool"', '"the\ttool"'))
    assert reader.read(file).findings == ()


def test_what_pinocchio_rejects_is_read_all_the_same(tmp_path, capfd):
    file = tmp_path / "robot.urdf"
    file.write_text(SIX.replace('xyz="0.5 0 0"', 'xyz="0.5\t0 0"'))
    reading = reader.read(file)
    assert reading.model is not None
    (finding,) = reading.findings
    assert (finding.code, finding.severity) == ("original-rejected", "info")
    assert "joint" in finding.message
    assert capfd.readouterr() == ("", "")

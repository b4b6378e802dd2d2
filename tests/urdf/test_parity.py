"""Pinocchio's model is held against the file: whatever differs is found, and nothing where they agree."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from urdf.corpus.parts import ARM, AXIS, HAND, LIMIT, inertial, joint, link, robot

import ospace
from ospace.urdf import bodies, build, parity, parse, reader, source, structure

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
    description = structure.ordered(path, parse.parse(root, path.stem)[0], LIMITS)
    return description, bodies.bodies_of(description), build.build(path, description)[0]


def test_what_agrees_is_let_through():
    _, merged, model = read(SIX)
    parity.prove(Path("made.urdf"), merged, model)
    assert [body.link.name for body in merged] == ["base", "slide", "arm", "hand"]
    assert merged[0].mass == 9.0
    assert model.inertias[1].mass == 9.0


def set_inertia(model, j, **change):
    body = model.inertias[j]
    values = {"mass": body.mass, "lever": body.lever.copy(), "inertia": body.inertia.copy(), **change}
    model.inertias[j] = pin.Inertia(values["mass"], values["lever"], values["inertia"])


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
    "name": (lambda m: m.names.__setitem__(2, "other"), "no joint"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_what_differs_is_found(name):
    mistake, word = MISTAKES[name]
    _, merged, model = read(SIX)
    mistake(model)
    with pytest.raises(ospace.UrdfError, match=word) as caught:
        parity.prove(Path("made.urdf"), merged, model)
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

"""A composed robot is the one that Pinocchio makes of its parts: masses, inertias, the joint-space inertia matrix."""

from __future__ import annotations

import itertools
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import Part, compose

DATA = Path(pin.__file__).parents[4] / "share/example-robot-data/robots"
ARMS = {
    "ur5": "ur_description/urdf/ur5_robot.urdf",
    "ur5 with gripper": "ur_description/urdf/ur5_gripper.urdf",
    "panda with gripper": "panda_description/urdf/panda.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "xarm7": "xarm_description/urdf/xarm7.urdf",
}
BAXTER = DATA / "baxter_description/urdf/baxter.urdf"
BUS = "box:1.2x1x0.8m,250kg"
BUS_INERTIA = pin.Inertia.FromBox(250.0, 1.2, 1.0, 0.8)
AT, RPY = (0.6, 0.1, -0.2), (0.3, -0.4, 1.1)
AGREE = 1e-12


def se3(at, rpy):
    return pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(at))


def bus_of(inertia):
    """A body on a free-flyer, with a frame `bus` at its origin."""
    model = pin.Model()
    free_flyer = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(free_flyer, inertia, pin.SE3.Identity())
    model.addFrame(pin.Frame("bus", free_flyer, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    return model


def by_pinocchio(whole, *arms):
    """Put arms (file, on, at, rpy, prefix) on a model by `pin.appendModel`."""
    for file, on, at, rpy, prefix in arms:
        model = pin.buildModelFromUrdf(str(file))
        for j in range(1, model.njoints):
            model.names[j] = prefix + model.names[j]
        for frame in itertools.islice(model.frames, 1, None):
            frame.name = prefix + frame.name
        whole = pin.appendModel(whole, model, whole.getFrameId(on, pin.FrameType.BODY), se3(at, rpy))
    return whole


def assert_same_dynamics(model, other, seed=0):
    """Both models have the same joints, and the same H and centre of mass in random configurations."""
    names = list(model.names)[2:]
    assert sorted(names) == sorted(list(other.names)[2:])
    rng = np.random.default_rng(seed)
    pin.seed(seed)
    for _ in range(3):
        q, p = pin.neutral(model), pin.neutral(other)
        q[:7] = p[:7] = pin.SE3ToXYZQUAT(pin.SE3.Random())
        order, order_other = list(range(6)), list(range(6))
        for name in names:
            one, two = model.joints[model.getJointId(name)], other.joints[other.getJointId(name)]
            assert one.shortname().removeprefix("JointModel")[:2] == two.shortname().removeprefix("JointModel")[:2]
            angle = rng.uniform(-1.0, 1.0)
            value = [angle] if one.nq == 1 else [np.cos(angle), np.sin(angle)]
            q[one.idx_q : one.idx_q + one.nq] = p[two.idx_q : two.idx_q + two.nq] = value
            order.append(one.idx_v)
            order_other.append(two.idx_v)
        H, H_other = (symmetric(pin.crba(m, m.createData(), at)) for m, at in ((model, q), (other, p)))
        H, H_other = H[np.ix_(order, order)], H_other[np.ix_(order_other, order_other)]
        scale = np.sqrt(np.outer(H.diagonal(), H.diagonal()))
        assert np.abs((H - H_other) / scale).max() < AGREE
        centres = [pin.centerOfMass(m, m.createData(), at) for m, at in ((model, q), (other, p))]
        np.testing.assert_allclose(*centres, atol=AGREE)


def symmetric(upper):
    return np.triu(upper) + np.triu(upper, 1).T


def robot_of(composition, tmp_path):
    """The composed file, read as users read it."""
    out = tmp_path / "read.urdf"
    out.write_bytes(composition.content)
    return ospace.SpaceRobot.from_urdf(out, free_mimic=True)


@pytest.mark.parametrize("name", ARMS)
def test_an_arm_on_a_bus_has_the_dynamics_of_pinocchios_appended_model(name, tmp_path):
    file = DATA / ARMS[name]
    composed = compose(BUS, Part(file, at=AT, rpy=RPY, prefix="left_"))
    robot = robot_of(composed, tmp_path)
    expected = by_pinocchio(bus_of(BUS_INERTIA), (file, "bus", AT, RPY, "left_"))
    assert composed.total_mass == pytest.approx(pin.computeTotalMass(expected), rel=AGREE)
    assert_same_dynamics(robot.model, expected)


@pytest.mark.parametrize("name", ARMS)
def test_an_arm_on_a_bus_is_sound_and_keeps_its_joints(name, tmp_path):
    out = tmp_path / "out.urdf"
    composed = compose(BUS, Part(DATA / ARMS[name], at=AT, rpy=RPY, prefix="left_"), out=out)
    assert not [finding for finding in composed.findings if finding.severity == "error"]
    alone, robot = ospace.SpaceRobot.from_urdf(DATA / ARMS[name]), ospace.SpaceRobot.from_urdf(out)
    assert robot.rate_names == [f"left_{name}" for name in alone.rate_names]


def test_a_finger_follows_the_other_on_the_bus_as_well(tmp_path):
    out = tmp_path / "out.urdf"
    compose(BUS, Part(DATA / ARMS["panda with gripper"], prefix="left_"), out=out)
    robot = ospace.SpaceRobot.from_urdf(out)
    free = ospace.SpaceRobot.from_urdf(out, free_mimic=True)
    assert (robot.n_joints, free.n_joints) == (8, 9)
    state = robot.state(robot.configuration({"left_panda_finger_joint1": 0.02}))
    both = free.state(free.configuration({f"left_panda_finger_joint{k}": 0.02 for k in (1, 2)}))
    for finger in ("left_panda_leftfinger", "left_panda_rightfinger"):
        here, there = (one.placement(one.robot.point(finger)) for one in (state, both))
        np.testing.assert_allclose(here.homogeneous, there.homogeneous, atol=1e-15)


def test_two_arms_on_one_bus(tmp_path):
    ur5, panda = DATA / ARMS["ur5"], DATA / ARMS["panda with gripper"]
    places = [(AT, RPY), ((-0.6, 0.0, 0.3), (0.0, np.pi / 2, 0.0)), ((0.0, 0.5, 0.0), (0.0, 0.0, 0.0))]
    arms = list(zip((ur5, ur5, panda), places, ("left_", "right_", "top_"), strict=True))
    composed = compose(BUS, *(Part(file, at=at, rpy=rpy, prefix=prefix) for file, (at, rpy), prefix in arms))
    expected = by_pinocchio(bus_of(BUS_INERTIA), *((file, "bus", at, rpy, prefix) for file, (at, rpy), prefix in arms))
    assert_same_dynamics(robot_of(composed, tmp_path).model, expected)


def test_an_arm_on_the_hand_of_another_and_a_payload_in_its_hand(tmp_path):
    ur5, panda = DATA / ARMS["ur5"], DATA / ARMS["panda with gripper"]
    composed = compose(
        BUS,
        Part(ur5, at=AT, rpy=RPY, prefix="arm_"),
        Part(panda, at=(0.0, 0.0, 0.1), on="arm_tool0", prefix="hand_"),
        payloads=[("hand_panda_leftfinger", "5kg,0.1x0.2x0.15kgm2,0x-0.1x0.2m")],
    )
    no_turn = (0.0, 0.0, 0.0)
    expected = by_pinocchio(
        bus_of(BUS_INERTIA), (ur5, "bus", AT, RPY, "arm_"), (panda, "arm_tool0", (0.0, 0.0, 0.1), no_turn, "hand_")
    )
    finger = expected.frames[expected.getFrameId("hand_panda_leftfinger")]
    load = pin.Inertia(5.0, np.array([0.0, -0.1, 0.2]), np.diag([0.1, 0.2, 0.15]))
    expected.appendBodyToJoint(finger.parentJoint, load, finger.placement)
    assert_same_dynamics(robot_of(composed, tmp_path).model, expected)


def without_arms(baxter):
    """Baxter's file without what hangs on its arm mounts, cut here by another way than ospace's."""
    tree = ElementTree.parse(baxter)
    root, gone = tree.getroot(), {"left_arm_mount", "right_arm_mount"}
    while True:
        cut = [
            one for one in root.findall("joint") if {one.find(end).get("link") for end in ("parent", "child")} & gone
        ]
        if not cut:
            break
        for one in cut:
            gone.add(one.find("child").get("link"))
            root.remove(one)
    for one in root.findall("link"):
        if one.get("name") in gone:
            root.remove(one)
    return ElementTree.tostring(root, encoding="unicode"), gone


def test_baxters_torso_is_a_bus_once_its_arms_are_removed(tmp_path):
    ur5 = DATA / ARMS["ur5"]
    arms = [
        (ur5, "torso", (0.06, 0.26, 0.12), (0.0, 0.0, 0.8), "left_"),
        (ur5, "torso", (0.06, -0.26, 0.12), (0.0, 0.0, -0.8), "right_"),
    ]
    composed = compose(
        Part(BAXTER, remove=("left_arm_mount", "right_arm_mount")),
        *(Part(file, at=at, rpy=rpy, on=on, prefix=prefix) for file, on, at, rpy, prefix in arms),
    )
    bare, gone = without_arms(BAXTER)
    assert set(composed.parts[0].removed) == gone
    expected = by_pinocchio(pin.buildModelFromXML(bare, pin.JointModelFreeFlyer()), *arms)
    assert_same_dynamics(robot_of(composed, tmp_path).model, expected)


@pytest.mark.parametrize("name", ARMS)
def test_masses_and_centre_reported_are_those_of_the_model(name, tmp_path):
    composed = compose(BUS, Part(DATA / ARMS[name], at=AT, rpy=RPY))
    model = robot_of(composed, tmp_path).model
    assert composed.total_mass == pytest.approx(pin.computeTotalMass(model), rel=AGREE)
    assert sum(part.mass for part in composed.parts) == pytest.approx(composed.total_mass, rel=AGREE)
    centre = pin.centerOfMass(model, model.createData(), pin.neutral(model))
    np.testing.assert_allclose(composed.mass_centre, centre, atol=AGREE)

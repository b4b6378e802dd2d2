"""A Pinocchio model laid out for the recursions: own kinematics against Pinocchio's, for every joint type."""

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.kernels.tree import UNKNOWN
from ospace.kernels.workspace import LINKS
from ospace.model.layout import turn_z_to

NESTED = {
    **trees.JOINT_TYPES,
    "composite of several columns": lambda rng: composite(rng, pin.JointModelSpherical(), pin.JointModelPlanar()),
    "composite of composites": lambda rng: composite(rng, trees.JOINT_TYPES["composite"](rng), pin.JointModelHZ(0.2)),
    "helical about any axis": lambda rng: pin.JointModelHelicalUnaligned(np.array([0.6, 0.0, 0.8]), -0.4),
    "universal about other axes": lambda rng: pin.JointModelUniversal(
        np.array([0.0, 0.6, 0.8]), np.array([1.0, 0.0, 0.0])
    ),
}


def composite(rng, *joints):
    made = pin.JointModelComposite(len(joints))
    for joint in joints:
        made.addJoint(joint, pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)))
    return made


@pytest.mark.parametrize("name", NESTED)
def test_own_kinematics_place_what_pinocchio_places(monkeypatch, name):
    monkeypatch.setitem(trees.JOINT_TYPES, name, NESTED[name])
    robot = trees.tree(3, 4, (name,))
    assert robot.own_kinematics
    for seed in range(3):
        state = trees.state(robot, seed, far=seed == 1)
        run = ospace.OperationalSpaceEvaluator(robot, robot.point("link_3"), ("generalized_bias",))
        run.update(state.q, state.v)
        bodies = robot.link_of_joint[1:]  # links between the columns of a joint may stand elsewhere
        for table in LINKS:
            own, by_pinocchio = run.table(table), state.table(table)
            rows = slice(None) if table == "velocity" else bodies
            if table in ("S", "d"):
                rows = [i for i in bodies if robot.links.turning[i]]
            np.testing.assert_allclose(own[rows], by_pinocchio[rows], atol=2e-13, rtol=0)


def test_a_joint_of_one_column_turns_about_the_third_axis_of_its_link():
    robot = trees.tree(5, 12, ("revolute", "continuous about any axis", "revolute about any axis"))
    state = trees.state(robot, 5)
    np.testing.assert_array_equal(robot.links.turning[1:], 1)
    np.testing.assert_allclose(state.table("S")[1:, 3:], state.table("R")[1:, 6:], atol=1e-14)
    np.testing.assert_allclose(state.table("S")[1:, :3], 0.0, atol=1e-14)


def test_a_frame_is_turned_until_its_third_axis_is_the_joints():
    rng = np.random.default_rng(0)
    for axis in [*np.eye(3), *-np.eye(3), *rng.normal(size=(20, 3)), np.array([1e-9, -1e-9, -1.0])]:
        R = turn_z_to(axis)
        np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-15)
        assert np.linalg.det(R) == pytest.approx(1.0, abs=1e-15)
        np.testing.assert_allclose(R[:, 2], axis / np.linalg.norm(axis), atol=1e-16)
    np.testing.assert_array_equal(turn_z_to(np.array([0.0, 0.0, 1.0])), np.eye(3))


def ellipsoid_robot():
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia.Random(), pin.SE3.Identity())
    joint = model.addJoint(root, pin.JointModelEllipsoid(0.3, 0.4, 0.5), pin.SE3.Random(), "ball")
    model.appendBodyToJoint(joint, pin.Inertia.FromBox(1.0, 0.2, 0.3, 0.4), pin.SE3.Identity())
    model.addBodyFrame("tip", joint, pin.SE3.Identity(), 0)
    return ospace.SpaceRobot.from_model(model)


def test_what_own_kinematics_do_not_know_pinocchio_places():
    robot = ellipsoid_robot()
    assert UNKNOWN in robot.links.kind
    rng = np.random.default_rng(1)
    q = pin.integrate(robot.model, pin.neutral(robot.model), rng.normal(size=robot.nv))
    state, tip = robot.state(q, rng.normal(size=robot.nv)), robot.point("tip")
    reference = ospace.operational_space(state, tip, "dense")
    run = ospace.OperationalSpaceEvaluator(robot, tip).update(state.q, state.v)
    batch = ospace.operational_space_batch(robot, tip, [state.q] * 3, [state.v] * 3, ("bias_acceleration", "inertia"))
    for result in (ospace.operational_space(state, tip), run):
        np.testing.assert_allclose(result.inertia, reference.inertia, rtol=1e-11)
        np.testing.assert_allclose(result.bias_acceleration, reference.bias_acceleration, rtol=1e-11)
    np.testing.assert_allclose(batch.inertia[1], reference.inertia, rtol=1e-11)
    with pytest.raises(ospace.OspaceError, match="joint 'ball' is of a type"):
        ospace.Controller(robot, ospace.control.PoseTask(name="tip", point=tip))

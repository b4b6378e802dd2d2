"""The controller on joints of every type: a row and a torque for each joint rate."""

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.control import Controller, DampingTask, JointLimits, PoseTask, PostureTask
from ospace.model.joint_positions import from_q

SEVERAL = ("planar", "floating", "spherical", "spherical by angles", "translation", "universal", "composite", "helical")


def near(robot, q, size, seed=0):
    """A configuration whose joints are off by up to `size`, the base where it is."""
    rng = np.random.default_rng(seed)
    return pin.integrate(robot.model, q, np.r_[np.zeros(6), rng.uniform(-size, size, robot.n_joints)])


def positions(robot, q):
    model = robot.model
    return {
        str(model.names[j]): from_q(model.joints[j], q[model.idx_qs[j] : model.idx_qs[j] + model.nqs[j]])
        for j in range(2, model.njoints)
    }


def accelerations(robot, q, v, command):
    """φ̈ under the command, by Pinocchio."""
    data, R = robot.model.createData(), pin.Quaternion(*q[[6, 3, 4, 5]]).matrix()
    on_base = np.r_[R.T @ command.base_wrench[:3], R.T @ command.base_wrench[3:]]
    return pin.aba(robot.model, data, q, v, np.r_[on_base, command.torque])[6:]


@pytest.mark.parametrize("name", [*trees.JOINT_TYPES, "mixed"])
def test_a_posture_is_approached_along_every_column(name):
    """By the posture's own law: with the error e = q_ref ⊖ q, φ̈ = k e − d φ̇, and ė = −φ̇ to first order."""
    robot = trees.tree(4, 5 if name != "mixed" else 14, None if name == "mixed" else (name,))
    state = trees.state(robot, 4)
    posture = near(robot, state.q, 1e-5)
    task = PostureTask(name="posture", posture=positions(robot, posture), stiffness=4.0, weight=1.0)
    command = Controller(robot, task, regularization=1e-12).update(0.0, state.q, state.v)
    left = pin.difference(robot.model, state.q, posture)[6:]
    np.testing.assert_allclose(command.errors["posture"], left, atol=1e-9)
    expected = 4.0 * left - 4.0 * state.v[6:]
    np.testing.assert_allclose(accelerations(robot, state.q, state.v, command), expected, atol=1e-6)
    assert len(command.torque) == robot.n_joints


@pytest.mark.parametrize("name", SEVERAL)
def test_a_run_ends_at_the_posture(name):
    robot = trees.tree(6, 2, (name,))
    q = pin.neutral(robot.model)
    goal = near(robot, q, 0.4, seed=2)
    task = PostureTask(name="posture", posture=positions(robot, goal), stiffness=25.0, weight=1.0)
    run = ospace.simulate(robot, q, np.zeros(robot.nv), Controller(robot, task), duration=3.0)
    np.testing.assert_allclose(pin.difference(robot.model, run.q[-1], goal)[6:], 0.0, atol=2e-3)
    assert run.certificate().passed


def test_a_hand_behind_joints_of_every_type_follows_its_pose():
    robot = trees.tree(8, 14)
    state = trees.state(robot, 8)
    hand = robot.point("link_13")
    tasks = [PoseTask(name="hand", point=hand), DampingTask(name="rest", weight=1e-9)]
    controller = Controller(robot, tasks, regularization=1e-10, trust_radius=1e6)  # the hand is fast
    command = controller.update(0.0, state.q, state.v)
    reached = ospace.operational_space(state, hand)
    F = np.r_[command.base_wrench, command.torque]
    acceleration = reached.response.T @ F - reached.bias_acceleration
    velocity = reached.jacobian @ np.r_[state.base_twist, state.v[6:]]
    np.testing.assert_allclose(acceleration, -10.0 * velocity, atol=1e-4 * np.abs(velocity).max())


def test_rates_of_joints_with_several_have_names_of_their_own():
    robot = trees.tree(1, 4, ("planar", "spherical", "revolute", "universal"))
    assert robot.rate_names == [
        "joint_0.x", "joint_0.y", "joint_0.rz", "joint_1.rx", "joint_1.ry", "joint_1.rz", "joint_2",
        "joint_3.0", "joint_3.1",
    ]  # fmt: skip
    task = PostureTask(name="posture", posture={"joint_1": np.array([0.0, 0.0, 0.0, 1.0]), "joint_2": 0.1})
    assert task.row_names(robot) == [f"posture.{name}" for name in robot.rate_names[3:7]]
    with pytest.raises(ospace.OspaceError, match="task 'posture': joint 'joint_1' takes 4"):
        Controller(robot, PostureTask(name="posture", posture={"joint_1": 0.3}))


def test_acceleration_limits_by_name_land_on_the_rates_of_their_joint():
    """Behind a joint of several columns, the number of a joint is not that of its rate."""
    robot = trees.tree(6, 8, ("planar", "revolute"))
    for joint in robot.joint_names:
        named = [rate.split(".")[0] == joint for rate in robot.rate_names]
        limits = JointLimits.of(robot, acceleration={joint: 3.0})
        np.testing.assert_array_equal(limits.acceleration, np.where(named, 3.0, np.inf))


def test_position_limits_of_a_translation_joint_are_kept():
    """Each of its coordinates is one of a sliding joint."""
    robot = trees.tree(6, 1, ("translation",))
    robot.model.lowerPositionLimit[7:], robot.model.upperPositionLimit[7:] = -0.1, [0.1, 0.2, 0.3]
    robot = ospace.SpaceRobot.from_model(robot.model)
    limits = JointLimits.of(robot)
    np.testing.assert_array_equal(limits.upper, [0.1, 0.2, 0.3])
    q, (joint,) = pin.neutral(robot.model), robot.joint_names
    limits = JointLimits(np.full(3, 50.0), limits.lower, limits.upper, limits.velocity, limits.acceleration)
    task = PostureTask(name="posture", posture={joint: [1.0, 1.0, 1.0]}, stiffness=25.0, weight=1.0)
    run = ospace.simulate(robot, q, np.zeros(robot.nv), Controller(robot, task, limits=limits), duration=2.0)
    np.testing.assert_allclose(run.q[-1][7:], limits.upper, atol=1e-5)

"""Joints with friction: drives make up for it, within their torque."""

import numpy as np
import pinocchio as pin
import pytest
from commands import forces, paper_tasks, state, unlimited

import ospace
from ospace.control import (
    Constant,
    Controller,
    DampingTask,
    JointLimits,
    MinimumJerk,
    PoseTask,
)
from ospace.control.base import MODES
from ospace.dynamics.joint_friction import FRICTION_VELOCITY


def whole_acceleration(robot, q, v, command):
    """v̇ of a command, as Pinocchio has it."""
    R, omega = robot.base_pose(q).rotation, v[3:6]
    base = command.base_acceleration
    return np.concatenate([R.T @ base[:3] - np.cross(omega, v[:3]), R.T @ base[3:], command.joint_acceleration])


@pytest.fixture(scope="module")
def rubbing(chaser):
    """Damping and friction in proportion to the inertia of each joint, as drives of that size have."""
    robot = ospace.SpaceRobot.from_model(chaser.model.copy())
    rng, model = np.random.default_rng(3), robot.model
    inertia = ospace.generalized_dynamics(chaser.state(chaser.configuration())).generalized_inertia.diagonal()
    friction = np.concatenate([np.zeros(6), rng.uniform(0.0, 5.0, 18) * inertia])
    model.damping = np.concatenate([np.zeros(6), rng.uniform(0.0, 20.0, 18) * inertia])
    model.upperDryFrictionLimit, model.lowerDryFrictionLimit = friction, -friction
    return robot


def passive(robot, v):
    friction = robot.model.upperDryFrictionLimit[6:] * np.tanh(v[6:] / FRICTION_VELOCITY)
    return -robot.model.damping[6:] * v[6:] - friction


@pytest.mark.parametrize("base", MODES)
def test_drives_make_up_for_friction(chaser, rubbing, base):
    """The same accelerations as without friction, by torques that differ by it."""
    for seed in range(5):
        q, v = state(chaser, seed)
        smooth, rough = (
            Controller(
                robot,
                paper_tasks(robot, robot.point("right_hand"), robot.point("head")),
                base=base,
                limits=unlimited(robot),
            ).update(0.0, q, v)
            for robot in (chaser, rubbing)
        )
        end = v.copy()
        end[6:] += 1e-3 * rough.joint_acceleration
        np.testing.assert_allclose(rough.torque - smooth.torque, -passive(rubbing, end), rtol=0, atol=1e-6)
        np.testing.assert_allclose(rough.joint_acceleration, smooth.joint_acceleration, rtol=0, atol=1e-7)
        tau = forces(rubbing, q, rough)
        tau[6:] += passive(rubbing, end)
        a = pin.aba(rubbing.model, rubbing.model.createData(), q, v, tau)
        np.testing.assert_allclose(a[6:], rough.joint_acceleration, rtol=0, atol=1e-8 * np.abs(a).max())


@pytest.mark.parametrize("leveled", [False, True])
def test_torque_limits_hold_with_friction(rubbing, leveled):
    limits = JointLimits.of(rubbing, share=0.1)
    hand, on = rubbing.point("right_hand"), 0
    for seed in range(20):
        q, v = state(rubbing, seed, speed=0.1)
        task = PoseTask(name="hand", point=hand, reference=Constant(pin.SE3.Identity()), level=0 if leveled else None)
        command = Controller(rubbing, [task, DampingTask(name="rest")], limits=limits).update(0.0, q, v)
        assert (np.abs(command.torque) <= limits.torque).all()
        planned = forces(rubbing, q, command)
        planned[6:] = pin.rnea(
            rubbing.model, rubbing.model.createData(), q, v, whole_acceleration(rubbing, q, v, command)
        )[6:]
        left = planned[6:] - passive(rubbing, v)
        assert (np.abs(left) <= limits.torque + 1e-5 * np.maximum(1.0, limits.torque)).all()
        on += any("torque" in name for name in command.active_limits)
    assert on > 5


def test_a_robot_that_rubs_tracks_as_well(chaser, rubbing):
    worst = {}
    for name, known, moved in (("smooth", chaser, chaser), ("rough", rubbing, rubbing), ("unknown", chaser, rubbing)):
        hand = known.point("right_hand")
        q, v = known.configuration(), np.zeros(24)
        origin = known.state(q, v).placement(hand)
        goal = origin * pin.SE3(pin.exp3(np.array([0.2, 0.1, -0.1])), np.array([0.05, -0.1, 0.1]))
        task = PoseTask(name="hand", point=hand, stiffness=100.0, reference=MinimumJerk(origin, goal, 0.0, 1.0))
        run, worst[name] = Controller(known, [task, DampingTask(name="rest")]), 0.0
        data, h, substeps = moved.model.createData(), 1e-3, 20
        for k in range(1000):
            command = run.update(k * h, q, v)
            worst[name] = max(worst[name], np.abs(command.errors["hand"]).max())
            for _ in range(substeps):
                tau = forces(moved, q, command)
                tau[6:] += passive(moved, v)
                v = v + h / substeps * pin.aba(moved.model, data, q, v, tau)
                q = pin.integrate(moved.model, q, v * (h / substeps))
    assert worst["rough"] < 3.0 * worst["smooth"], worst
    assert worst["rough"] < 0.05 * worst["unknown"], worst

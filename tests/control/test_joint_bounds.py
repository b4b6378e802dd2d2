"""Limits of joints: they hold in motion and are named, and torque limits stand above them."""

import numpy as np
import pinocchio as pin
import pytest
from commands import KEPT, accelerations

import ospace
from ospace.control import (
    Constant,
    Controller,
    DampingTask,
    JointLimits,
    PoseTask,
    PositionTask,
)


def test_limits_hold_in_motion_and_are_named(chaser, hand):
    robot, q, v = chaser, chaser.configuration(), np.zeros(24)
    limits = JointLimits.of(robot, acceleration=2.0)
    start = robot.state(q, v).placement(hand)
    far = Constant(pin.SE3(start.rotation, start.translation + [3.0, 2.0, -1.0]))
    run = Controller(
        robot, [PositionTask(name="reach", point=hand, reference=far), DampingTask(name="rest")], limits=limits
    )
    told, highest = set(), np.zeros(18)
    for k in range(6000):
        command = run.update(k * 1e-3, q, v)
        assert command.status in KEPT
        told.update(command.active_limits)
        a = accelerations(robot, q, v, command)
        q = pin.integrate(robot.model, q, 1e-3 * (v + 0.5e-3 * a))
        v = v + 1e-3 * a
        highest = np.maximum(highest, np.abs(v[6:]))
        assert (q[7:] <= limits.upper + 1e-6).all()
        assert (q[7:] >= limits.lower - 1e-6).all()
    assert (highest <= limits.velocity * (1.0 + 1e-6)).all()
    for kind in ("position", "velocity", "acceleration"):
        assert any(f": {kind}, " in name for name in told), (kind, told)
    assert all(name.split(":")[0] in robot.joint_names for name in told)


@pytest.mark.parametrize("outside", [0.05, 0.5])
def test_joints_outside_their_limits_come_back(chaser, outside):
    limits = JointLimits.of(chaser, acceleration=3.0)
    q, v = chaser.configuration(), np.zeros(24)
    bounded = np.flatnonzero(np.isfinite(limits.upper))
    q[7 + bounded] = limits.upper[bounded] + outside
    run = Controller(chaser, [DampingTask(name="rest")], limits=limits)
    for k in range(4000):
        command = run.update(k * 1e-3, q, v)
        beyond = chaser.outside_limits(q)
        assert (command.status == "outside limits") == (max(beyond.values(), default=0.0) > 1e-6)
        v = v + 1e-3 * accelerations(chaser, q, v, command)
        q = pin.integrate(chaser.model, q, 1e-3 * v)
    assert command.status in KEPT
    assert (q[7 + bounded] <= limits.upper[bounded] + 1e-6).all()


def test_torque_limits_stand_above_motion_limits(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    v[6:] = 1.4  # with next to no torque, nothing keeps joints from passing their velocity limits
    limits = JointLimits.of(chaser, share=1e-3)
    command = Controller(chaser, [PoseTask(name="hand", point=hand)], limits=limits).update(0.0, q, v)
    assert command.status == "softened"
    assert command.softened
    assert (np.abs(command.torque) <= limits.torque * (1.0 + 1e-8)).all()
    assert any("torque" in name for name in command.active_limits)


def test_a_joint_of_velocity_zero_is_held(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    limits = JointLimits.of(chaser)
    velocity = limits.velocity.copy()
    velocity[7] = 0.0
    limits = JointLimits(limits.torque, limits.lower, limits.upper, velocity, limits.acceleration)
    run = Controller(chaser, PoseTask(name="hand", point=hand, reference=Constant(pin.SE3.Identity())), limits=limits)
    command = run.update(0.0, q, v)
    assert command.status in KEPT
    assert abs(command.joint_acceleration[7]) < 1e-9
    assert np.abs(command.joint_acceleration).max() > 1.0


def test_limits_of_zero_are_taken_from_the_model(chaser):
    robot = ospace.SpaceRobot.from_model(chaser.model.copy())
    robot.model.effortLimit[6 + 3] = 0.0
    robot.model.velocityLimit[6 + 4] = 0.0
    robot.model.effortLimit[6 + 5] = robot.model.velocityLimit[6 + 5] = 0.0
    limits = JointLimits.of(robot, share=0.5)
    assert limits.torque[3] == 0.0
    assert limits.velocity[4] == 0.0
    assert limits.torque[5] == 0.0
    assert limits.velocity[5] == np.inf  # nothing is there to hold it still
    assert (np.delete(limits.torque, [3, 5]) > 0.0).all()

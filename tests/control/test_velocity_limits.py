"""A joint that is pushed against its velocity limit keeps it, though torques are held while the arm moves on."""

import math

import arms
import numpy as np
import pytest

from ospace.control import Controller, JointLimits, PostureTask
from ospace.simulation import simulate

FAST = 4
"""The joint that stays at its limit."""


def swinging(forget=False, duration=0.6, **settings):
    """Return limits and the run of an arm whose wrist turns at its limit while shoulder and elbow swing."""
    robot = arms.arm()
    given = JointLimits.of(robot)
    velocity = np.full(robot.n_joints, 6.0)
    velocity[FAST] = 2.0
    limits = JointLimits(given.torque, np.full_like(velocity, -math.inf), np.full_like(velocity, math.inf), velocity)
    posture = dict(zip(robot.joint_names, (1.5, -1.0, 2.0, 1.0, 40.0, -2.0), strict=True))
    controller = Controller(robot, [PostureTask(name="posture", posture=posture, weight=1.0)], limits=limits)

    def update(time, q, v):
        if forget:
            controller._held.time[:] = math.nan
        return controller.update(time, q, v)

    q = robot.configuration()
    q[7:] = (0.2, 0.4, -0.5, 0.3, 0.0, 0.1)
    return limits, simulate(robot, q, np.zeros(robot.nv), update, duration=duration, period=1e-3, **settings)


def excess(limits, run):
    return (np.abs(run.v[:, 6:]) - limits.velocity).max()


def test_the_limit_is_kept_to_the_second_order_of_the_period():
    """Without what the last period showed it is passed at first order."""
    assert excess(*swinging()) < 3e-6
    assert excess(*swinging(forget=True)) > 2e-5
    limits, run = swinging()
    assert np.abs(run.v[-200:, 6 + FAST] - limits.velocity[FAST]).max() < 1e-5


@pytest.mark.parametrize("delay", [2e-3, 5e-3])
def test_a_joint_stays_at_its_velocity_limit_though_commands_are_late(delay):
    limits, run = swinging(delay=delay)
    assert excess(limits, run) < 5e-3
    assert np.ptp(np.diff(run.torque[-200:, FAST])) < 0.05


def test_what_is_seen_of_a_period_is_the_drift_of_the_acceleration():
    """The mean of φ̈ over the period, less what was commanded, by the rates that come of it."""
    robot = arms.arm()
    velocity = np.full(robot.n_joints, 1e-3)
    given = JointLimits.of(robot)
    limits = JointLimits(given.torque, given.lower, given.upper, velocity)
    controller = Controller(robot, [PostureTask(name="posture", weight=1.0)], limits=limits)
    q, v = robot.configuration(), np.zeros(robot.nv)
    q[7:], v[6:] = (0.2, 0.4, -0.5, 0.3, 0.0, 0.1), (0.5, -1.0, 1.5, 0.4, 2.0, -1.0)
    h, commands = 1e-3, []

    def update(time, q, v):
        commands.append(controller.update(time, q, v))
        return commands[-1]

    run = simulate(robot, q, v, update, duration=2 * h, step=h / 4, period=h)
    mean = (run.v[4, 6:] - run.v[0, 6:]) / h
    expected = mean - commands[0].joint_acceleration
    assert np.abs(expected).max() > 1e-3
    np.testing.assert_allclose(controller._held.drift, expected, rtol=0, atol=0.02 * np.abs(expected).max())

"""Late commands, noisy sensors, long periods, weak drives: joints rest at their limits."""

import arms
import numpy as np
import pytest

import ospace
from ospace.control import (
    BaseAttitudeTask,
    Constant,
    Controller,
    DampingTask,
    JointLimits,
    PoseTask,
    PostureTask,
)
from ospace.simulation import Noise, simulate

PUSHED = {"joint_1": 1.6, "joint_2": 2.4}
UPPER = {1: 0.8, 2: 1.5}


def pushed_against_limits(duration=3.0, start=(0.0, 0.3, 1.0, -0.5, 0.4, 0.3), share=1.0, **settings):
    """A posture that is asked for beyond two limits: limits, and the run."""
    robot = arms.arm()
    limits = JointLimits.of(robot, share=share)
    upper = limits.upper.copy()
    upper[list(UPPER)] = list(UPPER.values())
    limits = JointLimits(limits.torque, limits.lower, upper, limits.velocity, limits.acceleration)
    own = {name: settings.pop(name) for name in ("limit_horizon", "period") if name in settings}
    q = robot.configuration()
    q[7:] = start
    tasks = [PostureTask(name="posture", posture=PUSHED, weight=1.0), DampingTask(name="rest", stiffness=1.0)]
    run = Controller(robot, tasks, limits=limits, **own)
    return limits, simulate(
        robot, q, np.zeros(robot.nv), run, duration=duration, period=own.get("period", 1e-3), **settings
    )


def spread(run):
    """Of torques over the last quarter, N m."""
    return np.ptp(run.torque[3 * len(run.time) // 4 :], axis=0).max()


@pytest.mark.parametrize("delay", [0.0, 2e-3, 5e-3])
def test_a_joint_rests_on_its_limit_though_commands_are_late(delay):
    limits, run = pushed_against_limits(delay=delay)
    assert spread(run) < 0.02
    assert (run.q[:, 7:] - limits.upper).max() < (1e-6 if delay == 0.0 else 1e-5)
    np.testing.assert_allclose(run.q[-1, 7 + np.array([*UPPER])], [*UPPER.values()], atol=1e-4)


@pytest.mark.parametrize("delay", [0.0, 2e-3])
def test_a_joint_rests_on_its_limit_though_encoders_are_noisy(delay):
    limits, run = pushed_against_limits(delay=delay, noise=Noise(q=1e-5))
    assert spread(run) < 1.0
    assert (run.q[:, 7:] - limits.upper).max() < 2e-5


@pytest.mark.parametrize("settings", [{"delay": 2e-3}, {"noise": Noise(q=1e-5)}])
def test_with_a_horizon_of_one_period_it_chatters(settings):
    _, run = pushed_against_limits(limit_horizon=1e-3, **settings)
    assert spread(run) > 30.0


def test_velocity_limits_are_kept_though_commands_are_late():
    limits, run = pushed_against_limits(start=(0.0, -2.5, -2.5, -0.5, 0.4, 0.3), delay=2e-3)
    assert (np.abs(run.v[:, 6:]).max(axis=0) / limits.velocity)[[1, 2]].max() > 0.9
    assert (np.abs(run.v[:, 6:]) - limits.velocity).max() < 0.01


@pytest.mark.parametrize("outside", [0.05, 0.5])
def test_from_outside_its_limits_a_joint_comes_back_though_commands_are_late(outside):
    _, run = pushed_against_limits(start=(0.0, 0.8 + outside, 1.5 + outside, -0.5, 0.4, 0.3), delay=2e-3)
    np.testing.assert_allclose(run.q[-1, 7 + np.array([*UPPER])], [*UPPER.values()], atol=1e-4)
    assert spread(run) < 0.05


def test_at_ten_hertz_it_holds_its_limits():
    limits, run = pushed_against_limits(duration=8.0, period=0.1, step=1e-2)
    assert (run.q[:, 7:] - limits.upper).max() < 1e-3
    assert spread(run) < 1.0
    assert (np.abs(run.torque) <= limits.torque).all()


def test_at_five_percent_torque_it_holds_its_limits():
    limits, run = pushed_against_limits(duration=20.0, share=0.05)
    assert (run.q[:, 7:] - limits.upper).max() < 1e-6
    np.testing.assert_allclose(run.q[-1, 7 + np.array([*UPPER])], [*UPPER.values()], atol=1e-3)
    assert (np.abs(run.torque) <= limits.torque).all()


def test_with_full_wheels_arm_and_base_come_to_rest():
    robot = arms.arm()
    q = robot.configuration()
    q[7:] = 0.0, 0.3, 1.0, -0.5, 0.4, 0.3
    goal = robot.state(q).placement(robot.point("tool"))
    goal.translation += np.array([0.05, 0.1, -0.1])
    tasks = [
        PoseTask(name="hand", point=robot.point("tool"), reference=Constant(goal), weight=10.0),
        BaseAttitudeTask(name="base", robot=robot),
        DampingTask(name="rest"),
    ]
    base = ospace.control.Base(torque=1.0, wheels=True, wheel_momentum=0.01)
    run, full, statuses = Controller(robot, tasks, base=base), 0, set()

    def law(time, q, v):
        nonlocal full
        command = run.update(time, q, v)
        statuses.add(command.status)
        full += any("wheel momentum" in name for name in command.active_limits)
        return command

    trajectory = simulate(robot, q, np.zeros(robot.nv), law, duration=8.0)
    assert full > 100
    assert statuses == {"nominal", "falling short"}
    R = [robot.base_pose(q).rotation for q in trajectory.q]
    stored = np.einsum("nji,nj->ni", R, trajectory.wheel_momentum)
    assert np.abs(stored).max() < 0.01 + 1e-4
    assert np.abs(trajectory.v[-1]).max() < 1e-3
    assert np.abs(np.diff(trajectory.torque[4000:], axis=0)).max() < 0.5

"""References: how they begin and end, and errors of large turns."""

import numpy as np
import pinocchio as pin
import pytest
from commands import unlimited

from ospace.control import (
    Constant,
    Controller,
    Function,
    MinimumJerk,
    PoseTask,
)


def test_minimum_jerk_starts_and_ends_at_rest(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    origin = chaser.state(q, v).placement(hand)
    goal = origin * pin.SE3(pin.exp3(np.array([0.4, 0.1, -0.3])), np.array([0.05, -0.1, 0.1]))
    task = PoseTask(name="hand", point=hand, reference=MinimumJerk(origin, goal, 1.0, 4.0))
    run = Controller(chaser, [task], limits=unlimited(chaser))
    for time in (0.0, 1.0):
        assert np.abs(run.update(time, q, v).errors["hand"]).max() < 1e-12
    half = run.update(3.0, q, v).errors["hand"]
    np.testing.assert_allclose(half[:3], 0.5 * (goal.translation - origin.translation), atol=1e-12)
    np.testing.assert_allclose(half[3:], 0.5 * pin.log3(goal.rotation @ origin.rotation.T), atol=1e-12)
    end = run.update(9.0, q, v).errors["hand"]
    np.testing.assert_allclose(end[3:], pin.log3(goal.rotation @ origin.rotation.T), atol=1e-12)


@pytest.mark.parametrize("angle", [1e-9, 0.5, 3.1, np.pi - 1e-7, np.pi])
def test_large_turns_are_errors_of_their_size(chaser, hand, angle):
    q, v = chaser.configuration(), np.zeros(24)
    pose = chaser.state(q, v).placement(hand)
    for axis in np.eye(3):
        goal = Constant(pin.SE3(pin.exp3(angle * axis) @ pose.rotation, pose.translation))
        run = Controller(chaser, [PoseTask(name="hand", point=hand, reference=goal)])
        error = run.update(0.0, q, v).errors["hand"]
        assert np.linalg.norm(error[3:]) == pytest.approx(angle, abs=1e-7)
        assert abs(error[3:] @ axis) == pytest.approx(angle, abs=1e-7)


def test_minimum_jerk_is_fed_forward(chaser, hand):
    """As the same motion by its definition: 10 u³ − 15 u⁴ + 6 u⁵ of the way, and of the turn about one axis."""
    q, v = chaser.configuration(), np.zeros(24)
    origin = chaser.state(q, v).placement(hand)
    way, turn, start, T = np.array([0.05, -0.1, 0.1]), np.array([0.4, 0.1, -0.3]), 1.0, 4.0
    goal = pin.SE3(pin.exp3(turn) @ origin.rotation, origin.translation + way)

    def motion(time):
        u = (time - start) / T
        s, rate, curve = (
            10.0 * u**3 - 15.0 * u**4 + 6.0 * u**5,
            (30.0 * u**2 - 60.0 * u**3 + 30.0 * u**4) / T,
            (60.0 * u - 180.0 * u**2 + 120.0 * u**3) / T**2,
        )
        pose = pin.SE3(pin.exp3(s * turn) @ origin.rotation, origin.translation + s * way)
        return pose, np.r_[rate * way, rate * turn], np.r_[curve * way, curve * turn]

    runs = [
        Controller(chaser, [PoseTask(name="hand", point=hand, reference=one)], limits=unlimited(chaser))
        for one in (MinimumJerk(origin, goal, start, T), Function(motion))
    ]
    for time in (1.3, 2.4, 3.7):
        one, other = (run.update(time, q, v).joint_acceleration for run in runs)
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(other).max())

"""References: how they begin and end, and errors of large turns."""

import numpy as np
import pinocchio as pin
import pytest
from commands import unlimited

from ospace.control import (
    Constant,
    Controller,
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

"""Completion: an error that has been small for long enough."""

import numpy as np

from ospace.control import (
    Completion,
    Controller,
    MinimumJerk,
    PoseTask,
)


def test_a_task_is_complete_when_its_error_was_small_for_long_enough(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    task = PoseTask(name="hand", point=hand, completion=Completion(position=1e-3, angle=1e-3, hold=0.2))
    run = Controller(chaser, [task])
    done = []
    for time in (0.0, 0.1, 0.19, 0.2, 0.3):
        run.update(time, q, v)
        done.append(run.completed("hand"))
    assert done == [False, False, False, True, True]
    moved = q.copy()
    moved[8] += 0.1
    run.update(0.4, moved, v)
    assert not run.completed("hand")
    run.follow("hand", MinimumJerk(run.pose(hand), run.pose(hand), 0.4, 1.0))
    for time in (0.5, 1.3, 1.4, 1.6):
        run.update(time, moved, v)
    assert run.completed("hand")
    run.follow("hand", MinimumJerk(run.pose(hand), run.pose(hand), 1.6, 1.0))
    for time in (1.6, 1.9):
        run.update(time, moved, v)
    assert not run.completed("hand")

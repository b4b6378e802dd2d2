"""Tasks in axes of their point: a tool that may roll, and what is refused."""

import math

import missions
import numpy as np
import pytest

import ospace
from ospace import scenario

NO_ROLL = [True, True, True, False, True, True]
"""The last joint turns the hand about its own x axis."""


def turning(*, axes=NO_ROLL, axes_in="point", goal=None):
    hand = {
        "name": "hand",
        "type": "pose",
        "point": "right_hand",
        "axes": axes,
        "axes_in": axes_in,
        "goal": goal or {"shift": ["-2 cm", 0, "1 cm"], "turn": [0, 0, 0], "duration": "1 s"},
        "completion": {"position": "0.2 mm", "angle": "0.02 deg", "hold": "0.1 s"},
    }
    roll = {"name": "roll", "type": "posture", "posture": {"right_arm_7": "1.5 rad"}, "weight": 0.1}
    return missions.toml(
        missions.phase("go", hand, roll, timeout="4 s"),
        robot={"model": "chaser_24dof"},
        control={"step": "2 ms", "period": "4 ms"},
        tasks=[{"name": "posture", "type": "posture", "stiffness": 1.0, "weight": 1e-3}],
    )


def test_the_axis_is_kept_while_the_tool_rolls(load):
    made = load(turning())
    run = scenario.run(made)
    assert run.passed, [phase.reason for phase in run.phases]
    robot, first, last = made.robot, run.segments[0].trajectory.q[0], run.segments[0].trajectory.q[-1]
    hand = robot.point("right_hand")
    before, after = (robot.state(q).placement(hand) for q in (first, last))
    np.testing.assert_allclose(after.translation - before.translation, [-0.02, 0.0, 0.01], atol=2.5e-4)
    assert math.acos(min(1.0, after.rotation[:, 0] @ before.rotation[:, 0])) < math.radians(0.025)
    assert after.rotation[:, 1] @ before.rotation[:, 1] < math.cos(0.3)


@pytest.mark.parametrize(("axes_in", "what"), [("tool", "is unknown"), ("points", "did you mean 'point'")])
def test_other_axes_are_refused(load, axes_in, what):
    with pytest.raises(ospace.ScenarioError) as error:
        load(turning(axes_in=axes_in))
    ((key, said),) = error.value.problems
    assert key == "phase[0].task[0].axes_in"
    assert what in said


def test_a_goal_out_of_reach_along_some_axes_of_the_point_is_left_to_the_run(load):
    """Where these axes will point is not known beforehand."""
    far = {"position": [50.0, 0, 0], "duration": "1 s"}
    with pytest.raises(ospace.ScenarioError, match="out of reach"):
        load(turning(goal=far))
    load(turning(goal=far, axes=[False, True, True, False, True, True]))

"""What a rehearsal refuses cannot run, and what it passes does: the run itself is asked."""

from pathlib import Path

import missions
import numpy as np
import pytest

import ospace
from ospace import scenario

ROBOT = Path(ospace.models.path("planar_2r")).read_text()
NARROW = ROBOT.replace('lower="-2.9671"', 'lower="-1.2"').replace('upper="2.9671"', 'upper="1.2"')


@pytest.fixture
def made(tmp_path):
    def call(text, robot=ROBOT):
        (tmp_path / "arm.urdf").write_text(robot)
        return missions.loaded(tmp_path, text)

    return call


@pytest.fixture
def place(made):
    """The tip's place at the start."""
    start = made(turning([0.5, 0, 0])).start
    return start.placement(start.robot.point("end_effector")).translation


def turning(place, *, spin=0, tip=None, timeout="12 s", grasp=None, joints=missions.PLANAR["joints"]):
    """Return a scenario in which the tip follows a target that turns by so many deg/s."""
    follow = {"goal": {"follow": "knob", "duration": "8 s"}, "completion": {"position": "5 mm", "hold": "0.1 s"}}
    body = {"mass": 50, "inertia": [3, 4, 5], "frames": {"knob": {}}}
    return missions.toml(
        missions.phase("approach", missions.TIP | follow | (tip or {}), timeout=timeout, grasp=grasp),
        robot={"model": "arm.urdf", "joints": joints},
        target={"position": [float(x) for x in place], "spin": [0, 0, f"{spin} deg/s"], "body": body},
    )


def turn(spin, **keys):
    """Return one in which the tip only turns."""
    angle = {"axes": [False] * 5 + [True], "completion": {"angle": "1 deg", "hold": "0.1 s"}}
    return turning([0.5, 0, 0], spin=spin, tip={"type": "orientation"} | angle, **keys)


def same(ready, words):
    """Rehearse and run; return the reason of a refusal."""
    run = scenario.run(ready)
    if run.complete:
        assert scenario.rehearse(ready) == ""
        assert words is None
        return
    assert words is not None
    with pytest.raises(scenario.ScenarioError) as refusal:
        scenario.rehearse(ready)
    assert words in str(refusal.value)
    assert run.phases[-1].name in str(refusal.value)


@pytest.mark.parametrize("spin", [10, -20])
def test_a_target_that_turns_is_followed(made, spin):
    """By 80 and -160 deg in the approach."""
    same(made(turn(spin)), None)


def test_a_target_that_turns_more_than_once_is_followed(made):
    """By 560 deg, with joints without limits."""
    same(made(turn(70), ROBOT.replace('type="revolute"', 'type="continuous"')), None)


def test_a_place_that_joint_limits_exclude_is_refused(made, place):
    """It is as near as the start, and behind the bus: the bound of the links' lengths knows nothing of that."""
    same(made(turning(place + [0.02, -0.05, 0]), NARROW), None)
    same(made(turning(place * [-1, 1, 1]), NARROW), "position, upper")


def test_a_grasp_that_needs_more_than_its_tasks_give_is_refused(made, place):
    """Only the place is reached, not the angle that the grasp needs."""
    grasp = {"hand": "end_effector", "fixture": "knob", "angle": "2 deg"}
    same(made(turning(place + [0.02, -0.05, 0], grasp=grasp)), "a grasp needs 10 mm and 2 deg")


def test_a_time_out_that_is_too_short_by_a_cycle_is_left_to_the_run(made, place):
    """The steps of a rehearsal are longer: what hangs on one of them is not refused."""
    ready = made(turning(place + [0.02, -0.05, 0], tip={"completion": {"position": "5 mm", "hold": "3.99 s"}}))
    assert scenario.rehearse(ready) == ""


def test_no_rehearsal_is_made_where_it_would_mislead(made):
    long = made(turn(1, timeout="300 s"))
    assert "are the most that is rehearsed" in scenario.rehearse(long)
    outside = made(turn(1, joints={"joint_2": "200 deg"}))
    assert scenario.rehearse(outside) == "its start is outside limits of joints"


def test_a_rehearsal_leaves_the_scenario_as_it_is(made):
    ready = made(turn(10))
    before = ready.start.q.copy(), ready.control
    scenario.rehearse(ready)
    np.testing.assert_array_equal(ready.start.q, before[0])
    assert ready.control == before[1]

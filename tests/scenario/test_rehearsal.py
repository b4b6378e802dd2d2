"""What can be known not to run is refused before it runs, and nothing else."""

import pytest
from missions import reaching

from ospace import scenario

FAR = {"position": [9.0, 0.5, 0]}
KNOB = {"hand": "end_effector", "fixture": "knob"}
NEAR_KNOB = KNOB | {"position": "5 mm"}
BEHIND = {"position": ["-20 cm", 0, 0]}
OUT = "phase[1].task[0].goal", "out of reach of 'end_effector'"


def goal(**place):
    return {"goal": place | {"duration": "4 s"}}


REFUSED = {
    "a target too far away": (reaching(target=FAR), *OUT),
    "a place too far away": (reaching(tip=goal(position=[-7, 0, 0])), *OUT),
    "a shift too far away": (reaching(tip=goal(shift=[0, 30, 0])), *OUT),
    "a target that has gone by then": (reaching(target={"velocity": ["2 m/s", 0, 0]}), *OUT),
    "a target that has not come by then": (reaching(target=FAR | {"velocity": ["-0.2 m/s", 0, 0]}), *OUT),
    "a robot that leaves": (reaching(robot={"velocity": ["-1 m/s", 0, 0]}), *OUT),
    "a relative pose too far apart": (
        reaching(tip={"type": "relative_pose", "seen_from": "base"} | goal(position=[9, 0, 0])),
        "phase[1].task[0].goal",
        "is 9 m from 'base'",
    ),
    "a grasp where nothing moves": (
        reaching(wait={"grasp": KNOB}).partition('[[phase]]\nname = "go"')[0],
        "phase[0].grasp",
        "no task moves 'end_effector'",
    ),
    "a grasp from too far": (
        reaching(go={"grasp": NEAR_KNOB}, tip=goal(follow="knob", offset=BEHIND)),
        "phase[1].grasp",
        "is at least 199 mm from 'knob' where task 'tip' is done: a grasp needs 5 mm",
    ),
}


@pytest.mark.parametrize(("text", "key", "what"), REFUSED.values(), ids=REFUSED)
def test_a_scenario_that_cannot_run_is_refused(load, text, key, what):
    with pytest.raises(scenario.ScenarioError) as refusal:
        load(text)
    assert what in dict(refusal.value.problems)[key]


VALID = {
    "as it is": reaching(),
    "grasped": reaching(go={"grasp": NEAR_KNOB}),
    "no completion: followed as far as it goes": reaching(target=FAR, tip={"completion": None}, go={"duration": "5 s"}),
    "thrusters go there": reaching(target=FAR, robot={"base": "thrusters"}),
    "a target that comes": reaching(target=FAR | {"velocity": ["-1 m/s", 0, 0]}),
    "both drift along": reaching(robot={"velocity": ["5 m/s", 0, 0]}, target={"velocity": ["5 m/s", 0, 0]}),
    "an axis along which it is near": reaching(
        target=FAR, tip={"type": "position", "axes": [False, True, False, False, False, False]}
    ),
    "the tool has a handle": reaching(
        go={"grasp": NEAR_KNOB}, tip={"offset": BEHIND} | goal(follow="knob", offset=BEHIND)
    ),
}


@pytest.mark.parametrize("text", VALID.values(), ids=VALID)
def test_a_scenario_that_may_run_is_not_refused(load, text):
    assert load(text).phases


def test_problems_of_all_phases_are_reported_together(load):
    """A goal of each phase that is out of reach."""
    far = reaching(target=FAR)
    far += far[far.index('[[phase]]\nname = "go"') :].replace('"go"', '"on"')
    with pytest.raises(scenario.ScenarioError) as raised:
        load(far)
    assert [key for key, _ in raised.value.problems] == ["phase[1].task[0].goal", "phase[2].task[0].goal"]

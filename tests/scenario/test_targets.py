"""Several targets: each moves by itself until it is grasped, and again when it is let go."""

import missions
import numpy as np
import pytest

import ospace
from ospace import scenario
from ospace.scenario import log
from ospace.visual import run_report

BODY = {"mass": 20, "inertia": [2, 3, 4], "frames": {"knob": {"position": [0.2, 0, 0]}}}
TANGO = {"name": "tango", "model": "target", "position": [2.0, 0.2, 0], "spin": [0, 0, "2 deg/s"]}
DEBRIS = {"name": "debris", "body": BODY, "position": [-1.0, 0.5, 0], "velocity": ["1 cm/s", 0, 0], "spin": [0, 0.1, 0]}
ANYWHERE = {"position": float("inf"), "angle": float("inf")}
TAKE_TANGO = {"hand": "end_effector", "fixture": "grapple", "target": "tango"} | ANYWHERE
TAKE_DEBRIS = {"hand": "base", "fixture": "knob", "target": "debris"} | ANYWHERE


def coast(name, **keys):
    return {"name": name, "duration": "0.2 s", "timeout": "1 s", "task": []} | keys


def mission(*phases, targets=(TANGO, DEBRIS), **tables):
    return missions.toml(
        *phases,
        robot=missions.PLANAR | {"joint_rates": {"joint_1": "5 deg/s"}},
        target=list(targets),
        control={"step": "1 ms", "period": "5 ms"},
        **tables,
    )


BOTH = (
    coast("wait"),
    coast("first", grasp=TAKE_TANGO),
    coast("second", grasp=TAKE_DEBRIS),
    coast("carry"),
    coast("let go", release="debris"),
    coast("alone", release=True),
    coast("leave"),
)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    return missions.flown(tmp_path_factory.mktemp("targets"), mission(*BOTH))


def test_both_targets_are_held_and_let_go(flown):
    assert flown.passed, [phase.reason for phase in flown.phases]
    assert [[one.name for one in segment.targets] for segment in flown.segments] == [
        ["tango", "debris"],
        ["debris"],
        [],
        ["debris"],
        ["debris", "tango"],
    ]
    assert [[hold.target for hold in segment.holds] for segment in flown.segments] == [
        [],
        ["tango"],
        ["tango", "debris"],
        ["tango"],
        [],
    ]
    masses = [segment.robot.total_mass for segment in flown.segments]
    chaser, tango = flown.scenario.robot.total_mass, flown.scenario.targets["tango"].robot.total_mass
    np.testing.assert_allclose(
        masses, [chaser, chaser + tango, chaser + tango + 20, chaser + tango, chaser], rtol=1e-12
    )


def momentum(segment, k):
    """Of the robot and of all that moves by itself, about the origin, at the start (0) or the end (-1)."""
    states = [segment.robot.state(segment.trajectory.q[k], segment.trajectory.v[k])]
    states += [one.robot.state(one.q[k], one.v[k]) for one in segment.targets]
    total = np.zeros(6)
    for state in states:
        h, place = ospace.momentum(state), state.T_WB.translation
        total += np.concatenate([h[:3], h[3:] + np.cross(place, h[:3])])
    return total


def test_the_momentum_of_all_is_kept_through_all_grasps(flown):
    before = momentum(flown.segments[0], 0)
    assert np.linalg.norm(before[:3]) > 0.01
    for segment in flown.segments:
        np.testing.assert_allclose(momentum(segment, -1), before, rtol=0, atol=1e-8)


def test_a_target_goes_on_from_where_it_was_let_go(flown):
    held, free = flown.segments[-2], flown.segments[-1]
    states, _ = scenario.holds.parts(held.holds, held.trajectory.q[-1], held.trajectory.v[-1])
    np.testing.assert_allclose(states.q, free.trajectory.q[0], atol=1e-12)
    for before, after in zip(held.targets, free.targets, strict=False):
        np.testing.assert_allclose(before.q[-1], after.q[0], atol=1e-12)


def test_log_tables_and_page_have_all_targets(flown, tmp_path):
    read = log.load(log.save(flown, tmp_path / "both.npz"))
    assert read == log.of(flown)
    assert [one.name for one in read.segments[0].targets] == ["tango", "debris"]
    written = {file.name for file in log.to_csv(flown, tmp_path / "csv") if file.parent.name == "segment_0"}
    assert {"target_tango.csv", "target_debris.csv"} <= written
    motions = run_report.motions_of(flown)
    robots = [flown.scenario.robot, *(target.robot for target in flown.scenario.targets.values())]
    assert [motion.q.shape[1] for motion in motions] == [robot.nq for robot in robots]
    for motion in motions:
        assert (motion.time[0], motion.time[-1]) == (0.0, pytest.approx(flown.duration))
        assert np.abs(np.diff(motion.q, axis=0)).max() < 0.02  # nothing jumps


def test_a_target_is_followed_by_its_name(load):
    for name, frame in (("tango", "grapple"), ("debris", "knob")):
        look = {"name": "look", "type": "look_at", "point": "end_effector", "goal": {"follow": frame, "target": name}}
        run = scenario.run(load(mission(missions.phase("look", look, duration="0.1 s", timeout="1 s"))))
        segment = run.segments[0]
        free = next(one for one in segment.targets if one.name == name)
        place = free.robot.state(free.q[0]).placement(free.robot.point(frame)).translation
        tip = segment.robot.state(segment.trajectory.q[0]).placement(segment.robot.point("end_effector"))
        line = place - tip.translation
        angle = np.arccos(tip.rotation[:, 0] @ line / np.linalg.norm(line))
        assert run.phases[0].errors["look"].norms[0, 1] == pytest.approx(angle, abs=1e-9)


def test_disturbances_and_errors_of_masses_are_of_targets_by_name(load):
    leak = {"name": "leak", "of": "debris", "point": "knob", "force": ["1 N", 0, 0]}
    text = mission(*BOTH[:4], disturbances=[leak], mass_errors=[{"of": "tango", "mass": 0.5}])
    run = scenario.run(load(text))
    assert run.passed
    free, _, held = run.segments
    assert free.trajectory.impulse[-1, 0] == 0.0
    assert held.trajectory.impulse[-1, 0] == pytest.approx(0.2, rel=1e-9)


def test_frames_of_the_same_name_are_told_apart_by_the_targets(load):
    twins = [{"name": name, "body": BODY, "position": [2.0, y, 0]} for name, y in (("a", 0.0), ("b", 1.0))]
    takes = [
        coast(f"take {name}", grasp={"hand": hand, "fixture": "knob", "target": name} | ANYWHERE)
        for name, hand in (("a", "end_effector"), ("b", "base"))
    ]
    run = scenario.run(load(mission(*takes, coast("carry"), targets=twins)))
    assert run.passed
    assert {"knob", "b/knob"} <= set(run.segments[-1].robot.frame_names)
    assert run.segments[-1].holds[1].frames["knob"] == "b/knob"


def test_an_array_of_one_target_needs_no_name(load):
    unnamed = {key: value for key, value in TANGO.items() if key != "name"}
    made = load(mission(coast("wait", grasp={"hand": "base", "fixture": "grapple"} | ANYWHERE), targets=[unnamed]))
    assert list(made.targets) == ["target"]


def look(**goal):
    task = {"name": "look", "type": "look_at", "point": "end_effector", "goal": {"follow": "grapple"} | goal}
    return missions.phase("look", task, duration="0.1 s", timeout="1 s")


@pytest.mark.parametrize(
    ("phases", "targets", "key", "what"),
    [
        ((look(),), (TANGO, DEBRIS), "phase[0].task[0].goal.follow", "there are several targets: give target as well"),
        ((look(target="tang"),), (TANGO, DEBRIS), "phase[0].task[0].goal.target", "did you mean 'tango'"),
        ((look(target="debris"),), (TANGO, DEBRIS), "phase[0].task[0].goal.follow", "no frame 'grapple' in"),
        ((BOTH[1], look(target="tango")), (TANGO, DEBRIS), "phase[1].task[0].goal.follow", "is held already"),
        ((BOTH[1], BOTH[1] | {"name": "again"}), (TANGO, DEBRIS), "phase[1].grasp", "is held already"),
        ((BOTH[1], BOTH[4]), (TANGO, DEBRIS), "phase[1].release", "'debris' is not held"),
        (
            (BOTH[1], BOTH[2], coast("go", release="tango")),
            (TANGO, DEBRIS),
            "phase[2].release",
            "'tango' is held, but 'debris' was grasped after it: let that go first",
        ),
        ((coast("a"),), (TANGO, DEBRIS | {"name": None}), "target[1].name", "missing: there are several targets"),
        ((coast("a"),), (TANGO, DEBRIS | {"name": "tango"}), "target[1].name", "two targets are called 'tango'"),
        ((coast("a"),), (TANGO, DEBRIS | {"name": "robot"}), "target[1].name", "is the chaser"),
        ((coast("a"),), (TANGO, DEBRIS | {"spin": 3}), "target[1].spin", "give a list of 3"),
    ],
)
def test_targets_that_are_mixed_up_are_refused(load, phases, targets, key, what):
    with pytest.raises(ospace.ScenarioError) as error:
        load(mission(*phases, targets=targets))
    ((named, said),) = error.value.problems
    assert named == key
    assert what in said

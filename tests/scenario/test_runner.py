"""Runs: what the scenarios that come with ospace promise, and what becomes of those that fail."""

import math

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import scenario
from ospace.scenario import log, motion, runner
from ospace.simulation import grasp


def worst(run, task, column):
    return max(phase.errors[task].worst[column] for phase in run.phases if task in phase.errors)


def certified(run):
    assert run.passed, [phase.reason for phase in run.phases]
    assert run.exceeded == {}
    assert all(set(phase.statuses) == {"nominal"} for phase in run.phases)
    assert all(phase.near_singularity == {} for phase in run.phases)


def test_the_grasp_of_the_paper_keeps_its_tolerances(grasped):
    certified(grasped)
    (held,) = (phase.grasp for phase in grasped.phases if phase.grasp)
    assert held.position_error < 1e-5  # asked for: 1 mm, 0.1 deg
    assert held.angle_error < math.radians(1e-3)
    np.testing.assert_allclose(held.velocity_error, 0.0, atol=1e-5)
    assert worst(grasped, "head", 1) < math.radians(0.01)
    assert worst(grasped, "base", 1) < math.radians(0.01)
    for segment in grasped.segments:
        assert not segment.trajectory.base_wrench.any()
        assert not segment.trajectory.wheel_torque.any()
    assert {one.name for one in grasped.certificate.quantities} >= {"linear momentum", "grasp momentum", "grasp energy"}


def test_head_and_base_keep_their_orientation_in_the_grasp(grasped):
    """Not by what the controller calls its error."""
    for frame in ("head", "base"):
        first = None
        for segment in grasped.segments:
            point = segment.robot.point(frame)
            for k in range(0, len(segment.trajectory), 100):
                R = segment.robot.state(segment.trajectory.q[k]).placement(point).rotation
                first = R if first is None else first
                assert math.acos(min(1.0, (np.trace(R @ first.T) - 1.0) / 2.0)) < math.radians(0.01)


def test_sigma_min_of_the_grasp_is_that_of_the_generalized_jacobian(grasped):
    for phase in (grasped.phases[1], grasped.phases[3]):
        segment = grasped.segments[phase.segment]
        k = int(np.argmin(np.abs(segment.trajectory.time - phase.time[1000])))
        state = segment.robot.state(segment.trajectory.q[k], segment.trajectory.v[k])
        for task, frame, axes in (
            ("right hand", "right_hand", "all"),
            ("head", "head", "angular"),
            ("base", "base", "angular"),
        ):
            if task in phase.sigma_min:
                J = ospace.generalized_jacobian(state, segment.robot.point(frame, axes=axes)).generalized_jacobian
                smallest = np.linalg.svd(J, compute_uv=False)[-1]
                assert phase.sigma_min[task][1000] == pytest.approx(smallest, rel=1e-9)
    assert [len(phase.sigma_min) for phase in grasped.phases] == [3, 3, 3, 2]


def test_the_hand_meets_the_fixture(grasped):
    """By the last states of both before the grasp."""
    segment = grasped.segments[0]
    hand = segment.robot.state(segment.trajectory.q[-1]).placement(segment.robot.point("right_hand"))
    (free,) = segment.targets
    fixture = free.robot.state(free.q[-1]).placement(free.robot.point("grapple"))
    assert free.time[-1] == pytest.approx(segment.trajectory.time[-1])
    np.testing.assert_allclose(hand.translation, fixture.translation, rtol=0, atol=1e-5)
    np.testing.assert_allclose(hand.rotation, fixture.rotation, rtol=0, atol=1e-5)


def test_a_free_flying_grasp_keeps_the_base_and_ends_at_rest():
    run = scenario.run(scenario.load(ospace.models.scenario("grasp_flying")))
    certified(run)
    assert worst(run, "base", 0) < 1e-5
    assert worst(run, "base", 1) < math.radians(1e-3)
    after = run.segments[1].trajectory
    assert np.abs(after.v[-1]).max() < 1e-5  # chaser and target are at rest
    assert np.abs(run.segments[0].trajectory.base_wrench).max() > 0.1


def test_ets_vii_captures_its_target_and_comes_to_rest():
    run = scenario.run(scenario.load(ospace.models.scenario("ets_vii_capture")))
    certified(run)
    (held,) = (phase.grasp for phase in run.phases if phase.grasp)
    assert held.position_error < 1e-4
    assert np.abs(run.segments[1].trajectory.v[-1, 6:]).max() < 1e-4  # the arm stands, both turn as one


def test_detumbling_moves_the_momentum_to_the_wheels():
    run = scenario.run(scenario.load(ospace.models.scenario("detumble")))
    certified(run)
    share, dump = run.phases[1:]
    after = run.segments[1].trajectory
    begun = np.linalg.norm(after.momentum[0, 3:])
    assert begun > 1.0
    before_dump = np.searchsorted(after.time, dump.start)
    assert np.linalg.norm(after.momentum[before_dump, 3:]) == pytest.approx(begun, rel=1e-3)
    assert np.linalg.norm(after.momentum[-1, 3:]) < 0.01
    taken = after.wheel_momentum[-1] - after.wheel_momentum[0]
    assert np.linalg.norm(taken) == pytest.approx(begun, rel=0.01)
    assert np.abs(after.v[before_dump, 6:]).max() < 1e-2  # joints stand when the momentum is shared
    assert dump.active_limits
    assert share.outcome == "complete"


def test_wheels_are_as_full_at_the_start_of_a_phase_as_at_the_end_of_the_one_before(load):
    """Of a base that turns with more than they take, which fills them in the first of three phases."""
    base = {"name": "base", "type": "base_attitude"}
    text = missions.toml(
        *(missions.phase(name, duration="2 s", timeout="3 s") for name in ("fill", "keep", "and keep")),
        robot=missions.PLANAR
        | {"base": {"torque": "5 N m", "wheels": True, "wheel_momentum": "1 N m s"}}
        | {"angular_velocity": [0, 0, "10 deg/s"]},
        control={"step": "5 ms", "period": "10 ms"},
        tasks=[missions.REST, base],
    )
    run = scenario.run(load(text))
    trajectory = run.segments[0].trajectory
    assert trajectory.momentum[0, 5] > 2.0
    stored = trajectory.wheel_momentum[trajectory.time >= run.phases[0].end - 1e-9, 2]
    np.testing.assert_allclose(stored, 1.0, rtol=0, atol=1e-9)


def test_a_wrong_impulse_is_seen(monkeypatch):
    def wrong(*given):
        held = grasp(*given)
        v = held.state.v.copy()
        v[6] += 1e-3
        return runner.replace(held, state=held.state.robot.state(held.state.q, v))

    monkeypatch.setattr(runner, "grasp", wrong)
    made = scenario.load(ospace.models.scenario("detumble"))
    run = scenario.run(runner.replace(made, phases=made.phases[:2]))
    assert not run.certificate["grasp momentum"].passed or not run.certificate["grasp energy"].passed
    assert not run.passed


def test_a_reference_that_does_not_follow_the_target_is_seen(monkeypatch):
    """As one that takes the target's place where it is at the start."""
    honest = motion.FreeMotion.frame

    def standing(self, point):
        first = honest(self, point)(self.first, self.first + 1)
        return motion.still(motion.pin.SE3(first.rotation[0], first.place[0]))

    monkeypatch.setattr(motion.FreeMotion, "frame", standing)
    made = scenario.load(ospace.models.scenario("detumble"))
    run = scenario.run(made)
    assert not run.passed
    assert run.phases[0].outcome == "failed"
    assert "a grasp needs 1 mm and 0.1 deg" in run.phases[0].reason


def test_phases_take_their_time(load):
    run = scenario.run(load(missions.SHORT))
    assert run.passed
    one, two = run.phases
    assert (one.start, one.end) == (0.0, pytest.approx(0.05))
    assert (two.start, two.end) == (one.end, pytest.approx(0.35))
    assert len(one.time) == 5
    assert len(two.time) == 30
    assert two.errors["tip"].last[0] < 1e-3
    trajectory = run.segments[0].trajectory
    places = [run.scenario.robot.state(q).placement(run.scenario.robot.point("end_effector")) for q in trajectory.q]
    moved = places[-1].translation - places[0].translation
    np.testing.assert_allclose(moved, [-0.01, 0.01, 0.0], rtol=0, atol=1e-3)
    assert np.isnan(two.errors["tip"].last[1])
    assert len(run.segments) == 1
    assert len(run.segments[0].trajectory) == 71


def test_a_phase_that_does_not_complete_times_out(load):
    later = missions.phase("three", duration=1, timeout=1)
    run = scenario.run(load(missions.short(later, tip={"completion": {"position": "1e-30 m"}})))
    assert not run.passed
    assert run.certificate.passed
    assert [phase.outcome for phase in run.phases] == ["complete", "timed out"]
    assert run.phases[1].reason == "not complete after 0.4 s: tip"
    assert run.duration == pytest.approx(0.45)


def test_a_grasp_where_the_hand_did_not_go_fails(load):
    held = {"hand": "end_effector", "fixture": "grapple"}
    run = scenario.run(load(missions.short(move={"grasp": held}, target={"model": "target", "position": [2.5, 0, 0]})))
    assert run.phases[-1].outcome == "failed"
    assert "a grasp needs 10 mm and 1 deg" in run.phases[-1].reason
    assert not run.passed


def test_a_release_gives_both_back(load):
    """The hand lets go of what it took, and either goes on as it was."""
    text = missions.short(
        missions.phase("three", duration=0.1, timeout=1, release=True),
        missions.phase("four", duration=0.1, timeout=1),
        wait={"grasp": missions.GRASP},
        target={"model": "target", "spin": [0, 0, "1 deg/s"]},
        control={"step": "1 ms"},
    )
    run = scenario.run(load(text))
    assert run.passed, run.certificate
    first, held, last = run.segments
    assert (first.robot, held.robot is first.robot, last.robot) == (run.scenario.robot, False, run.scenario.robot)
    assert held.targets == ()
    assert last.targets[0].time[0] == pytest.approx(run.phases[2].end)
    point = first.robot.point("end_effector"), first.targets[0].robot.point("grapple")

    def apart(segment, k):
        poses = (
            segment.robot.state(segment.trajectory.q[k]).placement(point[0]),
            segment.targets[0].robot.state(segment.targets[0].q[k]).placement(point[1]),
        )
        return poses[0].actInv(poses[1])

    assert apart(first, -1).isApprox(apart(last, 0), 1e-9)
    np.testing.assert_allclose(last.trajectory.q[0], held.trajectory.q[-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(last.trajectory.v[0], held.trajectory.v[-1], rtol=0, atol=1e-12)


def test_a_task_of_all_phases_follows_the_target_anew_after_its_release(load):
    """Held, the target was moved; what follows it from then on is not where it would have been by itself."""
    look = {"name": "look", "type": "look_at", "point": "end_effector", "weight": 1e-6, "goal": {"follow": "grapple"}}
    text = missions.toml(
        missions.phase("one", duration=0.5, timeout=1, grasp=missions.GRASP),
        missions.phase("two", {"name": "look", "type": "damping"}, duration=1, timeout=2, release=True),
        missions.phase("three", duration=0.1, timeout=1),
        robot=missions.PLANAR,
        target={"model": "target", "velocity": ["-5 cm/s", 0, 0]},
        control={"step": "1 ms", "period": "10 ms"},
        tasks=[missions.REST, look],
    )
    run = scenario.run(load(text))
    assert run.complete, [phase.reason for phase in run.phases]
    last = run.segments[-1]
    q, v = last.trajectory.q[0], last.trajectory.v[0]
    tip, axis = last.robot.state(q, v).placement(last.robot.point("end_effector")), np.array([1.0, 0.0, 0.0])
    (free,) = last.targets
    line = free.robot.state(free.q[0]).placement(free.robot.point("grapple")).translation - tip.translation
    angle = math.acos(tip.rotation @ axis @ line / np.linalg.norm(line))
    assert run.phases[2].errors["look"].norms[0, 1] == pytest.approx(angle, abs=1e-9)


def test_a_simulation_that_fails_keeps_what_was_run(load, monkeypatch):
    honest = runner.Controller.update

    def update(self, time, q, v):
        if time > 0.2:
            raise ospace.OspaceError("something is wrong")
        return honest(self, time, q, v)

    monkeypatch.setattr(runner.Controller, "update", update)
    run = scenario.run(load(missions.SHORT))
    assert [phase.outcome for phase in run.phases] == ["complete", "failed"]
    assert run.phases[1].reason == "something is wrong"
    assert run.duration == pytest.approx(0.205)


def test_a_phase_that_cannot_begin_fails(load, monkeypatch):
    """The one before it stays complete."""
    honest = runner.Start.reference

    def reference(start, plan):
        if plan.name == "tip":
            raise ospace.OspaceError("nothing to follow")
        return honest(start, plan)

    monkeypatch.setattr(runner.Start, "reference", reference)
    run = scenario.run(load(missions.SHORT))
    assert [phase.outcome for phase in run.phases] == ["complete", "failed"]
    assert run.phases[1].reason == "nothing to follow"
    assert run.phases[1].start == run.phases[1].end


def test_shift_and_turn_of_the_base_are_those_of_the_trajectory(run):
    assert any(phase.base_motion[:, 1].max() > 1e-3 for phase in run.phases)
    for phase in run.phases:
        trajectory = run.segments[phase.segment].trajectory
        assert len(phase.base_motion) == len(phase.time)
        for k in (0, len(phase.time) // 2, -1):
            first, now = (
                pin.XYZQUATToSE3(trajectory.q[np.abs(trajectory.time - time).argmin(), :7])
                for time in (phase.time[0], phase.time[k])
            )
            shift, turn = phase.base_motion[k]
            assert shift == pytest.approx(np.linalg.norm(now.translation - first.translation), abs=1e-12)
            assert turn == pytest.approx(np.linalg.norm(pin.log3(first.rotation.T @ now.rotation)), abs=1e-7)


def test_zero_reaction_leaves_the_base_in_peace(load):
    """The arm of two joints moves its tip by 10 cm along x, and has one joint left for the base."""
    tip = missions.TIP | {"axes": [True, False, False, False, False, False], "level": 1}
    tip |= {"goal": {"shift": ["-0.1 m", 0, 0], "duration": "2 s"}, "completion": {"position": "5 mm"}}
    peace = {"name": "peace", "type": "zero_reaction", "level": 0, "completion": {"angle": "1 mrad/s"}}
    turns = {}
    for tasks in ([tip], [tip, peace]):
        text = missions.toml(
            missions.phase("move", *tasks, timeout="4 s"),
            robot=missions.PLANAR,
            control={"step": "5 ms", "period": "10 ms"},
            tasks=[missions.REST],
        )
        run = scenario.run(load(text))
        assert run.passed, [phase.reason for phase in run.phases]
        turns[len(tasks)] = math.degrees(run.phases[0].base_motion[:, 1].max())
    assert turns[1] > 1.0
    assert turns[2] < 1e-4


@pytest.mark.parametrize("turn", [-200.0, 180.0, 500.0])
def test_a_turn_of_any_angle_is_made(load, turn):
    """By the base, on wheels; 500 deg is one whole turn and 140 deg."""
    base = {
        "name": "base",
        "type": "base_attitude",
        "goal": {"turn": [0, 0, f"{turn} deg"], "duration": "8 s"},
        "completion": {"angle": "1 deg", "hold": "0.1 s"},
    }
    text = missions.toml(
        missions.phase("turn", base, timeout="9 s"),
        robot=missions.PLANAR | {"base": "wheels"},
        control={"step": "5 ms", "period": "10 ms"},
        tasks=[missions.REST],
    )
    run = scenario.run(load(text))
    assert run.complete, [phase.reason for phase in run.phases]
    q, v = run.segments[0].trajectory.q, run.segments[0].trajectory.v
    turned = np.trapezoid(v[:, 5], run.segments[0].trajectory.time)
    assert math.degrees(turned) == pytest.approx(turn, abs=1.5)
    assert abs(q[-1, 3:7] @ pin.SE3ToXYZQUAT(pin.SE3(pin.exp3(np.radians([0, 0, turn])), np.zeros(3)))[3:]) > 0.9998


@pytest.mark.parametrize("when", [0.0, 0.03, 0.045, 0.05, 0.2, 0.35])
def test_an_interrupt_keeps_what_was_run(load, when):
    def interrupt(time):
        if time >= when:
            raise KeyboardInterrupt

    run = scenario.run(load(missions.SHORT), interrupt)
    assert run.interrupted
    assert not run.passed
    assert run.phases[-1].outcome == ("complete" if when == 0.35 else "interrupted")  # its last cycle was on its way
    assert run.duration == pytest.approx(when, abs=0.011)
    assert run.phases[-1].end == run.segments[-1].trajectory.time[-1]


def test_a_log_holds_the_run(tmp_path, grasped):
    read = log.load(log.save(grasped, tmp_path / "out.npz"))
    assert read == log.of(grasped)
    assert read.scenario == ospace.models.scenario("grasp").read_text()
    for stored, segment in zip(read.segments, grasped.segments, strict=True):
        np.testing.assert_array_equal(stored.trajectory.q, segment.trajectory.q)
        assert stored.trajectory.certificate().passed
        assert stored.joints == tuple(segment.robot.joint_names)
        np.testing.assert_array_equal(stored.torque_limits, segment.robot.model.effortLimit[6:])
    np.testing.assert_array_equal(read.segments[0].targets[0].q, grasped.segments[0].targets[0].q)
    assert read.segments[1].targets == ()

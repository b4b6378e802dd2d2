"""Noisy sensors and late commands: what the controller gets, what is logged, and what is refused."""

import json
import math

import missions
import numpy as np
import pytest

import ospace
from ospace import scenario
from ospace.scenario import log, summary_text
from ospace.scenario.schema import json_schema

NOISY = {"joints": "0.1 deg", "joint_rates": "0.1 deg/s", "seed": 7}


def holding(*, noise=None, duration="0.5 s", **control):
    tip = missions.TIP | {"completion": {"position": "1 m"}}
    return missions.toml(
        missions.phase("hold", tip, duration=duration, timeout="2 s"),
        robot=missions.PLANAR,
        noise=noise,
        control={"step": "1 ms", "period": "5 ms"} | control,
        tasks=[missions.REST],
    )


def seen_by_the_controller(monkeypatch):
    """Return the list of what every controller's update is given from now on."""
    honest, seen = scenario.runner.Controller.update, []

    def update(self, time, q, v):
        seen.append((self, time, np.array(q), np.array(v)))
        return honest(self, time, q, v)

    monkeypatch.setattr(scenario.runner.Controller, "update", update)
    return seen


def test_the_controller_sees_noise_of_the_size_that_is_given(load, monkeypatch):
    seen = seen_by_the_controller(monkeypatch)
    by_joint = {"joint_1": "1 mrad"}
    noise = {"position": "2 mm", "angle": "0.2 deg", "velocity": "3 mm/s", "joints": by_joint, "seed": 3}
    run = scenario.run(load(holding(noise=noise, duration="2 s").replace('timeout = "2 s"', 'timeout = "3 s"')))
    trajectory = run.segments[0].trajectory
    controller, truth = seen[-2][0], seen[-1][0]
    mine, its = ([one[1:] for one in seen if one[0] is own] for own in (controller, truth))
    assert len(mine) == 400
    k = [int(np.argmin(np.abs(trajectory.time - time))) for time, _, _ in mine]
    off_v = np.array([v for _, _, v in mine]) - trajectory.v[k]
    off_q = np.array([q for _, q, _ in mine]) - trajectory.q[k]
    assert off_q[:, :3].std() == pytest.approx(2e-3, rel=0.1)
    assert 2.0 * off_q[:, 3:6].std() == pytest.approx(math.radians(0.2), rel=0.1)
    assert off_q[:, 7].std() == pytest.approx(1e-3, rel=0.1)
    assert not off_q[:, 8].any()
    assert off_v[:, :3].std() == pytest.approx(3e-3, rel=0.1)
    assert not off_v[:, 3:].any()
    np.testing.assert_array_equal([q for _, q, _ in its], trajectory.q[k])


def test_errors_of_a_noisy_run_are_the_true_ones(load):
    run = scenario.run(load(holding(noise=NOISY)))
    assert run.certificate.passed
    (phase,) = run.phases
    robot, q, _ = missions.at_cycles(run, phase)
    tip = robot.point("end_effector")
    places = np.array([robot.state(one).placement(tip).translation for one in q])
    np.testing.assert_allclose(phase.poses["end_effector"][:, :3], places, atol=1e-12)
    held = scenario.runner.Sensors(robot, run.scenario.noise.of(robot, robot, 0)).measure(q[0], 0.0 * q[0, 1:])[0]
    off = places[:, :2] - robot.state(held).placement(tip).translation[:2]
    assert np.linalg.norm(off[0]) > 1e-5  # what is held is where the tip was measured to be
    np.testing.assert_allclose(phase.errors["tip"].norms[:, 0], np.linalg.norm(off, axis=1), atol=1e-12)


def test_the_same_seed_gives_the_same_run_and_another_one_another(load):
    one, same, other = (
        scenario.run(load(holding(noise=NOISY | {"seed": seed}))).segments[0].trajectory.q[-1] for seed in (7, 7, 8)
    )
    np.testing.assert_array_equal(one, same)
    assert np.abs(one - other).max() > 1e-6


def test_noise_differs_from_segment_to_segment(load):
    made = load(holding(noise=NOISY))
    draws = [made.noise.of(made.robot, made.robot, segment).seed for segment in (0, 1)]
    assert draws[0] != draws[1]


@pytest.mark.parametrize("delay", [1, 5, 12])
def test_commands_act_late(load, delay):
    on_time, late = (scenario.run(load(holding(delay=f"{ms} ms", noise=NOISY))) for ms in (0, delay))
    first, second = (run.segments[0].trajectory for run in (on_time, late))
    assert not second.torque[:delay].any()
    np.testing.assert_array_equal(second.torque[delay], first.torque[0])
    assert first.torque[0].any()
    assert late.certificate.passed
    changes = np.flatnonzero(np.diff(second.torque[:, 0])) + 1
    assert set((changes - delay) % 5) == {0}


def test_commands_on_their_way_go_on_after_a_grasp_and_a_release(load, monkeypatch):
    """Nothing says to the drives that the robot has changed."""
    text = missions.MISSION.replace('step = "1 ms"', 'step = "1 ms"\ndelay = "7 ms"')
    made = scenario.run(load(text.replace('goal = { shift = ["-1 cm", "1 cm", 0]', 'goal = { shift = ["-5 cm", 0, 0]')))
    assert [phase.outcome for phase in made.phases] == ["complete"] * 3
    assert made.certificate.passed
    for before, after in zip(made.segments, made.segments[1:], strict=False):
        n = min(before.trajectory.torque.shape[1], after.trajectory.torque.shape[1])
        assert after.trajectory.torque[0, :n].any()
        ahead = np.abs(after.trajectory.torque[0, :n] - before.trajectory.torque[-2, :n]).max()
        assert ahead < 0.2 * np.abs(before.trajectory.torque[-2, :n]).max() + 1e-3


def test_motion_limits_are_seen_eight_delays_ahead(load):
    assert load(holding(delay="10 ms")).control.settings["limit_horizon"] == pytest.approx(0.08)
    assert load(holding(delay="2 ms")).control.settings["limit_horizon"] == pytest.approx(0.04)
    assert load(holding()).control.settings["limit_horizon"] is None
    given = load(holding(delay="10 ms", limit_horizon="50 ms"))
    assert given.control.settings["limit_horizon"] == pytest.approx(0.05)


@pytest.mark.parametrize(
    ("noise", "control", "key", "what"),
    [
        ({"joint": 1.0}, {}, "noise.joint", "did you mean 'joints'"),
        ({"joints": "1 mm"}, {}, "noise.joints", "unit 'mm', a unit of length"),
        ({"joints": -1.0}, {}, "noise.joints", "at least 0 rad"),
        ({"joints": {"joint_3": 0.1}}, {}, "noise.joints.joint_3", "no joint 'joint_3'; did you mean"),
        ({"joints": {"joint_1": -0.1}}, {}, "noise.joints.joint_1", "at least 0 rad"),
        ({"joint_rates": {"joint_1": "1 deg"}}, {}, "noise.joint_rates.joint_1", "unit 'deg', a unit of angle"),
        ({"seed": 1.5}, {}, "noise.seed", "give a whole number from 0 to"),
        ({}, {"delay": "1.5 ms"}, "control.delay", "0.0015 s is not a whole number of steps of 0.001 s"),
        ({}, {"delay": "-1 ms"}, "control.delay", "at least 0 s"),
    ],
)
def test_noise_and_delay_that_make_no_sense_are_refused(load, noise, control, key, what):
    with pytest.raises(ospace.ScenarioError) as error:
        load(holding(noise=noise, **control))
    ((named, said),) = error.value.problems
    assert named == key
    assert what in said


def test_the_table_tells_of_noise_and_delay(load):
    told = list(summary_text.conditions(load(holding(noise=NOISY, delay="4 ms"))))
    assert told == [
        "commands act 4 ms late",
        "sensors are noisy (seed 7): errors of tasks are the true ones, not those measured",
    ]
    assert not list(summary_text.conditions(load(holding())))


def test_a_noisy_scenario_is_rehearsed_without_noise_and_delay(load):
    assert scenario.rehearse(load(holding(noise=NOISY | {"joints": "40 deg"}, delay="3 ms"))) == ""


def test_the_log_of_a_noisy_run_is_read_again(load, tmp_path):
    run = scenario.run(load(holding(noise=NOISY, delay="3 ms")))
    assert log.load(log.save(run, tmp_path / "noisy.npz")) == log.of(run)


def test_the_schema_has_noise():
    keys = json_schema()["$defs"]["NoiseTable"]["properties"]
    assert json.dumps(keys["joints"])
    assert keys["seed"]["minimum"] == 0

"""Disturbances: their impulse is that of the file, the certificate balances it and says so, and nothing else does."""

import math
from dataclasses import replace

import missions
import numpy as np
import pytest

import ospace
from ospace import scenario
from ospace.scenario import log, summary_text
from ospace.scenario.disturbances import Disturbances
from ospace.scenario.motion import FreeMotion

PLUME = {"name": "plume", "point": "base", "force": ["2 N", 0, "1 N"], "start": "0.1013 s", "duration": "0.25 s"}
TWIST = {"name": "twist", "point": "end_effector", "torque": [0, "0.3 N m", "0.1 N m"]}
SHAKER = {"name": "shaker", "point": "end_effector", "force": ["3 N", 0, 0], "frequency": "4 Hz"}
LEAK = {"name": "leak", "of": "target", "point": "grapple", "force": [0, "0.5 N", 0]}
BESIDE = {"model": "target", "position": [2.0, 0.1, 0.0], "spin": [0, 0, "3 deg/s"]}


def drifting(*disturbances, duration="1 s", control=None, robot=None, **tables):
    coast = {"name": "coast", "duration": duration, "timeout": "5 s", "task": []}
    return missions.toml(
        coast,
        robot=missions.PLANAR | {"joint_rates": {"joint_1": "5 deg/s", "joint_2": "-3 deg/s"}} | (robot or {}),
        control={"step": "1 ms", "period": "5 ms"} | (control or {}),
        disturbances=disturbances,
        **tables,
    )


def gained(run, segment=0):
    """Return by how much the momentum (6,) has changed, about the mass centre."""
    trajectory = run.segments[segment].trajectory
    return trajectory.momentum[-1] - trajectory.momentum[0]


@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
def test_the_momentum_grows_by_force_times_time_also_within_steps(load, integrator):
    run = scenario.run(load(drifting(PLUME, control={"integrator": integrator})))
    np.testing.assert_allclose(gained(run)[:3], 0.25 * np.array([2.0, 0.0, 1.0]), rtol=0, atol=1e-10)
    assert run.passed
    velocity = np.diff(run.segments[0].trajectory.momentum[:, 0])
    pushed = np.flatnonzero(np.abs(velocity) > 1e-9)
    assert (pushed[0], pushed[-1]) == (101, 351)


def test_the_angular_momentum_grows_by_torque_times_time(load):
    run = scenario.run(load(drifting(TWIST)))
    np.testing.assert_allclose(gained(run), [0, 0, 0, 0, 0.3, 0.1], rtol=0, atol=1e-10)


def test_a_sine_gives_its_integral(load):
    run = scenario.run(load(drifting(SHAKER | {"start": "0.2 s", "duration": "0.6 s"})))
    omega = 2.0 * math.pi * 4.0
    assert gained(run)[0] == pytest.approx(3.0 / omega * (1.0 - math.cos(omega * 0.6)), rel=1e-6)
    assert run.passed


def test_disturbances_at_one_frame_add_up(load):
    run = scenario.run(load(drifting(PLUME, PLUME | {"name": "again"})))
    np.testing.assert_allclose(gained(run)[:3], 0.5 * np.array([2.0, 0.0, 1.0]), rtol=0, atol=1e-10)


def test_the_certificate_balances_a_disturbance_and_says_that_nothing_was_conserved(load, tmp_path):
    run = scenario.run(load(drifting(PLUME, TWIST, SHAKER, LEAK, duration="2 s", target=BESIDE)))
    assert run.passed
    assert run.certificate["linear momentum"].given == pytest.approx(2.0 * 0.5, rel=1e-9)
    said = str(run.certificate).splitlines()[-1]
    assert said.startswith("not conserved but balanced: from outside came up to 1 kg m/s, ")
    assert len(said) <= 80
    assert log.load(log.save(run, tmp_path / "pushed.npz")) == log.of(run)
    assert log.load(tmp_path / "pushed.npz").certificate.from_outside == run.certificate.from_outside
    assert scenario.run(load(drifting())).certificate.from_outside == ""


def test_an_impulse_that_is_not_accounted_for_fails_the_certificate(load):
    trajectory = scenario.run(load(drifting(PLUME))).segments[0].trajectory
    assert trajectory.certificate().passed
    for share in (0.0, 1.0 - 1e-6):
        certificate = replace(trajectory, impulse=share * trajectory.impulse).certificate()
        assert not certificate["linear momentum"].passed
    assert not replace(trajectory, work=0.0 * trajectory.work).certificate()["work and energy"].passed


def test_a_controller_resists_a_disturbance_that_it_does_not_know(load):
    hold = missions.TIP | {"stiffness": 100.0}
    text = missions.toml(
        missions.phase("hold", hold, duration="3 s", timeout="5 s"),
        robot=missions.PLANAR | {"base": "flying"},
        tasks=[missions.REST, {"name": "base", "type": "base_attitude"}],
        disturbances=[{"name": "push", "point": "end_effector", "force": ["1 N", 0, 0]}],
    )
    run = scenario.run(load(text))
    assert run.passed
    last = run.phases[0].errors["tip"].last[0]
    assert 1e-4 < last < 0.02  # it gives way, and holds


def test_a_target_is_followed_as_the_disturbance_moves_it(load):
    made = load(drifting(LEAK | {"frequency": "0.5 Hz"}, target=BESIDE))
    robot, state = made.targets["target"]
    point = robot.point("grapple")
    own = Disturbances({one: robot.point(one.point) for one in made.disturbances}, 1e-3)
    free = FreeMotion(robot, state, 0, 1e-3, 1e-3, "rk4", own)
    motion = free.frame(point)(200, 403)
    np.testing.assert_allclose(
        motion.acceleration[1:-1], (motion.velocity[2:] - motion.velocity[:-2]) / 2e-3, rtol=0, atol=1e-6
    )
    assert np.abs(motion.acceleration[:, 1]).max() > 1e-3
    undisturbed = FreeMotion(robot, state, 0, 1e-3, 1e-3, "rk4").frame(point)(402, 403)
    assert abs(motion.place[-1, 1] - undisturbed.place[0, 1]) > 1e-5


def test_a_disturbance_of_the_target_goes_on_when_it_is_held_and_let_go(load):
    grasp = {"name": "take", "duration": "0.2 s", "timeout": "1 s", "task": [], "grasp": missions.GRASP}
    carry = {"name": "carry", "duration": "0.3 s", "timeout": "1 s", "task": [], "release": True}
    leave = {"name": "leave", "duration": "0.2 s", "timeout": "1 s", "task": []}
    text = missions.toml(
        grasp,
        carry,
        leave,
        robot=missions.PLANAR,
        target=BESIDE,
        disturbances=[LEAK, PLUME | {"start": 0, "duration": float("inf")}],
        control={"step": "1 ms", "period": "5 ms"},
    )
    run = scenario.run(load(text))
    assert run.passed, [phase.reason for phase in run.phases]
    plume, leak = np.array([2.0, 0.0, 1.0]), np.array([0.0, 0.5, 0.0])
    for segment, force, time in ((0, plume, 0.2), (1, plume + leak, 0.3), (2, plume, 0.2)):
        np.testing.assert_allclose(gained(run, segment)[:3], time * force, rtol=0, atol=1e-10)
    mass = run.scenario.targets["target"].robot.total_mass
    for segment in (run.segments[0], run.segments[2]):
        (free,) = segment.targets
        target, q, v = free.robot, free.q, free.v
        momenta = [mass * _centre_velocity(target.state(q[k], v[k])) for k in (0, -1)]
        np.testing.assert_allclose(momenta[1] - momenta[0], 0.2 * leak, rtol=0, atol=1e-9)


def _centre_velocity(state):
    return ospace.momentum(state)[:3] / state.robot.total_mass


def test_a_goal_is_within_reach_where_a_disturbance_may_push_the_robot(load):
    go = missions.TIP | {"goal": {"shift": [9.0, 0, 0], "duration": "2 s"}, "completion": {"position": "1 cm"}}
    far = {"robot": missions.PLANAR, "tasks": [missions.REST]}
    phase = missions.phase("go", go, timeout="10 s")
    with pytest.raises(ospace.ScenarioError, match="out of reach"):
        load(missions.toml(phase, **far))
    load(missions.toml(phase, disturbances=[PLUME | {"force": ["20 N", 0, 0]}], **far))


def test_a_rehearsal_in_coarse_cycles_has_the_same_impulse(load):
    made = load(drifting(PLUME))
    coarse = replace(made, control=made.control.model_copy(update={"period": 0.01, "step": 0.01}))
    np.testing.assert_allclose(gained(scenario.run(coarse))[:3], [0.5, 0.0, 0.25], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("change", "key", "what"),
    [
        ({"point": "bas"}, "disturbance[0].point", "did you mean 'base'"),
        ({"of": "targt"}, "disturbance[0].of", "'targt' is unknown"),
        ({"of": "target"}, "disturbance[0].of", "there is no target"),
        ({"force": [0, 0, 0]}, "disturbance[0]", "pushes nothing"),
        ({"force": ["1 N m", 0, 0]}, "disturbance[0].force[0]", "a unit of torque"),
        ({"start": "-1 s"}, "disturbance[0].start", "at least 0 s"),
        ({"duration": 0}, "disturbance[0].duration", "above 0"),
        ({"frequency": "2 rpm"}, "disturbance[0].frequency", "a unit of Hz, mHz"),
        ({"name": None}, "disturbance[0].name", "missing"),
    ],
)
def test_disturbances_that_make_no_sense_are_refused(load, change, key, what):
    with pytest.raises(ospace.ScenarioError) as error:
        load(drifting(PLUME | change))
    ((named, said),) = error.value.problems
    assert named == key
    assert what in said


def test_two_disturbances_of_one_name_are_refused(load):
    with pytest.raises(ospace.ScenarioError, match="two disturbances are called 'plume'"):
        load(drifting(PLUME, PLUME))


def test_the_table_lists_disturbances(load):
    assert list(summary_text.conditions(load(drifting(PLUME, SHAKER | {"start": "1 s"})))) == [
        "disturbance 'plume': 2.236 N on 'base' of the robot, from 0.1013 to 0.3513 s",
        "disturbance 'shaker': 3 N at 4 Hz on 'end_effector' of the robot, from 1 s on",
    ]

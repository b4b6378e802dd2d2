"""Commands, wrenches, wheels, noise, delay; what a run keeps, and what it refuses."""

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import OspaceError, SpaceRobot
from ospace.simulation import Actuation, Noise, SimulationError, simulate

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def robot():
    return trees.tree(9, 8)


@pytest.fixture(scope="module")
def start(robot):
    state = trees.state(robot, 9)
    return state.q, 0.3 * state.v


def run(robot, state, controller=None, **options):
    return simulate(robot, *state, controller, **{"duration": 0.05, **options})


def test_the_example_of_the_docs_runs(tmp_path, monkeypatch, capsys):
    root = Path(__file__).parents[2]
    example = re.search(r"```python\n(.*?)```", (root / "docs/simulation.md").read_text(), re.DOTALL)[1]
    (tmp_path / "models").symlink_to(root / "models")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(example, names)
    assert capsys.readouterr().out.count("pass") == 4
    assert names["after"].certificate().passed
    assert (tmp_path / "run.npz").exists()


def test_chaser_keeps_momentum():
    """All joints in motion under torques that change every step; over 60 s, docs/simulation.md."""
    robot = SpaceRobot.from_urdf(MODELS / "chaser_24dof.urdf")
    q = robot.configuration()
    inertia = np.diag(ospace.generalized_dynamics(robot.state(q)).generalized_inertia)
    pace = np.random.default_rng(0).uniform(0.15, 1.5, robot.n_joints)

    def law(time, q_now, v_now):
        return inertia * (0.2 * pace**2 * np.sin(pace * time) - (q_now - q)[7:] - 0.3 * v_now[6:])

    certificate = simulate(robot, q, np.zeros(robot.nv), law, duration=2.0).certificate()
    assert certificate.passed
    for name in ("linear momentum", "angular momentum", "work and energy"):
        assert certificate[name].error < 1e-11


@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
def test_wrench_on_a_point_is_its_impulse_and_its_work(integrator):
    robot = trees.tree(11, 8, ("revolute", "prismatic", "helical", "continuous about any axis"))
    state = trees.state(robot, 11)
    point = robot.point("link_7", axes="linear", offset=pin.SE3(pin.exp3(np.ones(3)), np.array([0.1, -0.3, 0.2])))
    F = np.array([1.0, -2.0, 3.0, 0.4, 0.5, -0.6])
    result = run(robot, (state.q, 0.3 * state.v), wrenches={point: F}, integrator=integrator)
    assert np.allclose(result.momentum[-1, :3] - result.momentum[0, :3], 0.05 * F[:3], rtol=0, atol=1e-11)
    certificate = result.certificate()
    assert certificate.passed
    assert certificate["angular momentum"].error < 1e-9
    # Independent of the run's own quadrature: the moment about the mass centre by Simpson's rule over the records.
    moments = []
    for q, v in zip(result.q, result.v, strict=True):
        centre = pin.centerOfMass(robot.model, robot.model.createData(), q)
        moments.append(np.cross(robot.state(q, v).placement(point).translation - centre, F[:3]) + F[3:])
    weights = np.ones(51)
    weights[1:-1:2], weights[2:-1:2] = 4.0, 2.0
    gained = result.momentum[-1, 3:] - result.momentum[0, 3:]
    assert np.allclose(
        gained, weights @ moments * 1e-3 / 3.0, rtol=0, atol=1e-6 if integrator == "symplectic" else 1e-9
    )


def test_wrench_as_function_of_time_and_wrench_on_base_as_thrusters(robot, start):
    """A wrench on the base by `wrenches` and by a command is one motion."""
    F = np.array([1.0, -2.0, 3.0, 0.4, 0.5, -0.6])
    base = robot.point("base")
    by_point = run(robot, start, wrenches={base: lambda time: F})
    by_thrusters = run(robot, start, lambda *_: Actuation(np.zeros(robot.n_joints), F))
    assert np.abs(by_point.q - by_thrusters.q).max() < 1e-13
    assert np.abs(by_point.impulse - by_thrusters.impulse).max() < 1e-14
    assert np.abs(by_point.work - by_thrusters.work).max() < 1e-13


def test_wrenches_on_one_link_add_up(robot, start):
    offset = pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3]))
    here, there, base = robot.point("link_4", offset=offset), robot.point("link_4", offset=offset), robot.point("base")
    F, G, push = np.arange(6.0), np.ones(6), np.array([0.0, 1.0, 0.0, 0.5, 0.0, 0.0])
    two = run(robot, start, wrenches={here: F, base: push, there: G})
    command = Actuation(np.zeros(robot.n_joints), push)
    one = run(robot, start, lambda *_: command, wrenches={here: F + G})
    assert np.abs(two.q - one.q).max() < 1e-13
    assert np.abs(two.impulse - one.impulse).max() < 1e-13
    assert np.abs(two.work - one.work).max() < 1e-13
    assert two.certificate().passed


def test_acceleration_is_that_of_the_paper(robot, start):
    """The first step under a wrench starts with ẍ = Γ_e⁻¹ F − μ."""
    point, F = robot.point("link_5"), np.array([3.0, 2.0, 1.0, 0.3, 0.2, 0.1])
    state = robot.state(*start)
    space = ospace.operational_space(state, point)
    h = 1e-6
    moved = robot.state(*(lambda r: (r.q[-1], r.v[-1]))(run(robot, start, wrenches={point: F}, duration=h, step=h)))
    velocity = [space_of(one, point) for one in (state, moved)]
    assert np.allclose((velocity[1] - velocity[0]) / h, space.inertia_inverse @ F - space.bias_acceleration, atol=1e-4)


def space_of(state, point):
    """Velocity of a point, inertial axes."""
    J = ospace.operational_space(state, point).jacobian
    return J @ np.r_[state.base_twist, state.v[6:]]


def test_wheels_take_what_the_robot_gives(robot, start):
    torque = np.array([0.3, -0.2, 0.1])
    command = Actuation(np.zeros(robot.n_joints), wheel_torque=torque)
    result = run(robot, start, lambda *_: command, wheel_momentum=(1.0, 2.0, 3.0))
    assert np.allclose(result.wheel_momentum[-1], (1.0, 2.0, 3.0) - 0.05 * torque, rtol=1e-13)
    assert np.allclose(result.momentum[-1, 3:] - result.momentum[0, 3:], 0.05 * torque, rtol=0, atol=1e-11)
    assert not result.impulse.any()
    assert result.certificate().passed


def test_controller_is_called_once_a_period_with_the_state(robot, start):
    calls = []

    def law(time, q, v):
        calls.append((time, q, v))
        return np.full(robot.n_joints, time)

    result = run(robot, start, law, period=5e-3, start=2.0)
    assert np.allclose([time for time, *_ in calls], 2.0 + 5e-3 * np.arange(10))
    assert np.array_equal([q for _, q, _ in calls], result.q[:-1:5])
    assert np.array_equal([v for *_, v in calls], result.v[:-1:5])
    assert np.array_equal(result.torque[:, 0], np.r_[np.repeat(2.0 + 5e-3 * np.arange(10), 5), result.torque[-1, 0]])


def test_a_delayed_command_is_shifted_in_time(robot, start):
    q, _ = start
    law = lambda time, q, v: np.full(robot.n_joints, 0.1 + time)  # noqa: E731
    plain = simulate(robot, q, np.zeros(robot.nv), law, duration=0.05, period=5e-3)
    late = simulate(robot, q, np.zeros(robot.nv), law, duration=0.062, period=5e-3, delay=0.012)
    assert not late.v[:13].any()
    assert np.abs(late.q[12:] - plain.q).max() < 1e-14
    assert np.abs(late.v[12:] - plain.v).max() < 1e-13


def test_delayed_commands_may_share_memory(robot, start):
    torque = np.zeros(robot.n_joints)

    def law(time, q, v):
        torque[:] = time
        return torque

    assert np.allclose(run(robot, start, law, delay=0.01).torque[10:-1, 0], 1e-3 * np.arange(40))


def test_noise_is_seeded_and_of_the_size_asked(robot, start):
    def errors(noise):
        seen = []
        result = simulate(
            robot, *start, lambda t, q, v: seen.append((q, v)) or np.zeros(robot.n_joints), duration=0.5, noise=noise
        )
        return np.array(
            [
                np.r_[pin.difference(robot.model, q, told[0]), told[1] - v]
                for q, v, told in zip(result.q, result.v, seen, strict=False)
            ]
        )

    deviation = np.linspace(0.0, 1e-2, robot.nv)
    noise = errors(Noise(q=1e-3, v=deviation, seed=4))
    assert np.array_equal(noise, errors(Noise(q=1e-3, v=deviation, seed=4)))
    assert not np.array_equal(noise, errors(Noise(q=1e-3, v=deviation, seed=5)))
    assert np.allclose(noise[:, : robot.nv].std(axis=0), 1e-3, rtol=0.2)
    assert np.allclose(noise[:, robot.nv :].std(axis=0), deviation, rtol=0.2, atol=1e-13)


def test_records_and_the_last_state(robot, start):
    every = run(robot, start)
    some = run(robot, start, log_every=7)
    assert np.array_equal(some.time, np.r_[every.time[::7], every.time[-1]])
    assert np.array_equal(some.q, every.q[[*range(0, 51, 7), 50]])


@pytest.mark.parametrize("at", ["controller", "first call", "progress"])
def test_interrupt_keeps_what_was_run(robot, start, at):
    def law(time, q, v):
        if (at == "controller" and time > 0.02) or at == "first call":
            raise KeyboardInterrupt
        return np.zeros(robot.n_joints)

    def on_step(time):
        if at == "progress" and time > 0.02:
            raise KeyboardInterrupt

    result = run(robot, start, law, on_step=on_step)
    assert result.interrupted
    assert result.time[-1] == pytest.approx(0.0 if at == "first call" else 0.02, abs=1.1e-3)
    assert result.certificate().passed


def test_on_step_sees_time_and_ends_the_run(robot, start):
    times = []
    result = run(robot, start, on_step=lambda time: times.append(time) or time > 0.03)
    assert result.time[-1] == times[-1] == pytest.approx(0.031)
    assert not result.interrupted


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-8}, {"integrator": "symplectic"}])
def test_state_that_blows_up_says_when_and_keeps_the_run(options):
    robot = trees.tree(9, 8, ("revolute",))
    q = trees.state(robot, 9).q
    with pytest.raises(SimulationError) as caught:
        simulate(
            robot,
            q,
            np.zeros(robot.nv),
            lambda t, q, v: 10.0 ** (1e4 * t) * np.ones(robot.n_joints),
            duration=1.0,
            step=1e-3,
            **options,
        )
    assert 0.0 < caught.value.time < 0.1
    assert len(caught.value.trajectory) >= 2
    assert np.isfinite(caught.value.trajectory.v).all()


@pytest.mark.parametrize("name", ["torque", "base_wrench", "wheel_torque"])
def test_a_command_that_is_not_finite_ends_the_run(robot, start, name):
    def law(time, q, v):
        command = {"torque": np.zeros(robot.n_joints), "base_wrench": np.zeros(6), "wheel_torque": np.zeros(3)}
        if time > 0.01:
            command[name][1] = np.nan
        return Actuation(**command)

    with pytest.raises(SimulationError, match=rf"{name}\[1\] of the controller at 0.01\d* s is nan") as caught:
        run(robot, start, law)
    assert 10 <= len(caught.value.trajectory) <= 11


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"duration": 0.0}, "duration 0.0 s is no whole number of steps of 0.001 s; 0.001 s would be one"),
        ({"duration": np.inf}, "duration is inf"),
        ({"duration": 0.0505}, r"duration 0.0505 s is no whole number"),
        ({"step": 0.0}, "step 0.0: give a time above zero"),
        ({"step": np.nan}, "step is nan"),
        ({"period": 1.5e-3}, "period 0.0015 s"),
        ({"delay": 1.5e-3}, "delay 0.0015 s"),
        ({"delay": -1e-3}, "delay -0.001 s"),
        ({"log_every": 0}, "log_every 0"),
        ({"log_every": 1.5}, "log_every 1.5"),
        ({"start": np.inf}, "start is inf"),
        ({"integrator": "rk5"}, "integrator 'rk5' is unknown; did you mean 'rk4'?"),
        ({"tolerance": 0.0}, "tolerance 0.0"),
        ({"tolerance": 1e-9, "integrator": "symplectic"}, "leave out tolerance"),
        ({"wheel_momentum": (1.0, 2.0)}, "wheel_momentum has shape"),
        ({"noise": Noise(q=-1.0)}, "noise.q -1.0"),
        ({"noise": Noise(v=np.zeros(3))}, "noise.v"),
        ({"wrenches": {"hand": np.zeros(6)}}, "'hand' is not an OperationalPoint"),
    ],
)
def test_simulate_refuses_arguments_that_make_no_sense(robot, start, options, message):
    with pytest.raises(OspaceError, match=message):
        run(robot, start, lambda *_: np.zeros(robot.n_joints), **options)


def test_simulate_refuses_wrenches_that_make_no_sense(robot, start):
    point = robot.point("link_1")
    with pytest.raises(OspaceError, match="wrench at point 'link_1' has shape"):
        run(robot, start, wrenches={point: np.zeros(3)})
    with pytest.raises(SimulationError, match=r"wrench at point 'link_1' at 0 s\[0\] is nan"):
        run(robot, start, wrenches={point: lambda time: np.full(6, np.nan)})
    with pytest.raises(OspaceError, match="belongs to another robot"):
        run(robot, start, wrenches={trees.tree(9, 8).point("link_1"): np.zeros(6)})


@pytest.mark.parametrize(
    ("controller", "message"),
    [
        (3, "controller 3: give an object with update"),
        (lambda *_: np.zeros(2), "torque of the controller at 0 s has shape"),
        (lambda *_: "left", "the controller gave 'left' at 0 s"),
    ],
)
def test_simulate_refuses_controllers_that_make_no_sense(robot, start, controller, message):
    with pytest.raises(OspaceError, match=message):
        run(robot, start, controller)

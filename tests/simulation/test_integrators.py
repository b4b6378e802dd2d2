"""Order, invariants and agreement of the integrators."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

from ospace import OspaceError, SpaceRobot
from ospace.simulation import Actuation, lie, simulate

MODELS = Path(__file__).parents[2] / "models"
AXES_TURN = ("spherical by angles", "universal", "composite")
SMOOTH = tuple(name for name in trees.JOINT_TYPES if name not in AXES_TURN)


def distance(robot, a, b):
    """Difference of the last states of two runs, worst coordinate."""
    return max(np.abs(pin.difference(robot.model, a.q[-1], b.q[-1])).max(), np.abs(a.v[-1] - b.v[-1]).max())


def no_drives(robot):
    """The robot, without the inertia of drives on joints that are no vectors."""
    model = pin.Model(robot.model)
    armature = model.armature.copy()
    for j in range(1, model.njoints):
        if model.nvs[j] > 1:
            armature[model.idx_vs[j] :][: model.nvs[j]] = 0.0
    model.armature = armature
    return SpaceRobot.from_model(model)


def slow(state):
    """The state, at a speed at which steps of hundredths of a second are short."""
    return state.q, 0.3 * state.v


@pytest.mark.parametrize(
    ("integrator", "order", "types"), [("rk4", 4, tuple(trees.JOINT_TYPES)), ("symplectic", 2, SMOOTH)]
)
def test_integrators_have_their_order(integrator, order, types):
    robot = trees.tree(5, 14, types)
    if integrator == "symplectic":
        robot = no_drives(robot)
    q, v = slow(trees.state(robot, 5))
    torque = np.random.default_rng(5).normal(size=robot.n_joints)
    reference = simulate(robot, q, v, lambda *_: torque, duration=0.08, step=0.04, period=0.08, tolerance=1e-13)
    errors = []
    for steps in (32, 64):
        run = simulate(
            robot, q, v, lambda *_: torque, duration=0.08, step=0.08 / steps, period=0.08, integrator=integrator
        )
        errors.append(distance(robot, run, reference))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)
    assert errors[0] > 1e-12


@pytest.mark.parametrize("kind", trees.JOINT_TYPES)
def test_every_joint_type_conserves_momentum_and_energy(kind):
    robot = trees.tree(2, 4, (kind,))
    q, v = slow(trees.state(robot, 3))
    torque = np.random.default_rng(2).normal(size=robot.n_joints)
    run = simulate(robot, q, v, lambda *_: torque, duration=0.05, step=1e-3, period=0.01)
    assert run.certificate().passed, str(run.certificate())
    for name in ("linear momentum", "angular momentum", "work and energy"):
        assert run.certificate()[name].error < 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_symplectic_keeps_momentum_to_rounding(seed):
    robot = no_drives(trees.tree(seed, 8, SMOOTH))
    q, v = slow(trees.state(robot, seed))
    torque = np.random.default_rng(seed).normal(size=robot.n_joints)
    run = simulate(robot, q, v, lambda *_: torque, duration=0.2, step=5e-3, integrator="symplectic")
    assert run.certificate()["linear momentum"].error < 1e-12
    assert run.certificate()["angular momentum"].error < 1e-12


def test_symplectic_energy_does_not_drift():
    """The worst error of the energy in the last third of a long run is that of the first third."""
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    v = np.r_[np.zeros(6), 1.0, -2.0]
    run = simulate(robot, robot.configuration(), v, duration=60.0, step=0.02, integrator="symplectic")
    error = np.abs(run.kinetic_energy - run.kinetic_energy[0])
    third = len(run) // 3
    assert error[-third:].max() < 1.1 * error[:third].max()


@pytest.mark.parametrize("kind", AXES_TURN)
def test_symplectic_names_the_joint_that_it_cannot_take(kind):
    robot = trees.tree(1, 1, (kind,))
    with pytest.raises(OspaceError, match=r"joint 'joint_0' .* take integrator='rk4'"):
        simulate(robot, robot.configuration(), np.zeros(robot.nv), duration=0.01, integrator="symplectic")


def test_symplectic_names_the_drive_that_has_no_lagrangian():
    robot = trees.tree(1, 1, ("spherical",))
    with pytest.raises(OspaceError, match="joint 'joint_0' is a Spherical joint with armature"):
        simulate(robot, robot.configuration(), np.zeros(robot.nv), duration=0.01, integrator="symplectic")


@pytest.mark.parametrize("seed", range(3))
def test_series_are_the_derivatives_of_increments(seed):
    robot = trees.tree(seed, 14)
    model, q = robot.model, trees.state(robot, seed).q
    rng = np.random.default_rng(seed)
    u, x = 0.1 * rng.normal(size=model.nv), rng.normal(size=model.nv)
    end = pin.integrate(model, q, u)
    A = lie.Adjoint(model).at(u)
    for coefficients, expected in (
        (lie.EXP, pin.dIntegrate(model, q, u, pin.ARG1)),
        (lie.TRANSPORT, pin.dIntegrate(model, q, u, pin.ARG0)),
        (lie.LOG, pin.dDifference(model, q, end, pin.ARG1)),
        (lie.LOG_BACK, -pin.dDifference(model, q, end, pin.ARG0)),
    ):
        assert np.abs(lie.series(coefficients, A, x) - expected @ x).max() < 1e-11


def test_tolerance_divides_steps_and_is_kept():
    robot = trees.tree(7, 10)
    q, v = slow(trees.state(robot, 7))
    fine = simulate(robot, q, v, duration=0.5, step=0.05, tolerance=1e-13)
    errors = [
        distance(robot, simulate(robot, q, v, duration=0.5, step=0.5, tolerance=tolerance), fine)
        for tolerance in (1e-6, 1e-9)
    ]
    assert errors[0] < 1e-4
    assert errors[1] < 1e-7


@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
def test_a_symmetric_top_precesses_as_euler_found(integrator):
    """Torque-free symmetric top: the spin about its axis stays, the rest of ω turns at (A − C)/A Ω in body axes."""
    A, C = 2.0, 3.0
    robot = _body(pin.Inertia(5.0, np.zeros(3), np.diag([A, A, C])))
    omega = np.array([0.3, 0.0, 1.2])
    duration, step = 5.0, 1e-2
    run = simulate(
        robot, robot.configuration(), np.r_[np.zeros(3), omega], duration=duration, step=step, integrator=integrator
    )
    rate = (C - A) / A * omega[2]
    expected = np.c_[omega[0] * np.cos(rate * run.time), omega[0] * np.sin(rate * run.time)]
    limit = 1e-9 if integrator == "rk4" else 1e-4
    assert np.abs(run.v[:, 3:5] - expected).max() < limit
    assert np.abs(run.v[:, 5] - omega[2]).max() < limit
    # The axis of symmetry keeps its angle to the angular momentum, and goes about it at |h|/A.
    h = np.array([A * omega[0], 0.0, C * omega[2]])
    axis = pin.XYZQUATToSE3(run.q[-1]).rotation[:, 2]
    turned = pin.exp3(h / A * duration) @ np.array([0.0, 0.0, 1.0])
    assert np.abs(axis - turned).max() < limit


def test_a_planar_arm_and_its_base_exchange_angular_momentum():
    """Two bodies on one hinge through both mass centres: ω_1 I_1 + ω_2 I_2 = 0, angles as under a constant torque."""
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia(10.0, np.zeros(3), np.diag([1.0, 1.0, 4.0])), pin.SE3.Identity())
    wheel = model.addJoint(root, pin.JointModelRZ(), pin.SE3.Identity(), "wheel")
    model.appendBodyToJoint(wheel, pin.Inertia(1.0, np.zeros(3), np.diag([0.5, 0.5, 0.8])), pin.SE3.Identity())
    robot = SpaceRobot.from_model(model)
    run = simulate(robot, robot.configuration(), np.zeros(7), lambda *_: [0.1], duration=2.0, step=0.01)
    assert np.abs(run.v[:, 5] + 0.1 / 4.0 * run.time).max() < 1e-14
    assert np.abs(run.v[:, 6] - (0.1 / 4.0 + 0.1 / 0.8) * run.time).max() < 1e-14
    assert run.q[-1, 7] == pytest.approx(0.5 * (0.1 / 4.0 + 0.1 / 0.8) * 4.0, rel=1e-13)


def test_a_robot_far_away_and_fast_moves_the_same():
    """7e6 m away at 7.5e3 m/s: joints and attitude move as they do here."""
    robot = trees.tree(4, 8)
    q, v = slow(trees.state(robot, 4))
    torque = np.random.default_rng(4).normal(size=robot.n_joints)
    command = Actuation(torque, np.array([1.0, 2.0, 3.0, 0.1, 0.2, 0.3]))
    here = simulate(robot, q, v, lambda *_: command, duration=0.1)
    far_q, far_v = q.copy(), v.copy()
    far_q[:3] += (7e6, -1e5, 3e5)
    far_v[:3] += pin.XYZQUATToSE3(q[:7]).rotation.T @ (10.0, 7.5e3, -200.0)
    there = simulate(robot, far_q, far_v, lambda *_: command, duration=0.1)
    assert np.abs(there.q[:, 3:] - here.q[:, 3:]).max() < 1e-12
    assert np.abs(there.v[:, 3:] - here.v[:, 3:]).max() < 1e-11
    shift = there.q[-1, :3] - here.q[-1, :3] - (7e6, -1e5, 3e5)
    assert np.abs(shift - 0.1 * np.array([10.0, 7.5e3, -200.0])).max() < 1e-8
    assert there.certificate().passed
    assert np.abs(there.momentum - here.momentum).max() < 1e-9
    seen = there.momentum_in_user_frame[:, :3] - here.momentum_in_user_frame[:, :3]
    assert np.allclose(seen, robot.total_mass * np.array([10.0, 7.5e3, -200.0]), rtol=1e-12)


def _body(inertia):
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, inertia, pin.SE3.Identity())
    return SpaceRobot.from_model(model)


@pytest.mark.parametrize("options", [{}, {"tolerance": 1e-11}, {"integrator": "symplectic"}])
def test_thrusters_and_wheels_that_fire_and_stop(options):
    """The base is pushed for a while, then left alone: impulses are counted, and end."""
    robot = trees.tree(12, 6, ("revolute", "prismatic", "continuous"))
    q, v = slow(trees.state(robot, 12))
    push = Actuation(np.zeros(robot.n_joints), np.array([1.0, -2.0, 3.0, 0.3, 0.2, -0.1]), np.array([0.1, 0.0, -0.2]))
    rest = Actuation(np.zeros(robot.n_joints))
    run = simulate(robot, q, v, lambda t, *_: push if t < 0.0195 else rest, duration=0.05, **options)
    assert np.allclose(run.impulse[20:, :3], 0.02 * push.base_wrench[:3], rtol=1e-12)
    assert np.allclose(run.wheel_momentum[20:], -0.02 * push.wheel_torque, rtol=1e-12)
    assert np.abs(run.momentum[20:] - run.momentum[20]).max() < 1e-10
    certificate = run.certificate()
    assert certificate.passed, str(certificate)
    assert certificate["linear momentum"].error < 1e-11


def test_a_joint_composed_of_rotations_is_integrated():
    """Not a vector, and of no group that the chart of a tolerance knows."""
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia(10.0, np.zeros(3), np.diag([1.0, 2.0, 3.0])), pin.SE3.Identity())
    joint = pin.JointModelComposite(2)
    joint.addJoint(pin.JointModelSpherical(), pin.SE3.Identity())
    joint.addJoint(pin.JointModelPX(), pin.SE3(np.eye(3), np.array([0.1, 0.2, 0.3])))
    wrist = model.addJoint(root, joint, pin.SE3.Identity(), "wrist")
    model.appendBodyToJoint(wrist, pin.Inertia(1.0, np.ones(3), np.diag([0.2, 0.3, 0.4])), pin.SE3.Identity())
    robot = SpaceRobot.from_model(model)
    v = 0.3 * np.random.default_rng(0).normal(size=robot.nv)
    run = simulate(robot, robot.configuration(), v, lambda *_: 0.1 * np.ones(4), duration=0.05)
    assert run.certificate().passed, str(run.certificate())
    assert run.rotation_drift.max() < 1e-14
    with pytest.raises(OspaceError, match="joint 'wrist' is composed of joints that are no vectors"):
        simulate(robot, robot.configuration(), v, duration=0.05, tolerance=1e-9)

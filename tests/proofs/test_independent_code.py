"""Γ_e⁻¹ and μ by code that shares nothing with Pinocchio: MuJoCo, and adam on CasADi.

Errors of Γ_e⁻¹ are shares of √(Γ_ii Γ_jj), those of μ of √(Γ_ii 2 T): metres and radians then count alike.
"""

from __future__ import annotations

import importlib.util

import numpy as np
import pinocchio as pin
import pytest
from proven import row
from robots.mujoco_robot import MujocoRobot, example_robot

import ospace

HANDS = {
    "planar_2r": ("end_effector", "link_1"),
    "ets_vii": ("end_effector", "link_3"),
    "chaser_7dof": ("end_effector", "link_4"),
    "chaser_24dof": ("right_hand", "left_hand", "head", "base"),
}
STATES = 6
needs_adam = pytest.mark.skipif(
    importlib.util.find_spec("adam") is None,
    reason="adam and CasADi are of the extra: pip install 'ospace[benchmarks]'",
)


@pytest.fixture(scope="module", params=HANDS)
def name(request):
    return request.param


def states_of(robot, count=STATES):
    rng = np.random.default_rng(17)
    for _ in range(count):
        angles = dict(zip(robot.joint_names, rng.uniform(-1.5, 1.5, robot.n_joints), strict=True))
        T_WB = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
        yield robot.state(robot.configuration(angles, T_WB), rng.normal(size=robot.nv))


def share(ours, other):
    scale = np.sqrt(np.diag(other))
    return np.abs((ours - other) / np.outer(scale, scale)).max()


def test_mujoco_gives_the_same_by_every_way_in(name):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    engine = MujocoRobot(ospace.models.path(name))
    links = [one for one in HANDS[name] if one in robot.leaf_links or one in robot.frame_names]
    points = [robot.point(one) for one in links]
    run = ospace.OperationalSpaceEvaluator(robot, points)
    states = list(states_of(robot))
    many = ospace.operational_space_batch(
        robot,
        points,
        [state.q for state in states],
        [state.v for state in states],
        ("inertia_inverse", "bias_acceleration"),
    )
    errors, biases = [], []
    for k, state in enumerate(states):
        engine.take(state)
        exact = engine.inertia_inverse(points)
        at_rest = -engine.accelerations(points, np.zeros(robot.nv), np.zeros(6 * len(points)))
        unit = np.sqrt(np.diag(exact) * (state.v @ state.v) * robot.total_mass)
        one = run.update(state.q.copy(), state.v.copy())
        ways = [(one.inertia_inverse, one.bias_acceleration)]
        ways += [(many.inertia_inverse[k], many.bias_acceleration[k])]
        for method in ("pv_osimr", "forward"):
            found = ospace.operational_space(state, points, method)
            ways.append((found.inertia_inverse, found.bias_acceleration))
        errors += [share(inertia, exact) for inertia, _ in ways]
        biases += [np.abs((mu - at_rest) / unit).max() for _, mu in ways]
        for e, point in enumerate(points):
            own, found = slice(6 * e, 6 * e + 6), ospace.operational_space(state, point, "inverted")
            errors.append(share(found.inertia_inverse, exact[own, own]))
            biases.append(np.abs((found.bias_acceleration - at_rest[own]) / unit[own]).max())
    row("Γ_e⁻¹ by MuJoCo, four ways in").within(max(errors))
    row("μ by MuJoCo, four ways in").within(max(biases))


def test_mujoco_gives_the_same_floating_dynamics(name):
    """Λ⁻¹ = J_m* H_m*⁻¹ J_m*ᵀ, Γ_e, and the impulse response H⁻¹ J_eᵀ from MuJoCo's H and J alone."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    engine = MujocoRobot(ospace.models.path(name))
    points = [robot.point(HANDS[name][0])]
    errors, responses, inertias, momenta, jacobians, drifts = [], [], [], [], [], []
    for state in states_of(robot):
        engine.take(state)
        H, J = engine.inertia(), engine.jacobian(points)
        momentum = H[:6] @ np.r_[state.base_twist, state.v[6:]]
        momenta.append(np.abs(ospace.momentum(state) - momentum).max() / np.abs(momentum).max())
        inertias.append(
            share(ospace.operational_space(state, points).inertia, np.linalg.inv(engine.inertia_inverse(points)))
        )
        locked = np.linalg.solve(H[:6, :6], H[:6, 6:])
        reduced, moved = H[6:, 6:] - H[6:, :6] @ locked, J[:, 6:] - J[:, :6] @ locked
        exact = moved @ np.linalg.solve(reduced, moved.T)
        floating, generalized = ospace.free_floating(state, points), ospace.generalized_jacobian(state, points)
        jacobians.append(np.abs(generalized.generalized_jacobian - moved).max() / np.abs(moved).max())
        drift = J[:, :6] @ np.linalg.solve(H[:6, :6], momentum)
        drifts.append(np.abs(generalized.momentum_velocity - drift).max() / np.abs(drift).max())
        scale = np.sqrt(np.diag(J @ np.linalg.solve(H, J.T)))
        errors.append(np.abs((floating.floating_inertia_inverse - exact) / np.outer(scale, scale)).max())
        response = np.linalg.solve(H, J.T)
        unit = np.outer(1.0 / np.sqrt(np.diag(H)), scale)
        responses.append(np.abs((ospace.operational_space(state, points).response - response) / unit).max())
    row("M_0 by MuJoCo, of its largest element").within(max(momenta))
    row("J_m\\* by MuJoCo, of its largest element").within(max(jacobians))
    row("J_b H_b⁻¹ M_0 by MuJoCo, of its largest element").within(max(drifts))
    row("Γ_e of the hand by MuJoCo").within(max(inertias))
    row("Λ⁻¹ by MuJoCo").within(max(errors))
    row("H⁻¹ J_eᵀ by MuJoCo").within(max(responses))


def test_mujoco_gives_the_same_where_a_finger_mimics_another():
    """Panda: with G the map of rates, Γ_e⁻¹ = J G (Gᵀ H G)⁻¹ Gᵀ Jᵀ of MuJoCo's robot, whose fingers are free."""
    file = example_robot("panda_description/urdf/panda.urdf")
    robot, free = (ospace.SpaceRobot.from_urdf(file, free_mimic=free) for free in (False, True))
    engine = MujocoRobot(file)
    links = ("panda_rightfinger", "panda_link4")
    points = [robot.point(one) for one in links]
    G, errors = robot.free.G, []
    for state in states_of(robot):
        engine.take(free.state(robot.free.configuration(state.q), G @ state.v))
        H, J = G.T @ engine.inertia() @ G, engine.jacobian([free.point(one) for one in links]) @ G
        exact = J @ np.linalg.solve(H, J.T)
        errors.append(share(ospace.operational_space(state, points).inertia_inverse, exact))
    row("Γ_e⁻¹ by MuJoCo where joints mimic others").within(max(errors))


@needs_adam
@pytest.mark.parametrize(
    "name", [name for name in HANDS if name != "planar_2r"]
)  # adam stops: its Jacobian has no rows
def test_adam_on_casadi_gives_the_same(name):
    from adam.casadi import KinDynComputations

    urdf = ospace.models.path(name)
    robot = ospace.SpaceRobot.from_urdf(urdf)
    points = [robot.point(one) for one in HANDS[name]]
    adam = KinDynComputations(str(urdf), list(robot.joint_names))
    mass, jacobians = adam.mass_matrix_fun(), [adam.jacobian_fun(point.frame) for point in points]
    states = list(states_of(robot))
    many = ospace.operational_space_batch(robot, points, [state.q for state in states])
    errors = []
    for ours, state in zip(many.inertia_inverse, states, strict=True):
        at = state.T_WB.homogeneous, state.q[7:]
        H, J = np.array(mass(*at)), np.vstack([np.array(one(*at)) for one in jacobians])
        errors.append(share(ours, J @ np.linalg.solve(H, J.T)))
    row("Γ_e⁻¹ by adam on CasADi").within(max(errors))

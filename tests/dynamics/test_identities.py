"""Identities of the dynamics on seeded random trees that mix all joint types."""

import numpy as np
import pinocchio as pin
import pytest
import trees
from hypothesis import given, settings
from hypothesis import strategies as st

import ospace
from ospace.dynamics.dense import Dense
from ospace.dynamics.joint_space import inverse_dynamics

TIGHT = 1e-12
trees_of_any_shape = st.builds(
    trees.tree, st.integers(0, 10_000), st.integers(0, 14), st.none(), st.floats(0.0, 1.0, allow_nan=False)
)


def close(value, reference, tolerance=TIGHT, size=None):
    size = size or max(np.abs(reference).max(initial=0.0), 1e-3)
    assert np.abs(value - reference).max(initial=0.0) <= tolerance * size


def points_of(robot):
    last = f"link_{robot.model.njoints - 3}" if robot.n_joints else "base"
    offset = pin.SE3(np.eye(3), np.array([0.1, -0.2, 0.3]))
    return [robot.point("base", "angular"), robot.point(last), robot.point(last, "linear", offset)]


def full_inertia(state):
    terms = ospace.joint_space_dynamics(state)
    return np.block(
        [[terms.base_inertia, terms.coupling_inertia], [terms.coupling_inertia.T, terms.manipulator_inertia]]
    )


@pytest.fixture(params=[*trees.JOINT_TYPES, "mixed"])
def state(request):
    types = None if request.param == "mixed" else (request.param,)
    robot = trees.tree(11, 16 if types is None else 5, types)
    return trees.state(robot, 4)


@settings(max_examples=40, deadline=None)
@given(trees_of_any_shape, st.integers(0, 1000), st.booleans())
def test_recursions_agree_with_the_dense_forms(robot, seed, far):
    state = trees.state(robot, seed, far)
    points = points_of(robot)
    dense = Dense(state, points)
    result = ospace.operational_space(state, points)
    close(full_inertia(state), dense.H)
    close(inverse_dynamics(state, np.zeros(robot.nv)), dense.c)
    close(ospace.momentum(state), dense.M_0)
    close(result.jacobian, dense.J_e)
    condition = np.linalg.cond(dense.H)
    close(result.inertia_inverse, dense.Gamma_e_inv, TIGHT * condition)
    close(result.bias_acceleration, dense.mu, TIGHT * condition)
    close(result.response, dense.response, TIGHT * condition)


def test_momentum_is_the_inertia_times_the_velocity(state):
    velocity = np.r_[state.base_twist, state.v[6:]]
    close(ospace.momentum(state), (full_inertia(state) @ velocity)[:6])


def test_kinetic_energy(state):
    velocity = np.r_[state.base_twist, state.v[6:]]
    model, data = state.robot.model, state.robot.scratch.data
    pin.forwardKinematics(model, data, state.q, state.v)
    energy = sum(
        0.5 * data.v[j].vector @ model.inertias[j].matrix() @ data.v[j].vector for j in range(1, model.njoints)
    )
    energy += 0.5 * model.armature @ state.v**2
    assert 0.5 * velocity @ full_inertia(state) @ velocity == pytest.approx(energy, rel=TIGHT)


def test_the_inverted_chain_meets_the_forward_chain_at_every_link(state):
    robot = state.robot
    for name in ["base", *(f"link_{k}" for k in range(robot.model.njoints - 2))]:
        point = robot.point(name, offset=pin.SE3(np.eye(3), np.array([0.2, 0.1, -0.3])))
        inverted = ospace.operational_space(state, point, "inverted")
        dense = ospace.operational_space(state, point, "dense")
        close(inverted.inertia, dense.inertia, 1e-10)
        close(inverted.bias_force, dense.bias_force, 1e-10)


def test_the_dynamically_consistent_inverse(state):
    result = ospace.operational_space(state, points_of(state.robot)[1])
    H, J_e, plus, N = (
        full_inertia(state),
        result.jacobian,
        result.dynamically_consistent_inverse,
        result.null_space_projector,
    )
    size = np.abs(plus).max()
    close(J_e @ plus, np.eye(len(J_e)), 1e-10, size)
    close(N @ N, N, 1e-10, size)
    close(J_e @ N, np.zeros_like(J_e), 1e-10, size)
    close(H @ N, (H @ N).T, 1e-10, np.abs(H).max() * size)


def test_the_response_carries_the_operational_inertia(state):
    result = ospace.operational_space(state, points_of(state.robot))
    close(result.jacobian @ result.response, result.inertia_inverse, 1e-10)
    close(full_inertia(state) @ result.response, result.jacobian.T, 1e-10)


def test_floating_and_base_inertia_add_up(state):
    points = points_of(state.robot)
    flying, floating = ospace.operational_space(state, points), ospace.free_floating(state, points)
    close(floating.floating_inertia_inverse + floating.base_inertia_inverse, flying.inertia_inverse, 1e-11)
    close(floating.bias_acceleration, flying.bias_acceleration, 1e-11)


def test_the_generalized_jacobian_moves_points_as_momentum_demands(state):
    points = points_of(state.robot)
    result = ospace.generalized_jacobian(state, points)
    velocity = np.r_[state.base_twist, state.v[6:]]
    J_e = ospace.operational_space(state, points).jacobian
    close(result.generalized_jacobian @ state.v[6:] + result.momentum_velocity, J_e @ velocity)
    base = result.base_generalized_jacobian @ state.v[6:] + result.base_momentum_velocity
    close(base, state.base_twist)


def test_joints_alone_leave_no_momentum(state):
    """With ẋ_b = J_b* φ̇ the momentum is zero."""
    rates = state.v[6:]
    twist = ospace.generalized_jacobian(state, points_of(state.robot)).base_generalized_jacobian @ rates
    R = state.T_WB.rotation
    moved = state.robot.state(state.q, np.r_[R.T @ twist[:3], R.T @ twist[3:], rates])
    H_bm = ospace.joint_space_dynamics(state).coupling_inertia
    close(ospace.momentum(moved), np.zeros(6), TIGHT, max(np.abs(H_bm @ rates).max(initial=0.0), 1.0))


def step(state, acceleration, dt):
    """The state a moment later, for Pinocchio's q̈; exact to second order from the middle."""
    middle = state.v + 0.5 * dt * acceleration
    q = pin.integrate(state.robot.model, state.q, dt * middle)
    return state.robot.state(q, state.v + dt * acceleration)


def test_points_accelerate_as_the_bias_says_when_nothing_acts(state):
    """Central differences of ẋ_e along the motion that pin.aba gives without any force."""
    robot, dt = state.robot, 1e-5
    point = points_of(robot)[1]
    a = pin.aba(robot.model, robot.scratch.data, *state.base_frame_state(), np.zeros(robot.nv)).copy()
    a[:3] -= np.cross(state.v[3:6], state.v[:3])  # from the frame beside the base to q̈ at its full velocity

    def velocity(moved):
        J_e = ospace.operational_space(moved, point).jacobian
        return J_e @ np.r_[moved.base_twist, moved.v[6:]]

    measured = (velocity(step(state, a, dt)) - velocity(step(state, a, -dt))) / (2 * dt)
    close(-ospace.operational_space(state, point).bias_acceleration, measured, 1e-6, max(1.0, np.abs(measured).max()))


def test_momentum_changes_by_the_wrench_and_by_the_motion_of_its_centre(state):
    """dM_0/dt = F_b − [0; v_b × P], by central differences under a wrench on the base."""
    robot, dt = state.robot, 1e-5
    F_b = np.random.default_rng(1).normal(size=6)
    R = state.T_WB.rotation
    load = np.r_[R.T @ F_b[:3], R.T @ F_b[3:], np.zeros(robot.n_joints)]
    q = state.base_frame_state()[0]
    a = pin.aba(robot.model, robot.scratch.data, q, state.v, load).copy()
    rate = (ospace.momentum(step(state, a, dt)) - ospace.momentum(step(state, a, -dt))) / (2 * dt)
    P = ospace.momentum(state)[:3]
    close(F_b - np.r_[np.zeros(3), np.cross(state.base_twist[:3], P)], rate, 1e-6, max(1.0, np.abs(rate).max()))


def test_inverse_dynamics_undoes_forward_dynamics(state):
    robot = state.robot
    load = np.random.default_rng(2).normal(size=robot.nv)
    dense = Dense(state, points_of(robot))
    _, acceleration = dense.accelerations_under(load, np.zeros(len(dense.J_e)))
    close(inverse_dynamics(state, acceleration), load, 1e-9)


def test_results_do_not_depend_on_where_the_robot_is_or_how_fast_it_goes():
    robot = trees.tree(7, 12)
    here = trees.state(robot, 3)
    q, v = here.q.copy(), here.v.copy()
    q[:3] += (7e6, -3e6, 1e6)
    v[:3] += here.T_WB.rotation.T @ (7.5e3, 1e3, -2e3)
    there = robot.state(q, v)
    points = points_of(robot)
    one, two = ospace.operational_space(here, points), ospace.operational_space(there, points)
    for name in ("inertia_inverse", "bias_acceleration", "jacobian", "inertia", "response"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
    np.testing.assert_array_equal(
        ospace.joint_space_dynamics(here).manipulator_bias, ospace.joint_space_dynamics(there).manipulator_bias
    )
    assert np.linalg.norm(ospace.momentum(there)[:3]) > 1e3 * robot.total_mass

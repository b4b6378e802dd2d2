"""Null spaces of the base's motion and of its momentum, and what is derived of them."""

from __future__ import annotations

import numpy as np
import pytest
import trees

import ospace
from ospace import analysis

AXES = {"linear": slice(0, 3), "angular": slice(3, 6), "all": slice(0, 6)}


@pytest.fixture(scope="module")
def state():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    rng = np.random.default_rng(0)
    q = robot.configuration({name: rng.uniform(-1.0, 1.0) for name in robot.joint_names})
    return robot.state(q, rng.normal(size=robot.nv))


def check(space, rows, n):
    assert space.basis.shape == (n, n - space.rank)
    np.testing.assert_allclose(space.basis.T @ space.basis, np.eye(n - space.rank), atol=1e-13)
    np.testing.assert_allclose(space.projector, space.basis @ space.basis.T, atol=1e-14)
    np.testing.assert_allclose(rows @ space.basis, 0.0, atol=1e-12 * np.abs(rows).max())
    assert space.rank == np.linalg.matrix_rank(rows, tol=1e-9 * np.abs(rows).max())


@pytest.mark.parametrize("axes", AXES)
def test_rates_of_the_reaction_null_space_leave_the_base_at_rest(state, axes):
    space = analysis.reaction_null_space(state, axes)
    J_b_star = ospace.generalized_jacobian(state, state.robot.point("head")).base_generalized_jacobian
    check(space, J_b_star[AXES[axes]], state.robot.n_joints)


@pytest.mark.parametrize("axes", AXES)
def test_rates_of_the_coupling_null_space_pass_no_momentum(state, axes):
    H_bm = ospace.joint_space_dynamics(state).coupling_inertia
    check(analysis.coupling_null_space(state, axes), H_bm[AXES[axes]], state.robot.n_joints)


def test_both_null_spaces_are_the_same_for_all_rows_and_not_for_some(state):
    for axes, same in (("all", True), ("angular", False)):
        reaction, coupling = (
            find(state, axes).projector for find in (analysis.reaction_null_space, analysis.coupling_null_space)
        )
        assert np.allclose(reaction, coupling, atol=1e-10) is same


def test_a_base_at_rest_and_rates_of_the_reaction_null_space_have_no_momentum(state):
    """A base that does not turn, and shifts as its mass centre demands, is without any momentum."""
    robot = state.robot
    still = robot.state(state.q)
    rates = analysis.reaction_null_space(still).basis @ np.ones(robot.n_joints - 3)
    R = still.T_WB.rotation
    linear = R.T @ (ospace.generalized_jacobian(still, robot.point("head")).base_generalized_jacobian @ rates)[:3]
    moving = robot.state(state.q, np.r_[linear, np.zeros(3), rates])
    np.testing.assert_allclose(ospace.momentum(moving), 0.0, atol=1e-10)


@pytest.mark.parametrize("robot", ["planar_2r", "target", "ets_vii"])
def test_robots_with_few_joints_have_null_spaces_of_their_rank(robot):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(robot))
    state = robot.state(robot.neutral())
    for axes in AXES:
        space = analysis.reaction_null_space(state, axes)
        assert space.basis.shape == (robot.n_joints, robot.n_joints - space.rank)
        assert space.projector.shape == (robot.n_joints, robot.n_joints)


def test_the_fixed_attitude_jacobian_is_that_of_rates_that_keep_the_attitude(state):
    hand = state.robot.point("right_hand")
    J = analysis.fixed_attitude_jacobian(state, hand)
    J_m_star = ospace.generalized_jacobian(state, hand).generalized_jacobian
    space = analysis.reaction_null_space(state)
    np.testing.assert_allclose(J @ space.basis, J_m_star @ space.basis, atol=1e-12)
    assert np.linalg.matrix_rank(J) <= state.robot.n_joints - space.rank


def test_wheels_store_what_joints_and_base_have_of_angular_momentum(state):
    """With the attitude held and no linear momentum, h = K φ̇ is the angular momentum about the mass centre."""
    robot, rates = state.robot, np.random.default_rng(1).normal(size=state.robot.n_joints)
    dynamics = ospace.joint_space_dynamics(state)
    linear = -np.linalg.solve(dynamics.base_inertia[:3, :3], dynamics.coupling_inertia[:3] @ rates)
    R = state.T_WB.rotation
    M_0 = ospace.momentum(robot.state(state.q, np.r_[R.T @ linear, np.zeros(3), rates]))
    np.testing.assert_allclose(M_0[:3], 0.0, atol=1e-11)
    np.testing.assert_allclose(analysis.wheel_momentum(state) @ rates, M_0[3:], atol=1e-10)


def test_the_disturbance_map_is_that_of_the_base_by_joints(state):
    found = analysis.disturbance_map(state)
    J = ospace.generalized_jacobian(state, state.robot.point("head")).base_generalized_jacobian[3:]
    np.testing.assert_allclose(np.linalg.norm(J @ found.directions, axis=0), found.sizes, atol=1e-14)
    np.testing.assert_allclose(found.by_joint, np.linalg.norm(J, axis=0), atol=1e-15)


def test_an_impulse_moves_base_joints_and_hand_together(state):
    hand = state.robot.point("right_hand")
    jumps = analysis.impulse_map(state, hand)
    J = ospace.operational_space(state, hand).jacobian
    np.testing.assert_allclose(J @ np.vstack([jumps.base, jumps.joints]), jumps.point, atol=1e-12)
    turns = np.linalg.norm(jumps.base[3:], axis=0)
    assert np.linalg.norm(jumps.base[3:] @ jumps.least_reaction) <= turns.min() + 1e-15
    assert np.linalg.norm(jumps.least_reaction) == pytest.approx(1.0)


def test_dynamic_manipulability_vanishes_at_a_dynamic_singularity_alone():
    """Papadopoulos and Dubowsky (1993): joints at -65 and -11.410803 deg, where the arm on a fixed base is regular."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    hand = robot.point("end_effector", axes=(True, True, False, False, False, False))
    angles = np.deg2rad([-65.0, -11.410803])
    state = robot.state(robot.configuration(dict(zip(robot.joint_names, angles, strict=True))))
    fixed = analysis.dynamic_manipulability(state, hand, "fixed")
    assert analysis.dynamic_manipulability(state, hand) < 1e-7 * fixed
    with pytest.raises(ospace.OspaceError, match="base 'flying' is unknown"):
        analysis.dynamic_manipulability(state, hand, "flying")


def test_the_coupling_factor_is_of_base_by_hand(state):
    hand = state.robot.point("right_hand", axes="linear")
    jacobians = ospace.generalized_jacobian(state, hand)
    K = jacobians.base_generalized_jacobian[3:] @ np.linalg.pinv(jacobians.generalized_jacobian)
    assert analysis.coupling_factor(state, hand) == pytest.approx(np.sqrt(np.linalg.det(K @ K.T)), rel=1e-6)


def test_bad_input_of_null_spaces_is_refused():
    robot = trees.tree(0, 4)
    with pytest.raises(ospace.OspaceError, match="axes 'sideways'"):
        analysis.reaction_null_space(trees.state(robot, 0), "sideways")
    with pytest.raises(ospace.OspaceError, match="not a State"):
        analysis.coupling_null_space(robot)

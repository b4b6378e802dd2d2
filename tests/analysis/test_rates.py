"""Rates and derivatives of Jacobians and inertias, against differences of the dense oracle of eighth order."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import analysis
from ospace.dynamics.dense import Dense

WEIGHTS = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))
STEP, DIGITS = 1e-3, 1e-10


def rate(state, points, quantity):
    """Of a quantity of the oracle along the state's own velocity."""
    robot = state.robot

    def at(time):
        return getattr(
            Dense(ospace.State(robot, pin.integrate(robot.model, state.q, time * state.v)), points), quantity
        )

    return sum(weight * (at(k * STEP) - at(-k * STEP)) for k, weight in WEIGHTS) / STEP


def close(value, reference):
    np.testing.assert_allclose(value, reference, rtol=0, atol=DIGITS * max(1.0, np.abs(reference).max()))


@pytest.mark.parametrize("kind", [*trees.JOINT_TYPES, None])
def test_the_rate_of_the_generalized_jacobian_for_every_joint_type(kind):
    robot = trees.tree(1, 3, (kind,)) if kind else trees.tree(4, 14)
    state, points = trees.state(robot, 1), [robot.point("link_2"), robot.point("link_1", axes="linear")]
    close(analysis.generalized_jacobian_rate(state, points), rate(state, points, "J_m_star"))


@pytest.mark.parametrize("seed", range(4))
def test_the_rate_of_the_generalized_jacobian_of_a_coupled_robot(seed):
    robot = trees.coupled(seed)
    state, point = trees.state(robot, seed), robot.point("link_8")
    close(analysis.generalized_jacobian_rate(state, point), rate(state, [point], "J_m_star"))


def test_the_rate_far_from_the_origin_is_the_same():
    robot = trees.tree(2, 9)
    near = trees.state(robot, 2)
    far = robot.state(np.r_[near.q[:3] + 7e6, near.q[3:]], near.v + np.r_[7.5e3, np.zeros(robot.nv - 1)])
    point = robot.point("link_8")
    close(analysis.generalized_jacobian_rate(far, point), analysis.generalized_jacobian_rate(near, point))


def test_acceleration_of_a_point_without_momentum_is_the_jacobian_and_its_rate():
    """Where M_0 = 0, ẍ_e = J_m* φ̈ + J̇_m* φ̇: with φ̈ = 0, J̇_m* φ̇ is the rate of ẋ_e = J_m* φ̇."""
    robot = trees.tree(3, 8, trees.ONE_POSITION)
    start = trees.state(robot, 3)
    point = robot.point("link_7")
    jacobians = ospace.generalized_jacobian(start, point)
    R = start.T_WB.rotation
    base = jacobians.base_generalized_jacobian @ start.v[6:]
    state = robot.state(start.q, np.r_[R.T @ base[:3], R.T @ base[3:], start.v[6:]])
    drift = analysis.generalized_jacobian_rate(state, point) @ state.v[6:]
    dense = Dense(state, [point])
    acceleration = np.linalg.solve(dense.H[:6, :6], -dense.c[:6])
    close(drift, dense.J_e[:, :6] @ acceleration + dense.drift)


@pytest.mark.parametrize("seed", range(3))
def test_derivatives_along_coordinates_add_up_to_the_rate(seed):
    robot = trees.tree(seed, 7)
    state, point = trees.state(robot, seed), robot.point("link_6")
    for derivative, quantity in (
        (analysis.generalized_jacobian_derivative, "J_m_star"),
        (analysis.inertia_inverse_derivative, "Gamma_e_inv"),
    ):
        whole = derivative(state, point)
        along = derivative(state, point, state.v)
        close(whole @ state.v, along)
        close(along, rate(state, [point], quantity))


def test_bad_input_of_derivatives_is_refused():
    robot = trees.tree(0, 4)
    state, point = trees.state(robot, 0), robot.point("link_3")
    with pytest.raises(ospace.OspaceError, match="direction has shape"):
        analysis.inertia_inverse_derivative(state, point, [1.0])
    with pytest.raises(ospace.OspaceError, match="not a State"):
        analysis.generalized_jacobian_rate(robot, point)
    with pytest.raises(ospace.OspaceError, match="another robot"):
        analysis.generalized_jacobian_rate(state, trees.tree(1, 4).point("link_3"))

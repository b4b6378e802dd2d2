"""Operational-space dynamics of the free-floating robot (§2.3, §3.2, §6.3): no force acts on the base."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ospace.checks import all_finite
from ospace.dynamics.generalized_jacobian import point_jacobian
from ospace.dynamics.joint_space import bias, composite_bodies
from ospace.dynamics.operational_space import forward_chain, refuse_dependent
from ospace.dynamics.ranges import inverse_on_range
from ospace.kernels import composite
from ospace.kernels.tables import Floats
from ospace.points import OperationalPoint, point_set
from ospace.state import State


@dataclass(frozen=True)
class FreeFloating:
    """The terms of (12): ẍ_e + μ = J_m* H_m*⁻¹ τ + Γ_e⁻¹ F_e, for r rows; inertial axes, at the points.

    Attributes
    ----------
    floating_inertia_inverse : (r, r)
        Λ⁻¹ = J_m* H_m*⁻¹ J_m*ᵀ: what joint torques alone can do.
    base_inertia_inverse : (r, r)
        Λ_b⁻¹ = J_b H_b⁻¹ J_bᵀ: what moves along with the locked robot; Γ_e⁻¹ = Λ⁻¹ + Λ_b⁻¹.
    floating_inertia : (r, r)
        Λ; at `rank` < r the pseudo-inverse of Λ⁻¹ on its numerical range.
    bias_acceleration : (r,)
        μ: ẍ_e = −μ when nothing acts; m/s², rad/s².
    torque_map : (r, n)
        J_m* H_m*⁻¹: accelerations of the points per unit torque.
    generalized_jacobian : (r, n)
        J_m*.
    rank : int
        Rank of Λ⁻¹: in how many directions joint torques move the points.
    """

    floating_inertia_inverse: Floats
    base_inertia_inverse: Floats
    floating_inertia: Floats
    bias_acceleration: Floats
    torque_map: Floats
    generalized_jacobian: Floats
    rank: int

    @property
    def dynamically_consistent_inverse(self) -> Floats:
        """J_m*⁺ = H_m*⁻¹ J_m*ᵀ Λ (13), (n, r)."""
        return self.torque_map.T @ self.floating_inertia

    @property
    def null_space_projector(self) -> Floats:
        """1 − J_m*⁺ J_m*, (n, n): joint motions that leave points (and, with the base among them, the base) at rest."""
        return np.eye(self.torque_map.shape[1]) - self.dynamically_consistent_inverse @ self.generalized_jacobian


def free_floating(
    state: State, points: OperationalPoint | Sequence[OperationalPoint], *, strict: bool = False
) -> FreeFloating:
    """Compute what joint torques alone do at points of a free-floating robot.

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        Any frames of the state's robot; r rows in the order given.
    strict : bool
        Refuse rows of Λ⁻¹ that depend on each other instead of inverting on the numerical range.

    Raises
    ------
    DependentRowsError
        With `strict`, where joint torques cannot move the rows independently: too few joints, or a dynamic
        singularity; names the points.
    SingularInertiaError
        A joint moves nothing in this state; names the joint.
    OspaceError
        No point, or another robot's; or a result that is not finite.

    Notes
    -----
    The torque map is the joint part of the response H⁻¹ J_eᵀ of the forward chain, transposed: by (7) a force at the
    points accelerates the joints by H_m*⁻¹ J_m*ᵀ F_e. The bias follows from (6) and (7) with nothing acting,

        μ = J_m* H_m*⁻¹ c_m* + J_b H_b⁻¹ c_b − J̇_e ẋ,

    which is the μ of (12) together with the term that the paper drops: with M_0 about the moving base point,
    J_b H_b⁻¹ c_b − J̇_e ẋ = −J̇_m* φ̇ − d/dt(J_b H_b⁻¹) M_0 − J_b H_b⁻¹ [0; −v_b × P].
    """
    given = point_set(state.robot, points)
    Gamma_inv, _, response = forward_chain(state, given)
    J_e = point_jacobian(state, given)
    bodies = composite_bodies(state)
    c_b, c_m = bias(state)
    drift = composite.point_motion(given.table, state.placements, state.tree)[2].ravel()[given.rows]

    J_b, J_m = J_e[:, :6], J_e[:, 6:]
    J_m_star = J_m + J_b @ bodies.J_b_star
    c_m_star = c_m + bodies.J_b_star.T @ c_b
    torque_map = response[6:].T
    Lambda_inv = torque_map @ J_m_star.T
    Lambda_inv = 0.5 * (Lambda_inv + Lambda_inv.T)
    Lambda_b_inv = J_b @ bodies.H_b_inv @ J_b.T
    mu = torque_map @ c_m_star + J_b @ (bodies.H_b_inv @ c_b) - drift
    all_finite((torque_map, Lambda_inv, Lambda_b_inv, mu), "the free-floating dynamics")

    H_m_star = bodies.H_m + bodies.H_bm.T @ bodies.J_b_star
    Lambda, rank, dependent = inverse_on_range(Lambda_inv, J_m_star, np.diag(Gamma_inv), np.diag(H_m_star))
    if strict and rank < len(Lambda_inv):
        refuse_dependent(given, rank, dependent)
    return FreeFloating(Lambda_inv, Lambda_b_inv, Lambda, mu, torque_map, J_m_star, rank)

"""Operational-space dynamics of the free-floating robot (§2.3, §3.2, §6.3): no force acts on the base."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ospace.dynamics import workspace
from ospace.kernels import evaluation as kernel
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, points_of
from ospace.model.state import State
from ospace.results import Result


@dataclass(frozen=True)
class FreeFloating(Result):
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

    Returns
    -------
    FreeFloating
        Λ⁻¹, Λ_b⁻¹, Λ (r, r), μ (r,) and the torque map J_m* H_m*⁻¹ (r, n) of (12), inertial axes at the points.

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
    The torque map is the joint part of the response H⁻¹ J_eᵀ, transposed: by (7) a force at the
    points accelerates the joints by H_m*⁻¹ J_m*ᵀ F_e. The bias follows from (6) and (7) with nothing acting,

        μ = J_m* H_m*⁻¹ c_m* + J_b H_b⁻¹ c_b − J̇_e ẋ,

    which is the μ of (12) together with the term that the paper drops: with M_0 about the moving base point,
    J_b H_b⁻¹ c_b − J̇_e ẋ = −J̇_m* φ̇ − d/dt(J_b H_b⁻¹) M_0 − J_b H_b⁻¹ [0; −v_b × P].
    """
    run = workspace.of(state, points)
    run.evaluate(kernel.MOBILITY | kernel.COMPOSITE)
    run.respond(floating=True)
    if strict:
        run.refuse_dependent(points_of(state.robot, points))
    return FreeFloating(
        run.copy("floating_inertia_inverse"),
        run.copy("base_inertia_inverse"),
        run.copy("floating_inertia"),
        run.table("floating_bias")[:, 0].copy(),
        run.table("response")[6:].T.copy(),
        run.copy("generalized_jacobian"),
        run.rank,
    )

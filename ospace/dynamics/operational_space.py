"""Operational-space dynamics of the free-flying robot (§3.1, §6.1, §6.2)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ospace.checks import all_finite
from ospace.dynamics import paper_sweeps
from ospace.dynamics.dense import Dense
from ospace.dynamics.generalized_jacobian import point_jacobian
from ospace.dynamics.joint_space import composite_bodies
from ospace.dynamics.ranges import inverse_on_range
from ospace.exceptions import DependentRowsError, OspaceError, SingularInertiaError
from ospace.kernels.articulated import NO_INERTIA
from ospace.kernels.tables import Floats
from ospace.points import OperationalPoint, PointSet, point_set
from ospace.state import State

METHODS = ("forward", "inverted", "dense")


@dataclass(frozen=True)
class OperationalSpace:
    """The terms of (8): Γ_e ẍ_e + μ_e = F_e^in + F_e, for r rows; inertial axes, at the points.

    Attributes
    ----------
    inertia : (r, r)
        Γ_e; at `rank` < r the pseudo-inverse of Γ_e⁻¹ on its numerical range.
    inertia_inverse : (r, r)
        Γ_e⁻¹ = J_e H⁻¹ J_eᵀ (9).
    bias_force : (r,)
        μ_e = Γ_e μ (10); N, N m.
    bias_acceleration : (r,)
        μ: ẍ_e = −μ when nothing acts; m/s², rad/s².
    jacobian : (r, nv)
        J_e = [J_b J_m]; base columns for ẋ_b in inertial axes.
    rank : int
        Rank of Γ_e⁻¹: how many of the rows are independent.
    response : (nv, r)
        H⁻¹ J_eᵀ: [ẍ_b; φ̈] per unit of each force at the points.
    """

    inertia: Floats
    inertia_inverse: Floats
    bias_force: Floats
    bias_acceleration: Floats
    jacobian: Floats
    rank: int
    response: Floats

    @cached_property
    def dynamically_consistent_inverse(self) -> Floats:
        """J_e⁺ = H⁻¹ J_eᵀ Γ_e (11), (nv, r): of all motions [ẋ_b; φ̇] with the same ẋ_e that of least kinetic energy."""
        return self.response @ self.inertia

    @cached_property
    def null_space_projector(self) -> Floats:
        """1 − J_e⁺ J_e, (nv, nv): motions that leave the points at rest; transposed, forces that do not move them."""
        return np.eye(len(self.response)) - self.dynamically_consistent_inverse @ self.jacobian


def operational_space(
    state: State,
    points: OperationalPoint | Sequence[OperationalPoint],
    method: str = "forward",
    *,
    strict: bool = False,
) -> OperationalSpace:
    """Compute the operational-space inertia Γ_e and bias force μ_e of points on a free-flying robot.

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        Any frames of the state's robot, the base included, several on one link; r rows in the order given.
    method : "forward", "inverted" or "dense"
        Forward chain (37)–(45); inverted chain (33)–(36), for one point; or (9), (10) from Pinocchio's crba, rnea
        and Jacobians.
    strict : bool
        Refuse dependent rows instead of inverting on the numerical range.

    Raises
    ------
    DependentRowsError
        With `strict`, where rows depend on each other; names the points.
    SingularInertiaError
        A joint moves nothing in this state; names the joint.
    OspaceError
        No point, or another robot's; an unknown method; more than one point for the inverted chain; or a result
        that is not finite.

    Notes
    -----
    The inverted chain gives Γ_e and μ_e; `response` is the forward chain's under that method too.
    Rows that depend on each other are told by the Jacobian: see `ospace.dynamics.ranges.RANK_CUTOFF`.
    """
    if method not in METHODS:
        raise OspaceError(f"method '{method}' is unknown: give one of {', '.join(METHODS)}")
    given = point_set(state.robot, points)
    known: tuple[Floats, Floats] | None = None
    if method == "inverted":
        Gamma_inv, mu, known = _inverted(state, given)
        response = forward_chain(state, given)[2]
        J_e = point_jacobian(state, given)
    elif method == "dense":
        _refuse_singular(state, paper_sweeps.forward(state, given)[3])
        dense = Dense(state, given.points)
        Gamma_inv, mu, response, J_e = dense.Gamma_e_inv, dense.mu, dense.response, dense.J_e
    else:
        Gamma_inv, mu, response = forward_chain(state, given)
        J_e = point_jacobian(state, given)
    all_finite((Gamma_inv, mu, response, J_e), "the operational-space dynamics")

    H = composite_bodies(state).diagonal
    Gamma, rank, dependent = inverse_on_range(Gamma_inv, J_e, np.diag(Gamma_inv), H)
    if strict and rank < len(Gamma_inv):
        refuse_dependent(given, rank, dependent)
    Gamma, mu_e = known or (Gamma, Gamma @ mu)
    all_finite((Gamma, mu_e), "the operational-space dynamics")
    return OperationalSpace(Gamma, Gamma_inv, mu_e, mu, J_e, rank, response)


def refuse_dependent(given: PointSet, rank: int, dependent: Iterable[int]) -> None:
    """Raise the `DependentRowsError` that names the points of the dependent rows."""
    names = [given.points[given.rows[row] // 6].frame for row in dependent]
    raise DependentRowsError(rank, len(given.rows), dict.fromkeys(names))


def forward_chain(state: State, given: PointSet) -> tuple[Floats, Floats, Floats]:
    """Return Γ_e⁻¹ (r, r), μ (r,) and H⁻¹ J_eᵀ (nv, r) by the forward chain (38)–(45)."""
    Gamma_inv, mu, response, pivots = paper_sweeps.forward(state, given)
    _refuse_singular(state, pivots)
    return Gamma_inv, mu, response


def _inverted(state: State, given: PointSet) -> tuple[Floats, Floats, tuple[Floats, Floats] | None]:
    """Return Γ_e⁻¹ (r, r) and μ (r,) by the inverted chain; if all rows are taken, Γ_e and μ_e as they come."""
    if len(given.points) != 1:
        raise OspaceError(f"the inverted chain takes one point, got {len(given.points)}: use method='forward'")
    Gamma, mu_e, Gamma_inv, mu, pivots = paper_sweeps.inverted(state, given)
    _refuse_singular(state, pivots)
    return Gamma_inv, mu, (Gamma, mu_e) if len(given.rows) == 6 else None


def _refuse_singular(state: State, pivots: Floats) -> None:
    """Raise where a joint has no inertia left to resist it; NaN counts as none."""
    none = np.flatnonzero(~(pivots[1:] > NO_INERTIA))
    if none.size:
        raise SingularInertiaError(state.robot.joint_of_link(1 + int(none[-1])))

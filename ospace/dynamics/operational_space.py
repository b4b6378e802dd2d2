"""Operational-space dynamics of the free-flying robot (§3.1, §6.1, §6.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ospace.checks import all_finite
from ospace.dynamics import paper_sweeps, workspace
from ospace.dynamics.dense import Dense
from ospace.dynamics.workspace import Workspace
from ospace.exceptions import OspaceError
from ospace.kernels import evaluation as kernel
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, points_of
from ospace.model.state import State
from ospace.results import Result

METHODS = ("pv_osimr", "forward", "inverted", "dense")
_ALL = kernel.MOBILITY | kernel.INERTIA | kernel.BIAS | kernel.JACOBIAN


@dataclass(frozen=True)
class OperationalSpace(Result):
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
    """

    inertia: Floats
    inertia_inverse: Floats
    bias_force: Floats
    bias_acceleration: Floats
    jacobian: Floats
    rank: int
    _state: State = field(repr=False)
    _points: tuple[OperationalPoint, ...] = field(repr=False)

    @cached_property
    def response(self) -> Floats:
        """H⁻¹ J_eᵀ (nv, r): [ẍ_b; φ̈] per unit of each force at the points."""
        run = workspace.of(self._state, self._points)
        run.evaluate(kernel.MOBILITY)
        run.respond(floating=False)
        return run.copy("response")

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
    method: str = "pv_osimr",
    *,
    strict: bool = False,
) -> OperationalSpace:
    """Compute the operational-space inertia Γ_e and bias force μ_e of points on a free-flying robot.

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        Any frames of the state's robot, the base included, several on one link; r rows in the order given.
    method : "pv_osimr", "forward", "inverted" or "dense"
        The fast way, which evaluator and batch share; or one of three independent ones: the paper's forward chain
        (37)–(45); its inverted chain (33)–(36), for one point; (9), (10) from Pinocchio's crba, rnea and Jacobians.
    strict : bool
        Refuse dependent rows instead of inverting on the numerical range.

    Returns
    -------
    OperationalSpace

    Raises
    ------
    DependentRowsError
        With `strict`, where rows depend on each other; names the points.
    SingularInertiaError
        A joint moves nothing in this state; names the joint.
    OspaceError
        No point, or another robot's; an unknown method; more than one point for the inverted chain; joints that mimic
        others for either chain; or a result that is not finite.

    Notes
    -----
    Whether rows depend on each other is decided by the Jacobian: see `ospace.dynamics.ranges.RANK_CUTOFF`.
    """
    if method not in METHODS:
        raise OspaceError(f"method '{method}' is unknown: give one of {', '.join(METHODS)}")
    run = workspace.of(state, points)
    run.evaluate(_ALL)
    if method != "pv_osimr":
        return _by(method, run, state, points_of(state.robot, points), strict)
    if strict:
        run.refuse_dependent(points_of(state.robot, points))
    return OperationalSpace(
        run.copy("inertia"),
        run.copy("inertia_inverse"),
        run.table("bias_force")[:, 0].copy(),
        run.table("bias_acceleration")[:, 0].copy(),
        run.copy("jacobian"),
        run.rank,
        state,
        run.points,
    )


def _by(
    method: str, run: Workspace, state: State, points: tuple[OperationalPoint, ...], strict: bool
) -> OperationalSpace:
    """Compute the same by an independent method; `run` has evaluated the state."""
    J_e, known, response = run.copy("jacobian"), None, None
    if method != "dense" and state.robot.free:
        raise OspaceError(
            f"method '{method}' eliminates one joint after the other, and joints of robot '{state.robot.name}' mimic "
            f"others: use 'pv_osimr' or 'dense', or read it with free_mimic=True"
        )
    if method == "inverted":
        if len(points) != 1:
            raise OspaceError(f"the inverted chain takes one point, got {len(points)}: use method='forward'")
        Gamma_e, mu_e, Gamma_inv, mu, _ = paper_sweeps.inverted(state, points)
        known = (Gamma_e, mu_e) if len(run.rows) == 6 else None
    elif method == "forward":
        Gamma_inv, mu, response, _ = paper_sweeps.forward(state, points)
    else:
        dense = Dense(state, points)
        Gamma_inv, mu, response, J_e = dense.Gamma_e_inv, dense.mu, dense.response, dense.J_e
    all_finite((Gamma_inv, mu), "the operational-space dynamics")
    Gamma = run.inverse_on_range(Gamma_inv, J_e)
    if strict:
        run.refuse_dependent(points)
    Gamma, mu_e = known or (Gamma, Gamma @ mu)
    all_finite((Gamma, mu_e), "the operational-space dynamics")
    result = OperationalSpace(Gamma, Gamma_inv, mu_e, mu, J_e, run.rank, state, points)
    if response is not None:
        vars(result)["response"] = response  # in place of the one by the fast way
    return result

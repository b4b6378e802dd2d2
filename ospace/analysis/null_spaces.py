"""Joint rates that leave the base at rest, and those that pass it no momentum: two spaces that are often confused.

The base follows the joints by ẋ_b = J_b* φ̇ where M_0 = 0 (2). Rates in the null space of rows of J_b* leave these
components of the base's velocity at zero (reaction null space of all that is solved for the base).

H_bm φ̇ is the momentum that the joints have beside the base. Rates in the null space of rows of H_bm pass no such
momentum. As J_b* = −H_b⁻¹ H_bm (27), both are the same for all six rows. For some of them they are not: H_b mixes
linear and angular momentum, so a base without angular H_bm φ̇ turns all the same where the linear part pushes it off
its mass centre.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ospace.checks import check_kind
from ospace.dynamics.generalized_jacobian import base_generalized_jacobian, generalized_jacobian
from ospace.dynamics.joint_space import joint_space_dynamics
from ospace.kernels.tree import Floats, Ints
from ospace.model.points import Axes, OperationalPoint, parse_axes, points_of
from ospace.model.state import State
from ospace.results import Result

RANK_CUTOFF = 1e-9
"""Singular values below this share of the largest count as zero, rows and columns over the roots of their inertias."""


@dataclass(frozen=True)
class NullSpace(Result):
    """Joint rates that rows of a map take to zero.

    Attributes
    ----------
    basis : (n, k)
        Orthonormal columns; rad/s or m/s of each joint.
    projector : (n, n)
        basis basisᵀ: what is left of joint rates in the space.
    rank : int
        Rank of the rows, n − k.
    """

    basis: Floats
    projector: Floats
    rank: int


def reaction_null_space(state: State, axes: Axes = "angular") -> NullSpace:
    """Find the joint rates that leave components of the base's velocity at zero while M_0 = 0.

    Parameters
    ----------
    state : State
        Its velocity does not count.
    axes : "all", "linear", "angular" or six booleans
        Rows of J_b* (27): of ẋ_b, inertial axes, at the base-link frame's origin.

    Returns
    -------
    NullSpace

    Raises
    ------
    OspaceError
        `axes` make no sense.
    """
    rows, H_b, H_m = _of(state, axes)
    J_b_star = base_generalized_jacobian(state)
    return _null_space(J_b_star[rows], np.sqrt(H_b[rows]), 1.0 / np.sqrt(H_m))


def coupling_null_space(state: State, axes: Axes = "angular") -> NullSpace:
    """Find the joint rates that pass no momentum to the base: H_bm φ̇ = 0 in some rows.

    Parameters
    ----------
    state : State
        Its velocity does not count.
    axes : "all", "linear", "angular" or six booleans
        Rows of H_bm (21): of momentum, inertial axes, about the base-link frame's origin.

    Returns
    -------
    NullSpace

    Raises
    ------
    OspaceError
        `axes` make no sense.

    Notes
    -----
    It is not the space in which the base stays at rest, unless all six rows are taken: see `reaction_null_space`.
    """
    rows, H_b, H_m = _of(state, axes)
    H_bm = joint_space_dynamics(state).coupling_inertia
    return _null_space(H_bm[rows], 1.0 / np.sqrt(H_b[rows]), 1.0 / np.sqrt(H_m))


def fixed_attitude_jacobian(state: State, points: OperationalPoint | Sequence[OperationalPoint]) -> Floats:
    """Compute the Jacobian of points for joint rates that keep the base's attitude, J_m* N.

    Parameters
    ----------
    state : State
        Its velocity does not count.
    points : OperationalPoint or sequence of them
        r rows in the order given.

    Returns
    -------
    (r, n) array
        J_m* N with N the projector of `reaction_null_space(state, "angular")`; inertial axes, at the points.

    Raises
    ------
    OspaceError
        No point, or another robot's.
    """
    check_kind(state, State, "make it with robot.state(q, v)")
    taken = points_of(state.robot, points)
    J_m_star = generalized_jacobian(state, taken).generalized_jacobian
    return np.asarray(J_m_star @ reaction_null_space(state).projector)


def _of(state: State, axes: Axes) -> tuple[Ints, Floats, Floats]:
    """Return rows, and the diagonals of H_b and H_m."""
    check_kind(state, State, "make it with robot.state(q, v)")
    rows = np.flatnonzero(parse_axes(axes))
    dynamics = joint_space_dynamics(state)
    return rows, np.diag(dynamics.base_inertia), np.diag(dynamics.manipulator_inertia)


def _null_space(A: Floats, rows: Floats, columns: Floats) -> NullSpace:
    """Take the null space of A; its rank by A with rows and columns scaled."""
    n = A.shape[1]
    if n == 0:
        return NullSpace(np.zeros((0, 0)), np.zeros((0, 0)), 0)
    values = np.linalg.svd(rows[:, None] * A * columns, compute_uv=False)
    rank = int((values > RANK_CUTOFF * max(values.max(initial=0.0), 1e-300)).sum()) if A.any() else 0
    basis = np.linalg.svd(rows[:, None] * A)[2][rank:].T
    return NullSpace(basis, basis @ basis.T, rank)

"""Rates of inertias and Jacobians along a motion, by one inward recursion over the links.

Seen from the base and carried to its origin, with V_i the twist of link i relative to the base's linear motion,

    Ṡ_i = V_i × S_i,   İ_i = V_i ×* I_i − I_i V_i ×
    I_h^C ← I_h^C + I_i^C,   F_i = I_i^C S_i,   and likewise of the rates          (21)
    H_ij = S_jᵀ F_i,   Ḣ_ij = Ṡ_jᵀ F_i + S_jᵀ Ḟ_i
    J̇_b* = −H_b⁻¹ (Ḣ_bm + Ḣ_b J_b*)                                                (27)

and at the point e at p, X(p) = [1 −p̃; 0 1], with ṗ its velocity relative to the base's origin,

    J_m* = X(p) (S_k [k below e] + J_b*),   J̇_m* = X(p) (Ṡ_k + J̇_b*) + [−ṗ × (…)_angular; 0]      (29–31)

A rate is linear in the motion; along a unit of each coordinate it is the derivative by that coordinate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from ospace.checks import all_finite, check_kind, checked_vector
from ospace.dynamics import workspace
from ospace.exceptions import OspaceError
from ospace.kernels import evaluation as kernel
from ospace.kernels.tree import COLUMNS, UNKNOWN, Floats, Ints
from ospace.model.points import OperationalPoint, points_of, rows_of
from ospace.model.state import State

_LOWER = np.tril_indices(6)


class Rates:
    """H, J_b* and J_e of a state, base rows in inertial axes, and their rates along its motion.

    Attributes
    ----------
    S, S_dot : (links, 6) columns of the links, about the base, and their rates
    V : (links, 6) twists, likewise
    I, I_dot : (links, 6, 6) inertias of the links by themselves, likewise
    H, H_dot : (nv, nv)
    J_b_star, J_b_star_dot : (6, n)
    below : (links, links) 1 where joint j is on the way from link i to the base
    columns : (links, n) 1 where a link belongs to a degree of freedom
    carriers : (links,) the link in whose axes each column stands still: of joints with several, that of the body
    """

    def __init__(self, state: State, points: Sequence[OperationalPoint]) -> None:
        self.state, self.points, self.robot = state, points, state.robot
        run = workspace.of(state, points)
        run.evaluate(kernel.FLOATING_BASE)
        links, self.carriers, self.below = self.robot.links, self._carriers(), self._below()
        r, V = run.table("r"), run.table("v").copy()
        self.S = carried(run.table("S"), -r)
        self.S[0] = 0.0
        self.V = carried(V, -r)
        I, X = _symmetric(run.table("I")), _shift(r)
        self.I = np.einsum("nji,njk,nkl->nil", X, I, X)
        crm = cross_motion(self.V)
        self.I_dot = -np.einsum("nji,njk->nik", crm, self.I) - np.einsum("nij,njk->nik", self.I, crm)
        I, rate = self.I.copy(), self.I_dot.copy()
        for i in range(len(links.parent) - 1, 0, -1):
            I[links.parent[i]] += I[i]
            rate[links.parent[i]] += rate[i]
        self.S_dot = np.einsum("nij,nj->ni", crm[self.carriers], self.S)
        F = np.einsum("nij,nj->ni", I, self.S)
        F_dot = np.einsum("nij,nj->ni", rate, self.S) + np.einsum("nij,nj->ni", I, self.S_dot)
        self.columns = np.eye(self.robot.n_joints + 1)[links.column][:, 1:]  # (links, n): whose degree of freedom
        self.columns[0] = 0.0
        H_m, H_m_dot = self.below * (F @ self.S.T), self.below * (F @ self.S_dot.T + F_dot @ self.S.T)
        self.H = self._joint_space(I[0], F, H_m) + np.diag(np.r_[np.zeros(6), self.columns.T @ links.armature[:, 0]])
        self.H_dot = self._joint_space(rate[0], F_dot, H_m_dot)
        H_b, H_bm = self.H[:6, :6], self.H[:6, 6:]
        self.J_b_star = -np.linalg.solve(H_b, H_bm)
        self.J_b_star_dot = -np.linalg.solve(H_b, self.H_dot[:6, 6:] + self.H_dot[:6, :6] @ self.J_b_star)

    def _carriers(self) -> Ints:
        kind = self.robot.links.kind
        if UNKNOWN in kind:
            joint = self.robot.joint_of_link(int(np.flatnonzero(kind == UNKNOWN)[0]))
            raise OspaceError(f"joint '{joint}' is of a type whose columns have no known rate")
        carriers = np.arange(len(kind))
        for i in np.flatnonzero(np.array(COLUMNS)[kind] > 1):
            carriers[i : i + COLUMNS[kind[i]]] = i + COLUMNS[kind[i]] - 1
        return carriers

    def _below(self) -> Floats:
        parent = self.robot.links.parent
        below = np.eye(len(parent))
        for i in range(1, len(parent)):
            below[i] += below[parent[i]]
        return below

    def _joint_space(self, base: Floats, F: Floats, H_m: Floats) -> Floats:
        """Put a matrix such as H together of its blocks, those of the joints by links; each pair (i, j) stands once."""
        whole = H_m + H_m.T - np.diag(np.diag(H_m))
        H_bm = F.T @ self.columns
        return np.block([[base, H_bm], [H_bm.T, self.columns.T @ whole @ self.columns]])

    def jacobians(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return J_e and J_m* of the rows taken, and their rates."""
        found = []
        unit, none = np.eye(6), np.zeros((6, 6))
        for point in self.points:
            link = int(self.robot.link_of_joint[point.joint])
            p = self.state.placement_about_base(point).translation
            columns = [one * self.below[link] @ self.columns for one in (self.S.T, self.S_dot.T)]
            p_dot = carried(self.V[link][None], p[None])[0, :3]
            J, J_dot = _at(p, p_dot, np.hstack([unit, columns[0]]), np.hstack([none, columns[1]]))
            star = columns[0] + self.J_b_star, columns[1] + self.J_b_star_dot
            found.append((J, J_dot, *_at(p, p_dot, *star)))
        rows = rows_of(self.points)
        J, J_dot, J_m_star, J_m_star_dot = (np.vstack(each)[rows] for each in zip(*found, strict=True))
        return J, J_m_star, J_dot, J_m_star_dot


def _at(p: Floats, p_dot: Floats, motion: Floats, rate: Floats) -> tuple[Floats, Floats]:
    """Carry motions (6, k) at the base to a point at `p` that moves with `p_dot`; return them and their rates."""
    X, turned = _shift(p[None])[0], np.zeros_like(motion)
    turned[:3] = np.cross(motion[3:].T, p_dot).T
    return X @ motion, X @ rate + turned


def _shift(d: Floats) -> Floats:
    """Return X (N, 6, 6), which takes motions to points `d` (N, 3) away."""
    X = np.tile(np.eye(6), (len(d), 1, 1))
    X[:, :3, 3:] = -_tilde(d)
    return X


def carried(motions: Floats, d: Floats) -> Floats:
    """Return motions (N, 6) at points `d` (N, 3) away."""
    return np.asarray(np.einsum("nij,nj->ni", _shift(d), motions))


def cross_motion(V: Floats) -> Floats:
    """Return V × (N, 6, 6)."""
    crm = np.zeros((len(V), 6, 6))
    crm[:, :3, :3] = crm[:, 3:, 3:] = _tilde(V[:, 3:])
    crm[:, :3, 3:] = _tilde(V[:, :3])
    return crm


def _tilde(v: Floats) -> Floats:
    x, y, z = v.T
    o = np.zeros_like(x)
    return np.moveaxis(np.array([[o, -z, y], [z, o, -x], [-y, x, o]]), -1, 0)


def _symmetric(lower_rows: Floats) -> Floats:
    I = np.zeros((len(lower_rows), 6, 6))
    I[:, _LOWER[0], _LOWER[1]] = I[:, _LOWER[1], _LOWER[0]] = lower_rows
    return I


def generalized_jacobian_rate(state: State, points: OperationalPoint | Sequence[OperationalPoint]) -> Floats:
    """Compute the rate of the generalized Jacobian, J̇_m*.

    Parameters
    ----------
    state : State
        Its base twist and joint rates are those of the motion.
    points : OperationalPoint or sequence of them
        r rows in the order given.

    Returns
    -------
    (r, n) array
        J̇_m*; inertial axes, at the points. With M_0 = 0, ẍ_e = J_m* φ̈ + J̇_m* φ̇ (5).

    Raises
    ------
    OspaceError
        No point, or another robot's; or a result that is not finite.
    """
    return _along(state, points, 3)


def _along(state: State, points: OperationalPoint | Sequence[OperationalPoint], which: int) -> Floats:
    check_kind(state, State, "make it with robot.state(q, v)")
    result = Rates(state, points_of(state.robot, points)).jacobians()[which]
    all_finite((result,), "the rate of the Jacobian")
    return result


def generalized_jacobian_derivative(
    state: State, points: OperationalPoint | Sequence[OperationalPoint], direction: npt.ArrayLike | None = None
) -> Floats:
    """Compute ∂J_m*/∂q along a direction of the configuration, or along each coordinate of the velocity.

    Parameters
    ----------
    state : State
        Its velocity does not count.
    points : OperationalPoint or sequence of them
        r rows in the order given.
    direction : (nv,), optional
        In the coordinates of v: base twist in base axes, then joint rates.

    Returns
    -------
    (r, n) or (r, n, nv) array
        Inertial axes, at the points. Unit of J_m* per unit of the coordinate.

    Raises
    ------
    OspaceError
        No point, or another robot's; a direction of another length; or a result that is not finite.
    """
    return _by_coordinates(state, direction, lambda at: _along(at, points, 3))


def inertia_inverse_derivative(
    state: State, points: OperationalPoint | Sequence[OperationalPoint], direction: npt.ArrayLike | None = None
) -> Floats:
    """Compute ∂Γ_e⁻¹/∂q along a direction of the configuration, or along each coordinate of the velocity.

    With Φ = H⁻¹ J_eᵀ and Γ_e⁻¹ = J_e Φ (9), the rate is J̇_e Φ + Φᵀ J̇_eᵀ − Φᵀ Ḣ Φ.

    Parameters
    ----------
    state : State
        Its velocity does not count.
    points : OperationalPoint or sequence of them
        r rows in the order given.
    direction : (nv,), optional
        In the coordinates of v: base twist in base axes, then joint rates.

    Returns
    -------
    (r, r) or (r, r, nv) array
        Inertial axes, at the points.

    Raises
    ------
    OspaceError
        No point, or another robot's; a direction of another length; or a result that is not finite.
    """

    def along(at: State) -> Floats:
        rates = Rates(at, points_of(at.robot, points))
        J, _, J_dot, _ = rates.jacobians()
        response = np.linalg.solve(rates.H, J.T)
        half = J_dot @ response
        derivative = half + half.T - response.T @ rates.H_dot @ response
        all_finite((derivative,), "the derivative of Γ_e⁻¹")
        return np.asarray(derivative)

    return _by_coordinates(state, direction, along)


def _by_coordinates(state: State, direction: npt.ArrayLike | None, along: Callable[[State], Floats]) -> Floats:
    check_kind(state, State, "make it with robot.state(q, v)")
    robot = state.robot
    if direction is not None:
        way = checked_vector(direction, robot.nv, "direction", robot.name)
        return along(State(robot, state.q, way))
    each = [along(State(robot, state.q, way)) for way in np.eye(robot.nv)]
    return np.stack(each, axis=-1)

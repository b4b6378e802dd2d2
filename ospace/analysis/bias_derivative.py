"""Derivatives of the biases μ and μ_e by configuration and velocity: the tangent of the recursions of motion and force.

Along a displacement with twists Δ_i of the links, and a change δφ̇, δω_b of the velocity, all seen from the base and
carried to its origin, with C the link in whose axes a column stands still (`rates`),

    δS_i = Δ_C × S_i,   δI_i = Δ_i ×* I_i − I_i Δ_i ×
    V_i = V_p + S_i φ̇_i,   Ṡ_i = V_C × S_i,   a_i = a_p + Ṡ_i φ̇_i                        (16), (17)
    δV_i = δV_p + δS_i φ̇_i + S_i δφ̇_i,   δṠ_i = δV_C × S_i + V_C × δS_i
    δa_i = δa_p + δṠ_i φ̇_i + Ṡ_i δφ̇_i
    f_i = I_i a_i + V_i ×* I_i V_i                                                       (19)
    δf_i = δI_i a_i + I_i δa_i + δV_i ×* I_i V_i + V_i ×* (δI_i V_i + I_i δV_i)
    F_h ← F_h + F_i,   c = [F_b; S_iᵀ F_i],   δc = [δF_b; δS_iᵀ F_i + S_iᵀ δF_i]             (17–19)

and with x = H⁻¹ c, Φ = H⁻¹ J_eᵀ (9), (10)

    δμ = δJ_e x + Φᵀ (δc − δH x) − δ(J̇_e ẋ),   δμ_e = Γ_e (δμ − δΓ_e⁻¹ μ_e)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from ospace.analysis.rates import Rates, carried, cross_motion
from ospace.checks import all_finite, check_kind, checked_vector
from ospace.dynamics.operational_space import operational_space
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, points_of, rows_of
from ospace.model.state import State


def bias_acceleration_derivative(
    state: State, points: OperationalPoint | Sequence[OperationalPoint], direction: npt.ArrayLike | None = None
) -> Floats:
    """Compute ∂μ/∂(q, v) along a direction, or along each coordinate.

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        r rows in the order given.
    direction : (2 nv,), optional
        Change of the configuration, then of the velocity, both in the coordinates of v: base twist in base axes, then
        joint rates.

    Returns
    -------
    (r,) or (r, 2 nv) array
        Inertial axes, at the points. m/s² or rad/s² per unit of the coordinate.

    Raises
    ------
    OspaceError
        No point, or another robot's; a direction of another length; or a result that is not finite.
    """
    check_kind(state, State, "make it with robot.state(q, v)")
    taken = points_of(state.robot, points)
    return _by_coordinates(state, direction, lambda way: _changes(state, taken, way)[0], "the derivative of μ")


def bias_force_derivative(
    state: State, points: OperationalPoint | Sequence[OperationalPoint], direction: npt.ArrayLike | None = None
) -> Floats:
    """Compute ∂μ_e/∂(q, v) along a direction, or along each coordinate.

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        r rows in the order given.
    direction : (2 nv,), optional
        As of `bias_acceleration_derivative`.

    Returns
    -------
    (r,) or (r, 2 nv) array
        Inertial axes, at the points. N or N m per unit of the coordinate.

    Raises
    ------
    OspaceError
        No point, or another robot's; a direction of another length; rows that depend on each other in this state, where
        Γ_e is a pseudo-inverse; or a result that is not finite.
    """
    check_kind(state, State, "make it with robot.state(q, v)")
    taken = points_of(state.robot, points)
    space = operational_space(state, taken)
    if space.rank < len(space.bias_force):
        raise OspaceError(
            f"the {len(space.bias_force)} rows have rank {space.rank} in this state: Γ_e is a pseudo-inverse there, "
            "and μ_e has no derivative; take fewer rows with robot.point(…, axes=…)"
        )

    def along(way: Floats) -> Floats:
        mu_change, Gamma_inv_change = _changes(state, taken, way)
        return np.asarray(space.inertia @ (mu_change - Gamma_inv_change @ space.bias_force))

    return _by_coordinates(state, direction, along, "the derivative of μ_e")


def _by_coordinates(
    state: State, direction: npt.ArrayLike | None, along: Callable[[Floats], Floats], what: str
) -> Floats:
    size = 2 * state.robot.nv
    if direction is not None:
        derivative = along(checked_vector(direction, size, "direction", state.robot.name))
    else:
        derivative = np.stack([along(way) for way in np.eye(size)], axis=-1)
    all_finite((derivative,), what)
    return derivative


def _changes(state: State, points: Sequence[OperationalPoint], way: Floats) -> tuple[Floats, Floats]:
    """Return the changes of μ and of Γ_e⁻¹ along a direction (2 nv,)."""
    nv = state.robot.nv
    rates = Rates(State(state.robot, state.q, way[:nv]), points)
    c, c_change, drift_change = _velocity_products(rates, state.v, way[nv:])
    J, _, J_change, _ = rates.jacobians()
    solved = np.linalg.solve(rates.H, np.column_stack([c, J.T]))
    x, response = solved[:, 0], solved[:, 1:]
    mu_change = J_change @ x + response.T @ (c_change - rates.H_dot @ x) - drift_change
    half = J_change @ response
    return np.asarray(mu_change), np.asarray(half + half.T - response.T @ rates.H_dot @ response)


def _velocity_products(rates: Rates, v: Floats, v_change: Floats) -> tuple[Floats, Floats, Floats]:
    """Return c, its change and that of J̇_e ẋ along the motion of `rates` and a change of the velocity `v`."""
    S, S_change, I, I_change = rates.S, rates.S_dot, rates.I, rates.I_dot
    R, below, columns = rates.state.T_WB.rotation, rates.below, rates.columns
    V_b, V_b_change = np.r_[np.zeros(3), R @ v[3:6]], np.r_[np.zeros(3), R @ v_change[3:6]]
    rate, rate_change = columns @ v[6:, None], columns @ v_change[6:, None]
    V = V_b + below @ (S * rate)
    V_change = V_b_change + cross_motion(rates.V[:1])[0] @ V_b + below @ (S_change * rate + S * rate_change)
    cross, cross_change = cross_motion(V), cross_motion(V_change)
    at, at_change = cross[rates.carriers], cross_change[rates.carriers]
    S_dot, S_dot_change = _times(at, S), _times(at_change, S) + _times(at, S_change)
    a, a_change = below @ (S_dot * rate), below @ (S_dot_change * rate + S_dot * rate_change)
    h, h_change = _times(I, V), _times(I_change, V) + _times(I, V_change)
    f = _times(I, a) - _times(cross.transpose(0, 2, 1), h)
    f_change = _times(I_change, a) + _times(I, a_change)
    f_change -= _times(cross_change.transpose(0, 2, 1), h) + _times(cross.transpose(0, 2, 1), h_change)
    F, F_change = below.T @ f, below.T @ f_change
    c = np.r_[F[0], columns.T @ (S * F).sum(axis=1)]
    c_change = np.r_[F_change[0], columns.T @ (S_change * F + S * F_change).sum(axis=1)]
    drift_change = []
    for point in rates.points:
        link = int(rates.robot.link_of_joint[point.joint])
        p = rates.state.placement_about_base(point).translation
        p_change, p_dot = _moved(rates.V[link], p), _moved(V[link], p)
        p_dot_change = _moved(V_change[link], p) + np.cross(V[link, 3:], p_change)
        p_dot_dot_change = _moved(a_change[link], p) + np.cross(a[link, 3:], p_change)
        p_dot_dot_change += np.cross(V_change[link, 3:], p_dot) + np.cross(V[link, 3:], p_dot_change)
        drift_change.append(np.r_[p_dot_dot_change, a_change[link, 3:]])
    return c, c_change, np.concatenate(drift_change)[rows_of(rates.points)]


def _times(A: Floats, x: Floats) -> Floats:
    """Return A_i x_i (N, 6)."""
    return np.asarray(np.einsum("nij,nj->ni", A, x))


def _moved(V: Floats, p: Floats) -> Floats:
    """Return the linear part of a motion at `p`."""
    return carried(V[None], p[None])[0, :3]

"""Motion of the base while the joints follow a path and nothing else acts.

With P the linear momentum and L the angular one about the mass centre, both kept,

    ẋ_b = J_b* φ̇ + H_b⁻¹ M_0,   M_0 = [P; L + c × P]           (2), (26), c the mass centre about the base
    R' = R [ω_B]_×,   ω_B the angular part in base axes
    p = c_0 + P t/m − c                                          the mass centre goes on evenly

The attitude is integrated on the rotation group, R = R_k exp(u), u' = dexp⁻¹(ω_B), by a Runge–Kutta–Munthe-Kaas method
of fourth order, and the position by its integral. Steps are halved until the attitude changes by less than 1e-10.

Between rows the path is straight where it turns sharply, and a cubic spline elsewhere: a path of few corners is that
polygon, and one that is sampled finely is the curve that it samples.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from scipy.interpolate import CubicSpline

from ospace.checks import check_kind, checked_numbers, checked_vector
from ospace.dynamics.generalized_jacobian import base_generalized_jacobian
from ospace.dynamics.joint_space import joint_space_dynamics
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.base_displacement import base_displacement
from ospace.model.robot import SpaceRobot
from ospace.model.state import State

_CLOSE = 1e-10
_MOST_HALVINGS = 12
_CORNER = math.cos(0.35)
"""Cosine of the angle between ways from row to row from which a path turns sharply."""


def base_motion(
    robot: SpaceRobot,
    path: npt.ArrayLike,
    momentum: npt.ArrayLike | None = None,
    *,
    time: npt.ArrayLike | None = None,
    T_WB: pin.SE3 | None = None,
) -> Floats:
    """Compute the poses of a floating base while the joints follow a path.

    Parameters
    ----------
    robot : SpaceRobot
    path : (N, nq − 7)
        Joint part of q, row by row; continuous joints as cosine and sine. rad, m.
    momentum : (6,), optional
        Linear (kg m/s) and angular momentum about the mass centre (kg m²/s), inertial axes; zero without it.
    time : (N,), optional
        Of each row, s, rising; one second from row to row without it. It counts only where there is momentum.
    T_WB : pin.SE3, optional
        Pose of the base at the first row; identity without it.

    Returns
    -------
    (N, 7) array
        Position (m) and quaternion x, y, z, w of the base-link frame in the inertial frame.

    Raises
    ------
    OspaceError
        The path is no array of such rows, times do not rise, or the integration did not converge.
    """
    check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
    rows = checked_numbers(path, "path")
    if rows.ndim != 2 or rows.shape[1] != robot.nq - 7 or len(rows) == 0:
        raise OspaceError(f"path has shape {rows.shape}; robot '{robot.name}' needs (N, {robot.nq - 7})")
    kept = np.zeros(6) if momentum is None else checked_vector(momentum, 6, "momentum")
    times = np.arange(len(rows), dtype=float) if time is None else checked_vector(time, len(rows), "time")
    if not (np.diff(times) > 0.0).all():
        raise OspaceError("times of the path do not rise from row to row")
    start = robot.configuration(T_WB=T_WB)
    way = _Way(robot, rows, times, kept)
    R_0 = pin.XYZQUATToSE3(start[:7]).rotation
    attitudes = _attitudes(way, R_0)
    centre_0 = start[:3] + R_0 @ way.centre(way.q[0])
    poses = np.empty((len(rows), 7))
    for k, R in enumerate(attitudes):
        centre = centre_0 + kept[:3] * (times[k] - times[0]) / robot.total_mass
        poses[k] = pin.SE3ToXYZQUAT(pin.SE3(R, centre - R @ way.centre(way.q[k])))
    return poses


def base_turn(poses: Floats) -> float:
    """Return the angle between the first and the last attitude of a base.

    Parameters
    ----------
    poses : (N, 7)
        As `base_motion` returns them.

    Returns
    -------
    float
        In [0, π]; rad.
    """
    return float(base_displacement(poses[[0, -1]])[-1, 1])


def _attitudes(way: _Way, R_0: Floats) -> list[Floats]:
    """Integrate the attitude over all rows, with steps halved until it changes no more."""
    before = _integrate(way, R_0, 1)
    for halving in range(1, _MOST_HALVINGS + 1):
        after = _integrate(way, R_0, 2**halving)
        change = max((float(np.abs(a - b).max()) for a, b in zip(before, after, strict=True)), default=0.0)
        if change < _CLOSE:
            return after
        before = after
    raise OspaceError("the attitude of the base did not converge along the path: give it with more rows")


def _integrate(way: _Way, R: Floats, steps: int) -> list[Floats]:
    attitudes = [R]
    for k in range(len(way.times) - 1):
        h = (way.times[k + 1] - way.times[k]) / steps
        for s in range(steps):
            R = _step(way, k, s / steps, 1.0 / steps, h, R)
        attitudes.append(R)
    return attitudes


def _step(way: _Way, k: int, begin: float, share: float, h: float, R: Floats) -> Floats:
    """Take one step of the interval behind row `k`, of `share` from `begin` on; both as shares of the interval."""

    def rate(part: float, u: Floats) -> Floats:
        omega = way.angular_velocity(k, begin + part * share, R @ pin.exp3(u))
        across = np.cross(u, omega)
        return np.asarray(h * (omega + 0.5 * across + np.cross(u, across) / 12.0))

    k_1 = rate(0.0, np.zeros(3))
    k_2 = rate(0.5, 0.5 * k_1)
    k_3 = rate(0.5, 0.5 * k_2)
    k_4 = rate(1.0, k_3)
    return np.asarray(R @ pin.exp3((k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4) / 6.0))


class _Way:
    """Joints along the path, and what they and the momentum do to the base there, in base axes."""

    def __init__(self, robot: SpaceRobot, rows: Floats, times: Floats, momentum: Floats) -> None:
        self.robot, self.times, self.momentum = robot, times, momentum
        base = np.r_[np.zeros(6), 1.0]
        self.q = np.array([robot.state(np.r_[base, row]).q for row in rows])
        self._data = robot.model.createData()
        ways = [pin.difference(robot.model, a, b)[6:] for a, b in zip(self.q[:-1], self.q[1:], strict=True)]
        self._ways = np.array(ways).reshape(len(rows) - 1, robot.n_joints)
        self._slopes = _slopes(self._ways)
        self._known: dict[tuple[int, float], tuple[Floats, Floats, Floats]] = {}

    def centre(self, q: Floats) -> Floats:
        """Return the mass centre about the base, base axes."""
        return np.array(pin.centerOfMass(self.robot.model, self._data, np.r_[np.zeros(6), 1.0, q[7:]]))

    def angular_velocity(self, k: int, part: float, R: Floats) -> Floats:
        """Return ω_B where the base has the attitude R, at a part of the interval behind row `k`; rad/s."""
        by_joints, H_b, centre = self._at(k, part)
        omega = by_joints / (self.times[k + 1] - self.times[k])
        if self.momentum.any():
            P, L = R.T @ self.momentum[:3], R.T @ self.momentum[3:]
            omega = omega + np.linalg.solve(H_b, np.r_[P, L + np.cross(centre, P)])[3:]
        return np.asarray(omega)

    def _at(self, k: int, part: float) -> tuple[Floats, Floats, Floats]:
        """Return what joints do to ω_B over the whole interval at their rate here, H_b, and the mass centre."""
        key = (k, part)
        if key not in self._known:
            moved, rate = _hermite(self._ways[k], self._slopes[k], part)
            q = np.asarray(pin.integrate(self.robot.model, self.q[k], np.r_[np.zeros(6), moved]))
            state = State(self.robot, q)
            J_b_star = base_generalized_jacobian(state)
            H_b = joint_space_dynamics(state).base_inertia if self.momentum.any() else np.eye(6)
            self._known[key] = (J_b_star @ rate)[3:], H_b, self.centre(q)
        return self._known[key]


def _hermite(way: Floats, slopes: Floats, s: float) -> tuple[Floats, Floats]:
    """Return how far a cubic has gone at the part `s` of a way with slopes (2, n) at its ends, and its slope there."""
    first, last = slopes
    bend, twist = 3.0 * way - 2.0 * first - last, first + last - 2.0 * way
    return s * (first + s * (bend + s * twist)), first + s * (2.0 * bend + s * 3.0 * twist)


def _slopes(ways: Floats) -> Floats:
    """Return slopes (N − 1, 2, n) at the ends of each way: of splines between corners, and of straight ways."""
    slopes = np.stack([ways, ways], axis=1)
    lengths = np.linalg.norm(ways, axis=1)
    along = np.einsum("ij,ij->i", ways[:-1], ways[1:])
    corners = [k + 1 for k in range(len(along)) if not along[k] > _CORNER * lengths[k] * lengths[k + 1]]
    for first, last in zip([0, *corners], [*corners, len(ways)], strict=True):
        if last - first >= 3:
            rows = np.arange(last - first + 1)
            at_rows = CubicSpline(rows, np.vstack([0.0 * ways[:1], ways[first:last].cumsum(axis=0)]))(rows, 1)
            slopes[first:last, 0], slopes[first:last, 1] = at_rows[:-1], at_rows[1:]
    return slopes

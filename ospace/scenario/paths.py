"""Motions along paths: a circle, and poses on the way.

A path is place p(u) and rotation R_p(u) for u from 0 to 1, which starts at the point. It is gone along by minimum jerk,
u = s(t), from rest to rest; the velocity v_0, ω_0 that the point has at the start runs out meanwhile. With the quintic
r(t) that starts with rate 1 and ends at rest, both zero,

    x = p + r v_0,        ẋ = p' ṡ + ṙ v_0,        ẍ = p'' ṡ² + p' s̈ + r̈ v_0
    R = E R_p,            E = exp(r ω_0),          R_p' = ω_p × R_p
    ω = ṙ ω_0 + E ω_p ṡ,  α = r̈ ω_0 + ṙ ω_0 × E ω_p ṡ + E (ω_p' ṡ² + ω_p s̈)

A circle turns by u φ about the axis through c along φ. Between poses the place is a cubic spline over u, and the
rotation that of `scipy.spatial.transform.RotationSpline`: velocity and acceleration are continuous, and nothing stops
on the way.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.minimum_jerk import rest_to_rest
from ospace.kernels.tree import Floats
from ospace.scenario.motion import Motion, Tabulated, exponentials, run_out, turned

_SAME = 1e-9
"""m, rad: poses nearer than this count as the same."""


class Course(NamedTuple):
    """A path at N places: place (N, 3), rotation (N, 3, 3), and derivatives of it by u (N, 6), inertial axes."""

    place: Floats
    rotation: Floats
    slope: Floats
    curve: Floats


Path = Callable[[Floats], Course]
"""Returns the course at u (N,), from 0 to 1."""


def circle(pose: pin.SE3, centre: Floats, turn: Floats, shift: Floats, turns_along: bool) -> Path:
    """Return the path that turns by the rotation vector `turn` about an axis through `centre`, and goes by `shift`."""
    arm = pose.translation - centre

    def course(u: Floats) -> Course:
        E = exponentials(u[:, None] * turn)
        at = E @ arm
        n, none = len(u), np.zeros((len(u), 3))
        around = np.cross(turn, at)
        spin = np.tile(turn, (n, 1)) if turns_along else none
        return Course(
            centre + at + u[:, None] * shift,
            E @ pose.rotation if turns_along else np.tile(pose.rotation, (n, 1, 1)),
            np.hstack([around + shift, spin]),
            np.hstack([np.cross(turn, around), none]),
        )

    return course


def through(poses: Sequence[pin.SE3]) -> Path:
    """Return the path through poses, the first of which is where the point is.

    Raises
    ------
    OspaceError
        Two poses in a row are the same.
    """
    from scipy.interpolate import CubicSpline  # as long to load as all the rest, and for such paths alone
    from scipy.spatial.transform import Rotation, RotationSpline

    places = np.array([one.translation for one in poses])
    rotations = np.array([one.rotation for one in poses])
    way = np.linalg.norm(np.diff(places, axis=0), axis=1)
    angle = np.array([np.linalg.norm(pin.log3(a.T @ b)) for a, b in pairwise(rotations)])
    if (still := np.flatnonzero((way < _SAME) & (angle < _SAME))).size:
        raise OspaceError(f"pose {still[0] + 1} on the way is where the one before it is: leave it out")
    length = sum(part / part.sum() for part in (way, angle) if part.sum() > _SAME)
    knots = np.concatenate([[0.0], np.cumsum(length)])
    knots /= knots[-1]
    place, rotation = CubicSpline(knots, places), RotationSpline(knots, Rotation.from_matrix(rotations))

    def course(u: Floats) -> Course:
        R = rotation(u).as_matrix()
        return Course(
            place(u),
            R,
            np.hstack([place(u, 1), turned(R, rotation(u, 1))]),
            np.hstack([place(u, 2), turned(R, rotation(u, 2))]),
        )

    return course


class AlongPath(Tabulated):
    """Reference along a path, from the point's own motion to rest.

    Parameters
    ----------
    path : Path
        Starts where the point is.
    velocity : (6,)
        Of the point at the start, inertial axes.
    duration : float
        s; above 0.
    first : int
        Control cycle at the start.
    period : float
        Of a control cycle, s.
    name : str
        Of the task, for errors.
    """

    def __init__(
        self, path: Path, velocity: Floats, *, duration: float, first: int = 0, period: float = 1e-3, name: str = "path"
    ) -> None:
        super().__init__(first, period, name)
        self._path, self._velocity, self._duration = path, velocity, duration

    def _motion(self, begun: int, ended: int) -> Motion:
        t = np.minimum(np.arange(begun, ended, dtype=np.float64) * self._period / self._duration, 1.0)[:, None]
        T, v_0, omega_0 = self._duration, self._velocity[:3], self._velocity[3:]
        s, rate, curve = rest_to_rest(t)
        rate, curve = rate / T, curve / T**2
        r, r_1, r_2 = run_out(t)
        r, r_2 = r * T, r_2 / T
        p = self._path(s[:, 0])
        E = exponentials(r * omega_0)
        spin, spin_1 = turned(E, p.slope[:, 3:]), turned(E, p.curve[:, 3:])
        v = p.slope[:, :3] * rate + r_1 * v_0
        a = p.curve[:, :3] * rate**2 + p.slope[:, :3] * curve + r_2 * v_0
        omega = r_1 * omega_0 + spin * rate
        alpha = r_2 * omega_0 + np.cross(r_1 * omega_0, spin * rate) + spin_1 * rate**2 + spin * curve
        return Motion(p.place + r * v_0, E @ p.rotation, np.hstack([v, omega]), np.hstack([a, alpha]))

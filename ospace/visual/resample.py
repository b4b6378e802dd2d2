"""States between the records of a motion, where the records are too far apart for a straight line between them.

From q_0 to q_1, a time h later, configurations go along the cubic in the tangent space of q_0 that has the records'
velocities at both ends:

    q(s) = q_0 ⊕ u(s),   u(0) = 0,  u(1) = q_1 ⊖ q_0,   u'(0) = h v_0,  u'(1) = h D(q_1 ⊖ q_0) v_1

so that what a motion conserves is kept between its records too, to h⁴; and joints hold their links together. Records
as close as those of a simulation are joined by the geodesic, as `Trajectory.at` has it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats, Ints

_MOST = 60_000  # states; placing them takes seconds
_CLOSE = 5e-3  # s
_UNKNOWN = 256  # pieces between two records that are all that is known


def resample_poses(
    model: pin.Model, time: Floats, Q: Floats, V: Floats, poses: Callable[[Floats], Floats], error: float
) -> tuple[Floats, Floats, float]:
    """Place bodies at the records of a motion, and so often between them that straight lines are off by `error`.

    Parameters
    ----------
    model : pin.Model
    time : (N,)
        s, increasing.
    Q, V : (N, nq), (N, nv)
    poses : function
        From configuration to positions and quaternions of bodies (J, 7).
    error : float
        m, and half angles in rad.

    Returns
    -------
    time, poses, error : (M,), (M, J, 7), float
        The error kept to: more than given where that would take too many states.
    """
    at_records = np.array([poses(q) for q in Q])
    bends = _bends(time, at_records)
    while True:
        pieces = _pieces(bends, error, len(time) == 2)
        if pieces.sum() <= max(_MOST, len(time)):
            break
        error *= 2.0
    times, places = [time[:1]], [at_records[:1]]
    for k, count in enumerate(pieces):
        if count > 1:
            shares = np.arange(1, count) / count
            times.append(time[k] + shares * (time[k + 1] - time[k]))
            places.append(np.array([poses(q) for q in _along(model, time[k + 1] - time[k], Q, V, k, shares)]))
        times.append(time[k + 1 : k + 2])
        places.append(at_records[k + 1 : k + 2])
    return np.concatenate(times), np.concatenate(places), error


def _along(model: pin.Model, h: float, Q: Floats, V: Floats, k: int, shares: Floats) -> list[Floats]:
    """Return configurations between record `k` and the next; without velocities, those of the geodesic too."""
    whole = pin.difference(model, Q[k], Q[k + 1])
    begin, end = h * V[k], h * pin.dDifference(model, Q[k], Q[k + 1], pin.ARG1) @ V[k + 1]
    if h <= _CLOSE or not (begin.any() or end.any()):
        begin = end = whole
    s = shares[:, None]
    steps = s * begin + s**2 * (3.0 * whole - 2.0 * begin - end) + s**3 * (begin + end - 2.0 * whole)
    return [np.asarray(pin.integrate(model, Q[k], step)) for step in steps]


def _bends(time: Floats, poses: Floats) -> Floats:
    """Return how far a straight line between records is off about the middle, the worst of all bodies (N - 1,)."""
    if len(time) < 3:
        return np.zeros(len(time) - 1)
    h = np.diff(time)[:, None, None]
    steps = np.diff(poses, axis=0)
    flipped = np.sum(poses[1:, :, 3:] * poses[:-1, :, 3:], axis=2) < 0.0
    steps[:, :, 3:] -= np.where(flipped[..., None], 2.0 * poses[1:, :, 3:], 0.0)
    signs = np.where(flipped, -1.0, 1.0)
    slopes = steps / h
    after = slopes[1:].copy()
    after[:, :, 3:] *= signs[:-1, :, None]  # both as seen from the record before
    bend = 2.0 * (after - slopes[:-1]) / (h[1:] + h[:-1])
    sizes = np.maximum(np.linalg.norm(bend[:, :, :3], axis=2), np.linalg.norm(bend[:, :, 3:], axis=2)).max(axis=1)
    sizes = np.maximum(np.r_[sizes[:1], sizes], np.r_[sizes, sizes[-1:]])
    return np.asarray(sizes * np.diff(time) ** 2 / 8.0)


def _pieces(bends: Floats, error: float, unknown: bool) -> Ints:
    """Return into how many pieces each way between two records is cut."""
    if unknown:
        return np.array([_UNKNOWN])
    return np.maximum(1, np.ceil(np.sqrt(bends / error))).astype(np.int64)

"""Motion as meshcat's animation tracks: as few keys as keep the straight line between them close to the motion.

Between two keys a time h apart, the line is off by h² |x''| / 8 at most. Keys that are spread with the density
√(|x''| / 8ε) keep this below ε everywhere; what rests costs two keys. Rotations are lines on the sphere of unit
quaternions, whose x'' is that across the sphere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from meshcat.animation import Animation, AnimationClip, AnimationTrack
from meshcat.path import Path

from ospace.kernels.tree import Floats, Ints

ERROR = 4e-7
"""Largest deviation of a body from its motion between two keys: m, and half angles in rad."""
_ANGLE_SHARE = 0.4
"""Share of it for half angles: a point one metre away from a body's origin moves by twice that."""
_SCALED_FACTOR = 1e3
"""Factor of the deviation for quantities drawn to scale, which are for the eye alone."""
_MOST_KEYS = 400_000  # some 15 MB


def animation(motions: Mapping[str, tuple[Floats, Floats]]) -> tuple[Animation, float]:
    """Animate nodes by their poses.

    Parameters
    ----------
    motions : mapping of path to (N,) and (N, 7) or (N, 10)
        Times, s, increasing from 0 to the same end for all nodes; and position, unit quaternion (x, y, z, w) and, in
        ten columns, the scale of the node in what is above it.

    Returns
    -------
    animation, error : Animation, float
        Largest deviation of the page at the given times, scaled nodes apart: `ERROR` and the rounding of its numbers,
        or more where that many keys would be too many.
    """
    tracks = []
    for path, (time, pose) in motions.items():
        rough = _SCALED_FACTOR if pose.shape[1] > 7 else 1.0
        tracks.append((path, "position", "vector3", time, pose[:, :3], _line, rough))
        tracks.append((path, "quaternion", "quaternion", time, _continuous(pose[:, 3:7]), _arc, _ANGLE_SHARE * rough))
        if pose.shape[1] > 7:
            tracks.append((path, "scale", "vector3", time, pose[:, 7:], _line, rough))
    error = ERROR
    while True:
        keys = [keys_of(time, X, way, error * rough) for *_, time, X, way, rough in tracks]
        if sum(map(len, keys)) <= _MOST_KEYS:
            break
        error *= 4.0
    clips: dict[str, AnimationClip] = {path: AnimationClip(fps=1) for path in motions}
    off = 0.0
    for (path, name, kind, time, X, way, rough), k in zip(tracks, keys, strict=True):
        at = np.unique(time[k].astype(np.float32))  # as pages keep them: a key stands at a time that there is
        values = _interpolate(at.astype(np.float64), time, X, way).astype(np.float32)
        clips[path].tracks[name] = AnimationTrack(name, kind, at.tolist(), values.tolist())
        if rough <= 1.0:
            shown = _interpolate(time, at.astype(np.float64), values.astype(np.float64), way)
            off = max(off, float(np.linalg.norm(shown - X, axis=1).max()))
    paths = {Path(tuple(path.strip("/").split("/"))): clip for path, clip in clips.items()}
    return Animation(paths, default_framerate=1), off


Way = Callable[[Floats, Floats, Floats], Floats]


def keys_of(time: Floats, X: Floats, way: Way, error: float) -> Ints:
    """Return the records of `X` (N, k) to keep, so that `way` between them is off by no more than `error` in any other.

    Where every record is kept, the error is what it is. Records that no time of a page lies between are a jump: both
    are kept, and what lies before and after is a motion each.
    """
    jumps = np.flatnonzero(np.diff(time) <= np.spacing(time[1:].astype(np.float32))) + 1
    if jumps.size:
        parts = np.split(np.arange(len(time)), jumps)
        return np.concatenate([part[keys_of(time[part], X[part], way, error)] for part in parts])
    last = len(time) - 1
    if last < 2:
        return np.arange(last + 1)
    before, after = np.diff(time)[:-1, None], np.diff(time)[1:, None]
    slopes = np.diff(X, axis=0) / np.diff(time)[:, None]
    bend = 2.0 * np.diff(slopes, axis=0) / (before + after)
    if way is _arc:
        bend -= np.sum(bend * X[1:-1], axis=1, keepdims=True) * X[1:-1]
    density = np.sqrt(np.linalg.norm(bend, axis=1) / (8.0 * error))
    density = np.r_[density[0], density, density[-1]] + 0.5 / (time[-1] - time[0])
    share = np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(time))]
    count = 1.2
    while True:
        pieces = max(1, int(np.ceil(share[-1] * count)))
        keys = np.unique(np.r_[0, np.searchsorted(share, np.linspace(0.0, share[-1], pieces + 1)).clip(0, last), last])
        off = np.linalg.norm(_interpolate(time, time[keys], X[keys], way) - X, axis=1).max()
        if len(keys) > last or off <= error:
            return keys
        count *= 1.5
        if pieces > 2 * last:
            return np.arange(last + 1)


def _interpolate(wanted: Floats, time: Floats, X: Floats, way: Way) -> Floats:
    """Return what stands at the times wanted, between neighbours of `X` at `time`."""
    if len(time) == 1:
        return np.repeat(X, len(wanted), axis=0)
    after = np.clip(np.searchsorted(time, wanted, side="right"), 1, len(time) - 1)
    share = ((wanted - time[after - 1]) / (time[after] - time[after - 1])).clip(0.0, 1.0)[:, None]
    return way(X[after - 1], X[after], share)


def _line(a: Floats, b: Floats, share: Floats) -> Floats:
    return a + share * (b - a)


def _arc(a: Floats, b: Floats, share: Floats) -> Floats:
    """Interpolate unit quaternions on their sphere, the shorter way, as a page does."""
    b = np.where(np.sum(a * b, axis=1, keepdims=True) < 0.0, -b, b)
    half = np.arctan2(np.linalg.norm(b - a, axis=1), np.linalg.norm(b + a, axis=1))[:, None]
    angle = 2.0 * half
    small = angle < 1e-9
    safe = np.where(small, 1.0, np.sin(angle))
    left = np.where(small, 1.0 - share, np.sin((1.0 - share) * angle) / safe)
    right = np.where(small, share, np.sin(share * angle) / safe)
    return left * a + right * b


def _continuous(quaternions: Floats) -> Floats:
    """Turn signs so that neighbours are near each other."""
    flips = np.r_[1.0, np.where(np.sum(quaternions[1:] * quaternions[:-1], axis=1) < 0.0, -1.0, 1.0)]
    return np.asarray(quaternions * np.cumprod(flips)[:, None])

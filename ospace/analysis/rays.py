"""Reach of an arm along rays: how far the hand goes from the mass centre in given directions, the base level.

With ρ the hand from the mass centre and P ⟂ d two directions across a ray d: ascents of d·ρ on P ρ = 0, from the
postures of a sample that are best to begin with.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from ospace.analysis.arm import Arm, Posture
from ospace.analysis.constrained_ascent import Linear, ascend, restore
from ospace.checks import check_kind, check_whole, checked_numbers
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats, Ints

_SAMPLES, _STARTS, _NEIGHBOURS, _PASSES = 16384, 10, 8, 3
_STEPS, _POLISH = 25, 120
_ON_RAY = 1e-9
"""Across a ray, L."""
_NOWHERE = 1e-6
"""L: nearer to the mass centre is no direction."""
_ACROSS = 3.0
"""How much more a posture to begin with loses by what it is off a ray than by what it is short of its end."""


@dataclass(frozen=True)
class Rays:
    """Reach along R rays from the mass centre, the base level.

    Attributes
    ----------
    directions : (R, 3)
        Unit vectors, base axes.
    reached : (R,) bool
        Whether the hand comes onto the ray at all.
    distance : (R,)
        How far; 0 where it is not reached. m.
    postures : (R, n)
        Of the joints there; `arm.home` where it is not reached.
    """

    directions: Floats
    reached: npt.NDArray[np.bool_]
    distance: Floats
    postures: Floats


def lattice_directions() -> Floats:
    """Return 98 directions, even over the sphere: from its middle to the lattice points of a cube of 5 on each edge.

    Returns
    -------
    (98, 3) array
        Unit vectors.
    """
    corners = np.array([one for one in product(range(-2, 3), repeat=3) if max(map(abs, one)) == 2], dtype=float)
    bent = np.tan(corners * (np.pi / 8.0))  # nearer to even on the sphere
    return np.asarray(bent / np.linalg.norm(bent, axis=1, keepdims=True))


def reach_along(arm: Arm, directions: npt.ArrayLike | None = None, *, seed: int = 0) -> Rays:
    """Compute how far a hand reaches along rays from the mass centre while the base is level.

    Parameters
    ----------
    arm : Arm
    directions : (R, 3), optional
        Of any length but zero, base axes; `lattice_directions` without it.
    seed : int
        Of the postures to begin with; the same seed gives the same result.

    Returns
    -------
    Rays

    Raises
    ------
    OspaceError
        A direction is zero, or `seed` no such number.
    """
    check_kind(arm, Arm, "make it with analysis.Arm(robot, point)")
    check_whole("seed", seed, 0)
    d = checked_numbers(lattice_directions() if directions is None else directions, "directions")
    if d.ndim != 2 or d.shape[1] != 3 or not np.linalg.norm(d, axis=1).all():
        raise OspaceError(f"directions have shape {d.shape}: give (R, 3) vectors, none of them zero")
    d = d / np.linalg.norm(d, axis=1, keepdims=True)
    rng = np.random.default_rng([seed, 2])
    x = np.vstack([arm.home[None].clip(arm.lower, arm.upper), arm.draw(rng, _SAMPLES)])
    rho = arm.posture(x).from_centre
    along = rho @ d.T
    score = along - _ACROSS * np.sqrt((np.einsum("ki,ki->k", rho, rho)[:, None] - along**2).clip(0.0))
    begun = np.argsort(-score, axis=0, kind="stable")[:_STARTS].T.ravel()
    which = np.repeat(np.arange(len(d)), _STARTS)
    best = _Best(arm, d)
    best.improve(which, x[begun], _STEPS)
    nearest = np.argsort(-(d @ d.T), axis=1, kind="stable")[:, : _NEIGHBOURS + 1]
    for _ in range(_PASSES):  # what one ray found, its neighbours may not have
        which, of = np.repeat(np.arange(len(d)), nearest.shape[1]), nearest.ravel()
        best.improve(which[best.reached[of]], best.postures[of[best.reached[of]]], _STEPS)
    on = np.flatnonzero(best.reached)
    best.improve(on, best.postures[on], _POLISH)
    return Rays(d, best.reached, best.distance, best.postures)


class _Best:
    """The farthest that was found along each ray."""

    def __init__(self, arm: Arm, directions: Floats) -> None:
        self.arm, self.directions = arm, directions
        self.reached = np.zeros(len(directions), dtype=bool)
        self.distance, self.postures = np.zeros(len(directions)), np.tile(arm.home, (len(directions), 1))

    def improve(self, which: Ints, x: Floats, steps: int) -> None:
        """Ascend from postures (K, n) along rays `which` (K,)."""
        arm = self.arm
        x, found = restore(_AlongRay(arm, self.directions[which]), x, arm.lower, arm.upper, _ON_RAY)
        which = which[found]
        x, f = ascend(
            _AlongRay(arm, self.directions[which]), x[found], arm.lower, arm.upper, iterations=steps, tolerance=_ON_RAY
        )
        for k in np.flatnonzero(f > 0.0):
            ray, distance = which[k], arm.length * float(f[k])
            if distance > max(self.distance[ray], _NOWHERE * arm.length):
                self.reached[ray], self.distance[ray], self.postures[ray] = True, distance, x[k]


class _AlongRay:
    """d·ρ, on P ρ = 0; lengths in L."""

    def __init__(self, arm: Arm, directions: Floats) -> None:
        self.arm, self.d = arm, directions
        other = np.eye(3)[np.abs(directions).argmin(axis=1)]
        first = np.cross(directions, other)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        self.P = np.stack([first, np.cross(directions, first)], axis=1)

    def linear(self, x: Floats, which: Ints) -> Linear:
        posture, d, P = self.arm.posture(x), self.d[which], self.P[which]
        J = posture.level_jacobian(self.arm.length) / self.arm.scale
        f, c = self._of(posture, d, P)
        return Linear(f, np.einsum("ki,kin->kn", d, J), c, P @ J, (d, P))

    def at(self, x: Floats, frame: Any) -> tuple[Floats, Floats]:
        return self._of(self.arm.posture(x), *frame)

    def _of(self, posture: Posture, d: Floats, P: Floats) -> tuple[Floats, Floats]:
        rho = posture.from_centre / self.arm.length
        return np.einsum("ki,ki->k", d, rho), np.einsum("kai,ki->ka", P, rho)

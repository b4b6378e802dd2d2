"""Table of allowed collisions: which pairs of links need no watch, and why.

Two links are not watched where one body carries both, where they are adjacent, where they overlap with all joints at
zero, and where, over random configurations, they are always too near or never near. Adjacent are a body and the next
one towards the base that has a shape.

A pair was never near if its smallest distance over N configurations is above the clearance by more than a share of the
range of its distances: the less its distance varies, the less can be between the configurations.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from ospace.collision.geometry import CollisionGeometry
from ospace.collision.solver import DistanceSolver
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot

Reason = Literal["watched", "one body", "adjacent", "overlap at zero", "always near", "never near"]
Pair = tuple[str, str]
_SEED, _MOST, _LEAST, _DISTANCES = 0, 500, 100, 200_000
"""Of the configurations; how many at most and at least, and distances at most that are computed of them."""
_VARIES = 0.2
"""Share of the range of its distances that the smallest one may miss."""
_TOUCHING = 1e-9
"""m."""
_WIDEST = np.pi
"""Positions that joints without limits are drawn from, to either side; rad, m."""


def pair_table(geometry: CollisionGeometry, clearance: float = 0.0, *, sampled: bool = True) -> dict[Pair, Reason]:
    """Return for each pair of links with shapes whether it needs a watch, or why not.

    Parameters
    ----------
    geometry : CollisionGeometry
    clearance : float
        Distance that is to be kept, m; nearer counts as near.
    sampled : bool
        Look at configurations as well, random ones inside the limits of the joints but the same each time; else all
        pairs that can move are watched.

    Returns
    -------
    dict of (str, str) to str
        "watched", "one body", "adjacent", "overlap at zero", "always near" or "never near".
    """
    table = _by_structure(geometry)
    open_ = [pair for pair, reason in table.items() if reason == "watched"]
    if not (open_ and sampled):
        return table
    known, pairs = _RANGES.setdefault(geometry.robot, {}), tuple(open_)
    if pairs not in known:
        known[pairs] = _ranges(geometry, pairs)
    for pair, at_zero, nearest, farthest in zip(pairs, *known[pairs], strict=True):
        if at_zero <= _TOUCHING:
            table[pair] = "overlap at zero"
        elif farthest < clearance:
            table[pair] = "always near"
        elif nearest - clearance > _VARIES * (farthest - nearest):
            table[pair] = "never near"
    return table


_RANGES: WeakKeyDictionary[SpaceRobot, dict[tuple[Pair, ...], tuple[Floats, Floats, Floats]]] = WeakKeyDictionary()
"""Of the pairs of a robot: its geometries have links of different names, its own or those of what it holds."""


def _ranges(geometry: CollisionGeometry, pairs: Sequence[Pair]) -> tuple[Floats, Floats, Floats]:
    """Return the distance of each pair with joints at zero, its smallest and its largest one; m."""
    solver, places = solver_of_links(geometry, pairs)
    starts = np.array([one.start for one in places])
    rng, robot = np.random.default_rng(_SEED), geometry.robot
    solver.configure(robot.neutral())
    at_zero: Floats = np.minimum.reduceat(solver.distances(), starts)
    nearest, farthest = at_zero.copy(), at_zero.copy()
    for _ in range(int(np.clip(_DISTANCES // places[-1].stop, _LEAST, _MOST))):
        solver.configure(_random(robot, rng))
        found = np.minimum.reduceat(solver.distances(), starts)
        np.minimum(nearest, found, out=nearest)
        np.maximum(farthest, found, out=farthest)
    return at_zero, nearest, farthest


def solver_of_links(geometry: CollisionGeometry, pairs: Iterable[Pair]) -> tuple[DistanceSolver, list[slice]]:
    """Return a solver of all pairs of solids of these pairs of links, and where those of each stand."""
    own: dict[str, list[int]] = {}
    for k, solid in enumerate(geometry.solids):
        own.setdefault(solid.link, []).append(k)
    numbers: list[tuple[int, int]] = []
    places = []
    for a, b in pairs:
        first = len(numbers)
        numbers += [(i, j) for i in own[a] for j in own[b]]
        places.append(slice(first, len(numbers)))
    return DistanceSolver(geometry.robot.model, geometry.solids, numbers), places


def overlaps(geometry: CollisionGeometry) -> dict[Pair, float]:
    """Return pairs of links that overlap with all joints at zero, one body's and adjacent ones left out.

    Parameters
    ----------
    geometry : CollisionGeometry

    Returns
    -------
    dict of (str, str) to float
        By how much, m.
    """
    open_ = [pair for pair, reason in _by_structure(geometry).items() if reason == "watched"]
    if not open_:
        return {}
    solver, places = solver_of_links(geometry, open_)
    solver.configure(geometry.robot.neutral())
    found = solver.distances()
    depths = {pair: -float(found[own].min()) for pair, own in zip(open_, places, strict=True)}
    return {pair: depth for pair, depth in depths.items() if depth > _TOUCHING}


def _by_structure(geometry: CollisionGeometry) -> dict[Pair, Reason]:
    joint_of, parents = geometry.joint_of, geometry.robot.model.parents
    carrying = set(joint_of.values())

    def before(joint: int) -> int:
        joint = parents[joint]
        while joint > 0 and joint not in carrying:
            joint = parents[joint]
        return int(joint)

    table: dict[Pair, Reason] = {}
    for a, b in combinations(geometry.links, 2):
        i, j = joint_of[a], joint_of[b]
        if i == j:
            table[a, b] = "one body"
        else:
            table[a, b] = "adjacent" if i == before(j) or j == before(i) else "watched"
    return table


def _random(robot: SpaceRobot, rng: np.random.Generator) -> Floats:
    """Draw joint positions inside their limits, the base at the origin."""
    model = robot.model
    step: Floats = rng.uniform(-_WIDEST, _WIDEST, model.nv)
    step[:6] = 0.0
    for j in range(2, model.njoints):
        if model.nqs[j] == model.nvs[j] == 1:
            low, high = (
                float(np.clip(limit[model.idx_qs[j]], -_WIDEST, _WIDEST))
                for limit in (model.lowerPositionLimit, model.upperPositionLimit)
            )
            if low <= high:
                step[model.idx_vs[j]] = rng.uniform(low, high)
    q: Floats = pin.integrate(model, pin.neutral(model), step)
    return q

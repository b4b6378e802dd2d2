"""Distances of pairs of solids, by Coal through Pinocchio's geometry."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from ospace.collision.geometry import Solid
from ospace.kernels.tree import Floats, Ints

_TOLERANCE = 1e-12
"""Of GJK, relative: at Coal's own 1e-6 the normals of round solids are off by some 1e-2 rad, and it takes as long. EPA,
for solids that overlap, keeps its own: with 1e-12 it fails for one pair in ten."""
NUMBERS = 10
"""Of a pair: distance, the normal from the first solid to the second, and both nearest points."""


class DistanceSolver:
    """Distances of pairs of solids, in configurations of the robot whose model carries them.

    Parameters
    ----------
    model : pin.Model
    solids : sequence of Solid
        Those of joint 0 stand still, unless `place` moves them.
    pairs : sequence of (int, int)
        Numbers of solids.

    Attributes
    ----------
    geometry : pin.GeometryModel
    """

    def __init__(self, model: pin.Model, solids: Sequence[Solid], pairs: Sequence[tuple[int, int]]) -> None:
        self._model, self._data = model, model.createData()
        self.geometry = pin.GeometryModel()
        for k, solid in enumerate(solids):
            one = pin.GeometryObject(f"{solid.link} {k}", solid.joint, solid.placement, solid.geometry)
            self.geometry.addGeometryObject(one)
        for a, b in pairs:
            self.geometry.addCollisionPair(pin.CollisionPair(a, b))
        self._solids = pin.GeometryData(self.geometry)
        for request in self._solids.distanceRequests:
            request.gjk_tolerance = _TOLERANCE
        self._active: set[int] = set(range(len(pairs)))
        self._seen = self._view(model) if pairs else None

    def configure(self, q: Floats) -> None:
        """Place all solids at the configuration `q` (nq,)."""
        pin.forwardKinematics(self._model, self._data, q)
        pin.updateGeometryPlacements(self._model, self._data, self.geometry, self._solids)

    def place(self, k: int, T: pin.SE3) -> None:
        """Place solid `k` at `T`, until the next `configure`."""
        self._solids.oMg[k] = T

    def distances(self) -> Floats:
        """Return the distances of all pairs, m; negative where solids overlap."""
        self._activate(set(range(len(self.geometry.collisionPairs))))
        pin.computeDistances(self.geometry, self._solids)
        return np.array([one.min_distance for one in self._solids.distanceResults])

    def nearest(self, pairs: Ints, numbers: Floats) -> None:
        """Compute distances, normals and nearest points of some pairs, and write them to their rows of `numbers`.

        Parameters
        ----------
        pairs : (c,)
            Their numbers.
        numbers : (p, 10)
            Of each pair: distance, unit vector from the first solid to the second, nearest point of the first, of the
            second; m, in the axes and about the origin of the configuration.
        """
        self._activate(set(pairs.tolist()))
        pin.computeDistances(self.geometry, self._solids)
        if self._seen is not None:
            numbers[pairs] = self._seen[pairs]
        else:
            for k in pairs.tolist():
                numbers[k] = _numbers(self._solids.distanceResults[k])

    def _activate(self, wanted: set[int]) -> None:
        """Let only the pairs `wanted` be computed."""
        if wanted != self._active:
            for k in self._active - wanted:
                self._solids.deactivateCollisionPair(k)
            for k in wanted - self._active:
                self._solids.activateCollisionPair(k)
            self._active = wanted

    def _view(self, model: pin.Model) -> Floats | None:
        """Return the results of Coal as they stand in memory (p, 10); None where they lie otherwise than is thought.

        Python access to a result takes 4 µs, Coal's work 1 µs. Where distance, normal and points stand belongs to the
        wheel, so what is seen is compared with what is returned.
        """
        self.configure(pin.neutral(model))
        self.distances()
        results = list(self._solids.distanceResults)
        try:
            at = [int(one.normal.__array_interface__["data"][0]) - 8 for one in results[:2]]
            stride = at[1] - at[0] if len(at) > 1 else 8 * NUMBERS
            seen: Floats = np.asarray(_Memory(self._solids, at[0], (len(results), NUMBERS), (stride, 8)))
        except (AttributeError, KeyError, TypeError, ValueError):
            return None
        return seen if np.array_equal(seen, [_numbers(one) for one in results], equal_nan=True) else None


class _Memory:
    """Memory that `owner` keeps alive, offered to NumPy."""

    def __init__(self, owner: Any, address: int, shape: tuple[int, int], strides: tuple[int, int]) -> None:
        self.owner = owner
        self.__array_interface__ = {
            "data": (address, True), "shape": shape, "strides": strides, "typestr": "<f8", "version": 3
        }  # fmt: skip


def _numbers(result: Any) -> Floats:
    points = result.getNearestPoint1(), result.getNearestPoint2()
    return np.concatenate([[result.min_distance], result.normal, *points])

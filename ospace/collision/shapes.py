"""Shapes of a URDF as convex solids of Coal: primitives as they are, meshes by the convex hull of each of their parts.

Distances of convex solids are found in a microsecond and come with the two points that are nearest; the hull of a mesh
holds all of it, so what keeps clear of the hull keeps clear of the mesh.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from pathlib import Path

import coal
import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.urdf import mesh_file
from ospace.urdf.bodies import placement
from ospace.urdf.description import Link, Shape
from ospace.urdf.lint.meshes import MOST, locate
from ospace.urdf.numbers import LARGEST

_MOST_PARTS = 16
"""Of a mesh with a hull each; one of more parts has a single hull around all."""
_FLAT = 1e-6
"""Of the largest side: a mesh that is thinner is taken as the box around it."""
_THIN = 1e-5
"""Least side of such a box, m."""


def shapes_that_count(link: Link) -> tuple[Shape, ...]:
    """Return the <collision> shapes of a link; its <visual> ones where it has none."""
    solid = tuple(shape for shape in link.shapes if shape.role == "collision")
    return solid or link.shapes


def solids_of(
    shape: Shape, urdf: Path, package_dirs: Sequence[Path]
) -> Iterator[tuple[coal.CollisionGeometry, pin.SE3]]:
    """Yield the convex solids of a shape, and their placement in the link's frame, m.

    Raises
    ------
    MeshError, ValueError
        The file of a mesh is not there, or cannot be read.
    """
    T = pin.SE3(*placement(shape.pose))
    if shape.kind == "mesh":
        path = locate(shape.filename, urdf, package_dirs)
        for points in _hulls(path, path.stat().st_mtime_ns):
            with np.errstate(over="ignore"):
                scaled = points * np.array(shape.size)
            if not np.abs(scaled).max() < LARGEST:
                raise ValueError(f"'{path.name}' reaches further than {LARGEST:g} m")
            try:
                solid = _convex(scaled, T)
            except RuntimeError:
                raise ValueError(f"'{path.name}' has a corner with more than 255 edges, too many for Coal") from None
            yield solid
    elif shape.kind == "box":
        yield coal.Box(*shape.size), T
    elif shape.kind == "sphere":
        yield coal.Sphere(shape.size[0]), T
    elif shape.kind == "capsule":
        yield coal.Capsule(*shape.size), T
    else:
        yield coal.Cylinder(*shape.size), T


@lru_cache(maxsize=MOST)
def _hulls(path: Path, changed: int) -> tuple[Floats, ...]:
    """Return the points (N, 3) that span each part of a mesh changed at that time; m, in the axes of the file."""
    parts = [np.asarray(part.vertices, dtype=np.float64) for part in mesh_file.read_parts(path, colours=False)]
    return tuple(parts) if len(parts) <= _MOST_PARTS else (np.concatenate(parts),)


def _convex(points: Floats, T: pin.SE3) -> tuple[coal.CollisionGeometry, pin.SE3]:
    """Return the convex hull of points (N, 3); the box around them where they lie in a plane or on a line."""
    from scipy.spatial import ConvexHull, QhullError

    sides, centre = np.ptp(points, axis=0), 0.5 * (points.min(axis=0) + points.max(axis=0))
    try:
        if sides.min() <= _FLAT * sides.max():
            raise QhullError
        hull = ConvexHull(points)
    except QhullError:
        return coal.Box(*np.maximum(sides, _THIN)), T * pin.SE3(np.eye(3), centre)
    mesh = coal.BVHModelOBBRSS()
    mesh.beginModel(len(hull.simplices), len(hull.vertices))
    mesh.addVertices(np.ascontiguousarray(points[hull.vertices]))
    number = np.zeros(len(points), dtype=np.int64)
    number[hull.vertices] = np.arange(len(hull.vertices))
    mesh.addTriangles(number[hull.simplices])
    mesh.endModel()
    try:
        mesh.buildConvexHull(True, "Qt")
    except RuntimeError:  # 255 edges meet in a corner at most; a flat end that is not cut into triangles has fewer
        mesh.buildConvexHull(False, "")
    return mesh.convex, T

"""Shapes of a URDF in parts that meshcat draws: boxes and the like by their sizes, meshes by their triangles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from meshcat import geometry as g

from ospace.kernels.tree import Floats
from ospace.urdf import mesh_file
from ospace.urdf.bodies import placement
from ospace.urdf.description import Colour, Shape

GREY: Colour = (0.72, 0.74, 0.78, 1.0)
_Y_TO_Z = np.array([[1.0, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]])  # meshcat's cylinders stand along y
_MOST_FACES = 100_000  # of one mesh, for edges to be kept sharp: beyond, it would take seconds
_SHARP = 0.5  # rad


class SmoothSphere(g.Sphere):  # type: ignore[misc]
    """Meshcat's sphere, rounder."""

    def lower(self, object_data: Any) -> Any:
        """Return what three.js reads."""
        return super().lower(object_data) | {"widthSegments": 40, "heightSegments": 28}


@dataclass(frozen=True)
class ShapePart:
    """A part of a shape, placed at `T` (4, 4), m, in the frame of its link."""

    geometry: Any
    colour: Colour
    T: Floats
    half: Floats
    """Half of the sides (3,) of a box about the origin of `T` that holds it, m."""


def shape_parts(shape: Shape, mesh: Path | None = None) -> Iterator[ShapePart]:
    """Yield the parts of a shape; `mesh` is the file of a <mesh>.

    Raises
    ------
    ValueError
        The mesh cannot be read.
    """
    R, p = placement(shape.pose)
    T = homogeneous(R, p)
    if mesh is not None:
        for vertices, faces, colour in _mesh_parts(mesh, mesh.stat().st_mtime_ns):
            scaled = vertices * np.array(shape.size)
            turned = faces[:, ::-1] if np.prod(shape.size) < 0.0 else faces  # a mirror turns them inside out
            lower, upper = scaled.min(axis=0), scaled.max(axis=0)
            centre = 0.5 * (lower + upper)
            geometry = g.TriangularMeshGeometry(scaled - centre, turned)
            yield ShapePart(geometry, shape.colour or colour, T @ homogeneous(np.eye(3), centre), 0.5 * (upper - lower))
        return
    colour = shape.colour or GREY
    if shape.kind == "box":
        yield ShapePart(g.Box(list(shape.size)), colour, T, 0.5 * np.array(shape.size))
    elif shape.kind == "sphere":
        yield ShapePart(SmoothSphere(shape.size[0]), colour, T, np.full(3, shape.size[0]))
    else:
        radius, length = shape.size
        yield ShapePart(g.Cylinder(length, radius), colour, T @ _Y_TO_Z, np.array([radius, 0.5 * length, radius]))
        if shape.kind == "capsule":
            for end in (-0.5 * length, 0.5 * length):
                cap = T @ homogeneous(np.eye(3), np.array([0.0, 0.0, end]))
                yield ShapePart(SmoothSphere(radius), colour, cap, np.full(3, radius))


def homogeneous(R: Floats, p: Floats) -> Floats:
    """Return rotation and translation as one matrix (4, 4)."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def box_corners(T: Floats, half: Floats) -> Floats:
    """Return the corners (8, 3) of a box at `T` with half of its sides (3,), m."""
    signs = np.array(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0])).reshape(3, 8).T
    return np.asarray(signs * half @ T[:3, :3].T + T[:3, 3])


def material(colour: Colour) -> g.MeshPhongMaterial:
    """Return a slightly glossy material, opacity as that of the colour."""
    rgb = [round(255.0 * min(max(part, 0.0), 1.0)) for part in colour[:3]]
    opacity = min(max(colour[3], 0.0), 1.0)
    return g.MeshPhongMaterial(
        color=rgb[0] << 16 | rgb[1] << 8 | rgb[2],
        opacity=opacity,
        depthWrite=opacity == 1.0,  # what is behind a translucent solid stays to be seen
        specular=0x333333,
        shininess=40,
    )


@lru_cache(maxsize=256)
def _mesh_parts(path: Path, changed: int) -> list[tuple[Floats, Any, Colour]]:
    """Return vertices (N, 3), faces (M, 3) and colour of each part of a mesh that was changed then; m, its own axes."""
    import trimesh

    parts = []
    for part in mesh_file.read_parts(path, colours=True):
        colour = _colour(part.visual)
        part = trimesh.Trimesh(part.vertices, part.faces)  # without textures, which would be cut to pieces too
        if len(part.faces) <= _MOST_FACES:
            part = trimesh.graph.smooth_shade(part, angle=_SHARP)
        parts.append((np.asarray(part.vertices), np.asarray(part.faces), colour))
    return parts


def _colour(visual: Any) -> Colour:
    of_material = getattr(visual, "material", None)
    rgba = getattr(of_material, "main_color", None) if of_material is not None else None
    if rgba is None and visual.defined:
        rgba = visual.main_color
    if rgba is None:
        return GREY
    red, green, blue, opacity = (float(part) / 255.0 for part in rgba)
    return red, green, blue, opacity or 1.0  # some exporters write a transparency of 1 for what is solid

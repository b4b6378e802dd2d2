"""Meshes as the boxes around them: shapes against masses, where a URDF draws its links by meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.urdf.bodies import placement
from ospace.urdf.description import Link, Pose, Shape
from ospace.urdf.lint import plausibility
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.meshes import MOST, MeshError, locate

_MEASURED = (".stl", ".obj")  # formats without units or axes of their own
_LARGEST = 50_000_000  # bytes


def of_meshes(robot: SpaceRobot) -> Iterator[Finding]:
    """Tell of links whose mass, inertia or centre does not fit the extent of their meshes, and of meshes cut short.

    Meshes are looked for where `ospace.urdf.lint.meshes.locate` does; those that are not found have findings already.
    """
    description, source = robot.description, robot.source
    if description is None or source is None:
        return
    links, changed, looked_for = [], set(), set()
    for link in description.links:
        shapes = []
        for shape in link.shapes:
            looked_for.add(shape.filename)
            if len(looked_for) > MOST:
                shapes.append(shape)
                continue
            try:
                shapes.append(_boxed(shape, source, robot.package_dirs))
            except ValueError as error:
                yield make_finding("mesh-unreadable", link.subject, str(error), line=shape.line, value=shape.filename)
                shapes.append(shape)
        if any(one is not other for one, other in zip(shapes, link.shapes, strict=True)):
            changed.add(link.subject)
        links.append(Link(link.line, link.name, link.inertial, tuple(shapes)))
    if not changed:
        return
    told = {(finding.code, finding.subject) for finding in robot.findings}
    for finding in plausibility.check_links(replace(description, links=tuple(links))):
        if finding.subject in changed and (finding.code, finding.subject) not in told:
            yield finding


def _boxed(shape: Shape, urdf: Path, package_dirs: tuple[Path, ...]) -> Shape:
    """Return the box around a mesh; the shape itself where it is no mesh, or is not measured."""
    if shape.kind != "mesh" or Path(shape.filename).suffix.lower() not in _MEASURED:
        return shape
    try:
        path = locate(shape.filename, urdf, package_dirs)
    except MeshError:
        return shape
    if path.stat().st_size > _LARGEST:
        return shape
    corners = _corners(path) * np.array(shape.size)
    R, p = placement(shape.pose)
    centre = p + R @ corners.mean(axis=0)
    size = np.abs(np.ptp(corners, axis=0))
    pose = Pose((float(centre[0]), float(centre[1]), float(centre[2])), shape.pose.rpy)
    return Shape(shape.line, shape.role, pose, "box", tuple(float(length) for length in size))


@cache
def _corners(path: Path) -> Floats:
    """Return lower and upper corner (2, 3) of the vertices; raises `ValueError` where there are none to read."""
    import trimesh

    try:
        bounds = trimesh.load(path, force="mesh", process=False, skip_materials=True).bounds
    except Exception as error:  # a parser of files from anywhere raises what it meets
        raise ValueError(f"'{path.name}' cannot be read: {type(error).__name__}") from None
    if bounds is None or not np.isfinite(bounds).all():
        raise ValueError(f"'{path.name}' has no vertices that can be read")
    return np.asarray(bounds, dtype=np.float64)

"""Meshes as the boxes around them: shapes against masses, where a URDF draws its links by meshes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from ospace.kernels.tree import Floats
from ospace.urdf import mesh_file
from ospace.urdf.bodies import placement
from ospace.urdf.description import Description, Link, Pose, Shape
from ospace.urdf.lint import plausibility
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.meshes import MOST, MeshError, locate
from ospace.urdf.numbers import LARGEST

_LARGEST = 50_000_000  # bytes


def of_meshes(
    description: Description, urdf: Path, package_dirs: Sequence[Path], known: Iterable[Finding]
) -> Iterator[Finding]:
    """Report links whose mass, inertia or centre does not fit the extent of their meshes, and meshes without triangles.

    Meshes are looked for where `ospace.urdf.lint.meshes.locate` does; those that are not found have findings already.

    Parameters
    ----------
    description : Description
        Of a robot, sound or not.
    urdf : Path
        Its file.
    package_dirs : sequence of Path
        Where ``package://`` names of meshes are looked up.
    known : iterable of Finding
        What was found without meshes, and is not found again.

    Returns
    -------
    iterator of Finding
    """
    links, changed, looked_for = [], set(), set()
    for link in description.links:
        shapes, unreadable = [], set()
        for shape in link.shapes:
            looked_for.add(shape.filename)
            if len(looked_for) > MOST or shape.filename in unreadable:
                shapes.append(shape)
                continue
            try:
                shapes.append(_boxed(shape, urdf, package_dirs))
            except ValueError as error:
                yield make_finding("mesh-unreadable", link.subject, str(error), line=shape.line, value=shape.filename)
                unreadable.add(shape.filename)
                shapes.append(shape)
        if any(one is not other for one, other in zip(shapes, link.shapes, strict=True)):
            changed.add(link.subject)
        links.append(Link(link.line, link.name, link.inertial, tuple(shapes)))
    if not changed:
        return
    reported = {(finding.code, finding.subject) for finding in known}
    for finding in plausibility.check_links(replace(description, links=tuple(links))):
        if finding.subject in changed and (finding.code, finding.subject) not in reported:
            yield finding


def _boxed(shape: Shape, urdf: Path, package_dirs: Sequence[Path]) -> Shape:
    """Return the box around a mesh; the shape itself where it is no mesh, is not found, or is too large to measure."""
    if shape.kind != "mesh":
        return shape
    try:
        path = locate(shape.filename, urdf, package_dirs)
    except MeshError:
        return shape
    status = path.stat()
    if status.st_size > _LARGEST:
        return shape
    with np.errstate(over="ignore"):
        corners = _corners(path, status.st_mtime_ns) * np.array(shape.size)
    if not np.abs(corners).max() < LARGEST:
        raise ValueError(f"'{path.name}' reaches further than {LARGEST:g} m")
    R, p = placement(shape.pose)
    centre = p + R @ corners.mean(axis=0)
    size = np.abs(np.ptp(corners, axis=0))
    pose = Pose((float(centre[0]), float(centre[1]), float(centre[2])), shape.pose.rpy)
    return Shape(shape.line, shape.role, pose, "box", tuple(float(length) for length in size))


@lru_cache(maxsize=MOST)
def _corners(path: Path, changed: int) -> Floats:
    """Return lower and upper corner (2, 3), m, of a mesh changed at that time; raise `ValueError` without triangles."""
    bounds = np.array([part.bounds for part in mesh_file.read_parts(path, colours=False)])
    return np.array([bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)])

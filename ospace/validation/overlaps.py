"""Links that overlap with all joints at zero, as a robot's shapes have it: no clearance watches them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from ospace.collision.geometry import CollisionGeometry
from ospace.collision.pairs import overlaps
from ospace.collision.shapes import shapes_that_count
from ospace.model.robot import SpaceRobot
from ospace.urdf.description import Shape
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.meshes import MeshError, locate

_NAMED = 5
"""Pairs that the message names."""
_MOST_SOLIDS, _MOST_BYTES = 200, 25_000_000
"""Shapes or parts of meshes, and bytes of meshes, that are looked at: a second or two."""


def of_shapes(robot: SpaceRobot) -> Iterator[Finding]:
    """Report which links of a robot overlap with all joints at zero, but for one body's and adjacent ones.

    Parameters
    ----------
    robot : SpaceRobot

    Returns
    -------
    iterator of Finding
        One at most: the pairs, the deepest first, or that there is too much to look at. Nothing of a robot without a
        file; meshes that are not found or cannot be read have findings of their own.
    """
    description, urdf = robot.description, robot.source
    if description is None or urdf is None:
        return
    shapes = [shape for link in description.links for shape in shapes_that_count(link)]
    subject = f"robot '{robot.name}'"
    geometry = None if _too_much(shapes, urdf, robot.package_dirs) else CollisionGeometry.of(robot)
    if geometry is None or len(geometry.solids) > _MOST_SOLIDS:
        message = (
            "which links overlap with all joints at zero was not looked at: there are more than "
            f"{_MOST_SOLIDS} shapes or {_MOST_BYTES // 1_000_000} MB of meshes"
        )
        yield make_finding("overlap-at-zero", subject, message, remedy="Look with ospace.collision.pairs.overlaps.")
        return
    found = sorted(overlaps(geometry).items(), key=lambda one: -one[1])
    if not found:
        return
    named = [f"'{a}' and '{b}'{_by(depth)}" for (a, b), depth in found[:_NAMED]]
    more = f", and {len(found) - _NAMED} more" if len(found) > _NAMED else ""
    pairs = "1 pair of links overlaps" if len(found) == 1 else f"{len(found)} pairs of links overlap"
    message = f"{pairs} with all joints at zero: {', '.join(named)}{more}"
    yield make_finding("overlap-at-zero", subject, message, value=str(len(found)))


def _by(depth: float) -> str:
    """Tell a depth, m; nothing where Coal could not tell it."""
    return f" by {1e3 * depth:.3g} mm" if depth < float("inf") else ""


def _too_much(shapes: Sequence[Shape], urdf: Path, package_dirs: Sequence[Path]) -> bool:
    if len(shapes) > _MOST_SOLIDS:
        return True
    size = 0
    for shape in shapes:
        if shape.kind == "mesh":
            with suppress(MeshError):
                size += locate(shape.filename, urdf, package_dirs).stat().st_size
    return size > _MOST_BYTES

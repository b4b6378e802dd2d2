"""Findings on numbers that can be computed with and are hardly meant: shapes against masses, and units."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ospace.kernels.tree import Floats
from ospace.urdf.bodies import placement, tensor_of
from ospace.urdf.description import Description, Inertial, Link, Pose, Shape
from ospace.urdf.lint.findings import Finding, make_finding

FAR = 100.0  # m: the International Space Station is 109 m wide, its arm 17 m long
_ONE_TURN = 2.0 * math.pi * (1.0 + 1e-3)  # rad: 6.2832 is one, rounded
DENSEST, _THINNEST = 25_000.0, 0.1  # kg/m³: osmium has 22,600
_GYRATION_OVER_REACH, _REACH_OVER_GYRATION = 2.0, 50.0
_MARKER = 0.02  # m: smaller boxes stand for a sensor or a frame
LIGHTEST = 1e-5  # of the robot's mass: lighter links are there to please simulators


def check_links(description: Description) -> Iterator[Finding]:
    """Check the inertial of each link, its shape, and the lengths of joints.

    Returns
    -------
    iterator of Finding
    """
    total = sum(link.inertial.mass for link in description.links if link.inertial is not None)
    for link in description.links:
        shapes = _solid(link.shapes)
        inertial = link.inertial
        if inertial is not None:
            yield from _check_rpy(link.subject, inertial.pose, inertial.line)
        if inertial is not None and inertial.mass > max(0.0, LIGHTEST * total):
            yield from _check_units(link, inertial)
            if shapes:
                yield from _compare_with_shape(link, inertial, shapes)
        if shapes and (size := float(np.ptp(_box(shapes), axis=0).max())) > FAR:
            yield make_finding("units-length", link.subject, f"its shape is {size:g} m large", line=shapes[0].line)
    for joint in description.joints:
        yield from _check_rpy(joint.subject, joint.pose, joint.line)
        if (length := math.hypot(*joint.pose.xyz)) > FAR:
            message = f"lies {length:g} m from the origin of link '{joint.parent}'"
            yield make_finding("units-length", joint.subject, message, line=joint.line, value=f"{length:g}")


def _check_rpy(subject: str, pose: Pose, line: int | None) -> Iterator[Finding]:
    if max(map(abs, pose.rpy)) > _ONE_TURN:
        angles = " ".join(f"{angle:g}" for angle in pose.rpy)
        message = f"rpy '{angles}' of its <origin> is more than a turn: is it in degrees?"
        yield make_finding("units-angle", subject, message, line=line, value=angles)


def _check_units(link: Link, inertial: Inertial) -> Iterator[Finding]:
    away = math.hypot(*inertial.pose.xyz)
    if away > FAR:
        message = f"its centre of mass is {away:g} m from its origin"
        yield make_finding("units-length", link.subject, message, line=inertial.line, value=f"{away:g}")
    gyration = radius_of_gyration(inertial)
    if gyration > FAR:
        message = f"its radius of gyration is {gyration:g} m"
        yield make_finding("units-inertia", link.subject, message, line=inertial.line, value=f"{gyration:g}")


def _compare_with_shape(link: Link, inertial: Inertial, shapes: Sequence[Shape]) -> Iterator[Finding]:
    line, centre, box = inertial.line, np.array(inertial.pose.xyz), _box(shapes)
    diagonal = float(np.linalg.norm(box[1] - box[0]))
    if diagonal < _MARKER:
        return
    reach = float(np.linalg.norm(np.abs(box - centre).max(axis=0)))
    gyration = radius_of_gyration(inertial)
    compared = f"radius of gyration {gyration:.4g} m, farthest reach of its shape {reach:.4g} m"
    if gyration > _GYRATION_OVER_REACH * reach:
        yield make_finding("gyration-large", link.subject, compared, line=line, value=f"{gyration:.4g}")
    elif 0.0 < gyration < reach / _REACH_OVER_GYRATION:
        yield make_finding("gyration-small", link.subject, compared, line=line, value=f"{gyration:.4g}")
    roles = [[shape for shape in shapes if shape.role == role] for role in ("visual", "collision")]
    solid = max(sum(map(_volume, of_role)) for of_role in roles)
    whole = float(np.prod(box[1] - box[0]))  # shapes may be no more than the corners of a link
    if solid > 0.0 and (inertial.mass < _THINNEST * solid or inertial.mass > DENSEST * whole):
        volume = solid if inertial.mass < _THINNEST * solid else whole
        density = inertial.mass / volume
        message = f"{inertial.mass:g} kg in {volume:.4g} m³: {density:.4g} kg/m³"
        yield make_finding("density", link.subject, message, line=line, value=f"{density:.4g}")
    outside = float(np.linalg.norm(np.maximum(0.0, np.maximum(box[0] - centre, centre - box[1]))))
    if outside > 0.5 * diagonal:
        message = f"its centre of mass lies {outside:.4g} m outside its shape"
        yield make_finding("centre-outside", link.subject, message, line=line, value=f"{outside:.4g}")


def radius_of_gyration(inertial: Inertial) -> float:
    """Return the largest radius of gyration of a link that has mass.

    Returns
    -------
    float
        m.
    """
    return math.sqrt(max(0.0, float(np.linalg.eigvalsh(tensor_of(inertial))[2])) / inertial.mass)


def _solid(shapes: Sequence[Shape]) -> list[Shape]:
    """Return shapes of a role in which no mesh is: there the whole extent is known."""
    with_mesh = {shape.role for shape in shapes if shape.kind == "mesh"}
    return [shape for shape in shapes if shape.role not in with_mesh]


def _box(shapes: Sequence[Shape]) -> Floats:
    """Return lower and upper corner of the box around shapes, in the link's axes."""
    corners = []
    for shape in shapes:
        R, p = placement(shape.pose)
        half = np.abs(R) @ _half(shape)
        corners += [p - half, p + half]
    return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def _half(shape: Shape) -> Floats:
    if shape.kind == "box":
        return np.array(shape.size) / 2.0
    radius = shape.size[0]
    length = {"sphere": lambda: radius, "cylinder": lambda: shape.size[1] / 2.0}
    along = length.get(shape.kind, lambda: shape.size[1] / 2.0 + radius)()
    return np.array([radius, radius, along])


def _volume(shape: Shape) -> float:
    if shape.kind == "box":
        return math.prod(shape.size)
    radius = shape.size[0]
    ball = 4.0 / 3.0 * math.pi * radius**3
    if shape.kind == "sphere":
        return ball
    return math.pi * radius**2 * shape.size[1] + (ball if shape.kind == "capsule" else 0.0)

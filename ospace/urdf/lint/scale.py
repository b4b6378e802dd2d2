"""Findings on lengths, masses and tensors that do not fit to the rest of the robot, whatever its size."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ospace.urdf.bodies import Body
from ospace.urdf.description import Description
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.plausibility import DENSEST, FAR, LIGHTEST, radius_of_gyration
from ospace.urdf.lint.rules import Severity

_LONGEST = 20.0  # of all other lengths: a metre is 39 inches, 100 cm, 1000 mm
_HEAVIEST_ARM, _LIGHTEST_ARM = 100.0, 1e-6  # of the base's mass
_HEAVIEST_BODY = 5.0  # of the mass of all others
_NOTABLE = 0.05  # of the robot's mass: what has less can hardly be felt


class _Length(NamedTuple):
    subject: str
    line: int | None
    metres: float


def check_scale(description: Description, bodies: Sequence[Body]) -> Iterator[Finding]:
    """Compare lengths, masses and radii of gyration with each other.

    Returns
    -------
    iterator of Finding
    """
    yield from _check_lengths(description, bodies)
    yield from _check_masses(bodies)
    yield from _check_densities(bodies)


def _check_lengths(description: Description, bodies: Sequence[Body]) -> Iterator[Finding]:
    """Compare distances of joints, of mass centres, and radii of gyration, each kind with the other two."""
    carried = {link.name: 0.0 if link.inertial is None else link.inertial.mass for link in description.links}
    total = sum(carried.values())
    for joint in reversed(description.joints):
        carried[joint.parent] += carried[joint.child]
    # An offset before the first mass, or to frames alone, is part of no body.
    joints = [
        _Length(joint.subject, joint.line, math.hypot(*joint.pose.xyz))
        for joint in description.joints
        if 0.0 < carried[joint.child] < total
    ]
    centres, gyrations, of_base = [], [], 0.0
    for link in description.links:
        inertial = link.inertial
        if inertial is not None and inertial.mass > max(0.0, LIGHTEST * total):
            centres.append(_Length(link.subject, inertial.line, math.hypot(*inertial.pose.xyz)))
            if link.name in bodies[0].placed:
                of_base = max(of_base, radius_of_gyration(inertial))
            else:
                gyrations.append(_Length(link.subject, inertial.line, radius_of_gyration(inertial)))
    farthest, offset, widest = (max((one.metres for one in kind), default=0.0) for kind in (joints, centres, gyrations))
    for code, what, kind, others in (
        ("units-length", "lies {:g} m from the link that it hangs from", joints, (offset, widest, of_base)),
        ("units-length", "its centre of mass is {:g} m from its origin", centres, (farthest, widest, of_base)),
        ("units-inertia", "its radius of gyration is {:.3g} m", gyrations, (farthest, offset, of_base)),
    ):
        scale = max(others)
        for one in kind:
            if 0.0 < _LONGEST * scale < one.metres <= FAR:
                message = f"{what.format(one.metres)}, all other lengths of the robot {scale:.3g} m at most"
                yield make_finding(code, one.subject, message, line=one.line, value=f"{one.metres:g}")


def _check_masses(bodies: Sequence[Body]) -> Iterator[Finding]:
    """Compare the mass of the base with that of all other bodies, and of each of these with that of the rest."""
    base, rest = bodies[0].mass, sum(body.mass for body in bodies[1:])
    if base > 0.0 and rest > 0.0 and not _LIGHTEST_ARM <= rest / base <= _HEAVIEST_ARM:
        message = f"the base has {base:g} kg, and all that hangs from it {rest:g} kg"
        yield make_finding("mass-ratio", f"link '{bodies[0].link.name}'", message, value=f"{rest / base:g}")
        return
    for body in bodies[1:]:
        others = base + rest - body.mass
        if others > 0.0 and body.mass > _HEAVIEST_BODY * others:
            message = f"has {body.mass:g} kg, and all other bodies together {others:g} kg"
            value = f"{body.mass / others:g}"
            yield make_finding("mass-ratio", body.link.subject, message, line=body.link.line, value=value)


def _check_densities(bodies: Sequence[Body]) -> Iterator[Finding]:
    """Look for tensors that no matter has: a ball is the largest body of a given mass and trace of the tensor."""
    total = sum(body.mass for body in bodies)
    for body in bodies:
        second_moment = 0.5 * float(np.trace(body.tensor))
        if body.mass <= max(0.0, LIGHTEST * total) or second_moment <= 0.0:
            continue
        radius = math.sqrt(5.0 / 3.0 * second_moment / body.mass)
        density = body.mass / (4.0 / 3.0 * math.pi * radius**3)
        if density > DENSEST:
            extent = math.sqrt(second_moment / body.mass)
            message = f"{body.mass:g} kg within {extent:.2g} m of the centre of mass, on average: {density:.2g} kg/m³"
            severity: Severity | None = None if body.mass > _NOTABLE * total else "info"
            yield make_finding(
                "gyration-small",
                body.link.subject,
                message,
                severity=severity,
                line=body.link.line,
                value=f"{density:.4g}",
            )

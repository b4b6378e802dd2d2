"""Proofs that Pinocchio's model is what the file says: every body, link and joint against ospace's own reading.

The first is of the model that ospace has Pinocchio build of what was read; the second of Pinocchio's own reading of the
file as it stands, which sees what the first cannot: what was lost before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.urdf.bodies import Body
from ospace.urdf.description import Joint
from ospace.urdf.errors import UrdfError
from ospace.urdf.joint_axis import joint_axis
from ospace.urdf.lint.findings import Finding, make_finding

_TOLERANCE = 1e-10
"""Share by which a placement or inertia may differ: rounding over a chain of 2000 fixed joints leaves 1e-12."""
_TYPES = {
    "revolute": ("RX", "RY", "RZ", "RevoluteUnaligned"),
    "continuous": ("RUBX", "RUBY", "RUBZ", "RevoluteUnboundedUnaligned"),
    "prismatic": ("PX", "PY", "PZ", "PrismaticUnaligned"),
    "planar": ("Planar",),
    "floating": ("FreeFlyer",),
}


_EXPLAINED = {"number-spaces"}
"""Findings which say that Pinocchio reads a part of the file otherwise."""
_REJECTED = {
    "limits-missing",
    "effort-missing",
    "no-robot-name",
    "unknown-version",
    "number-spaces",
    "number-unreadable",
}
"""Findings which say that Pinocchio does not read the file."""


@dataclass(frozen=True)
class _Difference:
    """What differs, and links and joints a finding on which may explain it."""

    message: str
    subjects: frozenset[str]


def check_built(path: Path, bodies: Sequence[Body], model: pin.Model) -> None:
    """Compare the model with the bodies of the file.

    Raises
    ------
    UrdfError
        They differ: the model is not what the file says.
    """
    difference = next(_differences(bodies, model), None)
    if difference is not None:
        reason = f"Pinocchio's model is not what the file says: {difference.message}; please report it"
        raise UrdfError(path, reason, "parity")


def check_original(
    bodies: Sequence[Body], model: pin.Model | None, stderr: str, known: Sequence[Finding]
) -> Iterator[Finding]:
    """Compare with Pinocchio's reading of the file as it stands; what no finding explains is an error.

    Parameters
    ----------
    bodies : sequence of Body
    model : pin.Model or None
        None where Pinocchio rejects the file.
    stderr : str
        The errors that its parser wrote.
    known : sequence of Finding
        All findings on the file.

    Returns
    -------
    iterator of Finding
        One at most.
    """
    if model is None:
        if not any(finding.code in _REJECTED for finding in known):
            yield make_finding("original-rejected", "file", f"Pinocchio's parser rejects the file: {stderr}")
        return
    explained = {finding.subject for finding in known if finding.code in _EXPLAINED}
    for difference in _differences(bodies, model):
        if not difference.subjects & explained:
            message = f"Pinocchio's own reading of the file differs: {difference.message}"
            yield make_finding(
                "original-differs", "file", f"{message}; its parser says: {stderr}" if stderr else message
            )
            return


def _differences(bodies: Sequence[Body], model: pin.Model) -> Iterator[_Difference]:
    every = frozenset(subject for body in bodies for subject in _subjects(body))
    if model.njoints != len(bodies) + 1:
        yield _Difference(f"{model.njoints - 2} joints instead of {len(bodies) - 1}", every)
        return
    names = [_as_xml(name) for name in model.names]
    number = {"": 1} | {name: j for j, name in enumerate(names) if j > 1}
    frames = {_as_xml(frame.name): frame for frame in model.frames if frame.type == pin.FrameType.BODY}
    at = ["" if body.joint is None else _as_xml(body.joint.name) for body in bodies]
    mass = sum(body.mass for body in bodies)
    total = sum(inertia.mass for inertia in model.inertias)
    if not _near(mass, total, sum(abs(body.mass) for body in bodies)):
        yield _Difference(f"total mass {total:.12g} kg instead of {mass:.12g} kg", every)
    for body, name in zip(bodies, at, strict=True):
        subjects = frozenset(_subjects(body))
        if name not in number:
            yield _Difference(f"no joint '{name}'", subjects)
            continue
        j = number[name]
        for message in (*_compare_body(body, model.inertias[j]), *_compare_links(body, j, frames)):
            yield _Difference(message, subjects)
        if body.joint is not None:
            if model.parents[j] != number[at[body.parent]]:
                yield _Difference(f"{body.joint.subject} hangs from '{names[model.parents[j]]}'", subjects)
            for message in (*_compare_placement(body, model.jointPlacements[j]), *_compare_joint(body.joint, model, j)):
                yield _Difference(message, subjects)


def _subjects(body: Body) -> Iterator[str]:
    yield from (f"link '{name}'" for name in body.placed)
    if body.joint is not None:
        yield body.joint.subject


def _as_xml(name: str) -> str:
    """Read a name as XML does, for which white space in an attribute is one space; Pinocchio's parser keeps it."""
    return name.translate({ord(letter): " " for letter in "\t\r\n"})


def _compare_body(body: Body, inertia: pin.Inertia) -> Iterator[str]:
    if not _near(body.mass, inertia.mass, body.mass):
        yield f"mass {inertia.mass:.12g} kg of {body.subject} instead of {body.mass:.12g} kg"
    reach = float(np.abs(body.centre).max()) + math.sqrt(body.size / body.mass) if body.mass > 0.0 else 0.0
    if body.mass > 0.0 and not _near(body.centre, inertia.lever, reach):
        yield f"centre of mass {inertia.lever} of {body.subject} instead of {body.centre}"
    if not _near(body.tensor, inertia.inertia, body.size):
        yield f"inertia {inertia.inertia.tolist()} of {body.subject} instead of {body.tensor.tolist()}"


def _compare_links(body: Body, j: int, frames: Mapping[str, pin.Frame]) -> Iterator[str]:
    for name, (rotation, translation) in body.placed.items():
        frame = frames.get(_as_xml(name))
        if frame is None:
            yield f"no link '{name}'"
        elif frame.parentJoint != j:
            yield f"link '{name}' hangs from another joint"
        elif not _same_place(rotation, translation, frame.placement):
            yield f"link '{name}' lies at {_written(frame.placement)} instead of {translation}, {rotation.tolist()}"


def _compare_placement(body: Body, placed: pin.SE3) -> Iterator[str]:
    if not _same_place(body.rotation, body.translation, placed):
        expected = f"{body.translation}, {body.rotation.tolist()}"
        yield f"joint of {body.subject} lies at {_written(placed)} instead of {expected}"


def _compare_joint(joint: Joint, model: pin.Model, j: int) -> Iterator[str]:
    kind = model.joints[j].shortname().removeprefix("JointModel")
    if kind not in _TYPES[joint.kind]:
        yield f"{joint.subject} is of type {kind} instead of {joint.kind}"
        return
    if joint.kind in ("planar", "floating"):
        return
    axis = joint_axis(model.joints[j])
    if not _near(np.array(joint.axis), axis, 1.0):
        yield f"axis {axis} of {joint.subject} instead of {joint.axis}"
    q, v = model.idx_qs[j], model.idx_vs[j]
    limit = joint.limit
    effort, velocity = (math.inf, math.inf) if limit is None else (limit.effort, limit.velocity)
    expected = {"effort": (model.effortLimit[v], effort), "velocity": (model.velocityLimit[v], velocity)}
    if joint.kind != "continuous":
        lower, upper = (-math.inf, math.inf) if limit is None else (limit.lower, limit.upper)
        expected |= {"lower": (model.lowerPositionLimit[q], lower), "upper": (model.upperPositionLimit[q], upper)}
    expected |= {"damping": (model.damping[v], joint.damping), "friction": (model.friction[v], joint.friction)}
    for name, (actual, value) in expected.items():
        if actual != value:
            yield f"{name} {actual} of {joint.subject} instead of {value}"


def _same_place(rotation: Floats, translation: Floats, placed: pin.SE3) -> bool:
    reach = 1e-3 + float(np.abs(translation).max())
    return _near(rotation, placed.rotation, 1.0) and _near(translation, placed.translation, reach)


def _written(placed: pin.SE3) -> str:
    return f"{placed.translation}, {placed.rotation.tolist()}"


def _near(expected: Floats | float, actual: Floats | float, scale: float) -> bool:
    return bool(np.all(np.abs(np.subtract(expected, actual)) <= _TOLERANCE * scale))

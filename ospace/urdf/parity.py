"""Proofs that Pinocchio's model is what the file says: every body, link and joint against ospace's own reading.

The first is of the model that ospace has Pinocchio build of what was read; the second of Pinocchio's own reading of the
file as it stands, which sees what the first cannot: what was lost before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence, Set
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
    "limits-none",
}
"""Findings which say that Pinocchio does not read the file."""


@dataclass(frozen=True)
class _Difference:
    """Difference, with links and joints a finding on which may explain it."""

    message: str
    subjects: frozenset[str]


def check_built(path: Path, bodies: Sequence[Body], model: pin.Model) -> None:
    """Compare the model with the bodies of the file.

    Raises
    ------
    UrdfError
        They differ: the model is not what the file says.
    """
    difference = next(_differences(bodies, model, planes_turned=True), None)
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
    unlimited = {finding.subject for finding in known if finding.code == "limits-none"}
    for difference in _differences(bodies, model, planes_turned=False, unlimited=unlimited):
        if not difference.subjects & explained:
            message = f"Pinocchio's own reading of the file differs: {difference.message}"
            yield make_finding(
                "original-differs", "file", f"{message}; its parser says: {stderr}" if stderr else message
            )
            return


def _differences(
    bodies: Sequence[Body], model: pin.Model, *, planes_turned: bool, unlimited: Set[str] = frozenset()
) -> Iterator[_Difference]:
    """Compare all bodies, each in the frame of the link that its joint carries.

    Parameters
    ----------
    bodies : sequence of Body
    model : pin.Model
    planes_turned : bool
        Whether planar joints move across their axis; Pinocchio's own parser ignores it, and takes z.
    unlimited : set of str
        Joints of which ospace reads some limits as none.

    Returns
    -------
    iterator of _Difference
    """
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
    turns: dict[str, pin.SE3] = {}
    for body, name in zip(bodies, at, strict=True):
        subjects = frozenset(_subjects(body))
        frame = frames.get(_as_xml(body.link.name))
        turns[name] = turn = pin.SE3.Identity() if frame is None else frame.placement
        if name not in number:
            yield _Difference(f"no joint '{name}'", subjects)
            continue
        j = number[name]
        for message in (*_compare_body(body, turn.actInv(model.inertias[j])), *_compare_links(body, j, turn, frames)):
            yield _Difference(message, subjects)
        of_joint = [*_compare_turn(body, turn)]
        if body.joint is not None:
            if model.parents[j] != number[at[body.parent]]:
                yield _Difference(f"{body.joint.subject} hangs from '{names[model.parents[j]]}'", subjects)
            of_joint += _compare_placement(body, turns[at[body.parent]].actInv(model.jointPlacements[j] * turn))
            of_joint += _compare_type(body.joint, model, j)
            if not of_joint and body.joint.kind == "planar" and planes_turned:
                of_joint += _compare_axis(body.joint, turn.rotation[2])
            elif not of_joint and body.joint.kind not in ("planar", "floating"):
                of_joint += _compare_axis(body.joint, joint_axis(model.joints[j]))
                of_joint += _compare_numbers(body.joint, model, j, none_allowed=body.joint.subject in unlimited)
        for message in of_joint:
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


def _compare_links(body: Body, j: int, turn: pin.SE3, frames: Mapping[str, pin.Frame]) -> Iterator[str]:
    for name, (rotation, translation) in body.placed.items():
        frame = frames.get(_as_xml(name))
        if frame is None:
            yield f"no link '{name}'"
        elif frame.parentJoint != j:
            yield f"link '{name}' hangs from another joint"
        elif not _same_place(rotation, translation, placed := turn.actInv(frame.placement)):
            yield f"link '{name}' lies at {_written(placed)} instead of {translation}, {rotation.tolist()}"


def _compare_placement(body: Body, placed: pin.SE3) -> Iterator[str]:
    if not _same_place(body.rotation, body.translation, placed):
        expected = f"{body.translation}, {body.rotation.tolist()}"
        yield f"joint of {body.subject} lies at {_written(placed)} instead of {expected}"


def _compare_turn(body: Body, turn: pin.SE3) -> Iterator[str]:
    """Only a planar joint may have its link in other axes than its own, and none at another place."""
    turned = body.joint is not None and body.joint.kind == "planar"
    if not _same_place(turn.rotation if turned else np.eye(3), np.zeros(3), turn):
        yield f"link '{body.link.name}' lies at {_written(turn)} of its joint"


def _compare_type(joint: Joint, model: pin.Model, j: int) -> Iterator[str]:
    kind = model.joints[j].shortname().removeprefix("JointModel")
    if kind not in _TYPES[joint.kind]:
        yield f"{joint.subject} is of type {kind} instead of {joint.kind}"


def _compare_axis(joint: Joint, axis: Floats) -> Iterator[str]:
    if not _near(np.array(joint.axis), axis, 1.0):
        yield f"axis {axis} of {joint.subject} instead of {joint.axis}"


def _compare_numbers(joint: Joint, model: pin.Model, j: int, *, none_allowed: bool) -> Iterator[str]:
    q, v = model.idx_qs[j], model.idx_vs[j]
    limit = joint.limit
    effort, velocity = (math.inf, math.inf) if limit is None else (limit.effort, limit.velocity)
    expected = {"effort": (model.effortLimit[v], effort), "velocity": (model.velocityLimit[v], velocity)}
    if joint.kind != "continuous":
        lower, upper = (-math.inf, math.inf) if limit is None else (limit.lower, limit.upper)
        expected |= {"lower": (model.lowerPositionLimit[q], lower), "upper": (model.upperPositionLimit[q], upper)}
    expected |= {"damping": (model.damping[v], joint.damping), "friction": (model.friction[v], joint.friction)}
    for name, (actual, value) in expected.items():
        if actual != value and not (none_allowed and math.isinf(value)):
            yield f"{name} {actual} of {joint.subject} instead of {value}"


def _same_place(rotation: Floats, translation: Floats, placed: pin.SE3) -> bool:
    reach = 1e-3 + float(np.abs(translation).max())
    return _near(rotation, placed.rotation, 1.0) and _near(translation, placed.translation, reach)


def _written(placed: pin.SE3) -> str:
    return f"{placed.translation}, {placed.rotation.tolist()}"


def _near(expected: Floats | float, actual: Floats | float, scale: float) -> bool:
    return bool(np.all(np.abs(np.subtract(expected, actual)) <= _TOLERANCE * scale))

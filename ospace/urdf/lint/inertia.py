"""Findings on masses and tensors, of links as the file has them and of bodies as they move."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.urdf.bodies import Body, tensor_of
from ospace.urdf.coupling import Following
from ospace.urdf.description import Link
from ospace.urdf.lint.findings import Finding, any_error, make_finding
from ospace.urdf.lint.massless import JointMotion, motion_of, motions_of, new_rng, singular_joints
from ospace.urdf.lint.rules import Severity

ROUNDED = 1e-4
"""Share of the largest moment up to which a violation is one of digits that were lost."""
_ROUNDING, _POINT_LIKE = 1e-9, 1e-12  # of the middle moment; of m², radius of gyration squared around a point mass
_NEGATIVE, _POINT_NEGATIVE = 1e-13, 1e-16  # the same for negative moments, which no digit that is lost excuses
_GROSS = 1.0 - 1e-6  # of the largest moment: the digits of the other two are lost in it


@dataclass(frozen=True)
class MovingBody:
    """A body of any model, as far as findings are concerned; the base is the first and has parent −1."""

    subject: str
    link: str
    joint: str
    parent: int
    mass: float
    centre: Floats
    tensor: Floats
    line: int | None = None
    known: bool = False
    """Whether its one link was checked already."""


def check_bodies(bodies: Sequence[Body], followers: Mapping[str, Following]) -> list[Finding]:
    """Check each link, and each body that fixed joints make of several; `followers` are joints that follow others.

    Returns
    -------
    list of Finding
    """
    findings = [
        finding
        for body in bodies
        for link in body.weighed
        for finding in _check_link(link, merged=len(body.weighed) > 1)
    ]
    moving = [
        MovingBody(
            body.subject,
            body.link.name,
            "" if body.joint is None else body.joint.name,
            body.parent,
            body.mass,
            body.centre,
            body.tensor,
            body.link.line if body.joint is None else body.joint.line,
            len(body.weighed) == 1,
        )
        for body in bodies
    ]
    rng = new_rng()
    motions = [motion_of(body.joint, body.rotation, rng) for body in bodies if body.joint is not None]
    return findings + _check_bodies(moving, motions, followers, any_error(findings))


def check_model(model: pin.Model, followers: Mapping[str, Following]) -> list[Finding]:
    """Check the bodies of a Pinocchio model with a free-flyer and free joints, of which `followers` follow others.

    Returns
    -------
    list of Finding
    """
    moving = []
    for j in range(1, model.njoints):
        inertia, link = model.inertias[j], _link_name(model, j)
        parent = model.parents[j] - 1
        subject = f"link '{link}'"
        moving.append(
            MovingBody(subject, link, str(model.names[j]), parent, inertia.mass, inertia.lever, inertia.inertia)
        )
    return _check_bodies(moving, motions_of(model), followers)


def _check_bodies(
    bodies: Sequence[MovingBody],
    motions: Sequence[JointMotion],
    followers: Mapping[str, Following],
    unsound: bool = False,
) -> list[Finding]:
    findings: list[Finding] = []
    parents, masses = [body.parent for body in bodies], [body.mass for body in bodies]
    singular = set(singular_joints(parents, masses, [body.tensor for body in bodies], motions))
    resisted = {_leader(bodies[k].joint, followers) for k in range(1, len(bodies)) if k not in singular} - {None}
    singular = {k for k in singular if _leader(bodies[k].joint, followers) not in {*resisted, None}}
    for k, body in enumerate(bodies):
        if not body.known:
            findings += _check_tensor(body.subject, body.mass, body.centre, body.tensor, body.line)
        if k == 0:
            findings += _check_base(body, alone=len(bodies) == 1 and not unsound and not any_error(findings))
        elif k in singular:
            message = "the joint moves links without any mass, so the joint-space inertia is singular"
            if body.tensor.any():
                message = "the joint moves links without any mass, and no tensor of theirs resists it: H is singular"
            remedy = f"Give link '{body.link}' an <inertial>, or make the joint fixed."
            findings.append(
                make_finding("massless-subtree", f"joint '{body.joint}'", message, remedy=remedy, line=body.line)
            )
        elif body.mass == 0.0 and not body.tensor.any():
            message = f"the body on joint '{body.joint}' has no mass of its own"
            findings.append(make_finding("massless-link", f"link '{body.link}'", message, line=body.line))
    return findings


def _leader(joint: str, followers: Mapping[str, Following]) -> str | None:
    """Return the joint by whose rate another one moves: itself, or whom it follows; None where nothing moves it."""
    if joint not in followers:
        return joint
    return followers[joint].leader if followers[joint].ratio else None


def _check_base(base: MovingBody, *, alone: bool) -> Iterator[Finding]:
    subject = f"link '{base.link}'"
    if base.mass == 0.0:
        message = "the base, with all that is fixed to it, has no mass, so it could not float freely"
        yield make_finding("massless-base", subject, message, line=base.line)
        return
    if alone:
        smallest, _, largest = np.linalg.eigvalsh(base.tensor)
        if smallest <= 1e-12 * largest:
            message = "the only body has no rotational inertia about an axis, so nothing resists a torque about it"
            remedy = "Give its <inertia> three positive principal moments."
            yield make_finding("massless-base", subject, message, remedy=remedy, line=base.line)


def _check_link(link: Link, *, merged: bool) -> Iterator[Finding]:
    inertial = link.inertial
    if inertial is None:
        return
    tensor, line, subject = tensor_of(inertial), inertial.line, link.subject
    yield from _check_tensor(subject, inertial.mass, np.array(inertial.pose.xyz), tensor, line, merged=merged)
    if inertial.mass == 0.0 and tensor.any():
        yield make_finding("inertia-without-mass", subject, "has rotational inertia and no mass", line=line)
    if inertial.mass > 0.0 and not tensor.any():
        message = f"{inertial.mass:g} kg in one point: the tensor is zero"
        yield make_finding("point-mass", subject, message, line=line)
    if np.array_equal(tensor, np.eye(3)):
        yield make_finding(
            "inertia-identity", subject, "the tensor is the unit matrix, the default of exporters", line=line
        )
    if _about_origin(inertial.mass, np.array(inertial.pose.xyz), tensor):
        message = "the tensor looks like one about the link's origin, not the centre of mass"
        yield make_finding("inertia-about-origin", subject, message, line=line)


def _check_tensor(
    subject: str, mass: float, centre: Floats, tensor: Floats, line: int | None, *, merged: bool = False
) -> list[Finding]:
    """Check one mass and tensor about its centre; a link that is `merged` may lean on its neighbours."""
    if not np.isfinite(np.r_[mass, centre, tensor.ravel()]).all():
        message = "mass, centre of mass or inertia is not finite"
        return [make_finding("inertia-not-finite", subject, message, line=line)]
    if mass < 0.0:
        message = f"mass {mass:.6g} kg is negative"
        return [make_finding("negative-mass", subject, message, line=line, value=repr(mass))]
    code, share = classify_tensor(mass, tensor)
    if not code:
        return []
    moments = np.linalg.eigvalsh(tensor)
    if code == "planar-tensor":
        given = "xyz"[int(np.argmax(np.diag(tensor)))]
        others = " and ".join(f"i{axis}{axis}" for axis in "xyz" if axis != given)
        message = (
            f"only i{given}{given} is given, {moments[2]:.6g} kg m², as for motion in a plane: {others} are missing"
        )
        return [make_finding(code, subject, message, line=line, value=f"{moments[2]:.6g}")]
    if code == "inertia-indefinite":
        message = f"its tensor about the centre of mass has the negative principal moment {moments[0]:.6g} kg m²"
        severity: Severity = "warning" if merged else "error"
        return [make_finding(code, subject, message, severity=severity, line=line, value=f"{moments[0]:.6g}")]
    listed = ", ".join(f"{moment:.6g}" for moment in moments)
    message = (
        f"principal moments {listed} kg m² violate the triangle inequality by {share:.2g} of the largest: "
        f"no distribution of mass has them"
    )
    severity = "error" if share > _GROSS and not merged else "warning"
    return [make_finding(code, subject, message, severity=severity, line=line, value=f"{moments[2]:.6g}")]


def classify_tensor(mass: float, tensor: Floats) -> tuple[str, float]:
    """Compare the principal moments of a tensor with those that a body can have.

    One moment beside which the other two are equal, and a hundredth at most, is that of a planar model, which needs no
    other; without mass it may stand alone, for a wheel.

    Two of the moments of a body sum up to the third at least. So rounding is measured by the middle one: beside a
    largest moment that dwarfs the others, a negative one may still be more than rounding.

    Parameters
    ----------
    mass : float
        kg.
    tensor : (3, 3)
        About the centre of mass, in any axes. kg m².

    Returns
    -------
    str
        Name of the rule that is violated, "" for none.
    float
        The violation as a share of the largest moment.
    """
    if _of_plane(tensor):
        return ("planar-tensor", 1.0) if mass > 0.0 else ("", 0.0)
    smallest, middle, largest = np.linalg.eigvalsh(tensor)
    excess = largest - smallest - middle
    if smallest < -(_NEGATIVE * abs(middle) + _POINT_NEGATIVE * mass):
        return "inertia-indefinite", float(max(-smallest, excess) / largest) if largest > 0.0 else np.inf
    if excess > _ROUNDING * abs(middle) + _POINT_LIKE * mass:
        share = float(excess / largest)
        return "inertia-rounding" if share <= ROUNDED else "inertia-triangle", share
    return "", 0.0


def _of_plane(tensor: Floats) -> bool:
    smallest, middle, largest = np.sort(np.diag(tensor))
    return bool(np.count_nonzero(tensor - np.diag(np.diag(tensor))) == 0 and 0.0 <= smallest == middle < 0.01 * largest)


def _about_origin(mass: float, centre: Floats, tensor: Floats) -> bool:
    """Return whether most of the tensor is what the distance of the centre from the origin adds about the origin."""
    added = mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    total, apart = np.linalg.norm(tensor), np.linalg.norm(added)
    if mass <= 0.0 or total == 0.0 or apart == 0.0:
        return False
    moments = np.linalg.eigvalsh(tensor - added)
    sound = moments[0] >= 0.0 and moments[2] <= moments[0] + moments[1] + 1e-6 * total
    return bool(sound and np.sum(tensor * added) > 0.99 * total * apart and np.trace(tensor - added) < 0.25 * total)


def _link_name(model: pin.Model, j: int) -> str:
    """Return the name of the link that joint `j` carries."""
    for frame in model.frames:
        if frame.type == pin.FrameType.BODY and frame.parentJoint == j and frame.placement.isIdentity(1e-12):
            return str(frame.name)
    return str(model.names[j])

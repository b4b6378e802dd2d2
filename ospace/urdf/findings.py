"""What is wrong, or odd, with a model: findings with a stable code, by link or joint."""

from __future__ import annotations

import re
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np
import pinocchio as pin

from ospace.kernels.tables import Floats

Severity = Literal["error", "warning"]
_ROUNDING = 1e-9
_POINT_LIKE = 1e-12  # radius of gyration squared, m²: below it a tensor is rounding around a point mass


@dataclass(frozen=True)
class Finding:
    """One thing to know about a model.

    Attributes
    ----------
    code : str
        Stable name of the kind of finding.
    severity : "error" or "warning"
        With an error the model has no sound dynamics.
    subject : str
        The link or joint.
    message : str
        What was found, with its value, and why it matters.
    remedy : str
    """

    code: str
    severity: Severity
    subject: str
    message: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.severity} {self.code}: {self.subject}: {self.message}; {self.remedy}"

    def as_dict(self) -> dict[str, str]:
        """Return the fields by name."""
        return asdict(self)


def of_model(model: pin.Model) -> list[Finding]:
    """Look at the inertias of a model with a free-flyer, fixed joints merged."""
    found: list[Finding] = []
    subtree_mass = np.array([inertia.mass for inertia in model.inertias])
    for j in range(model.njoints - 1, 1, -1):
        subtree_mass[model.parents[j]] += subtree_mass[j]
    for j in range(1, model.njoints):
        body = model.inertias[j]
        found += of_body(link_of(model, j), body.mass, body.lever, body.inertia)
        if j == 1 and model.inertias[1].mass == 0.0:
            found.append(
                Finding(
                    "massless-base",
                    "error",
                    f"link '{link_of(model, 1)}'",
                    "the base, with all that is fixed to it, has no mass, so it could not float freely",
                    "give the root link, or a link fixed to it, an <inertial>",
                )
            )
        elif j == 1 and model.njoints == 2 and not found and np.linalg.eigvalsh(body.inertia)[0] <= 0.0:
            found.append(
                Finding(
                    "massless-base",
                    "error",
                    f"link '{link_of(model, 1)}'",
                    "the only body has no rotational inertia about an axis, so nothing resists a torque about it",
                    "give its <inertia> three positive principal moments",
                )
            )
        elif j > 1 and subtree_mass[j] == 0.0:
            found.append(
                Finding(
                    "massless-subtree",
                    "error",
                    f"joint '{model.names[j]}'",
                    "the joint moves links without any mass, so the joint-space inertia is singular",
                    f"give link '{link_of(model, j)}' an <inertial>, or make the joint fixed",
                )
            )
    return found


def of_body(link: str, mass: float, centre: Floats, inertia: Floats, *, merged: bool = False) -> list[Finding]:
    """Look at one inertia, the tensor about the centre of mass; a link that is `merged` may lean on its neighbours."""
    subject = f"link '{link}'"
    numbers = np.r_[mass, centre, inertia.ravel()]
    if not np.isfinite(numbers).all():
        message = "mass, centre of mass or inertia is not finite"
        return [Finding("inertia-not-finite", "error", subject, message, "write finite numbers in its <inertial>")]
    if mass < 0.0:
        message = f"mass {mass:.6g} kg is negative"
        return [Finding("negative-mass", "error", subject, message, "give it a positive mass")]
    smallest, middle, largest = np.linalg.eigvalsh(inertia)
    rounding = _ROUNDING * abs(largest) + _POINT_LIKE * mass
    if smallest < -rounding:
        message = f"rotational inertia about the centre of mass has the negative principal moment {smallest:.6g} kg m²"
        remedy = "correct the tensor: it belongs about the centre of mass, in the axes of the <inertial> origin"
        return [Finding("inertia-indefinite", "warning" if merged else "error", subject, message, remedy)]
    if largest > smallest + middle + rounding:
        message = (
            f"principal moments {smallest:.6g}, {middle:.6g}, {largest:.6g} kg m² violate the triangle inequality: "
            f"no distribution of mass has them"
        )
        return [Finding("inertia-triangle", "warning", subject, message, "correct the tensor")]
    return []


def mimic(joint: str, of: str) -> Finding:
    """Return the finding that `joint` mimics `of`."""
    return Finding(
        "mimic-freed",
        "warning",
        f"joint '{joint}'",
        f"mimics '{of}' in the file and is an independent joint here: the coupling is not enforced",
        f"keep to positions in which it follows '{of}', or make the joint fixed",
    )


def of_parser(errors: list[str]) -> list[Finding]:
    """Return what the errors of Pinocchio's parser mean, which builds a model all the same."""
    found: list[Finding] = []
    reason = ""
    for error in errors:
        dropped = re.search(r"parse (inertial|visual|collision) element for Link \[(.*)\]", error)
        if dropped is None:
            if reason:
                found.append(_of_parser(reason))
            reason = error
            continue
        if dropped[1] == "inertial":
            message = f"its <inertial> cannot be read ({reason}), and the link would be taken as massless"
            remedy = "write every value of <mass>, <origin> and <inertia> as a plain finite number"
            found.append(Finding("inertial-unreadable", "error", f"link '{dropped[2]}'", message, remedy))
        else:
            message = f"its <{dropped[1]}> cannot be read ({reason}), and is left out"
            remedy = "correct it; it is for looks and contacts, dynamics do not need it"
            found.append(Finding("parser-error", "warning", f"link '{dropped[2]}'", message, remedy))
        reason = ""
    return [*found, _of_parser(reason)] if reason else found


def without_repetition(found: list[Finding]) -> tuple[Finding, ...]:
    """Return each kind of finding once for each link or joint: a body may repeat what its link has."""
    return tuple({(finding.code, finding.subject): finding for finding in reversed(found)}.values())[::-1]


def _of_parser(error: str) -> Finding:
    message = f"Pinocchio's parser says: {error}"
    drawn = any(word in error.lower() for word in ("material", "color", "rgba"))
    remedy = "correct the element; its value is not used as written"
    return Finding("parser-error", "warning" if drawn else "error", "file", message, remedy)


def link_of(model: pin.Model, j: int) -> str:
    """Name of the link that joint `j` carries."""
    for frame in model.frames:
        if frame.type == pin.FrameType.BODY and frame.parentJoint == j and frame.placement.isIdentity(1e-12):
            return str(frame.name)
    return str(model.names[j])

"""Proof that Pinocchio's model is what the file says: every body and joint against ospace's own reading."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pinocchio as pin

from ospace.exceptions import UrdfError
from ospace.joint_axis import joint_axis
from ospace.kernels.tables import Floats
from ospace.urdf.bodies import Body
from ospace.urdf.description import Joint

_TOLERANCE = 1e-10
"""Share by which a placement or inertia may differ: rounding over a chain of 2000 fixed joints leaves 1e-12."""
_TYPES = {
    "revolute": ("RX", "RY", "RZ", "RevoluteUnaligned"),
    "continuous": ("RUBX", "RUBY", "RUBZ", "RevoluteUnboundedUnaligned"),
    "prismatic": ("PX", "PY", "PZ", "PrismaticUnaligned"),
    "planar": ("Planar",),
    "floating": ("FreeFlyer",),
}


def prove(path: Path, bodies: Sequence[Body], model: pin.Model) -> None:
    """Compare the model with the bodies of the file.

    Raises
    ------
    UrdfError
        They differ: the model is not what the file says.
    """
    difference = next(_differences(bodies, model), None)
    if difference is not None:
        raise UrdfError(path, f"Pinocchio's model is not what the file says: {difference}; please report it", "parity")


def _differences(bodies: Sequence[Body], model: pin.Model) -> Iterator[str]:
    if model.njoints != len(bodies) + 1:
        yield f"{model.njoints - 2} joints instead of {len(bodies) - 1}"
        return
    names = list(model.names)
    number = {"": 1} | {name: j for j, name in enumerate(names) if j > 1}
    at = ["" if body.joint is None else body.joint.name for body in bodies]
    mass = sum(body.mass for body in bodies)
    total = sum(inertia.mass for inertia in model.inertias)
    if not _near(mass, total, sum(abs(body.mass) for body in bodies)):
        yield f"total mass {total:.12g} kg instead of {mass:.12g} kg"
    for body, name in zip(bodies, at, strict=True):
        if name not in number:
            yield f"no joint '{name}'"
            continue
        j = number[name]
        yield from _of_body(body, model.inertias[j])
        if body.joint is not None:
            if model.parents[j] != number[at[body.parent]]:
                yield f"{body.joint.subject} hangs from '{names[model.parents[j]]}'"
            yield from _of_placement(body, model.jointPlacements[j])
            yield from _of_joint(body.joint, model, j)


def _of_body(body: Body, inertia: pin.Inertia) -> Iterator[str]:
    if not _near(body.mass, inertia.mass, body.mass):
        yield f"mass {inertia.mass:.12g} kg of {body.subject} instead of {body.mass:.12g} kg"
    reach = float(np.abs(body.centre).max()) + math.sqrt(body.size / body.mass) if body.mass > 0.0 else 0.0
    if body.mass > 0.0 and not _near(body.centre, inertia.lever, reach):
        yield f"centre of mass {inertia.lever} of {body.subject} instead of {body.centre}"
    if not _near(body.tensor, inertia.inertia, body.size):
        yield f"inertia {inertia.inertia.tolist()} of {body.subject} instead of {body.tensor.tolist()}"


def _of_placement(body: Body, placed: pin.SE3) -> Iterator[str]:
    reach = 1e-3 + float(np.abs(body.translation).max())
    if not _near(body.rotation, placed.rotation, 1.0) or not _near(body.translation, placed.translation, reach):
        yield f"joint of {body.subject} lies at {placed} instead of {body.translation}, {body.rotation.tolist()}"


def _of_joint(joint: Joint, model: pin.Model, j: int) -> Iterator[str]:
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
    wanted = {"effort": (model.effortLimit[v], effort), "velocity": (model.velocityLimit[v], velocity)}
    if joint.kind != "continuous":
        lower, upper = (-math.inf, math.inf) if limit is None else (limit.lower, limit.upper)
        wanted |= {"lower": (model.lowerPositionLimit[q], lower), "upper": (model.upperPositionLimit[q], upper)}
    wanted |= {"damping": (model.damping[v], joint.damping)}
    for name, (there, meant) in wanted.items():
        if there != meant:
            yield f"{name} {there} of {joint.subject} instead of {meant}"


def _near(wanted: Floats | float, there: Floats | float, scale: float) -> bool:
    return bool(np.all(np.abs(np.subtract(wanted, there)) <= _TOLERANCE * scale))

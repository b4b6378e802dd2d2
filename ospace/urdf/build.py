"""From a description to Pinocchio's model, by way of a URDF that holds nothing but what dynamics need."""

from __future__ import annotations

import math
import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.urdf.bodies import plane_axes
from ospace.urdf.description import Description, Inertial, Joint, Link, Pose
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, make_finding

_BASE_NQ, _BASE_NV = 7, 6
_LARGEST = sys.float_info.max  # Pinocchio's parser knows no infinity
_STACK = 64 * 2**20  # bytes: Pinocchio's parser calls itself from link to link, and the caller's stack may be small
_PROCESS_LOCK = threading.Lock()  # standard error and the size of new stacks are the whole process's


def build(path: Path, description: Description) -> tuple[pin.Model, list[Finding]]:
    """Build the model with a free-flyer, fixed joints merged.

    Returns
    -------
    pin.Model
    list of Finding
        On what its parser wrote to standard error.

    Raises
    ------
    UrdfError
        Pinocchio rejects the robot.
    """
    model, errors = _parsed(to_xml(description), _unused_name(description))
    if model is None:
        raise UrdfError(path, f"Pinocchio rejects it: {'; '.join(errors)}", "rejected")
    for joint in description.joints:
        if joint.kind == "planar":
            _turn_plane(model, list(model.names).index(joint.name, 2), plane_axes(joint.axis))
    return model, [make_finding("parser-error", "file", f"Pinocchio's parser says: {error}") for error in errors]


def build_original(content: bytes, description: Description, *, has_free_flyer: bool) -> tuple[pin.Model | None, str]:
    """Build the model from the file itself, as Pinocchio's parser reads it.

    Parameters
    ----------
    content : bytes
        Of a file whose links form one tree: on others the parser may not come back.
    description : Description
        All links and joints of the file.
    has_free_flyer : bool
        Whether the file has a floating joint for the base.

    Returns
    -------
    pin.Model or None
        None where Pinocchio rejects the file.
    str
        The errors that its parser wrote to standard error.
    """
    model, errors = _parsed(content.decode("utf-8-sig"), None if has_free_flyer else _unused_name(description))
    return model, "; ".join(errors)


def _parsed(xml: str, base: str | None) -> tuple[pin.Model | None, list[str]]:
    """Let Pinocchio's parser read; return the model with limits that may be infinite, and the errors it wrote."""
    model, reason = None, ""
    free_flyer = () if base is None else (pin.JointModelFreeFlyer(), base)
    with _PROCESS_LOCK, _captured_stderr() as lines:
        try:
            model = _on_large_stack(lambda: pin.buildModelFromXML(xml, *free_flyer))
        except (ValueError, RuntimeError) as error:
            reason = " ".join(str(error).split())
    errors = [" ".join(line.split()).removeprefix("Error: ") for line in lines if line.strip().startswith("Error")]
    if model is None:
        return None, errors or [reason]
    for limits in (
        model.lowerPositionLimit[_BASE_NQ:],
        model.upperPositionLimit[_BASE_NQ:],
        model.effortLimit[_BASE_NV:],
        model.velocityLimit[_BASE_NV:],
    ):
        limits[np.abs(limits) == _LARGEST] *= np.inf
    return model, errors


def _turn_plane(model: pin.Model, j: int, axes: Floats) -> None:
    """Turn the frame of planar joint `j` to `axes`, and what it carries back: Pinocchio's moves in its x-y plane."""
    turn = pin.SE3(axes, np.zeros(3))
    model.jointPlacements[j] = model.jointPlacements[j] * turn
    model.inertias[j] = turn.actInv(model.inertias[j])
    for child in model.children[j]:
        model.jointPlacements[child] = turn.actInv(model.jointPlacements[child])
    for frame in model.frames:
        if frame.parentJoint == j:
            frame.placement = turn.actInv(frame.placement)


def to_xml(description: Description) -> str:
    """Write links with their inertials, and joints, as a URDF; numbers keep every digit. No joint mimics another.

    Returns
    -------
    str
    """
    parts = [f"<robot name={quoteattr(description.name)}>"]
    parts += map(_link, description.links)
    parts += map(_joint, description.joints)
    return "".join([*parts, "</robot>"])


def _link(link: Link) -> str:
    inertial = "" if link.inertial is None else _inertial(link.inertial)
    return f"<link name={quoteattr(link.name)}>{inertial}</link>"


def _inertial(inertial: Inertial) -> str:
    keys = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    tensor = " ".join(f'{key}="{value!r}"' for key, value in zip(keys, inertial.tensor, strict=True))
    return f'<inertial>{_origin(inertial.pose)}<mass value="{inertial.mass!r}"/><inertia {tensor}/></inertial>'


def _joint(joint: Joint) -> str:
    text = (
        f'<joint name={quoteattr(joint.name)} type="{joint.kind}">{_origin(joint.pose)}'
        f"<parent link={quoteattr(joint.parent)}/><child link={quoteattr(joint.child)}/>"
    )
    if joint.kind in ("fixed", "floating"):
        return text + "</joint>"
    if joint.limit is None:
        limits = {"lower": -math.inf, "upper": math.inf, "effort": math.inf, "velocity": math.inf}
    else:
        limit = joint.limit
        limits = {"lower": limit.lower, "upper": limit.upper, "effort": limit.effort, "velocity": limit.velocity}
    bounds = " ".join(f'{key}="{max(-_LARGEST, min(_LARGEST, value))!r}"' for key, value in limits.items())
    return (
        f'{text}<axis xyz="{_joined(joint.axis)}"/><limit {bounds}/>'
        f'<dynamics damping="{joint.damping!r}" friction="{joint.friction!r}"/></joint>'
    )


def _origin(pose: Pose) -> str:
    return f'<origin xyz="{_joined(pose.xyz)}" rpy="{_joined(pose.rpy)}"/>'


def _joined(values: tuple[float, ...]) -> str:
    return " ".join(map(repr, values))


def _unused_name(description: Description) -> str:
    """Choose a name for the free-flyer that no joint of the file bears: else that joint would be welded to the base."""
    name = "root_joint"
    while name in description.joint or name in description.link:
        name += "_"
    return name


def _on_large_stack(call: Callable[[], pin.Model]) -> pin.Model:
    before = threading.stack_size(_STACK)
    try:
        with ThreadPoolExecutor(1) as pool:
            try:
                parsed = pool.submit(call)
            except RuntimeError as error:  # that no thread can be started says nothing of the file
                raise MemoryError(str(error)) from None
            return parsed.result()
    finally:
        threading.stack_size(before)


@contextmanager
def _captured_stderr() -> Iterator[list[str]]:
    """Catch what C++ writes to file descriptor 2; its lines are in the yielded list afterwards."""
    lines: list[str] = []
    if sys.stderr is not None:
        sys.stderr.flush()
    _occupy_stderr()
    with tempfile.TemporaryFile() as catch:
        saved = os.dup(2)
        os.dup2(catch.fileno(), 2)
        try:
            yield lines
        finally:
            os.dup2(saved, 2)
            os.close(saved)
            catch.seek(0)
            lines += catch.read().decode(errors="replace").splitlines()


def _occupy_stderr() -> None:
    """Open file descriptor 2 where it is closed: else the next file that is opened would take what C++ writes."""
    try:
        os.fstat(2)
    except OSError:
        null = os.open(os.devnull, os.O_WRONLY)
        if null != 2:
            os.dup2(null, 2)
            os.close(null)

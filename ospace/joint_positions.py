"""Joint positions as people say them, and as `q` holds them."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tables import Floats

Position: TypeAlias = float | Floats | Any
"""Angle or displacement; (x, y, θ) of a planar joint; `pin.SE3` of a floating one; Pinocchio's numbers of any other."""


def _kind(joint: pin.JointModel) -> str:
    if joint.nq == joint.nv == 1:
        return "scalar"
    if joint.nq == 2 and joint.nv == 1:
        return "angle"
    return {"JointModelPlanar": "planar", "JointModelFreeFlyer": "pose"}.get(joint.shortname(), "raw")


def to_q(joint: pin.JointModel, name: str, value: Position) -> Floats:
    """Return the part of `q` that puts the joint at `value`; raises `OspaceError` if the value is of the wrong kind."""
    kind = _kind(joint)
    if kind == "pose":
        if not isinstance(value, pin.SE3):
            raise OspaceError(f"joint '{name}' floats: give its pose as a pin.SE3")
        numbers = pin.SE3ToXYZQUAT(value)
    else:
        wanted = {"scalar": 1, "angle": 1, "planar": 3}.get(kind, joint.nq)
        if isinstance(value, pin.SE3):
            raise OspaceError(f"joint '{name}' takes {wanted} number(s), not a pose")
        try:
            numbers = np.atleast_1d(np.asarray(value, dtype=float))
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.shape != (wanted,):
            raise OspaceError(f"joint '{name}' takes {wanted} number(s), got {value!r}")
    if not np.isfinite(numbers).all():
        raise OspaceError(f"position of joint '{name}' is not finite: {value!r}")
    if kind in ("angle", "planar"):
        numbers = np.r_[numbers[:-1], np.cos(numbers[-1]), np.sin(numbers[-1])]
    return np.asarray(numbers, dtype=float)


def from_q(joint: pin.JointModel, numbers: Floats) -> Position:
    """Return the position that `numbers`, the joint's part of `q`, stand for."""
    kind = _kind(joint)
    if kind == "scalar":
        return float(numbers[0])
    if kind == "angle":
        return float(np.arctan2(numbers[1], numbers[0]))
    if kind == "planar":
        return np.array([numbers[0], numbers[1], np.arctan2(numbers[3], numbers[2])])
    return pin.XYZQUATToSE3(numbers) if kind == "pose" else numbers.copy()

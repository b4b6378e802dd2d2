"""User-facing joint coordinates, the numbers of `q` they stand for, and their limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import real_numbers
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.quantities import parse

Position: TypeAlias = float | str | Floats | Any
"""Angle or displacement, also as text with a unit, ``"20 deg"``; (x, y, θ) of a planar joint; `pin.SE3` of a floating
one; Pinocchio's numbers of any other."""
ROUNDING = 1e-9
"""Excess over a limit that counts as rounding, rad or m."""
_IN_METRES = ("PX", "PY", "PZ", "PrismaticUnaligned", "Translation", "Planar", "FreeFlyer")
_NO_LIMIT = 1e6  # rad or m: files write 1e9 or 999999999 for a limit that is never reached


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
            numbers = np.atleast_1d(real_numbers(in_si(joint, name, value)))
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.shape != (wanted,):
            raise OspaceError(f"joint '{name}' takes {wanted} number(s), got {value!r}")
    if not np.isfinite(numbers).all():
        raise OspaceError(f"position of joint '{name}' is not finite: {value!r}")
    if kind in ("angle", "planar"):
        numbers = np.r_[numbers[:-1], np.cos(numbers[-1]), np.sin(numbers[-1])]
    return np.asarray(numbers, dtype=float)


def in_si(joint: pin.JointModel, name: str, value: Position) -> Position:
    """Return a position with text read, as ``"20 deg"``, in rad or m; raises `OspaceError` for text of another kind."""
    if isinstance(value, list | tuple):
        first = ("length", "length") if _kind(joint) == "planar" else ()
        dimensions = (*first, *("angle" if first else _dimension(joint),) * len(value))
        return [_read(name, one, dimension) for one, dimension in zip(value, dimensions, strict=False)]
    return _read(name, value, _dimension(joint))


def _read(name: str, value: Any, dimension: str) -> Any:
    if not isinstance(value, str):
        return value
    try:
        return parse(value, dimension)
    except ValueError as error:
        raise OspaceError(f"position of joint '{name}': {error}") from None


def _dimension(joint: pin.JointModel) -> str:
    return "length" if unit_of(joint) == "m" else "angle"


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


@dataclass(frozen=True, eq=False)
class BoundedCoordinates:
    """The coordinates of `q` that a limit can bound: all but rotations kept as quaternions or as (cos, sin).

    Attributes
    ----------
    index : (k,)
        Where they stand in `q`.
    joint : (k,)
        Number of the joint that each belongs to, by Pinocchio's count.
    """

    index: npt.NDArray[np.int64]
    joint: npt.NDArray[np.int64]

    @classmethod
    def of(cls, model: pin.Model) -> BoundedCoordinates:
        """Collect those of all joints behind the base."""
        places = [(model.idx_qs[j] + k, j) for j in range(2, model.njoints) for k in range(_straight(model.joints[j]))]
        index, joint = np.array(places, dtype=np.int64).reshape(-1, 2).T
        return cls(index, joint)

    def limits(self, model: pin.Model) -> tuple[Floats, Floats]:
        """Return lower and upper limits (k,); infinite where reversed ones or NaN allow no position at all."""
        lower, upper = model.lowerPositionLimit[self.index], model.upperPositionLimit[self.index]
        usable = lower <= upper
        return np.where(usable, lower, -np.inf), np.where(usable, upper, np.inf)

    def excess(self, model: pin.Model, q: Floats) -> Floats:
        """Return how far the coordinates (..., k) of `q` (..., nq) are beyond a limit, rad or m; not above 0 inside."""
        lower, upper = self.limits(model)
        here = q[..., self.index]
        return np.maximum(lower - here, here - upper)

    def nearest_to_zero(self, model: pin.Model) -> Floats:
        """Return positions (k,) inside the limits: zero, or else the middle of the range, or its one bound."""
        lower, upper = self.limits(model)
        nearest: Floats = np.clip(0.0, lower, upper)
        ranged = (nearest != 0.0) & (lower > -_NO_LIMIT) & (upper < _NO_LIMIT)
        nearest[ranged] = 0.5 * (lower[ranged] + upper[ranged])
        return nearest


def unit_of(joint: pin.JointModel) -> str:
    """Return the unit of the joint's positions: m for those that slide, else rad."""
    return "m" if joint.shortname().removeprefix("JointModel") in _IN_METRES else "rad"


def in_unit(amount: float, unit: str) -> str:
    """Write an amount with its unit, angles in degrees as well, as in "0.0698 rad (4 deg)"."""
    degrees = f" ({np.rad2deg(amount):.3g} {unit.replace('rad', 'deg')})" if unit.startswith("rad") else ""
    return f"{amount:.3g} {unit}{degrees}"


def excess_text(model: pin.Model, beyond: Mapping[str, float]) -> str:
    """Write what `SpaceRobot.outside_limits` returns, as in "'elbow' by 0.0698 rad (4 deg), 'boom' by 0.02 m"."""
    return with_units(beyond, joint_units(model))


def joint_units(model: pin.Model) -> dict[str, str]:
    """Return the unit of the position of each joint by its name: rad, or m."""
    return {name: unit_of(joint) for name, joint in zip(model.names, model.joints, strict=True)}


def with_units(beyond: Mapping[str, float], unit: Mapping[str, str]) -> str:
    """Write by how much joints are beyond something, in the unit of each, angles in degrees as well."""
    return ", ".join(f"'{name}' by {in_unit(excess, unit[name])}" for name, excess in beyond.items())


def norm_error(model: pin.Model, j: int, Q: Floats) -> Floats:
    """Return how far the quaternion or the (cos, sin) pair of joint `j` is from unit length in each row of `Q` (N, nq).

    Zero for joints without one; of a joint composed of several, the most that unit length changes a coordinate.
    """
    joint, first = model.joints[j], int(model.idx_qs[j])
    if joint.nq == joint.nv:
        return np.zeros(len(Q))
    own = slice(first, first + joint.nq)
    if joint.shortname() == "JointModelComposite":
        return np.array([np.abs(pin.normalize(model, q) - q)[own].max() for q in Q])
    return np.asarray(np.abs(np.hypot.reduce(Q[:, own][:, _straight(joint) :], axis=1) - 1.0))


def _straight(joint: pin.JointModel) -> int:
    """Return how many of the joint's first coordinates are lengths or plain angles."""
    if joint.nq == joint.nv:
        return int(joint.nq)
    return {"planar": 2, "pose": 3}.get(_kind(joint), 0)

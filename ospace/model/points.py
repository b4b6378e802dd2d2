"""Operational points: frames of a robot, with an offset and a choice of rows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Ints
from ospace.model.layout import Layout

Axes = str | Sequence[bool]
ROW_NAMES = ("x", "y", "z", "rx", "ry", "rz")
_NAMED_AXES = {"all": (True,) * 6, "linear": (True,) * 3 + (False,) * 3, "angular": (False,) * 3 + (True,) * 3}


@dataclass(frozen=True, eq=False)
class OperationalPoint:
    """A point fixed to a link, and the rows of its motion that count; made by `SpaceRobot.point`.

    It belongs to the one robot that made it, and everything that takes a point refuses another robot's. So a copy of
    the robot takes points of its own: copy or pickle them in one go, as ``pickle.dumps((robot, point))``.

    Attributes
    ----------
    robot : SpaceRobot
    frame : str
        The frame's name.
    axes : tuple of 6 bool
        Rows taken: x, y, z, then rotation about x, y, z; inertial axes.
    joint : int
        Pinocchio's number of the joint that carries the point.
    placement : pin.SE3
        The point in the joint's frame, offset included.
    """

    robot: Layout = field(repr=False)
    frame: str
    axes: tuple[bool, ...]
    joint: int = field(repr=False)
    placement: pin.SE3 = field(repr=False)

    def __repr__(self) -> str:
        named = next((name for name, taken in _NAMED_AXES.items() if taken == self.axes), None)
        rows = (
            f"'{named}'"
            if named
            else ", ".join(name for name, taken in zip(ROW_NAMES, self.axes, strict=True) if taken)
        )
        offset = self.robot.frame(self.frame).placement.actInv(self.placement)
        shown = ""
        if not offset.isIdentity(1e-12):
            at, turn = (
                np.round(offset.translation, 6) + 0.0,
                np.round(np.rad2deg(pin.rpy.matrixToRpy(offset.rotation)), 4),
            )
            shown = f", offset=({', '.join(f'{x:g}' for x in at)}) m"
            shown += f", rpy ({', '.join(f'{x:g}' for x in turn + 0.0)}) deg" if turn.any() else ""
        return f"OperationalPoint('{self.frame}', {rows}{shown})"

    @cached_property
    def key(self) -> tuple[int, tuple[bool, ...], bytes]:
        """Numbers that kernels know of the point: equal for points that they cannot tell apart."""
        return self.joint, self.axes, np.asarray(self.placement.homogeneous).tobytes()

    @property
    def n_rows(self) -> int:
        """Rows that the point takes."""
        return sum(self.axes)

    @property
    def row_names(self) -> list[str]:
        """Names of the rows taken, as ``'hand.x'``."""
        return [f"{self.frame}.{name}" for name, taken in zip(ROW_NAMES, self.axes, strict=True) if taken]


def parse_axes(axes: Axes) -> tuple[bool, ...]:
    """Return six booleans for a name or six booleans; raises `OspaceError` for anything else."""
    if isinstance(axes, str):
        if axes not in _NAMED_AXES:
            raise OspaceError(f"axes '{axes}' is unknown: give 'all', 'linear', 'angular' or six booleans")
        return _NAMED_AXES[axes]
    try:
        taken = np.asarray(axes)
    except ValueError:
        taken = np.empty(0)
    if taken.shape != (6,) or not np.isin(taken, (0, 1)).all():
        raise OspaceError(f"axes {axes!r}: give 'all', 'linear', 'angular' or six booleans (x, y, z, rx, ry, rz)")
    if not taken.any():
        raise OspaceError("axes takes no row: at least one of the six must be True")
    return tuple(bool(one) for one in taken)


def check_owner(robot: Layout, point: OperationalPoint) -> None:
    """Raise `OspaceError` where `point` is another robot's, or not an `OperationalPoint`.

    A copy of a robot is another robot. Points and states that are copied or pickled in one go with their robot stay
    with it.
    """
    if not isinstance(point, OperationalPoint):
        raise _not_a_point(point)
    if point.robot is robot:
        return
    if point.robot.name == robot.name:
        raise OspaceError(
            f"point '{point.frame}' belongs to another robot, which bears the name '{robot.name}' as well: make it "
            f"with the point() of this one, or copy and pickle a robot in one go with its points"
        )
    raise OspaceError(
        f"point '{point.frame}' belongs to another robot ('{point.robot.name}'): "
        f"make it with the point() of the robot whose state is used ('{robot.name}')"
    )


def _not_a_point(given: object) -> OspaceError:
    return OspaceError(f"{given!r} is not an OperationalPoint: make one with robot.point('frame name')")


def points_of(robot: Layout, points: OperationalPoint | Sequence[OperationalPoint]) -> tuple[OperationalPoint, ...]:
    """Return `points` as a tuple; raises `OspaceError` where there is none, or one that `check_owner` refuses."""
    try:
        given = (points,) if isinstance(points, OperationalPoint) else tuple(points)
    except TypeError:
        raise _not_a_point(points) from None
    if not given:
        raise OspaceError("no operational point given: make one with robot.point('frame name')")
    for point in given:
        check_owner(robot, point)
    return given


def rows_of(points: Sequence[OperationalPoint]) -> Ints:
    """Return the rows that the points take, (r,), out of six for each."""
    return np.flatnonzero([taken for point in points for taken in point.axes])

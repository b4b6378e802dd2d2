"""A point follows a pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from ospace.control.tasks.task import Task, chosen
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes, OperationalPoint
from ospace.model.robot import SpaceRobot

AXES_IN = ("inertial", "point")
"""Whose axes the rows of a task are along and about."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseTask(Task):
    """Place and orientation of a point follow the reference; rows x, y, z and rotation about x, y, z.

    Attributes
    ----------
    point : OperationalPoint
    axes : "all", "linear", "angular" or six booleans
    axes_in : "inertial" or "point"
        Whose axes these are. A tool that may roll takes all but the rotation about its own z, say; the axis that it
        may roll about is then brought in line with the same axis of the reference, however far it has rolled.

    Raises
    ------
    OspaceError
        `axes_in` is neither.
    """

    point: OperationalPoint
    axes: Axes = "all"
    axes_in: Literal["inertial", "point"] = "inertial"

    kind: ClassVar[int] = kernel.MOTION
    geometric: ClassVar[bool] = True
    offered: ClassVar[tuple[int, ...]] = (0, 1, 2, 3, 4, 5)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.axes_in not in AXES_IN:
            raise OspaceError(f"task '{self.name}': axes_in is {self.axes_in!r}: give 'inertial' or 'point'")

    @property
    def own_axes(self) -> bool:
        """True where `axes_in` is "point"."""
        return self.axes_in == "point"

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """The one point."""
        return (self.point,)

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of six components."""
        return chosen(self.name, self.axes, self.offered)

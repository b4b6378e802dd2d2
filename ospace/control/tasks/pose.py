"""A point follows a pose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ospace.control.tasks.task import Task, chosen
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes, OperationalPoint
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class PoseTask(Task):
    """Place and orientation of a point follow the reference; rows x, y, z and rotation about x, y, z, inertial axes.

    Attributes
    ----------
    point : OperationalPoint
    axes : "all", "linear", "angular" or six booleans
    """

    point: OperationalPoint
    axes: Axes = "all"

    kind: ClassVar[int] = kernel.MOTION
    geometric: ClassVar[bool] = True
    offered: ClassVar[tuple[int, ...]] = (0, 1, 2, 3, 4, 5)

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """The one point."""
        return (self.point,)

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of six components."""
        return chosen(self.name, self.axes, self.offered)

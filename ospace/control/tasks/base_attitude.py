"""The base follows an orientation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import pinocchio as pin

from ospace.control.tasks.task import Task, chosen
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes, OperationalPoint
from ospace.model.robot import SpaceRobot


def base_point(robot: SpaceRobot) -> OperationalPoint:
    """Return the base-link frame's origin as a point."""
    return OperationalPoint(robot, "base", (True,) * 6, 1, pin.SE3.Identity())


@dataclass(frozen=True, kw_only=True, eq=False)
class BaseAttitudeTask(Task):
    """The orientation of the base follows that of the reference; rotation about x, y, z, inertial axes.

    A freely floating base is turned by the joints alone.

    Attributes
    ----------
    robot : SpaceRobot
    axes : "all", "angular" or six booleans
    """

    robot: SpaceRobot
    axes: Axes = "angular"

    kind: ClassVar[int] = kernel.MOTION
    geometric: ClassVar[bool] = True

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """The base."""
        return (base_point(self.robot),)

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of six components."""
        return chosen(self.name, self.axes, (3, 4, 5))

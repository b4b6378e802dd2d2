"""A point follows a pose as seen from another point of the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pinocchio as pin

from ospace.control.tasks.task import Task, chosen
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes, OperationalPoint
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class RelativePoseTask(Task):
    """The pose of a point as seen from a second one follows the reference, which is in the second one's axes.

    Rows are those of the relative motion in inertial axes.

    Attributes
    ----------
    point, seen_from : OperationalPoint
    axes : "all", "linear", "angular" or six booleans
    """

    point: OperationalPoint
    seen_from: OperationalPoint
    axes: Axes = "all"

    kind: ClassVar[int] = kernel.RELATIVE
    geometric: ClassVar[bool] = True

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """The point, and the one that it is seen from."""
        return (self.point, self.seen_from)

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of six components."""
        return chosen(self.name, self.axes, (0, 1, 2, 3, 4, 5))

    def initial(self, poses: list[pin.SE3], mass_centre: np.ndarray) -> pin.SE3:
        """Return the pose of one as seen from the other."""
        return poses[1].actInv(poses[0])

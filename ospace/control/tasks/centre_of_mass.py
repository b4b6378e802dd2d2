"""The centre of mass follows a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pinocchio as pin

from ospace.control.base import Base
from ospace.control.tasks.task import Task, chosen
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class CentreOfMassTask(Task):
    """The centre of mass follows the place of the reference: by forces on the base, since joints do not move it.

    Attributes
    ----------
    axes : "all", "linear" or six booleans
    """

    axes: Axes = "linear"

    kind: ClassVar[int] = kernel.CENTRE_OF_MASS

    def check(self, robot: SpaceRobot, base: Base) -> None:
        """Refuse a base without forces."""
        if not (base.limits[:3] > 0.0).any():
            raise OspaceError(f"task '{self.name}': joints do not move the centre of mass; give a base with forces")

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of x, y, z."""
        return chosen(self.name, self.axes, (0, 1, 2))

    def initial(self, poses: list[pin.SE3], mass_centre: np.ndarray) -> pin.SE3:
        """Return where it is."""
        return pin.SE3(np.eye(3), mass_centre)

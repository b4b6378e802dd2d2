"""An axis of a point looks at a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pinocchio as pin

from ospace.checks import real_numbers
from ospace.control.tasks.task import Task
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class LookAtTask(Task):
    """An axis of a point looks at the place of the reference: two rows, turns across the line of sight.

    Attributes
    ----------
    point : OperationalPoint
    axis : (3,)
        What looks, in the point's axes; of any length but zero.

    Raises
    ------
    OspaceError
        The axis is not of three finite numbers, or is zero.
    """

    point: OperationalPoint
    axis: tuple[float, float, float] = (1.0, 0.0, 0.0)

    kind: ClassVar[int] = kernel.LOOK_AT
    geometric: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        try:
            axis = real_numbers(self.axis)
        except (TypeError, ValueError):
            axis = np.empty(0)
        if axis.shape != (3,) or not np.isfinite(axis).all() or not np.any(axis):
            raise OspaceError(f"task '{self.name}': axis {self.axis!r}: give three finite numbers, not all zero")

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """The point whose axis looks."""
        return (self.point,)

    @property
    def direction(self) -> Floats:
        """The axis, of unit length."""
        axis: Floats = np.asarray(self.axis) / np.linalg.norm(self.axis)
        return axis

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Two turns."""
        return [3, 4]

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Names of the rows."""
        return [f"{self.name}.across_1", f"{self.name}.across_2"]

    def initial(self, poses: list[pin.SE3], mass_centre: np.ndarray) -> pin.SE3:
        """Return a place 1 m ahead."""
        return pin.SE3(np.eye(3), poses[0].act(self.direction))

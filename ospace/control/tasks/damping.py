"""Joints come to rest."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ospace.control.tasks.task import Task
from ospace.exceptions import OspaceError
from ospace.kernels import tasks as kernel
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class DampingTask(Task):
    """Joint rates fall with the rate 2 ζ √stiffness, 1/s."""

    weight: float = 1e-3

    kind: ClassVar[int] = kernel.DAMPING

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.reference is not None:
            raise OspaceError(f"task '{self.name}': joints come to rest, there is no reference to follow")

    @property
    def gain(self) -> tuple[float, float]:
        """No stiffness; damping, 1/s."""
        return 0.0, 2.0 * self.damping_ratio * math.sqrt(self.stiffness)

    def rows(self, robot: SpaceRobot) -> list[int]:
        """All joints."""
        return list(range(robot.n_joints))

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Names of the rows."""
        return [f"{self.name}.{name}" for name in robot.rate_names]

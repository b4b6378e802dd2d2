"""Joints approach a posture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from ospace.checks import checked_number
from ospace.control.tasks.task import Task
from ospace.exceptions import OspaceError, closest
from ospace.kernels import tasks as kernel
from ospace.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class PostureTask(Task):
    """Joints approach a posture: with a small weight, what the null space of the other tasks is used for.

    Attributes
    ----------
    posture : mapping of joint name to position, optional
        rad, or m for prismatic joints; without it, all joints stay where they are in the first cycle.
    """

    posture: Mapping[str, float] | None = None
    weight: float = 1e-3

    kind: ClassVar[int] = kernel.POSTURE

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.reference is not None:
            raise OspaceError(f"task '{self.name}': give the posture by joint names, not a reference")
        for joint, position in (self.posture or {}).items():
            checked_number(position, f"task '{self.name}': the position of joint '{joint}'")

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Which joints."""
        if self.posture is None:
            return list(range(robot.n_joints))
        for name in self.posture:
            if name not in robot.joint_names:
                raise OspaceError(f"task '{self.name}': no joint '{name}'{closest(name, robot.joint_names)}")
        return [j for j, name in enumerate(robot.joint_names) if name in self.posture]

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Names of the rows."""
        return [f"{self.name}.{robot.joint_names[j]}" for j in self.rows(robot)]

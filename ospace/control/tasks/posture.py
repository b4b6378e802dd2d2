"""Joints approach a posture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin

from ospace.checks import checked_numbers
from ospace.control.base import Base
from ospace.control.references import Reference
from ospace.control.tasks.task import Completion, Task
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.kernels.tree import Floats, Ints
from ospace.model.joint_positions import Position, to_q
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class PostureTask(Task):
    """Joints approach a posture: with a small weight, what the null space of the other tasks is used for.

    Attributes
    ----------
    posture : mapping of joint name to position, optional
        rad, or m for prismatic joints, and as `SpaceRobot.configuration` takes it for any other; without it, all
        joints stay where they are in the first cycle.

    Raises
    ------
    OspaceError
        A reference is given: a posture is none.
    """

    posture: Mapping[str, Position] | None = None
    weight: float = 1e-3

    kind: ClassVar[int] = kernel.POSTURE

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.reference is not None:
            raise OspaceError(f"task '{self.name}': give the posture by joint names, not a reference")
        for joint, position in (self.posture or {}).items():
            if not isinstance(position, pin.SE3):
                checked_numbers(position, f"task '{self.name}': the position of joint '{joint}'")

    def check(self, robot: SpaceRobot, base: Base) -> None:
        """Raise `OspaceError` where the robot has no such joint, or the joint no such position."""
        self.write(robot, np.zeros(robot.nq))

    def write(self, robot: SpaceRobot, q: Floats) -> None:
        """Put the joints that the posture names at their positions in `q` (nq,)."""
        for name, position in (self.posture or {}).items():
            try:
                j = robot.joint_number(name)
                numbers = to_q(robot.model.joints[j], name, position)
            except OspaceError as error:
                raise OspaceError(f"task '{self.name}': {error}") from None
            q[robot.model.idx_qs[j] : robot.model.idx_qs[j] + robot.model.nqs[j]] = numbers

    def is_within(self, bounds: Completion, rows: Ints, error: Floats) -> bool:
        """Return whether no joint's `error` passes the angle of `bounds`."""
        return bool(np.abs(error).max(initial=0.0) <= bounds.angle)

    def redirected(self, reference: Reference | Mapping[str, Any]) -> PostureTask:
        """Return the same task with another posture; raises `OspaceError` for what is not one."""
        if not isinstance(reference, Mapping):
            raise OspaceError(f"task '{self.name}': give a posture by joint names")
        return replace(self, posture=reference)

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the joint rates."""
        model = robot.model
        named = [j for j in range(2, model.njoints) if self.posture is None or model.names[j] in self.posture]
        return [k - 6 for j in named for k in range(model.idx_vs[j], model.idx_vs[j] + model.nvs[j])]

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Names of the rows."""
        return [f"{self.name}.{robot.rate_names[j]}" for j in self.rows(robot)]

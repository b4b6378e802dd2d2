"""Joints come to rest."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ospace.control.references import Reference
from ospace.control.tasks.task import Completion, Task
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.kernels.tree import Floats, Ints
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class DampingTask(Task):
    """Joint rates fall with the rate 2 ζ √stiffness, 1/s.

    Attributes
    ----------
    reference : None
        Rates fall to zero; the other attributes are those of `Task`.

    Raises
    ------
    OspaceError
        A reference is given, or what `Task` refuses.
    """

    weight: float = 1e-3

    kind: ClassVar[int] = kernel.DAMPING

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.reference is not None:
            raise OspaceError(f"task '{self.name}': joints come to rest, there is no reference to follow")

    @property
    def units(self) -> None:
        """No error, but rates."""
        return None

    @property
    def gain(self) -> tuple[float, float]:
        """No stiffness; damping, 1/s."""
        return 0.0, 2.0 * self.damping_ratio * math.sqrt(self.stiffness)

    def is_within(self, bounds: Completion, rows: Ints, error: Floats) -> bool:
        """Return whether no joint's `error` passes the angle of `bounds`."""
        return bool(np.abs(error).max(initial=0.0) <= bounds.angle)

    def redirected(self, reference: Reference | Mapping[str, Any]) -> DampingTask:
        """Raise `OspaceError`: there is nothing to follow."""
        raise OspaceError(f"task '{self.name}' follows no such reference: {reference!r}")

    def rows(self, robot: SpaceRobot) -> list[int]:
        """All joints."""
        return list(range(robot.n_joints))

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Names of the rows."""
        return [f"{self.name}.{name}" for name in robot.rate_names]

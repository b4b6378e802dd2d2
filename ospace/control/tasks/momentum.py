"""Momentum approaches a value: dumped, or held."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ospace.control.base import Base
from ospace.control.references import MinimumJerk
from ospace.control.tasks.task import Task, chosen
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class MomentumTask(Task):
    """Linear momentum, and angular about the centre of mass, approach a value: the reference's `velocity`, or zero.

    The acceleration of a `Function` is the rate at which it changes. By wrenches on the base, since joints do not
    change it. Wheels take angular momentum from the robot; what they store is not counted here. The error falls with
    the rate √stiffness, 1/s; `damping_ratio` has no meaning.

    Attributes
    ----------
    axes : "all", "linear", "angular" or six booleans

    Raises
    ------
    OspaceError
        The reference is a `MinimumJerk`, or what `Task` refuses.
    """

    axes: Axes = "angular"

    kind: ClassVar[int] = kernel.MOMENTUM

    @property
    def units(self) -> tuple[str, str]:
        """Of momentum."""
        return "N s", "N m s"

    @property
    def gain(self) -> tuple[float, float]:
        """The rate, 1/s."""
        return math.sqrt(self.stiffness), 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.reference, MinimumJerk):
            raise OspaceError(f"task '{self.name}': a momentum follows a Constant or a Function")

    def check(self, robot: SpaceRobot, base: Base) -> None:
        """Refuse a base that nothing acts upon."""
        if not (base.limits > 0.0).any():
            raise OspaceError(f"task '{self.name}': joints do not change momentum; give a base with forces or torques")

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of six components."""
        return chosen(self.name, self.axes, (0, 1, 2, 3, 4, 5))

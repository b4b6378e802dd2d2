"""Momentum approaches a value: dumped, or held."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ospace.control.tasks.task import Task, chosen
from ospace.kernels import tasks as kernel
from ospace.points import Axes
from ospace.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class MomentumTask(Task):
    """Linear momentum, and angular about the centre of mass, approach the reference's `velocity`; zero without one.

    By wrenches on the base, since joints do not change it. Wheels take angular momentum from the robot; what they store
    is not counted here. The error falls with the rate √stiffness, 1/s; `damping_ratio` has no meaning.

    Attributes
    ----------
    axes : "all", "linear", "angular" or six booleans
    """

    axes: Axes = "angular"

    kind: ClassVar[int] = kernel.MOMENTUM

    @property
    def gain(self) -> tuple[float, float]:
        """The rate, 1/s."""
        return math.sqrt(self.stiffness), 0.0

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Which of six components."""
        return chosen(self.name, self.axes, (0, 1, 2, 3, 4, 5))

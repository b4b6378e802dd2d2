"""A point follows a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ospace.control.tasks.pose import PoseTask


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionTask(PoseTask):
    """The place of a point follows that of the reference; rows x, y, z.

    Attributes
    ----------
    point : OperationalPoint
    axes : "all", "linear", "angular" or six booleans
        Of the rows offered.
    axes_in : "inertial" or "point"
        As of `PoseTask`.
    """

    offered: ClassVar[tuple[int, ...]] = (0, 1, 2)

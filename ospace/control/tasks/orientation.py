"""A point follows an orientation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ospace.control.tasks.pose import PoseTask


@dataclass(frozen=True, kw_only=True, eq=False)
class OrientationTask(PoseTask):
    """The orientation of a point follows that of the reference; rotation about x, y, z.

    Attributes
    ----------
    point : OperationalPoint
    axes : "all", "linear", "angular" or six booleans
        Of the rows offered.
    axes_in : "inertial" or "point"
        As of `PoseTask`.
    """

    offered: ClassVar[tuple[int, ...]] = (3, 4, 5)

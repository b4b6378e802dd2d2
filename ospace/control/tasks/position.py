"""A point follows a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ospace.control.tasks.pose import PoseTask


@dataclass(frozen=True, kw_only=True, eq=False)
class PositionTask(PoseTask):
    """The place of a point follows that of the reference; rows x, y, z, inertial axes."""

    offered: ClassVar[tuple[int, ...]] = (0, 1, 2)

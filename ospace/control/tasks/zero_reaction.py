"""Joints leave the base in peace."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from ospace.control.references import Reference
from ospace.control.tasks.task import Task, chosen
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.model.points import Axes
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class ZeroReactionTask(Task):
    """The velocity that the joints give the base, rows of J_b* φ̇ (2), falls with the rate 2 ζ √stiffness, 1/s.

    What is left of the joints' motion lies in the reaction null space. The base is not brought back where it was, as by
    `BaseAttitudeTask`: momentum and wrenches move it on as they would move a robot whose joints do not react.

    Attributes
    ----------
    axes : "all", "linear", "angular" or six booleans
        Of ẋ_b, inertial axes, at the base-link frame's origin.
    reference : None
        The other attributes are those of `Task`; completion bounds are of m/s and rad/s.

    Raises
    ------
    OspaceError
        A reference is given, or what `Task` refuses.
    """

    axes: Axes = "angular"

    kind: ClassVar[int] = kernel.ZERO_REACTION

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.reference is not None:
            raise OspaceError(f"task '{self.name}': the base is left in peace, there is no reference to follow")

    @property
    def units(self) -> tuple[str, str]:
        """Of the velocity that the joints give the base."""
        return "m/s", "rad/s"

    @property
    def gain(self) -> tuple[float, float]:
        """No stiffness; damping, 1/s."""
        return 0.0, 2.0 * self.damping_ratio * math.sqrt(self.stiffness)

    def redirected(self, reference: Reference | Mapping[str, Any]) -> ZeroReactionTask:
        """Raise `OspaceError`: there is nothing to follow."""
        raise OspaceError(f"task '{self.name}' follows no such reference: {reference!r}")

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the taken ones of six components."""
        return chosen(self.name, self.axes, (0, 1, 2, 3, 4, 5))

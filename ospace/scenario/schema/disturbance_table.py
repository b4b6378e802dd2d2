"""Table of a disturbance: a wrench from outside that no controller knows of."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated

import numpy as np
from pydantic import Field

from ospace.kernels.tree import Floats
from ospace.scenario.schema.keys import unbounded_field, vector_field
from ospace.scenario.table import Problem, Table, Text
from ospace.scenario.units import Quantity, Time, Vector

ROBOT, TARGET = "robot", "target"
"""Names of the chaser, and of a target that has no other."""


class DisturbanceTable(Table):
    """A wrench from outside on a frame of the robot or of a target; inertial axes."""

    name: Text = Field(description="A name of its own")
    of: Text = Field(ROBOT, description="Whose frame it is: robot, target, or the name of a target")
    point: Text = Field(description="The frame at whose origin it acts")
    force: Annotated[Floats, Vector("force")] = vector_field("Force, inertial axes")
    torque: Annotated[Floats, Vector("torque")] = vector_field("Torque, inertial axes")
    start: Time = Field(0.0, description="When it begins, time of the run")
    duration: Annotated[float, Quantity("time", above=0.0, infinite=True)] = unbounded_field(
        "How long it acts; to the end of the run if it is left out"
    )
    frequency: Annotated[float, Quantity("frequency", least=0.0)] = Field(
        0.0, description="Of a sine that begins at zero and that force and torque are the amplitudes of; 0 is constant"
    )

    @property
    def wrench(self) -> Floats:
        """Force and torque (6,); N, N m."""
        return np.concatenate([self.force, self.torque])

    def at(self, time: float) -> Floats:
        """Return the wrench (6,) at a time (s), as if it never began nor ended."""
        if not self.frequency:
            return self.wrench
        return self.wrench * math.sin(2.0 * math.pi * self.frequency * (time - self.start))

    def share(self, time: float, step: float) -> float:
        """Return the share of a step of time from `time` on (s) in which it acts."""
        acts = min(time + step, self.start + self.duration) - max(time, self.start)
        return float(np.clip(acts / step, 0.0, 1.0))

    def mistakes(self) -> Iterable[Problem]:
        """Return whether it is none."""
        if not self.wrench.any() and not self._noted:
            yield self.key, f"'{self.name}' pushes nothing: give a force, a torque or both"

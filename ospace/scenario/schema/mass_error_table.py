"""Table of an error of masses: what the controller's model has otherwise than the robot."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from ospace.kernels.tree import Floats
from ospace.scenario.schema.disturbance_table import ROBOT
from ospace.scenario.schema.keys import vector_field
from ospace.scenario.table import Problem, Table, Text
from ospace.scenario.units import Quantity, Vector

_Relative = Annotated[float, Quantity("number", above=-1.0, most=100.0)]


class MassErrorTable(Table):
    """An error of the model that the controller has: by how much masses are more there than they are."""

    of: Text = Field(ROBOT, description="Whose links are meant: robot, target, or the name of a target")
    link: Text | None = Field(None, description="A link, with all that is fixed to it; all links if it is left out")
    mass: _Relative = Field(0.0, description="Of the mass, over the true one: 0.1 is 10 % more")
    inertia: _Relative | None = Field(
        None, description="Of the inertia about the mass centre, over the true one; as of the mass if it is left out"
    )
    mass_centre: Annotated[Floats, Vector("length")] = vector_field("Shift of the mass centre, axes of the link")

    def mistakes(self) -> Iterable[Problem]:
        """Yield what makes it none, or leaves open what is shifted."""
        if self._noted:
            return
        if not (self.mass or self.inertia or self.mass_centre.any()):
            yield self.key, "changes nothing: give mass, inertia or mass_centre"
        if self.mass_centre.any() and self.link is None:
            yield self.path("mass_centre"), "is in axes of a link: give link as well"

"""Tables of what a task follows: a pose, a shift, a frame of the target, a momentum; or to stay."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from ospace.kernels.tree import Floats
from ospace.scenario.schema.keys import PoseTable, default_table, vector_field
from ospace.scenario.table import Either, OneOf, Table, Text
from ospace.scenario.units import Angles, Lengths, Time, Vector


def _true(value: object) -> object:
    if value is not True:
        raise ValueError("give true, or leave it out")
    return value


class Hold(Table):
    """Stay; with a duration, come to rest within it."""

    hold: Annotated[Literal[True], BeforeValidator(_true)] = Field(description="true")
    duration: Time = Field(0.0, description="Of the motion")


class ToPose(PoseTable):
    """A pose in the inertial frame; what is None stays as it is at the phase's start."""

    duration: Time = Field(0.0, description="Of the motion")


class Shift(Table):
    """From where the point is at the phase's start, by so much; inertial axes."""

    shift: Lengths = vector_field("Displacement, inertial axes")
    turn: Angles = vector_field("Rotation vector, inertial axes")
    duration: Time = Field(0.0, description="Of the motion")


class Follow(Table):
    """A frame of the target, with an offset as seen from it."""

    follow: Text = Field(description="A frame of the target")
    offset: PoseTable = default_table(PoseTable, "Pose as seen from that frame")
    duration: Time = Field(0.0, description="Of the motion")


class ToMomentum(Table):
    """Linear momentum, and angular about the centre of mass."""

    linear: Annotated[Floats, Vector("momentum")] = vector_field("Linear momentum, inertial axes")
    angular: Annotated[Floats, Vector("angular momentum")] = vector_field(
        "Angular momentum about the centre of mass, inertial axes"
    )
    duration: ClassVar[float] = 0.0

    @property
    def momentum(self) -> Floats:
        """Linear and angular momentum (6,)."""
        return np.concatenate([self.linear, self.angular])


Goal = Hold | ToPose | Shift | Follow | ToMomentum
_GOALS = {
    "follow": {"follow"},
    "shift": {"shift", "turn"},
    "pose": {"position", "rpy", "quaternion"},
    "hold": {"hold"},
}
"""The keys of which a goal has one or more, and of the others none."""


def _goal_way(value: Any) -> str | None:
    if isinstance(value, str):
        return "text"
    ways = [way for way, keys in _GOALS.items() if isinstance(value, dict) and keys & value.keys()]
    return ways[0] if len(ways) == 1 else None


def _of_text(goal: Goal | str) -> Goal:
    if isinstance(goal, str):
        return ToMomentum() if goal == "zero" else Hold(hold=True, duration=0.0)
    return goal


MotionGoal = Annotated[
    Goal,
    Either(
        _goal_way,
        {
            "text": Annotated[str, OneOf(("hold",))],
            "hold": Hold,
            "pose": ToPose,
            "shift": Shift,
            "follow": Follow,
        },
        "give one of: follow; shift or turn; position, rpy or quaternion; hold",
    ),
    AfterValidator(_of_text),
]
MomentumGoal = Annotated[
    Goal,
    Either(
        lambda value: {str: "text", dict: "table"}.get(type(value)),
        {"text": Annotated[str, OneOf(("zero", "hold"))], "table": ToMomentum},
        "give 'zero', 'hold', or a table with linear, angular or both",
    ),
    AfterValidator(_of_text),
]


def goal_field(default: str = "hold") -> Any:
    """Return the field of a goal."""
    what = "What to follow from the phase's start on"
    return Field(default_factory=lambda: _of_text(default), description=what, json_schema_extra={"default": default})

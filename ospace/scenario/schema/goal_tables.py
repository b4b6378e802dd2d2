"""Tables of what a task follows: a pose, a shift, a frame of the target, a momentum; or to stay."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field

from ospace.kernels.tree import Floats
from ospace.scenario.schema.keys import PoseTable, default_table, vector_field
from ospace.scenario.table import Array, Either, Flag, OneOf, Problem, Table, Text
from ospace.scenario.units import Angles, Lengths, Quantity, Time, Vector


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
    about: Lengths | None = Field(
        None, description="A place on the axis that the point goes round by the turn: a circle, with a shift a helix"
    )
    turns_along: Flag = Field(True, description="On a circle, the point turns along; else it keeps its orientation")
    duration: Time = Field(0.0, description="Of the motion")

    def mistakes(self) -> Iterable[Problem]:
        """Yield what a circle lacks."""
        if self.about is None:
            if "turns_along" in self.model_fields_set:
                yield self.path("turns_along"), "is of a circle: give about, a place on its axis"
            return
        if not self.turn.any():
            yield self.path("about"), "a circle needs a turn, the rotation vector about its axis"
        if self.duration == 0.0:
            yield self.path("duration"), "a circle takes time: give a duration above 0 s"


class Via(Table):
    """Through poses in their order, the last of which is the goal."""

    via: Annotated[list[PoseTable], Array] = Field(
        description="Poses in the inertial frame; what one leaves out is as in the one before",
        json_schema_extra={"minItems": 1},
    )
    duration: Annotated[float, Quantity("time", above=0.0)] = Field(description="Of the motion")

    def mistakes(self) -> Iterable[Problem]:
        """Yield whether there is no pose, or one that says nothing."""
        if not self.via and not self._noted:
            yield self.path("via"), "give at least one pose"
        for one in self.via:
            if one.position is None and one.rotation is None and not one._noted:
                yield one.key, "give position, rpy or quaternion"


class Follow(Table):
    """A frame of the target, with an offset as seen from it."""

    follow: Text = Field(description="A frame of the target")
    target: Text | None = Field(None, description="Name of the target; needed where there are several")
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


Goal = Hold | ToPose | Shift | Via | Follow | ToMomentum
_GOALS = {
    "follow": {"follow"},
    "via": {"via"},
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
            "via": Via,
        },
        "give one of: follow; shift or turn; via; position, rpy or quaternion; hold",
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

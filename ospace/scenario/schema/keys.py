"""Parts of tables: types of keys, fields with their defaults, and poses."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
import pinocchio as pin
from pydantic import AfterValidator, ConfigDict, Field

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import unit_of
from ospace.model.robot import SpaceRobot
from ospace.scenario.table import Problem, Table
from ospace.scenario.units import Angles, Lengths, Quantity, Vector

_UNIT_LENGTH = 1e-3


def is_a(kind: type) -> Callable[[Any], str]:
    """Return what chooses between "is" and "else", by whether a value is of a kind."""
    return lambda value: "is" if isinstance(value, kind) else "else"


def _unit_quaternion(x: Floats) -> Floats:
    length = float(np.linalg.norm(x))
    if abs(length - 1.0) > _UNIT_LENGTH:
        raise ValueError(f"its length is {length:.6g}: give x, y, z, w of length 1")
    return np.asarray(x / length)


def vector_field(description: str, first: float = 0.0) -> Any:
    """Return the field of a vector that is zero, or along x, if it is left out."""
    default: list[Any] = [first, 0.0, 0.0]
    return Field(
        default_factory=lambda: np.array(default), description=description, json_schema_extra={"default": default}
    )


def default_table(kind: type[Table], description: str) -> Any:
    """Return the field of a table that has its defaults if it is left out."""
    return Field(default_factory=lambda: kind.model_validate({}), description=description)


def _without_default(schema: dict[str, Any]) -> None:
    del schema["default"]


def unbounded_field(description: str) -> Any:
    """Return the field of a bound that is infinite if it is left out; JSON has no number for that."""
    return Field(math.inf, description=description, json_schema_extra=_without_default)


Quaternion = Annotated[Floats, Vector("number", 4), AfterValidator(_unit_quaternion)]
Period = Annotated[float, Quantity("time", least=1e-6, most=10.0)]
Weight = Annotated[float, Quantity("number", least=0.0)]


@dataclass(frozen=True)
class ByJoint:
    """Type of a table from joint names to quantities, whose dimension is that of the joint."""

    linear: str
    angular: str
    above: float = -math.inf
    least: float = -math.inf

    def of(self, joint: str, robot: SpaceRobot) -> Quantity:
        """Return the type of a joint's quantity; raises `ValueError` for a joint with several degrees of freedom."""
        model = robot.model.joints[robot.joint_number(joint)]
        if model.nv > 1:
            raise ValueError(f"joint '{joint}' has {model.nv} degrees of freedom: a scenario sets joints with one")
        return Quantity(self.linear if unit_of(model) == "m" else self.angular, least=self.least, above=self.above)

    def read(self, given: Mapping[str, Any], robot: SpaceRobot, key: str) -> tuple[dict[str, float], list[Problem]]:
        """Return the quantities in SI units, and what is wrong with others."""
        values, problems = {}, []
        for name, value in given.items():
            try:
                values[name] = self.of(name, robot).read(value)
            except (OspaceError, ValueError) as error:
                problems.append((f"{key}.{name}", str(error)))
        return values, problems

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        of = [
            Quantity(one, least=self.least, above=self.above).__get_pydantic_json_schema__(core, handler)
            for one in (self.linear, self.angular)
        ]
        return {"type": "object", "additionalProperties": {"anyOf": of}}


POSITIONS = ByJoint("length", "angle")
RATES = ByJoint("velocity", "angular velocity")
ACCELERATIONS = ByJoint("acceleration", "angular acceleration", above=0.0)


class MadeTable(Table):
    """A table that an object of ospace is made of, which says itself what it cannot be."""

    @abstractmethod
    def make(self) -> Any:
        """Make the object."""

    def mistakes(self) -> Iterable[Problem]:
        """Return what the object refuses."""
        if not self._noted:
            try:
                self.make()
            except OspaceError as error:
                yield self.key, str(error)


class PoseTable(Table):
    """A pose; what is left out is zero."""

    model_config = ConfigDict(json_schema_extra={"not": {"required": ["rpy", "quaternion"]}})
    position: Lengths | None = Field(None, description="Place")
    rpy: Angles | None = Field(None, description="Roll, pitch and yaw, as in URDF")
    quaternion: Quaternion | None = Field(None, description="x, y, z, w, of length 1; instead of rpy")

    @property
    def rotation(self) -> Floats | None:
        """The rotation (3, 3), where one is given."""
        if self.quaternion is not None:
            return np.asarray(pin.Quaternion(self.quaternion).toRotationMatrix())
        return None if self.rpy is None else np.asarray(pin.rpy.rpyToMatrix(self.rpy))

    @property
    def pose(self) -> pin.SE3:
        """The pose."""
        rotation = np.eye(3) if self.rotation is None else self.rotation
        return pin.SE3(rotation, np.zeros(3) if self.position is None else self.position)

    def mistakes(self) -> Iterable[Problem]:
        """Return whether two rotations are given."""
        if {"rpy", "quaternion"} <= self.model_fields_set:
            yield self.path("quaternion"), "give rpy or quaternion, not both"

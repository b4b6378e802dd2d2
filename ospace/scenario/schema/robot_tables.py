"""Tables of the robot and of its target: model, pose, velocity, what acts on the base."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field

from ospace.control import Base
from ospace.control.base import MODES
from ospace.exceptions import closest
from ospace.kernels.tree import Floats
from ospace.scenario.schema.keys import POSITIONS, RATES, MadeTable, PoseTable, is_a, unbounded_field, vector_field
from ospace.scenario.table import Either, Flag, OneOf, Problem, Table, Text
from ospace.scenario.units import AngularVelocities, Lengths, Quantity, Vector, Velocities

_LEAST_MOMENT = 1e-9
"""Least principal moment of inertia of a target's body, kg m²."""
_TENSOR = ((0, 3, 4), (3, 1, 5), (4, 5, 2))
"""Places of ixx, iyy, izz, ixy, ixz, iyz in the tensor."""


def _per_axis(dimension: str) -> Either:
    """Return the type of one limit for all three axes, or of three."""
    largest = Annotated[float, Quantity(dimension, least=0.0, infinite=True)]
    return Either(is_a(list), {"is": Annotated[Floats, Vector(dimension)], "else": largest})


def _tensor(inertia: Floats) -> Floats:
    tensor = inertia if len(inertia) == 3 else np.array([[inertia[k] for k in row] for row in _TENSOR])
    if not np.abs(tensor if tensor.ndim == 1 else np.linalg.eigvalsh(tensor)).min() >= _LEAST_MOMENT:
        raise ValueError(f"principal moments must be at least {_LEAST_MOMENT:g} kg m^2")
    return tensor


Inertia = Annotated[
    Floats,
    Either(
        lambda value: "six" if isinstance(value, list) and len(value) == 6 else "three",
        {"three": Annotated[Floats, Vector("inertia")], "six": Annotated[Floats, Vector("inertia", 6)]},
    ),
    AfterValidator(_tensor),
]


def _amount(limit: float | Floats) -> float | tuple[float, float, float]:
    if isinstance(limit, float):
        return limit
    x, y, z = map(float, limit)
    return x, y, z


class BaseTable(MadeTable):
    """Thrusters and wheels of the base."""

    force: Annotated[float | Floats, _per_axis("force")] = Field(
        0.0, description="Largest along each base axis, or three"
    )
    torque: Annotated[float | Floats, _per_axis("torque")] = Field(
        0.0, description="Largest about each base axis, or three"
    )
    wheels: Flag = Field(False, description="Torques come of reaction wheels")
    wheel_momentum: Annotated[float, Quantity("angular momentum", above=0.0, infinite=True)] = unbounded_field(
        "Largest that wheels store about each base axis; no bound if it is left out"
    )

    def make(self) -> Base:
        """Make the base."""
        return Base(_amount(self.force), _amount(self.torque), self.wheels, self.wheel_momentum)


class RobotTable(PoseTable):
    """The chaser."""

    model: Text = Field(description="A URDF, relative to the scenario, or a robot that comes with ospace")
    free_mimic: Flag = Field(False, description="Joints that mimic others are independent of these")
    base: Annotated[
        BaseTable | str,
        Either(
            lambda value: {dict: "table", str: "mode"}.get(type(value)),
            {"table": BaseTable, "mode": Annotated[str, OneOf(tuple(MODES))]},
            f"give the name of a mode, or a table{closest('', MODES)}",
        ),
    ] = Field("floating", description="What acts on the base: nothing, all, forces, or torques of wheels; or a table")
    velocity: Velocities = vector_field("Of the base-link frame's origin, inertial axes")
    angular_velocity: AngularVelocities = vector_field("Of the base, inertial axes")
    joints: Annotated[dict[str, Any], POSITIONS] = Field({}, description="Position by joint name: angle or length")
    joint_rates: Annotated[dict[str, Any], RATES] = Field({}, description="Rate by joint name")

    def make_base(self) -> Base:
        """Make what acts on the base."""
        return self.base.make() if isinstance(self.base, BaseTable) else MODES[self.base]


class BodyTable(Table):
    """A rigid body."""

    mass: Annotated[float, Quantity("mass", least=1e-6)] = Field(description="Mass")
    inertia: Inertia = Field(
        description="About the mass centre: three principal moments, or ixx, iyy, izz, ixy, ixz, iyz"
    )
    mass_centre: Lengths = vector_field("Place of the mass centre, in axes of the body")
    name: Text = Field("target", description="Name")
    frames: dict[str, PoseTable] = Field({}, description="Pose by frame name")


class TargetTable(PoseTable):
    """Target of the chaser, or another body that moves by itself."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["model"]}, {"required": ["body"]}]})
    name: Text | None = Field(None, description="A name of its own; needed where there are several targets")
    model: Text | None = Field(None, description="A URDF, relative to the scenario, or a model that comes with ospace")
    free_mimic: Flag = Field(False, description="Joints that mimic others are independent of these")
    body: BodyTable | None = Field(None, description="The numbers of a rigid body, instead of model")
    spin: AngularVelocities = vector_field("About its mass centre, inertial axes")
    velocity: Velocities = vector_field("Of its mass centre, inertial axes")
    joints: Annotated[dict[str, Any], POSITIONS] = Field({}, description="Position by joint name; they have no drives")

    def mistakes(self) -> Iterable[Problem]:
        """Return whether there is not one of model and body."""
        yield from super().mistakes()
        if ("model" in self.model_fields_set) == ("body" in self.model_fields_set):
            yield self.key, "give either model, a URDF, or body, the numbers of a rigid body"

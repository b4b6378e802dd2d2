"""Quantities with units: types of a scenario's keys, with dimension and bounds, in SI units once they are read."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from ospace.kernels.tree import Floats
from ospace.quantities import NUMBER, UNITS, parse, shown

LARGEST: dict[str, float] = {
    "length": 1e9,
    "angle": 1e4,
    "time": 1e8,
    "velocity": 1e6,
    "angular velocity": 1e4,
    "acceleration": 1e6,
    "angular acceleration": 1e6,
    "mass": 1e9,
    "inertia": 1e15,
    "force": 1e9,
    "torque": 1e9,
    "momentum": 1e12,
    "angular momentum": 1e15,
    "stiffness": 1e8,
    "frequency": 1e6,
    "number": 1e6,
}
"""The largest amounts that a scenario may have, SI: beyond these, a run would show rounding and overflow alone."""


@dataclass(frozen=True)
class Quantity:
    """Type of a key whose value is a quantity.

    Attributes
    ----------
    dimension : str
        A key of `UNITS`.
    least, above, most : float
        Bounds, SI units; `least` and `most` are allowed, `above` is not. The largest amount is that of the dimension
        where `most` is left out.
    infinite : bool
        ``inf`` is allowed.
    """

    dimension: str
    least: float = -math.inf
    above: float = -math.inf
    most: float | None = None
    infinite: bool = False

    @property
    def unit(self) -> str:
        """The SI unit, empty for a number."""
        return next(iter(UNITS[self.dimension]), "")

    @property
    def _range(self) -> tuple[float, float]:
        most = LARGEST[self.dimension] if self.most is None else self.most
        return max(self.least, -most), most

    def read(self, value: object) -> float:
        """Return the quantity in SI units; raise `ValueError` if it is of another dimension or out of bounds."""
        number = parse(value, self.dimension)
        least, most = self._range
        if math.isinf(number) and not (self.infinite and number > 0.0):
            raise ValueError(f"{shown(value)} must be finite")
        if number <= self.above or number < least:
            bound = f"above {self.above:g}" if math.isfinite(self.above) else f"at least {least:g}"
            raise ValueError(f"{shown(value)} must be {bound} {self.unit}".rstrip())
        if most < number < math.inf:
            raise ValueError(f"{shown(value)} must be at most {most:g} {self.unit}".rstrip())
        return number

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        least, most = self._range
        lower = {"exclusiveMinimum": self.above} if math.isfinite(self.above) else {"minimum": least}
        units = list(UNITS[self.dimension])
        number = {"type": "number", **lower, "maximum": most, "description": f"{self.dimension}, {self.unit or 'SI'}"}
        text = {
            "type": "string",
            "pattern": rf"^\s*({NUMBER})\s*({'|'.join(map(_unit_pattern, units))})\s*$",
            "description": f"a number with a unit of {', '.join(units)}" if units else "a number",
        }
        # editors that know JSON alone take the inf of TOML for null
        infinite = [{"type": ["number", "null"], "exclusiveMinimum": sys.float_info.max, "description": "inf"}]
        return {"anyOf": [number, text, *(infinite if self.infinite else [])], "unit": self.unit or "1"}


def _unit_pattern(unit: str) -> str:
    spaced = unit.replace(" ", r"(\s+|\s*·\s*)")
    return spaced.replace("^2", r"(\^2|²)").replace("^-2", r"\^-2")


@dataclass(frozen=True)
class Vector:
    """Type of a key whose value is a list of quantities.

    Attributes
    ----------
    dimension : str
        A key of `UNITS`.
    count : int
    """

    dimension: str
    count: int = 3

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        component = handler.generate_schema(Annotated[float, Quantity(self.dimension)])
        components = core_schema.list_schema(component, min_length=self.count, max_length=self.count)
        counted = core_schema.no_info_before_validator_function(self._counted, components)
        return core_schema.no_info_after_validator_function(np.array, counted)

    def _counted(self, value: object) -> object:
        if not isinstance(value, list) or len(value) != self.count:
            raise ValueError(f"{shown(value)}: give a list of {self.count} of {self.dimension}")
        return value


Time = Annotated[float, Quantity("time", least=0.0)]
Lengths = Annotated[Floats, Vector("length")]
Angles = Annotated[Floats, Vector("angle")]
Velocities = Annotated[Floats, Vector("velocity")]
AngularVelocities = Annotated[Floats, Vector("angular velocity")]

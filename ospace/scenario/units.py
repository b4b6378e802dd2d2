"""Quantities with units: types of a scenario's keys, with dimension and bounds, in SI units once they are read."""

from __future__ import annotations

import math
import re
import sys
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from ospace.kernels.tree import Floats

_RADIANS = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180.0, "°": math.pi / 180.0}
_SECONDS = {"s": 1.0, "ms": 1e-3, "min": 60.0}
_METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "km": 1e3}

UNITS: dict[str, dict[str, float]] = {
    "length": _METRES,
    "angle": _RADIANS,
    "time": _SECONDS,
    "velocity": {f"{unit}/s": size for unit, size in _METRES.items()},
    "angular velocity": {f"{unit}/s": size for unit, size in _RADIANS.items()} | {"rpm": math.pi / 30.0},
    "acceleration": {f"{unit}/s^2": size for unit, size in _METRES.items()},
    "angular acceleration": {f"{unit}/s^2": size for unit, size in _RADIANS.items()},
    "mass": {"kg": 1.0, "g": 1e-3, "t": 1e3},
    "inertia": {"kg m^2": 1.0},
    "force": {"N": 1.0, "mN": 1e-3, "kN": 1e3},
    "torque": {"N m": 1.0, "mN m": 1e-3, "kN m": 1e3},
    "momentum": {"N s": 1.0, "kg m/s": 1.0},
    "angular momentum": {"N m s": 1.0, "kg m^2/s": 1.0},
    "stiffness": {"1/s^2": 1.0, "s^-2": 1.0},
    "frequency": {"Hz": 1.0, "mHz": 1e-3},
    "number": {},
}
"""Factors to SI by unit; the first is the SI unit itself."""

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

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?inf"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*(.*?)\s*", re.DOTALL)
_SHOWN = 60


def parse(value: object, dimension: str) -> float:
    """Return a quantity in SI units.

    Parameters
    ----------
    value : int, float or str
        A number in SI units, or a number and a unit, as ``"20 deg"``.
    dimension : str
        A key of `UNITS`.

    Returns
    -------
    float
        Infinite for whole numbers that no float holds.

    Raises
    ------
    ValueError
        The value is not such a quantity: the message says why, and what would be right.
    """
    units = UNITS[dimension]
    if isinstance(value, str) and (match := _QUANTITY.fullmatch(value)):
        unit = " ".join(match[2].replace("²", "^2").replace("·", " ").split())
        if unit in units or not (unit or units):
            return float(match[1]) * units.get(unit, 1.0)
        raise ValueError(f"{shown(value)} is not {_a(dimension)}: {_wrong_unit(unit, dimension)}")
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{shown(value)} is not {_a(dimension)}: {_remedy(dimension)}")
    try:
        number = float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf
    if math.isnan(number):
        raise ValueError(f"{value} is not a number: {_remedy(dimension)}")
    return number


def shown(value: object) -> str:
    """Return the value as it is written, shortened."""
    if isinstance(value, int) and abs(value) >= 10**20:
        return f"a number of {value.bit_length()} bits"
    try:
        text = repr(value[:_SHOWN] if isinstance(value, str | list) else value)
    except ValueError:  # of whole numbers that are longer than Python writes
        text = f"{'a list' if isinstance(value, list) else 'a table'} with a number of thousands of digits"
    return text if len(text) <= _SHOWN else text[: _SHOWN - 3] + "..."


def _a(dimension: str) -> str:
    return f"{'an' if dimension[0] in 'ai' else 'a'} {dimension}"


def _wrong_unit(unit: str, dimension: str) -> str:
    if not unit:
        return f"a text needs a unit; {_remedy(dimension)}"
    other = [name for name, units in UNITS.items() if unit in units]
    measures = f", a unit of {' or '.join(other)}" if other else ""
    return f"unit {shown(unit)}{measures}; {_remedy(dimension)}"


def _remedy(dimension: str) -> str:
    units = UNITS[dimension]
    if not units:
        return "give a number"
    return f"give a number in {next(iter(units))}, or a text with a unit of {', '.join(units)}"


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
            "pattern": rf"^\s*({_NUMBER})\s*({'|'.join(map(_unit_pattern, units))})\s*$",
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

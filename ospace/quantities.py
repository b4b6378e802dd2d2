"""Quantities with units, as people write them: ``"20 deg"``, to SI."""

from __future__ import annotations

import math
import re

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

NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?inf"
_QUANTITY = re.compile(rf"\s*({NUMBER})\s*(.*?)\s*", re.DOTALL)
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

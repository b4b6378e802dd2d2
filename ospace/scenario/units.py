"""Units that a scenario may use, by what they measure; SI is what a plain number means."""

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
    "number": 1e6,
}
"""The largest amounts that a scenario may have, SI: beyond these, a run would show rounding and overflow alone."""

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?inf)\s*(.*?)\s*", re.DOTALL)


def parse(value: object, dimension: str) -> float:
    """Return a quantity in SI units; raises `ValueError`, whose text says what is wrong and what would be right.

    Parameters
    ----------
    value : int, float or str
        A number in SI units, or a number and a unit, as ``"20 deg"``.
    dimension : str
        A key of `UNITS`.
    """
    units = UNITS[dimension]
    if isinstance(value, int | float) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = math.inf if value > 0 else -math.inf
    elif isinstance(value, str):
        found = _QUANTITY.fullmatch(value)
        if found is None:
            raise ValueError(f"{value!r} is no {dimension}: {_right(dimension)}")
        unit = " ".join(found[2].replace("²", "^2").replace("·", " ").split())
        if unit not in units and (unit or units):
            raise ValueError(f"{value!r} is no {dimension}: {_wrong_unit(unit, dimension)}")
        number = float(found[1]) * units.get(unit, 1.0)
    else:
        raise ValueError(f"{_shown(value)} is no {dimension}: {_right(dimension)}")
    if math.isnan(number):
        raise ValueError(f"{value!r} is not a number: {_right(dimension)}")
    return number


def _wrong_unit(unit: str, dimension: str) -> str:
    if not unit:
        return f"a text needs a unit; {_right(dimension)}"
    other = [name for name, units in UNITS.items() if unit in units]
    measures = f", a unit of {' or '.join(other)}" if other else ""
    return f"unit '{unit}'{measures}; {_right(dimension)}"


def _right(dimension: str) -> str:
    units = UNITS[dimension]
    if not units:
        return "give a number"
    return f"give a number in {next(iter(units))}, or a text with a unit of {', '.join(units)}"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."

"""Typed reading of TOML tables: every mistake is noted by its key, and reading goes on."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ospace.exceptions import closest
from ospace.kernels.tree import Floats
from ospace.scenario import units

_UNIT_LENGTH = 1e-3


@dataclass
class Problems:
    """Mistakes found so far: keys, and what is wrong with each."""

    found: list[tuple[str, str]]

    def add(self, key: str, what: str) -> None:
        """Note a mistake."""
        self.found.append((key, what))


class Table:
    """One table of a scenario.

    Each method takes a key and returns its value, or `default` where the key is missing; a key without a default is
    required. Where something is wrong it is noted, and a value of the right type returned.
    """

    def __init__(self, data: dict[str, Any], key: str, problems: Problems) -> None:
        self.data, self.key, self.problems = data, key, problems
        self._asked: set[str] = set()

    def __contains__(self, name: str) -> bool:
        self._asked.add(name)
        return name in self.data

    def path(self, name: str) -> str:
        """Return the key's path."""
        return f"{self.key}.{name}" if self.key else name

    def wrong(self, name: str, what: str) -> None:
        """Note a mistake in the value of a key; of this table with the empty name."""
        self.problems.add(self.path(name) if name else self.key, what)

    def done(self) -> None:
        """Note every key that nothing asked for."""
        for name in self.data:
            if name not in self._asked:
                self.wrong(name, f"unknown key{closest(name, self._asked)}")

    # -- values ----------------------------------------------------------------------------------------------

    def text(self, name: str, default: str | None = None, choices: Iterable[str] | None = None) -> str:
        """Return a text, one of `choices` if given."""
        value = self._given(name, default is None)
        if value is None:
            return default or ""
        if not isinstance(value, str) or not value.strip():
            self.wrong(name, f"{value!r} is no text: put it in quotes")
            return default or ""
        if choices is not None and value not in choices:
            self.wrong(name, f"'{value}' is unknown{closest(value, choices)}")
            return default or ""
        return value

    def quantity(
        self,
        name: str,
        dimension: str,
        default: float | None = None,
        *,
        least: float = -math.inf,
        above: float = -math.inf,
        most: float | None = None,
        finite: bool = True,
    ) -> float:
        """Return a quantity in SI units; NaN for a wrong one. Without `most`, the largest is that of its dimension."""
        value = self._given(name, default is None)
        if value is None:
            return math.nan if default is None else default
        number = self._parsed(name, value, dimension)
        if number is None:
            return math.nan
        largest = units.LARGEST[dimension] if most is None else most
        if math.isinf(number) and (finite or number < 0.0):
            self.wrong(name, f"{_short(value)} must be finite")
        elif not (number > above and number >= least):
            bound = f"above {above:g}" if math.isfinite(above) else f"at least {least:g}"
            self.wrong(name, f"{_short(value)} must be {bound}{_unit(dimension)}")
        elif abs(number) > largest and not math.isinf(number):
            bound = f"at most {largest:g}" if number > 0.0 else f"at least {-largest:g}"
            self.wrong(name, f"{_short(value)} must be {bound}{_unit(dimension)}")
        else:
            return number
        return math.nan

    def vector(self, name: str, dimension: str, default: Sequence[float] | None = None, count: int = 3) -> Floats:
        """Return `count` finite quantities in SI units."""
        value = self._given(name, default is None)
        if value is None:
            return np.zeros(count) if default is None else np.array(default, dtype=np.float64)
        if not isinstance(value, list) or len(value) != count:
            self.wrong(name, f"{value!r}: give a list of {count} of {dimension}")
            return np.zeros(count)
        numbers = [self._parsed(f"{name}[{k}]", one, dimension) for k, one in enumerate(value)]
        for k, number in enumerate(numbers):
            if number is not None and not abs(number) <= (largest := units.LARGEST[dimension]):
                what = f"from {-largest:g} to {largest:g}{_unit(dimension)}"
                self.wrong(f"{name}[{k}]", f"{_short(value[k])} must be {'finite' if math.isinf(number) else what}")
        return np.array([0.0 if one is None else one for one in numbers])

    def whole(self, name: str, default: int | None = None, *, least: int = 0, most: int = 1000) -> int | None:
        """Return a whole number, or None where the key is missing."""
        value = self._given(name, False)
        if value is None:
            return default
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
            self.wrong(name, f"{value!r}: give a whole number from {least} to {most}")
            return default
        return value

    def flag(self, name: str, default: bool = False) -> bool:
        """Return true or false."""
        value = self._given(name, False)
        if value is not None and not isinstance(value, bool):
            self.wrong(name, f"{value!r}: give true or false")
        return value if isinstance(value, bool) else default

    def rotation(self) -> Floats | None:
        """Return the rotation (3, 3) of the keys ``rpy`` or ``quaternion``, if there is one."""
        if "rpy" in self and "quaternion" in self:
            self.wrong("quaternion", "give rpy or quaternion, not both")
        if "quaternion" in self:
            x = self.vector("quaternion", "number", count=4)
            length = float(np.linalg.norm(x))
            if abs(length - 1.0) > _UNIT_LENGTH:
                self.wrong("quaternion", f"its length is {length:.6g}: give x, y, z, w of length 1")
                return np.eye(3)
            return np.asarray(pin.Quaternion(x / length).toRotationMatrix())
        if "rpy" in self:
            return np.asarray(pin.rpy.rpyToMatrix(self.vector("rpy", "angle")))
        return None

    def pose(self) -> pin.SE3:
        """Return the pose of the keys ``position`` and ``rpy`` or ``quaternion``; zero where they are missing."""
        rotation = self.rotation()
        return pin.SE3(np.eye(3) if rotation is None else rotation, self.vector("position", "length", (0, 0, 0)))

    def table(self, name: str, required: bool = False) -> Table | None:
        """Return a table within this one."""
        value = self._given(name, required)
        if value is None:
            return None
        if not isinstance(value, dict):
            self.wrong(name, f"{value!r}: give a table, [{self.path(name)}] or {{key = value}}")
            return None
        return Table(value, self.path(name), self.problems)

    def tables(self, name: str, required: bool = False) -> list[Table]:
        """Return the tables of an array, ``[[name]]``."""
        value = self._given(name, required)
        if value is None:
            return []
        if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
            self.wrong(name, f"give an array of tables, [[{name}]]")
            return []
        return [Table(one, f"{self.path(name)}[{k}]", self.problems) for k, one in enumerate(value)]

    def rest(self) -> list[str]:
        """Return all keys, and take them for asked for: names that the user chooses."""
        self._asked.update(self.data)
        return list(self.data)

    def _given(self, name: str, required: bool) -> Any:
        if name in self:
            return self.data[name]
        if required:
            near = closest(name, self.data.keys() - self._asked)
            self.wrong(name, "missing" + (near if "did you mean" in near else ""))
        return None

    def _parsed(self, name: str, value: object, dimension: str) -> float | None:
        try:
            return units.parse(value, dimension)
        except ValueError as error:
            self.wrong(name, str(error))
            return None


def _short(value: object) -> str:
    """Return how a value is written, if that is short enough to show."""
    text = (
        repr(value) if not isinstance(value, int) or abs(value) < 10**20 else f"a number of {value.bit_length()} bits"
    )
    return text if len(text) <= 60 else text[:57] + "..."


def _unit(dimension: str) -> str:
    unit = next(iter(units.UNITS[dimension]), "")
    return f" {unit}" if unit else ""

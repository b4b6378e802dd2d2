"""Parts that users write in Python: functions of time and state, with their derivatives, and rows of the program."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import ClassVar

import numpy as np
import numpy.typing as npt

from ospace.control.instant import Instant
from ospace.model.points import OperationalPoint


class Custom:
    """Base of a user's class: a size, and points.

    Attributes
    ----------
    size : int
        How many rows it has; a property where it depends on the object.
    unit : str
        Of what its function returns.
    """

    size: ClassVar[int] = 1
    unit: ClassVar[str] = "m"

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """Points that it is about: those that its attributes hold, by themselves or in tuples and lists."""
        return tuple(_points_in(vars(self).values()))


class StateFunction(Custom, ABC):
    """A function y(q, t) (m,) of the robot's state and of time.

    Whole numbers and lists will do for arrays; what has one row may be a number, and its Jacobian (nv,).
    """

    @abstractmethod
    def jacobian(self, at: Instant) -> npt.ArrayLike:
        """Return J (m, nv): y changes at the rate J v while time stands still."""

    def rate(self, at: Instant) -> npt.ArrayLike:
        """Return ẏ (m,): J v, unless y depends on time by itself."""
        return np.asarray(self.jacobian(at)) @ at.v

    def drift(self, at: Instant) -> npt.ArrayLike:
        """Return ÿ (m,) while v stays: J̇ v and what time adds; by a difference of `rate`, to 1e-6 of its size or so."""
        later, step = at.later()
        return (np.asarray(self.rate(later)) - self.rate(at)) / step


def _points_in(values: object) -> Iterator[OperationalPoint]:
    for one in values:  # type: ignore[attr-defined]
        if isinstance(one, OperationalPoint):
            yield one
        elif isinstance(one, tuple | list):
            yield from _points_in(one)

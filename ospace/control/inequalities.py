"""Inequalities that users write in Python: what the robot must not pass, beside the limits of its joints."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from numbers import Real

import numpy.typing as npt

from ospace.control.instant import Instant
from ospace.control.state_function import Custom, StateFunction
from ospace.exceptions import OspaceError


@dataclass(frozen=True, kw_only=True, eq=False)
class Inequality(StateFunction):
    """A function y(q, t) (m,) that is to stay ≥ 0, as a distance.

    Write `value` and `jacobian`; `rate` where the value depends on time by itself, `drift` where it is known.

    Attributes
    ----------
    name : str
        Its name in a `Command`.
    deceleration : float
        By which y is slowed down as it approaches 0, unit of y over s²; what is below 0 comes back by no more.

    Raises
    ------
    OspaceError
        The deceleration is not above 0.
    """

    name: str
    deceleration: float = 0.1

    def __post_init__(self) -> None:
        if not (isinstance(self.deceleration, Real) and 0.0 < self.deceleration < math.inf):
            raise OspaceError(
                f"inequality '{self.name}': deceleration is {self.deceleration!r}: give a finite number above 0"
            )

    @abstractmethod
    def value(self, at: Instant) -> npt.ArrayLike:
        """Return y.

        Parameters
        ----------
        at : Instant

        Returns
        -------
        (m,) array
        """


@dataclass(frozen=True, kw_only=True, eq=False)
class RowsInequality(Custom, ABC):
    """Bounds on accelerations and base wrench: G z ≤ h.

    z = [φ̈; û] (n + k,) are the accelerations of the n joint rates, then the k actuated components of the base wrench,
    base axes, forces over the robot's mass (N/kg) and torques over a third of the trace of the base's inertia
    (N m/(kg m²)).

    Attributes
    ----------
    name : str
        Its name in a `Command`.
    """

    name: str

    @abstractmethod
    def bounds(self, at: Instant) -> tuple[npt.ArrayLike, npt.ArrayLike]:
        """Return G and h, infinite where a row is to bound nothing.

        Parameters
        ----------
        at : Instant

        Returns
        -------
        G, h : (m, n + k), (m,) arrays
        """

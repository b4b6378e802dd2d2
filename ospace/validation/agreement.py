"""Agreement of recursion and oracle: one table of quantities, their equations, and how far both are apart.

**Error.** Metres and radians, kilograms and their squares do not add up, so both sides are brought to one scale first:
a force on coordinate i is divided by √H_ii, a velocity multiplied by it, and at the points √(Γ_e⁻¹)_ii takes the place
of 1/√H_ii. The error is the largest difference over the largest element; a quantity whose terms happen to
cancel is measured against the size of the terms instead (1 for what is inertia or Jacobian in that scale).

**Bound.** nv · FACTOR · ε · κ: machine epsilon, times the condition numbers of what is inverted on the way (each of
the matrix with unit diagonal, so that units do not count), times a small factor and the number of coordinates summed.
What goes through an inverse of Γ_e⁻¹ or Λ⁻¹ is bounded by the perturbation of that inverse (`validation.perturbation`);
the bound is infinite where rounding decides on the rank.
A state whose bound passes `UNDECIDED` leaves too few digits to tell agreement from chance: it cannot vouch for the
quantity, and the row says how many states could.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Literal

import numpy as np

from ospace.dynamics.batch import QUANTITIES, interpreted_batch, operational_space_batch
from ospace.model.layout import Layout
from ospace.validation.dense_rates import has_rates
from ospace.validation.quantities import PIN_DERIVATIVES, TABLE
from ospace.validation.sample import Sample

UNDECIDED = 1e-4

Verdict = Literal["agrees", "differs", "undecided"]


@dataclass(frozen=True)
class Agreement:
    """One row of the table, over all states.

    Attributes
    ----------
    quantity, equation, computed_by, checked_against : str
    error, bound : float
        Of the state in which the error is the largest part of its bound.
    telling, states : int
        How many states could tell agreement from chance, of how many.
    """

    quantity: str
    equation: str
    computed_by: str
    checked_against: str
    error: float
    bound: float
    telling: int
    states: int

    @property
    def verdict(self) -> Verdict:
        """Return "differs" where the error passes the bound, "undecided" where no state could tell."""
        if not _within(self.error, self.bound):
            return "differs"
        return "agrees" if self.telling else "undecided"


class AgreementTable:
    """Collects the rows of the table over states: call `add` for each, `add_batch` for some, then `rows`."""

    def __init__(self, robot: Layout) -> None:
        coupled = [quantity.coupled() for quantity in TABLE]
        table = TABLE if robot.free is None else [quantity for quantity in coupled if quantity]
        self._table = [one for one in table if one.checked_against != PIN_DERIVATIVES or has_rates(robot)]
        self._seen: list[list[tuple[float, float]]] = [[] for _ in self._table]

    def add(self, sample: Sample) -> None:
        """Compare every quantity in one more state, but for those of the batch."""
        self._add(sample, in_batch=False)

    def add_batch(self, samples: Sequence[Sample], *, compiled: bool) -> None:
        """Compare the quantities of the batch in several states of a robot at once.

        Compiled, or else interpreted and of the first points alone.
        """
        of = samples if compiled else [sample.with_few_points() for sample in samples]
        robot, points = of[0].robot, of[0].points
        Q, V = (np.array([getattr(sample.state, name) for sample in of]) for name in "qv")
        if compiled:
            batch = operational_space_batch(robot, points, Q, V, QUANTITIES)
        else:
            batch = interpreted_batch(robot, points, Q, V)
        for k, sample in enumerate(of):
            sample.batch = SimpleNamespace(**{name: getattr(batch, name)[k] for name in QUANTITIES})
            self._add(sample, in_batch=True)

    def _add(self, sample: Sample, *, in_batch: bool) -> None:
        for seen, quantity in zip(self._seen, self._table, strict=True):
            if quantity.in_batch == in_batch:
                compared = quantity.compare(sample)
                seen.append((compared.error, sample.unit * compared.condition))

    def rows(self) -> list[Agreement]:
        """Return the table."""
        return [
            summary(quantity.name, quantity.equation, quantity.computed_by, quantity.checked_against, seen)
            for quantity, seen in zip(self._table, self._seen, strict=True)
        ]


def summary(
    quantity: str, equation: str, computed_by: str, checked_against: str, seen: Sequence[tuple[float, float]]
) -> Agreement:
    """Sum up (error, bound) of every state: the worst of those that can tell, or that differ all the same."""
    telling = [(error, bound) for error, bound in seen if bound <= UNDECIDED or not _within(error, bound)]
    error, bound = max(telling or seen, key=lambda one: (not _within(*one), one[0] / one[1]))
    return Agreement(quantity, equation, computed_by, checked_against, error, bound, len(telling), len(seen))


def _within(error: float, bound: float) -> bool:
    """Return whether an error is within its bound; one that is not finite is within none."""
    return math.isfinite(error) and error <= bound

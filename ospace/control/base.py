"""Actuation of the base: nothing, thrusters, reaction wheels, or both."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real

import numpy as np

from ospace.checks import real_numbers
from ospace.exceptions import OspaceError, closest
from ospace.kernels.tree import Floats

Amount = float | tuple[float, float, float] | None


@dataclass(frozen=True)
class Base:
    """Wrench on the base that a controller may use, in base axes at the base-link frame's origin.

    Attributes
    ----------
    force : float, three floats, or None
        Largest force of thrusters along x, y, z, N; None or 0 for none.
    torque : float, three floats, or None
        Largest torque about x, y, z, N m; of wheels that on the base, for their own turning with it included.
    wheels : bool
        Torques come of reaction wheels, which store the angular momentum that they take, instead of thrusters.
    wheel_momentum : float
        Largest angular momentum that wheels store about each base axis, N m s.

    Raises
    ------
    OspaceError
        An amount is not one or three numbers from 0 on, or the momentum of wheels is not above 0.
    """

    force: Amount = None
    torque: Amount = None
    wheels: bool = False
    wheel_momentum: float = math.inf

    def __post_init__(self) -> None:
        for name in ("force", "torque"):
            try:
                limits = _three(getattr(self, name))
            except (TypeError, ValueError):
                limits = np.empty(0)
            if limits.shape != (3,) or not (limits >= 0.0).all():
                raise OspaceError(f"base {name} {getattr(self, name)!r}: give one or three numbers from 0 on, or None")
        if not (isinstance(self.wheel_momentum, Real) and self.wheel_momentum > 0.0):
            raise OspaceError(f"wheel_momentum is {self.wheel_momentum!r}: give a number above 0, N m s")

    @property
    def limits(self) -> Floats:
        """Largest wrench (6,), linear first."""
        return np.concatenate([_three(self.force), _three(self.torque)])


def _three(amount: Amount) -> Floats:
    given = real_numbers(0.0 if amount is None else amount)
    return np.full(3, float(given)) if given.ndim == 0 else given


MODES = {
    "floating": Base(),
    "flying": Base(force=math.inf, torque=math.inf),
    "thrusters": Base(force=math.inf),
    "wheels": Base(torque=math.inf, wheels=True),
}
"""By name: nothing acts; all six; forces alone; torques of wheels alone."""


def parse_base(base: Base | str) -> Base:
    """Return the base of that name, or the one given."""
    if isinstance(base, Base):
        return base
    if not isinstance(base, str) or base not in MODES:
        raise OspaceError(f"base mode {base!r} is unknown{closest(str(base), MODES)}")
    return MODES[base]

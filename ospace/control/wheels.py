"""Reaction wheels of the base: what they store, and the torques that keep it within what they can."""

from __future__ import annotations

import numpy as np

from ospace.control.limits import bounded
from ospace.kernels.tree import Floats


class Wheels:
    """Wheels about the base axes whose torques are actuated.

    Attributes
    ----------
    rows : (k,) bool
        Which of the actuated components are torques of wheels.
    any : bool
        Whether one is.
    """

    def __init__(self, rows: np.ndarray, axes: np.ndarray, most: float, largest: Floats, scale: Floats) -> None:
        self.rows, self.any = rows, bool(rows.any())
        self._axes, self._most, self._largest, self._scale = axes[rows], most, largest[rows], scale[rows]

    def limit(self, stored: Floats, period: float, bounds: Floats) -> None:
        """Bound torques so that no wheel passes its momentum within a period: h − u T within ± the largest.

        Parameters
        ----------
        stored : (3,)
            Angular momentum of the wheels, base axes; N m s.
        period : float
            s.
        bounds : (2, k)
            Lower and upper bounds of the scaled components; those of wheels are written.
        """
        held, per_unit = stored[self._axes], period * self._scale
        for row, momentum in zip(bounds, (held - self._most, held + self._most), strict=True):
            row[self.rows] = bounded(np.clip(momentum / per_unit, -self._largest, self._largest))

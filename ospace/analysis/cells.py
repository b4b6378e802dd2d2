"""Extremes of quantities over postures that fall into the same cell of a lattice; memory grows with the cells alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ospace.kernels.tree import Floats, Ints

_WIDEST = 1 << 20
"""Of a lattice, cells to either side of zero."""


@dataclass(frozen=True)
class Cells:
    """Smallest and largest of m quantities in C cells, and where the n joints stand then.

    Attributes
    ----------
    index : (C, k) int
        Cells in which a posture falls, in rising order; k of one to three directions.
    count : (C,) int
        Of postures.
    low, high : (C, m)
        Of each quantity.
    at_low, at_high : (C, m, n)
        Postures there.
    """

    index: Ints
    count: Ints
    low: Floats
    high: Floats
    at_low: Floats
    at_high: Floats

    @classmethod
    def empty(cls, k: int, m: int, n: int) -> Cells:
        """Return no cells."""
        none, nowhere = np.zeros((0, m)), np.zeros((0, m, n))
        return cls(np.zeros((0, k), dtype=np.int64), np.zeros(0, dtype=np.int64), none, none, nowhere, nowhere)

    def with_postures(self, index: Ints, values: Floats, x: Floats) -> Cells:
        """Return these cells with N postures more.

        Parameters
        ----------
        index : (N, k) int
            The cell of each.
        values : (N, m)
        x : (N, n)
        """
        old, m = len(self.index), values.shape[1]
        keys = np.r_[_keys(self.index), _keys(index)]
        _, first, cell = np.unique(keys, return_index=True, return_inverse=True)
        both = np.vstack([self.index, index])
        count = np.bincount(cell, np.r_[self.count, np.ones(len(index))]).astype(np.int64)
        cells = np.arange(len(first))
        shape = (len(first), m)
        low, high = np.empty(shape), np.empty(shape)
        at_low, at_high = np.empty((*shape, x.shape[1])), np.empty((*shape, x.shape[1]))
        for c in range(m):
            for end, at, before, at_before, last in (
                (low, at_low, self.low, self.at_low, False),
                (high, at_high, self.high, self.at_high, True),
            ):
                of_all = np.r_[before[:, c], values[:, c]]
                order = np.lexsort((of_all, cell))
                place = np.searchsorted(cell[order], cells + 1) - 1 if last else np.searchsorted(cell[order], cells)
                chosen = order[place]
                end[:, c] = of_all[chosen]
                kept = chosen < old
                at[kept, c] = at_before[chosen[kept], c]
                at[~kept, c] = x[chosen[~kept] - old]
        return Cells(both[first], count, low, high, at_low, at_high)


def _keys(index: Ints) -> npt.NDArray[np.int64]:
    """Return one number of each row, which rises with the rows."""
    keys = np.zeros(len(index), dtype=np.int64)
    for column in index.T:
        keys = keys * (2 * _WIDEST) + np.clip(column + _WIDEST, 0, 2 * _WIDEST - 1)
    return keys

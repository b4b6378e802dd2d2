"""Inverse of a symmetric matrix on its numerical range."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ospace.kernels.tables import Floats

RANK_CUTOFF = 1e-12
"""Eigenvalues below this share of the largest count as zero, in rows scaled to unit mobility.

Rows are scaled by 1/√(Γ_e⁻¹)_ii, so that neither units nor masses matter. A direction in which a unit force moves the
points a 1e-12th of the best direction is beyond what the matrix itself, good to about 1e-15, can tell from none.
"""
_TAKES_PART = 1e-4


class RangeInverse(NamedTuple):
    """Inverse, rank, and the rows that depend on each other."""

    inverse: Floats
    rank: int
    dependent: npt.NDArray[np.int64]


def inverse_on_range(A: Floats, mobility: Floats) -> RangeInverse:
    """Invert a symmetric positive semidefinite `A` (r, r) with row scales √`mobility` (r,).

    The inverse is A⁻¹ at full rank, else the Moore–Penrose pseudo-inverse of the part of A of that rank.
    """
    scale = 1.0 / np.sqrt(mobility)
    eigenvalues, vectors = np.linalg.eigh(A * np.outer(scale, scale))
    kept = eigenvalues > RANK_CUTOFF * max(eigenvalues[-1], 1.0)
    rank = int(kept.sum())
    if rank == len(A):
        half = vectors / np.sqrt(eigenvalues) * scale[:, None]
        return RangeInverse(half @ half.T, rank, np.empty(0, dtype=np.int64))
    dependent = np.flatnonzero(np.abs(vectors[:, ~kept]).max(axis=1) > _TAKES_PART)
    eigenvalues, vectors = np.linalg.eigh(A)
    half = vectors[:, len(A) - rank :] / np.sqrt(eigenvalues[len(A) - rank :])
    return RangeInverse(half @ half.T, rank, dependent)

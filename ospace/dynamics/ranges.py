"""Inverse of A = J X Jᵀ, X positive definite, on its numerical range.

How many rows are independent is a matter of the Jacobian J alone, and J is known to the last digit where A, which went
through all masses of the robot, may not be. So the rank is read from J, and the inverse is taken of A.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats

RANK_CUTOFF = 1e-12
"""Eigenvalues of W Wᵀ below this share of the largest count as zero; W is J with each column over the square root of
its inertia and each row over the square root of its mobility, so that neither units nor masses matter."""
_TAKES_PART = 1e-4


class RangeInverse(NamedTuple):
    """Inverse, rank, and the rows that depend on each other."""

    inverse: Floats
    rank: int
    dependent: npt.NDArray[np.int64]


def inverse_on_range(A: Floats, J: Floats, mobility: Floats, inertia: Floats) -> RangeInverse:
    """Invert the symmetric `A` (r, r) that `J` (r, k) spans.

    `mobility` (r,) is the diagonal of Γ_e⁻¹, `inertia` (k,) that of H. The inverse is A⁻¹ at full rank, else the
    Moore–Penrose pseudo-inverse of the part of A that has the rank of J.
    """
    if not (mobility > 0.0).all() or not (inertia > 0.0).all():
        raise OspaceError("an inertia is not positive: masses or lengths of this robot are too large or too small")
    scale = 1.0 / np.sqrt(mobility)
    W = scale[:, None] * J / np.sqrt(inertia)
    eigenvalues, vectors = np.linalg.eigh(W @ W.T)
    null = eigenvalues <= RANK_CUTOFF * max(1.0, eigenvalues[-1])
    rank = len(A) - int(null.sum())
    dependent = np.flatnonzero((np.abs(vectors[:, null]) > _TAKES_PART).any(axis=1))
    if rank == len(A):
        inverse = np.linalg.inv(A * np.outer(scale, scale)) * np.outer(scale, scale)
    else:
        eigenvalues, vectors = np.linalg.eigh(A)
        kept = vectors[:, len(A) - rank :]
        inverse = kept / eigenvalues[len(A) - rank :] @ kept.T
    return RangeInverse(0.5 * (inverse + inverse.T), rank, dependent)

"""Inverse of a symmetric positive definite matrix of any size, by sweeping it in place.

The matrix is brought to unit diagonal. Step k sweeps row and column k, with the pivot p of a Cholesky factorization:

    x_ij ← x_ij − x_ik x_kj/p,   x_ik ← x_ik/p,   x_kj ← x_kj/p,   x_kk ← −1/p

It stays symmetric, and after the last step is −A⁻¹. With f the old row k and e_k the unit vector, all of that is

    y = (f − e_k)/p,   x_i ← x_i − f_i y for all rows i,   x_k ← y − e_k

since f_i − f_i (1 − 1/p) = f_i/p: whole rows at a time, and no number that is written alone and then read as part of a
row, for which a processor waits. Pivots of at most one, which the unit diagonal gives, keep the digits of f_i/p.
"""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.lanes import Number, Table, inlined
from ospace.kernels.simd import least, like, root


class Rows(NamedTuple):
    """Working memory."""

    scratch: Table
    """r + 1 rows of at least r columns."""
    wide: Table
    """The same memory in wider numbers, in which whole rows are worked on; or `scratch` itself."""
    unit: Table
    """The unit matrix, in rows of such numbers."""
    scale: Table
    """(r, 1)."""


@inlined
def inverse(A: Table, rows: Rows, X: Table) -> Number:
    """Write A⁻¹ to `X`, both (r, r). Return the smallest pivot.

    The pivots fall to rounding where rows of A depend on each other; `X` is then not to be used.
    """
    scratch, wide, unit, scale = rows.scratch, rows.wide, rows.unit, rows.scale
    r, columns = A.shape[0], wide.shape[1]
    smallest = like(1.0, A[0, 0])
    for i in range(r):
        scale[i, 0] = 1.0 / root(A[i, i])
    for i in range(r):
        for j in range(r):
            scratch[i, j] = A[i, j] * scale[i, 0] * scale[j, 0]
    for k in range(r):
        pivot = scratch[k, k]
        smallest = least(smallest, pivot)
        inverted = 1.0 / pivot
        for j in range(columns):
            wide[r, j] = wide[k, j]
        for j in range(columns):
            y = (wide[r, j] - unit[k, j]) * inverted
            for i in range(r):
                wide[i, j] = wide[i, j] - scratch[r, i] * y
            wide[k, j] = y - unit[k, j]
    for i in range(r):
        for j in range(i + 1):
            x = -scratch[i, j] * scale[i, 0] * scale[j, 0]
            X[i, j] = x
            X[j, i] = x
    return smallest

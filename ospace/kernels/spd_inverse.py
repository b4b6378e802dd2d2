"""Inverse of a symmetric positive definite matrix of any size, by sweeping it in place.

The matrix is brought to unit diagonal. Step k sweeps row and column k, with the pivot p of a Cholesky factorization:

    x_ij ← x_ij − x_ik x_kj/p,   x_ik ← x_ik/p,   x_kj ← x_kj/p,   x_kk ← −1/p

It stays symmetric, and after the last step is −A⁻¹. With f the old row k and e_k the unit vector, all of that is

    y = (f − e_k)/p,   x_i ← x_i − f_i y for all rows i,   x_k ← y − e_k

since f_i − f_i (1 − 1/p) = f_i/p: whole rows at a time, and no number that is written alone and then read as part of a
row, for which a processor waits. Pivots of at most one, which the unit diagonal gives, keep the digits of f_i/p.

Two steps are done at once, which halves what goes to and from memory; a matrix of odd size gets a row of the unit
matrix more.
"""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.jit.compile import Number, Table, inlined
from ospace.kernels.jit.simd import full_like, minimum, sqrt


class Rows(NamedTuple):
    """Working memory; m is the size of the matrix, rounded up to an even one."""

    scratch: Table
    """m + 2 rows of at least m columns."""
    wide: Table
    """The same memory in wider numbers, in which whole rows are worked on; or `scratch` itself."""
    unit: Table
    """(m, m) the unit matrix, in rows of such numbers."""
    scale: Table
    """(r, 1)."""


@inlined
def inverse(A: Table, rows: Rows, X: Table) -> Number:
    """Write A⁻¹ to `X`, both (r, r). Return the smallest pivot.

    The pivots fall to rounding where rows of A depend on each other; `X` is then not to be used.
    """
    scratch, wide, unit, scale = rows.scratch, rows.wide, rows.unit, rows.scale
    r, m, columns = A.shape[0], scratch.shape[0] - 2, wide.shape[1]
    one = full_like(1.0, A[0, 0])
    smallest = one
    for i in range(r):
        scale[i, 0] = 1.0 / sqrt(A[i, i])
    for i in range(r):
        for j in range(r):
            scratch[i, j] = A[i, j] * scale[i, 0] * scale[j, 0]
    if m > r:
        for j in range(r):
            scratch[r, j] = scratch[j, r] = 0.0 * one
        scratch[r, r] = one
    for k in range(0, m, 2):
        between, p = scratch[k, k + 1], scratch[k, k]
        p_inv = 1.0 / p
        p_next = scratch[k + 1, k + 1] - between * between * p_inv
        p_next_inv = 1.0 / p_next
        smallest = minimum(smallest, minimum(p, p_next))
        for j in range(columns):
            f = wide[k, j]
            g = wide[k + 1, j] - between * ((f - unit[k, j]) * p_inv)  # row k + 1 after step k
            wide[m, j], wide[m + 1, j] = f, g
        for j in range(columns):
            y = (wide[m, j] - unit[k, j]) * p_inv
            z = (wide[m + 1, j] - unit[k + 1, j]) * p_next_inv
            for i in range(m):
                wide[i, j] = wide[i, j] - (scratch[m, i] * y + scratch[m + 1, i] * z)
            wide[k, j] = y - unit[k, j] - scratch[m + 1, k] * z
            wide[k + 1, j] = z - unit[k + 1, j]
    for i in range(r):
        for j in range(i + 1):
            x = -scratch[i, j] * scale[i, 0] * scale[j, 0]
            X[i, j] = x
            X[j, i] = x
    return smallest

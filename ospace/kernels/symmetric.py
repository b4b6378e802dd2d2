"""Inverse of a symmetric positive definite matrix of any size, by Gauss–Jordan elimination in place.

Each step k eliminates row and column k, whose pivot is the same as in a Cholesky factorization:

    x_kk ← 1/x_kk,   x_kj ← x_kj x_kk,   x_ij ← x_ij − x_ik x_kj,   x_ik ← −x_ik x_kk

It takes twice the products of Cholesky, and half its time: all of them run along rows.
"""

from __future__ import annotations

from ospace.kernels.lanes import Number, Table, inlined
from ospace.kernels.simd import least, like


@inlined
def inverse(A: Table, scratch: Table, rows: Table, X: Table) -> Number:
    """Write A⁻¹ to `X`, both (r, r). Return the smallest pivot, over its diagonal element of A.

    `scratch` has r rows and at least r columns; `rows` is the same memory in wider numbers, in which whole rows are
    worked on, or `scratch` itself. The pivots fall to rounding where rows of A depend on each other; `X` is then not
    to be used.
    """
    r, columns = A.shape[0], rows.shape[1]
    smallest, zero = like(1.0, A[0, 0]), like(0.0, A[0, 0])
    for i in range(r):
        for j in range(r):
            scratch[i, j] = A[i, j]
        for j in range(r, scratch.shape[1]):
            scratch[i, j] = zero
    for k in range(r):
        pivot = scratch[k, k]
        smallest = least(smallest, pivot / A[k, k])
        inverted = 1.0 / pivot
        for j in range(columns):
            rows[k, j] = rows[k, j] * inverted
        scratch[k, k] = inverted
        for i in range(r):
            if i != k:
                f = scratch[i, k]
                for j in range(columns):
                    rows[i, j] = rows[i, j] - f * rows[k, j]
                scratch[i, k] = -f * inverted  # after the row: a vector that is read while its parts are written waits
    for i in range(r):
        for j in range(i + 1):
            X[i, j] = scratch[i, j]
            X[j, i] = scratch[i, j]
    return smallest

"""A program on what the levels above leave free, z = z_0 + N y with orthonormal columns of N (n + k, m).

    minimize ½ yᵀ (Nᵀ H N) y + (Nᵀ (f + H z_0))ᵀ y   subject to  lower − [1; C] z_0 ≤ [1; C] N y ≤ upper − [1; C] z_0

Rows that bound nothing are left out, others brought to unit length, and so is the objective: solvers take a program for
infeasible, or find no end, where its numbers differ by many powers of ten.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ospace.kernels.jit.compile import entry, inlined
from ospace.kernels.qp.tables import UNLIMITED, Program
from ospace.kernels.tree import Floats

NO_ROW = 1e-12
"""Of a row's size: what is left of it in the free directions, below which it bounds nothing there."""


class Restricted(NamedTuple):
    """The program in y, with room for all rows."""

    H: Floats
    f: Floats
    C: Floats
    """(n + k + rows of C, m)."""
    lower: Floats
    upper: Floats
    """(m + n + k + rows of C,)."""
    HN: Floats
    """(n + k, m) work."""


@entry
def restrict(program: Program, z: Floats, N: Floats, room: float, to: Restricted) -> int:
    """Write the program in y; return how many rows it has.

    z keeps the bounds by `room` of their size, at least of 1, at the worst: they get that much more, and y = 0 is then
    allowed.
    """
    size, m, kept = N.shape[0], N.shape[1], 0
    for row in range(size + program.C.shape[0]):
        lower, upper = program.lower[row], program.upper[row]
        below, above = lower > -0.5 * UNLIMITED, upper < 0.5 * UNLIMITED
        if not (below or above):
            continue
        whole, value, square = 0.0, 0.0, 0.0
        for k in range(m):
            to.C[kept, k] = 0.0
        for i in range(row if row < size else 0, row + 1 if row < size else size):
            c = 1.0 if row < size else program.C[row - size, i]
            whole += c * c
            value += c * z[i]
            for k in range(m):
                to.C[kept, k] += c * N[i, k]
        for k in range(m):
            square += to.C[kept, k] * to.C[kept, k]
        if not math.sqrt(square) > NO_ROW * math.sqrt(whole):
            continue
        scale = 1.0 / math.sqrt(square)
        for k in range(m):
            to.C[kept, k] *= scale
        least = scale * min(lower - value - room * max(1.0, abs(lower)), 0.0)
        most = scale * max(upper - value + room * max(1.0, abs(upper)), 0.0)
        to.lower[m + kept] = least if below else -UNLIMITED
        to.upper[m + kept] = most if above else UNLIMITED
        kept += 1
    for k in range(m):
        to.lower[k], to.upper[k] = -UNLIMITED, UNLIMITED
    restrict_objective(program, z, N, to)
    return kept


@entry
def excess(program: Program, y: Floats) -> float:
    """Return by how much y passes a bound of a program whose rows have unit length; infinite if it is not finite."""
    most, m = 0.0, y.size
    for row in range(program.lower.size):
        value = y[row] if row < m else 0.0
        for k in range(0 if row < m else m):
            value += program.C[row - m, k] * y[k]
        if not math.isfinite(value):
            return math.inf
        most = max(most, program.lower[row] - value, value - program.upper[row])
    return most


@inlined
def restrict_objective(program: Program, z: Floats, N: Floats, to: Restricted) -> None:
    """Nᵀ H N and Nᵀ (f + H z), over the largest of the diagonal."""
    size, m = N.shape
    for k in range(m):
        to.f[k] = 0.0
        for j in range(m):
            to.H[k, j] = 0.0
    for i in range(size):
        gradient = program.f[i]
        for k in range(m):
            to.HN[i, k] = 0.0
        for j in range(size):
            h = program.H[i, j]
            gradient += h * z[j]
            for k in range(m):
                to.HN[i, k] += h * N[j, k]
        for j in range(m):
            x = N[i, j]
            to.f[j] += x * gradient
            for k in range(m):
                to.H[j, k] += x * to.HN[i, k]
    largest = 0.0
    for k in range(m):
        largest = max(largest, to.H[k, k])
    scale = 1.0 / largest
    for k in range(m):
        to.f[k] *= scale
        for j in range(m):
            to.H[k, j] *= scale


@entry
def eliminate(B: Floats, N: Floats, least: float) -> int:
    """Turn the columns of N so that all but the first few are free of the rows B = A N; return how many are not.

    By Householder's reflections of columns, the largest row left first, down to rows of the size `least`. B is
    overwritten.
    """
    rows, m = B.shape
    most: int = min(rows, m)
    for r in range(most):
        best, largest = r, 0.0
        for row in range(r, rows):
            square = 0.0
            for k in range(r, m):
                square += B[row, k] * B[row, k]
            if square > largest:
                best, largest = row, square
        if not math.sqrt(largest) > least:
            return r
        for k in range(r, m):
            B[r, k], B[best, k] = B[best, k], B[r, k]
        B[r, r] += math.copysign(math.sqrt(largest), B[r, r])  # B[r, r:] is the direction of reflection from here on
        square = 0.0
        for k in range(r, m):
            square += B[r, k] * B[r, k]
        for row in range(r + 1, rows):
            reflect(B, row, B, r, square)
        for row in range(N.shape[0]):
            reflect(N, row, B, r, square)
    return most


@inlined
def reflect(A: Floats, row: int, B: Floats, r: int, square: float) -> None:
    """Reflect a row of A in its columns from `r` on at the direction B[r, r:], whose square is given."""
    along = 0.0
    for k in range(r, A.shape[1]):
        along += A[row, k] * B[r, k]
    factor = 2.0 * along / square
    for k in range(r, A.shape[1]):
        A[row, k] -= factor * B[r, k]

"""Singular values of many matrices, one in each lane, by one-sided Jacobi rotations.

A matrix A (r, n) has m = min(r, n) of them. Its rows, or its columns where these are fewer, become a lower triangle by
Householder reflections from the right, A = L Q. The columns of L, closer to orthogonal than the rows of A, are rotated
in pairs:

    c = a_iᵀ a_j,   δ = |a_j|² − |a_i|²,   t = 2c/(δ + sign(δ) √(δ² + 4c²)),   cos = 1/√(1 + t²),   sin = t cos
    a_i ← cos a_i − sin a_j,   a_j ← sin a_i + cos a_j

The pairs of one round have i + j alike, modulo m: they do not share a column, so that the processor works on several.
Sweeps over all rounds end when |a_iᵀ a_j| ≤ TOLERANCE ‖A‖_F max(|a_i|, |a_j|) for all pairs. A lane that has come so
far rests while others go on, so that no result depends on its neighbours. The lengths of the columns are then the
singular values. To make the columns exactly orthogonal, A has to be changed by no more than m TOLERANCE ‖A‖_F, which no
singular value changes by more than.

Elements of A are zero, or between 1e-70 and 1e70.
"""

from __future__ import annotations

from ospace.kernels.jit.compile import Number, Table, entry_for_threads, inlined
from ospace.kernels.jit.load_store import table
from ospace.kernels.jit.simd import copysign, full_like, maximum, minimum, sqrt, zeros
from ospace.kernels.tree import Floats

TOLERANCE = 1e-13
MOST_SWEEPS = 40
"""Far more than any matrix takes, which is 5 to 10."""
_TINY = 1e-140
"""Added to elements on the diagonal, so that no reflection is of a vector without length."""
_NO_LENGTH = 1e-270
"""Square of a length that is zero but for such elements."""


def memory_length(r: int, n: int, lanes: int) -> int:
    """Return how many numbers `singular_values` needs to work on matrices (r, n)."""
    m = min(r, n)
    return (m * max(r, n) + 3 * m + 1) * lanes


@inlined
def gather(A: Floats, first: int, memory: Floats, lanes: int) -> None:
    """Put the matrices from `first` on into the lanes, by rows or by columns; the last one into all that are left."""
    r, n = A.shape[1], A.shape[2]
    row, column = (n, 1) if r <= n else (1, r)
    for lane in range(lanes):
        a = min(first + lane, A.shape[0] - 1)
        for i in range(r):
            for k in range(n):
                memory[(i * row + k * column) * lanes + lane] = A[a, i, k]


@inlined
def square_lengths(a: Table, columns: int, squares: Table) -> None:
    """Write the squares of the lengths of the rows of `a` to `squares`, (m, 1)."""
    for i in range(a.shape[0]):
        square = full_like(0.0, a[0, 0])
        for k in range(columns):
            square = square + a[i, k] * a[i, k]
        squares[i, 0] = square


@inlined
def sort_rows(memory: Floats, m: int, length: int, columns: int, lanes: int) -> None:
    """Sort the rows in each lane, (m, length), by the squares behind them, the largest first."""
    squares = m * length * lanes
    for lane in range(lanes):
        for i in range(m - 1):
            longest = i
            for j in range(i + 1, m):
                if memory[squares + j * lanes + lane] > memory[squares + longest * lanes + lane]:
                    longest = j
            if longest != i:
                swap(memory, squares + i * lanes + lane, squares + longest * lanes + lane)
                for k in range(columns):
                    at = k * lanes + lane
                    swap(memory, i * length * lanes + at, longest * length * lanes + at)


@inlined
def swap(memory: Floats, i: int, j: int) -> None:
    """Swap two numbers."""
    memory[i], memory[j] = memory[j], memory[i]


@inlined
def triangle(a: Table, columns: int) -> None:
    """Make rows with so many columns a lower triangle by reflections, and put its m columns into the rows."""
    m = a.shape[0]
    for k in range(m):
        x = a[k, k] + copysign(full_like(_TINY, a[0, 0]), a[k, k])
        square = x * x
        for j in range(k + 1, columns):
            square = square + a[k, j] * a[k, j]
        size = copysign(sqrt(square), x)
        first = x + size
        half = 1.0 / (size * first)
        for i in range(k + 1, m):
            along = first * a[i, k]
            for j in range(k + 1, columns):
                along = along + a[k, j] * a[i, j]
            along = along * half
            a[i, k] = a[i, k] - along * first
            for j in range(k + 1, columns):
                a[i, j] = a[i, j] - along * a[k, j]
        a[k, k] = -size
        for i in range(k + 1, m):
            a[k, i] = a[i, k]
    for k in range(m):
        for i in range(k):
            a[k, i] = full_like(0.0, a[0, 0])


@inlined
def find_rotation(a: Table, i: int, j: int, active: Number, rotations: Table) -> None:
    """Write the cosine and sine that make rows `i` and `j` orthogonal where `active` is 1; no turn where it is 0."""
    c = full_like(0.0, a[0, 0])
    difference = c
    for k in range(a.shape[0]):
        x, y = a[i, k], a[j, k]
        difference, c = difference + (y * y - x * x), c + x * y
    root = sqrt(difference * difference + 4.0 * c * c + _TINY * _TINY)
    t = active * 2.0 * c / (difference + copysign(root, difference))
    cosine = 1.0 / sqrt(1.0 + t * t)
    rotations[i, 0], rotations[i, 1] = cosine, t * cosine


@inlined
def rotate(a: Table, i: int, j: int, rotations: Table) -> None:
    """Rotate rows `i` and `j`."""
    cosine, sine = rotations[i, 0], rotations[i, 1]
    for k in range(a.shape[0]):
        x, y = a[i, k], a[j, k]
        a[i, k], a[j, k] = cosine * x - sine * y, sine * x + cosine * y


@inlined
def sweep(a: Table, active: Number, rotations: Table) -> None:
    """Rotate every pair of rows in lanes that are active; a round at once, so that no root is waited for."""
    m = a.shape[0]
    for round_ in range(m):
        for i in range(m):
            j = (round_ - i) % m
            if i < j:
                find_rotation(a, i, j, active, rotations)
        for i in range(m):
            j = (round_ - i) % m
            if i < j:
                rotate(a, i, j, rotations)


@inlined
def excess(a: Table, squares: Table, negligible: Number) -> Number:
    """Write the squares of the lengths; return by what a product of two rows is beyond what is negligible, squared."""
    m = a.shape[0]
    square_lengths(a, m, squares)
    most = full_like(0.0, negligible)
    for i in range(m):
        for j in range(i):
            c = full_like(0.0, negligible)
            for k in range(m):
                c = c + a[i, k] * a[j, k]
            most = maximum(most, c * c - negligible * maximum(squares[i, 0], squares[j, 0]))
    return most


@inlined
def sort(values: Table) -> None:
    """Sort numbers, (m, 1), in each lane, the largest first."""
    for i in range(values.shape[0]):
        for j in range(i + 1, values.shape[0]):
            x, y = values[i, 0], values[j, 0]
            values[i, 0], values[j, 0] = maximum(x, y), minimum(x, y)


@inlined
def singular_values(A: Floats, memory: Floats, number: Number, lanes: int, out: Floats) -> None:
    """Write the singular values of all matrices of `A`, (N, r, n), to `out`, (N, m), the largest first."""
    m, length = out.shape[1], max(A.shape[1], A.shape[2])
    a, squares = table(memory, 0, m, length, number), table(memory, m * length * lanes, m, 1, number)
    worst = (m * length + 3 * m) * lanes
    rotations = table(memory, (m * length + m) * lanes, m, 2, number)
    most = table(memory, worst, 1, 1, number)
    for first in range(0, A.shape[0], lanes):
        gather(A, first, memory, lanes)
        for columns in (length, m):
            square_lengths(a, columns, squares)
            sort_rows(memory, m, length, columns, lanes)
            triangle(a, columns)
        negligible = full_like(0.0, a[0, 0])
        for i in range(m):
            negligible = negligible + squares[i, 0]
        negligible = negligible * (TOLERANCE * TOLERANCE)
        for _ in range(MOST_SWEEPS):
            most[0, 0] = excess(a, squares, negligible)
            unfinished = False
            for lane in range(lanes):
                active = memory[worst + lane] > 0.0
                memory[worst + lane] = 1.0 if active else 0.0
                unfinished = unfinished or active
            if not unfinished:
                break
            sweep(a, most[0, 0], rotations)
        sort(squares)
        for i in range(m):
            squares[i, 0] = sqrt(maximum(squares[i, 0] - _NO_LENGTH, full_like(0.0, negligible)))
        for lane in range(min(lanes, A.shape[0] - first)):
            for i in range(m):
                out[first + lane, i] = memory[(m * length + i) * lanes + lane]


@entry_for_threads
def singular_values_8(A: Floats, memory: Floats, out: Floats) -> None:
    """Compute them for eight matrices at a time."""
    singular_values(A, memory, zeros(8), 8, out)


@entry_for_threads
def singular_values_4(A: Floats, memory: Floats, out: Floats) -> None:
    """Compute them for four matrices at a time."""
    singular_values(A, memory, zeros(4), 4, out)


@entry_for_threads
def singular_values_2(A: Floats, memory: Floats, out: Floats) -> None:
    """Compute them for two matrices at a time."""
    singular_values(A, memory, zeros(2), 2, out)


BY_WIDTH = {2: singular_values_2, 4: singular_values_4, 8: singular_values_8}

"""Strict levels, and what gives way where limits contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ospace.control.solvers import Solver
from ospace.kernels.control import UNLIMITED, Program
from ospace.kernels.tables import Floats

_NOTHING_LEFT = 1e-9
"""Singular values of a level's rows, over their size, below which the level leaves a direction free."""
_SMALL_WEIGHT = 1e-4
"""Of squared accelerations beside the squared excess over motion limits."""
_ROUNDING = 1e-6
"""Room that bounds get where a solution is known to stand on them, relative and in rad/s²."""


@dataclass(frozen=True)
class Level:
    """Rows of one strict level, weighted: minimize |A z − b|² + damping |φ̈|²."""

    A: Floats
    b: Floats
    damping: float


def solve_by_levels(program: Program, levels: Sequence[Level], solve: Solver, regularization: float) -> Floats | None:
    """Solve one level after the other, then the weighted tasks of `program`, within the limits of all.

    Each level is solved on what those above leave free: z = z_0 + N y, with the columns of N spanning the null space
    of the rows above. Limits bound z at every level, so a solution of one level is where the next one starts from, and
    where a solver finds no other, it stays.
    """
    n = len(program.C)
    z, N = None, np.eye(len(program.f))
    for level in levels:
        H = level.A.T @ level.A + regularization * np.eye(len(N))
        H[:n, :n] += level.damping * np.eye(n)
        z_next = _within(Program(H, -level.A.T @ level.b, *program[2:]), z, N, solve)
        if z_next is None and z is None:
            return None
        z = z if z_next is None else z_next
        N = N @ _null_space(level.A @ N, float(np.linalg.norm(level.A)))
        if N.shape[1] == 0:
            return z
    last = _within(program, z, N, solve)
    return z if last is None else last


def _within(program: Program, z: Floats | None, N: Floats, solve: Solver) -> Floats | None:
    """Solve for y of z + N y, or for all of z where there is none yet."""
    if z is None:
        return solve(program)
    C = np.vstack([N, program.C @ N])
    value = np.concatenate([z, program.C @ z])
    free = np.full(N.shape[1], UNLIMITED)
    # z may stand on many limits at once, by rounding on either side: solvers need room to find y = 0 allowed
    lower = np.minimum(program.lower - value, 0.0) - _ROUNDING * np.minimum(1.0 + np.abs(value), UNLIMITED)
    upper = np.maximum(program.upper - value, 0.0) + _ROUNDING * np.minimum(1.0 + np.abs(value), UNLIMITED)
    lower, upper = np.concatenate([-free, lower]), np.concatenate([free, upper])
    H = N.T @ program.H @ N
    y = solve(Program(H, N.T @ (program.f + program.H @ z), C, lower, upper, program.cause))
    return None if y is None else z + N @ y


def _null_space(A: Floats, size: float) -> Floats:
    """Directions that A, of rows whose size was `size` before any level was taken out of them, leaves free."""
    _, values, V = np.linalg.svd(A)
    rank = int((values > _NOTHING_LEFT * size).sum())
    null: Floats = V[rank:].T
    return null


def relaxed(program: Program, n: int, solve: Solver) -> tuple[Program, Floats] | None:
    """Let bounds on φ̈ give way, by as little as may be; torque and base wrench stay within theirs.

    The least excess s over the bounds is found, min |s|². Since H_m* is invertible, the torque rows alone always leave
    a solution.

    Returns
    -------
    The program with bounds moved by s, and a z that keeps them; None where the solver fails.
    """
    size, rows = len(program.f), len(program.C)
    C = np.zeros((rows + 2 * n, size + n))
    C[:rows, :size] = program.C
    C[rows : rows + n, :n], C[rows : rows + n, size:] = np.eye(n), -np.eye(n)
    C[rows + n :, :n], C[rows + n :, size:] = np.eye(n), np.eye(n)
    none = np.full(n, UNLIMITED)
    lower = np.concatenate([-none, program.lower[n:size], np.zeros(n), program.lower[size:], -none, program.lower[:n]])
    upper = np.concatenate([none, program.upper[n:size], none, program.upper[size:], program.upper[:n], none])
    H = np.diag(np.concatenate([np.full(size, _SMALL_WEIGHT), np.ones(n)]))
    least = solve(Program(H, np.zeros(size + n), C, lower, upper, program.cause))
    if least is None:
        return None
    moved = np.maximum(least[size:], 0.0) * (1.0 + _ROUNDING) + _ROUNDING
    lower, upper = program.lower.copy(), program.upper.copy()
    lower[:n] -= moved
    upper[:n] += moved
    return Program(program.H, program.f, program.C, lower, upper, program.cause), least[:size]

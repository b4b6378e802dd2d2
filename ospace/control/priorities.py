"""Strict levels, and what gives way where limits contradict each other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ospace.control.solvers import Solver
from ospace.kernels.control import UNLIMITED, Program
from ospace.kernels.tables import Floats

_NOTHING_LEFT = 1e-9
"""Singular values of a level's rows, over the largest, below which the level leaves a direction free."""
_SMALL_WEIGHT = 1e-6
"""Of squared accelerations beside the squared excess over motion limits."""
_ROUNDING = 1e-6
"""Room that moved bounds get, relative and in rad/s²."""


@dataclass(frozen=True)
class Level:
    """Rows of one strict level, weighted: minimize |A z − b|²."""

    A: Floats
    b: Floats


def solve_by_levels(program: Program, levels: Sequence[Level], solve: Solver, regularization: float) -> Floats | None:
    """Solve one level after the other, then the weighted tasks of `program`, within the limits of all.

    Each level is solved on what those above leave free: z = z_0 + N y, with the columns of N spanning the null space
    of the rows above. Limits bound z at every level, so a solution of one level is where the next one starts from.
    """
    z, N = np.zeros(len(program.f)), np.eye(len(program.f))
    for level in levels:
        A = level.A
        H = A.T @ A + regularization * np.eye(len(z))
        z_next = _within(Program(H, -A.T @ level.b, *program[2:]), z, N, solve)
        if z_next is None:
            return None
        z, N = z_next, N @ _null_space(A @ N)
        if N.shape[1] == 0:
            return z
    return _within(program, z, N, solve)


def _within(program: Program, z: Floats, N: Floats, solve: Solver) -> Floats | None:
    """Solve for y of z + N y."""
    if N.shape[0] == N.shape[1]:
        return solve(program)
    C = np.vstack([N, program.C @ N])
    value = np.concatenate([z, program.C @ z])
    free = np.full(N.shape[1], UNLIMITED)
    # where z stands on a limit, or past it by rounding, y = 0 must stay allowed
    lower = np.concatenate([-free, np.minimum(program.lower - value, 0.0)])
    upper = np.concatenate([free, np.maximum(program.upper - value, 0.0)])
    H = N.T @ program.H @ N
    y = solve(Program(H, N.T @ (program.f + program.H @ z), C, lower, upper, program.cause))
    return None if y is None else z + N @ y


def _null_space(A: Floats) -> Floats:
    _, values, V = np.linalg.svd(A)
    rank = int((values > _NOTHING_LEFT * values.max(initial=1e-300)).sum())
    null: Floats = V[rank:].T
    return null


def solve_with_slack(program: Program, n: int, solve: Solver) -> tuple[Floats, Floats] | None:
    """Let bounds on φ̈ give way, by as little as may be; torque and base wrench stay within theirs.

    First the least excess s over the bounds is found, min |s|², then the program solved with bounds moved by s. Since
    H_m* is invertible, the torque rows alone always leave a solution.

    Returns
    -------
    z, and by how much each φ̈ passes its bounds (n,); None where the solver fails.
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
    excess = np.maximum(least[size:], 0.0)
    moved = excess * (1.0 + _ROUNDING) + _ROUNDING
    lower, upper = program.lower.copy(), program.upper.copy()
    lower[:n] -= moved
    upper[:n] += moved
    z = solve(Program(program.H, program.f, program.C, lower, upper, program.cause))
    z = least[:size] if z is None else z
    return z, np.maximum(np.maximum(z[:n] - program.upper[:n], program.lower[:n] - z[:n]), 0.0)

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
_SLACK_WEIGHT = 1e6
"""Of the squared excess over motion limits, relative to the largest weight of the program."""


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

    Since H_m* is invertible, the torque rows alone always leave a solution.

    Returns
    -------
    z, and by how much each φ̈ passes its bounds (n,); None where the solver fails.
    """
    size, rows = len(program.f), len(program.C)
    total = size + n
    H, f, C = np.zeros((total, total)), np.zeros(total), np.zeros((rows + 2 * n, total))
    H[:size, :size], f[:size] = program.H, program.f
    H[size:, size:] = np.eye(n) * _SLACK_WEIGHT * max(np.abs(np.diag(program.H)).max(), 1.0)
    C[:rows, :size] = program.C
    C[rows : rows + n, :n], C[rows : rows + n, size:] = np.eye(n), -np.eye(n)
    C[rows + n :, :n], C[rows + n :, size:] = np.eye(n), np.eye(n)
    none = np.full(n, UNLIMITED)
    lower = np.concatenate([-none, program.lower[n:size], np.zeros(n), program.lower[size:], -none, program.lower[:n]])
    upper = np.concatenate([none, program.upper[n:size], none, program.upper[size:], program.upper[:n], none])
    found = solve(Program(H, f, C, lower, upper, program.cause))
    if found is None:
        return None
    z = found[:size]
    return z, np.maximum(np.maximum(z[:n] - program.upper[:n], program.lower[:n] - z[:n]), 0.0)

"""Strict levels, and what gives way where limits contradict each other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ospace.control.solvers import Solver, by_proximal_steps
from ospace.kernels.qp.null_space import Restricted, eliminate, excess, restrict
from ospace.kernels.qp.tables import UNLIMITED, Program
from ospace.kernels.tree import Floats

_NOTHING_LEFT = 1e-9
"""Of a level's rows, over their size: what is left of it is none, and a direction stays free."""
_PASSED = 1e-8
"""By which a solution may pass the bounds of a level's program, whose rows have unit length."""
_SMALL_WEIGHT = 1e-4
"""Of squared accelerations beside the squared excess over motion limits."""
_ROUNDING = 1e-6
"""Room that bounds get where a solution is known to stand on them, relative and in rad/s², over all levels."""


@dataclass(frozen=True)
class Level:
    """Rows of one strict level, weighted: minimize ½ |A z − b|² + ½ φ̈ᵀ damped φ̈ + slowedᵀ φ̈.

    Attributes
    ----------
    damped, slowed : (n,)
        The diagonal D, and D_s d φ̇, as in `ospace.kernels.qp.program`.
    """

    A: Floats
    b: Floats
    damped: Floats
    slowed: Floats


class Solution(NamedTuple):
    """Solution of all levels."""

    z: Floats
    dropped: tuple[int, ...] = ()
    """Levels without a solution, by their order; as many as there are levels for the weighted tasks below them."""


def solve_by_levels(
    program: Program, levels: Sequence[Level], solve: Solver, regularization: float, start: Floats | None = None
) -> Solution | None:
    """Solve one level after the other, then the weighted tasks of `program`, within the limits of all.

    Each level is solved on what those above leave free: z = z_0 + N y, with the columns of N spanning the null space
    of the rows above. Limits bound z at every level, so a solution of one level is where the next one starts from, and
    where none is found, it stays and the level is dropped. The first level starts from `start`, which keeps the limits;
    without it, from nowhere.

    Returns
    -------
    The solution, or None where there is none of the first level and no `start`.
    """
    n, last = program.cause.shape[1], len(levels)
    z, N = start, np.eye(len(program.f))
    dropped = []
    damped, slowed = np.zeros(n), np.zeros(n)  # what damps one level damps those below, which else would swing for it
    for k, level in enumerate(levels):
        slowed = np.where(level.damped > damped, level.slowed, slowed)
        damped = np.maximum(level.damped, damped)
        H = level.A.T @ level.A + regularization * np.eye(len(N))
        H[:n, :n] += np.diag(damped)
        f = -level.A.T @ level.b
        f[:n] += slowed
        found = _within(Program(H, f, *program[2:]), z, N, solve, _room(k, last))
        if found is not None:
            z = found
        elif z is None:
            return None
        else:
            dropped.append(k)
            continue
        N = _null_space(level.A, N)
        if N.shape[1] == 0:
            return Solution(z, tuple(dropped))
    H, f = program.H.copy(), program.f.copy()
    H[:n, :n] += np.diag(damped)
    f[:n] += slowed
    found = _within(Program(H, f, *program[2:]), z, N, solve, _room(last, last))
    if found is not None:
        return Solution(found, tuple(dropped))
    return None if z is None else Solution(z, (*dropped, last))


def _room(k: int, last: int) -> float:
    """Share of the room that bounds have at step `k`: more at each, so that no step starts from where there is none."""
    return _ROUNDING * (k + 1) / (last + 1)


def _within(program: Program, z: Floats | None, N: Floats, solve: Solver, room: float) -> Floats | None:
    """Solve for y of z + N y, or for all of z where there is none yet."""
    if z is None:
        return solve(program)
    size, m = N.shape
    rows = size + len(program.C)
    to = Restricted(*map(np.empty, ((m, m), m, (rows, m), m + rows, m + rows, (size, m))))
    kept = restrict(program, z, N, room, to)
    left = Program(to.H, to.f, to.C[:kept], to.lower[: m + kept], to.upper[: m + kept], program.cause)
    y = solve(left)
    if y is not None and excess(left, y) > _PASSED:  # as DAQP ends at times, where many bounds meet
        y = by_proximal_steps(left)
    return None if y is None or excess(left, y) > _PASSED else z + N @ y


def kernel_calls(program: Program) -> list[tuple[Any, tuple[Any, ...]]]:
    """Return the kernels that levels and limits in contradiction run, each with arguments of the types it takes."""
    z, N = program.f, program.H
    to = Restricted(N, z, N, z, z, N)
    return [(restrict, (program, z, N, 0.0, to)), (eliminate, (N, N, 0.0)), (excess, (program, z))]


def _null_space(A: Floats, N: Floats) -> Floats:
    """Return directions among the columns of N, which are overwritten, that A leaves free as well."""
    taken = eliminate(A @ N, N, _NOTHING_LEFT * math.sqrt(np.vdot(A, A)))
    return N[:, taken:].copy()


def relaxed(program: Program, n: int, solve: Solver) -> tuple[Program, Floats] | None:
    """Let bounds on φ̈ and inequalities give way, by as little as may be; torque and base wrench stay within theirs.

    The least excess s over the bounds is found, min |s|². Since H_m* is invertible, the torque rows alone always leave
    a solution.

    Returns
    -------
    The program with bounds moved by s, and a z that keeps them; None where the solver fails.
    """
    size, torque = len(program.f), slice(len(program.f), len(program.f) + n)
    soft = np.concatenate([np.arange(n), np.arange(size + n, len(program.lower))])
    S, s = np.vstack([np.eye(n, size), program.C[n:]]), len(soft)
    C = np.block([[program.C[:n], np.zeros((n, s))], [S, -np.eye(s)], [S, np.eye(s)]])
    free = np.full(n, UNLIMITED)
    lower, upper = program.lower, program.upper
    none = np.full(s, UNLIMITED)
    least = solve(
        Program(
            np.diag(np.concatenate([np.full(size, _SMALL_WEIGHT), np.ones(s)])),
            np.zeros(size + s),
            C,
            np.concatenate([-free, lower[n:size], np.zeros(s), lower[torque], -none, lower[soft]]),
            np.concatenate([free, upper[n:size], none, upper[torque], upper[soft], none]),
            program.cause,
        )
    )
    if least is None:
        return None
    moved = np.maximum(least[size:], 0.0) * (1.0 + _ROUNDING) + _ROUNDING
    lower, upper = lower.copy(), upper.copy()
    lower[soft] -= moved
    upper[soft] += moved
    return Program(program.H, program.f, program.C, lower, upper, program.cause), least[:size]

"""Ascent of many postures at once along the set where constraints hold.

With f to be raised, c = 0 the constraints, A = ∂c/∂x and free coordinates those that no bound stops,

    d = (1 − A⁺ A) ∂f/∂x                     the way up that keeps the constraints to first order
    x ← x + α d,   x ← x − A⁺ c(x)           a step, and back to the constraints
    α ← s·s / |s·y|                          after a step s that changed d by y (Barzilai and Borwein)

A step that does not raise f, or from which there is no way back, is taken back, and the next is shorter. The path from
where a posture begins to where it ends lies in the set, and f takes all values between along it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from ospace.kernels.tree import Floats, Ints

Bools = npt.NDArray[np.bool_]

_RESTORATIONS, _BACK = 25, 3
_LONGEST = 0.25
"""Of a step, rad or L."""
_GAIN = 1e-14
"""Of f by a step: below it a posture has arrived."""
_CUTOFF = 1e-10


@dataclass(frozen=True)
class Linear:
    """Objective and constraints of K postures, to first order.

    Attributes
    ----------
    f, df : (K,), (K, n)
        What is raised, and its gradient.
    c, A : (K, m), (K, m, n)
        What is to be zero, and its derivative; scaled so that 1 is large.
    frame : object
        What `Problem.at` takes to measure postures near these as these.
    """

    f: Floats
    df: Floats
    c: Floats
    A: Floats
    frame: Any


class Problem(Protocol):
    """Objective, and constraints that are to hold meanwhile."""

    def linear(self, x: Floats, which: Ints) -> Linear:
        """Return objective and constraints of postures (K, n), to first order; `which` (K,) of those given they are."""

    def at(self, x: Floats, frame: Any) -> tuple[Floats, Floats]:
        """Return f (K,) and c (K, m) of postures near those of `frame`."""


def restore(problem: Problem, x: Floats, lower: Floats, upper: Floats, tolerance: float) -> tuple[Floats, Bools]:
    """Bring postures (K, n) onto the constraints, inside their bounds.

    Returns
    -------
    x : (K, n)
    found : (K,) bool
        Whether the constraints hold there to `tolerance`.
    """
    x, away = x.copy(), np.arange(len(x))
    for _ in range(_RESTORATIONS):
        here = problem.linear(x[away], away)
        off = np.abs(here.c).max(axis=1, initial=0.0) > tolerance
        away, at, A, c = away[off], x[away[off]], here.A[off], here.c[off]
        if not len(away):
            break
        step = -_lift(A, c)
        outward = ((at <= lower) & (step < 0.0)) | ((at >= upper) & (step > 0.0))
        step = -_lift(A * ~outward[:, None, :], c)
        step *= np.minimum(1.0, 2.0 * _LONGEST / np.maximum(np.abs(step).max(axis=1, keepdims=True), 1e-300))
        x[away] = np.clip(at + step, lower, upper)
    found = np.ones(len(x), dtype=bool)
    if len(away):
        found[away] = np.abs(problem.linear(x[away], away).c).max(axis=1, initial=0.0) <= tolerance
    return x, found


def ascend(
    problem: Problem, x: Floats, lower: Floats, upper: Floats, *, iterations: int, tolerance: float
) -> tuple[Floats, Floats]:
    """Raise f of postures (K, n) on which the constraints hold.

    Returns
    -------
    x, f : (K, n), (K,)
        Where they end, and f there; the constraints hold to `tolerance`.
    """
    going = np.arange(len(x))
    x, f = x.copy(), problem.linear(x, going).f
    alpha = np.ones(len(x))
    before: tuple[Floats, Floats] | None = None
    for _ in range(iterations):
        begin, width = x[going], alpha[going]
        here = problem.linear(begin, going)
        d, inverse = _way_up(here, begin, lower, upper)
        if before is not None:
            s, y = begin - before[0], d - before[1]
            ss, sy = np.einsum("ki,ki->k", s, s), np.abs(np.einsum("ki,ki->k", s, y))
            width = np.where((ss > 0.0) & (sy > 1e-14 * ss), ss / np.maximum(sy, 1e-300), width)
        step = width[:, None] * d
        step *= np.minimum(1.0, _LONGEST / np.maximum(np.abs(step).max(axis=1, keepdims=True), 1e-300))
        tried = np.clip(begin + step, lower, upper)
        f_tried, c = problem.at(tried, here.frame)
        for _ in range(_BACK):
            if np.abs(c).max(initial=0.0) <= 0.1 * tolerance:
                break
            tried = np.clip(tried - np.einsum("kim,km->ki", inverse, c), lower, upper)
            f_tried, c = problem.at(tried, here.frame)
        good = (np.abs(c).max(axis=1, initial=0.0) <= tolerance) & (f_tried > here.f)
        x[going], f[going] = np.where(good[:, None], tried, begin), np.where(good, f_tried, here.f)
        alpha[going] = np.where(
            good, width, 0.2 * np.minimum(width, _LONGEST / np.maximum(np.abs(d).max(axis=1), 1e-300))
        )
        on = np.einsum("ki,ki->k", step, d) > _GAIN
        before = begin[on], d[on]
        going = going[on]
        if not len(going):
            break
    return x, f


def _way_up(here: Linear, x: Floats, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Return d (K, n), and A⁺ (K, n, m) of the free coordinates; bounds stop what d would push beyond them."""
    free = np.ones(x.shape, dtype=bool)
    d, inverse = here.df, np.zeros((*x.shape, here.c.shape[1]))
    for _ in range(x.shape[1]):
        A, df = here.A * free[:, None, :], here.df * free
        inverse = _pseudo_inverse(A)
        d = df - np.einsum("kim,kmj,kj->ki", inverse, A, df)
        stopped = free & (((x <= lower) & (d < 0.0)) | ((x >= upper) & (d > 0.0)))
        if not stopped.any():
            break
        free &= ~stopped
    return d, inverse


def _lift(A: Floats, c: Floats) -> Floats:
    return np.asarray(np.einsum("kim,km->ki", _pseudo_inverse(A), c))


def _pseudo_inverse(A: Floats) -> Floats:
    """Return A⁺ (K, n, m) by A Aᵀ; rows that say nothing, or what others say, do not count."""
    if A.shape[1] == 0:
        return np.zeros((len(A), A.shape[2], 0))
    return np.asarray(A.transpose(0, 2, 1) @ np.linalg.pinv(A @ A.transpose(0, 2, 1), rcond=_CUTOFF, hermitian=True))

"""Solvers of the quadratic program: DAQP, ProxQP, and every back-end of qpsolvers by its name."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ospace.checks import real_numbers
from ospace.exceptions import OspaceError, closest
from ospace.kernels.qp.tables import UNLIMITED, Program
from ospace.kernels.tree import Floats

Solver = Callable[[Program], Floats | None]
"""Returns z, or None where there is no solution."""
_TOLERANCE = 1e-9
_PASSED = 1e-6
"""By how much, relative to a bound and at least to 1, a function's solution may pass it."""
_FINE = 1e-12
_PROXIMAL = (1e-3, 1e-2, 1e-1)
"""Weights of |z − z_before|² beside the largest of H: the larger, the better conditioned, and the more steps."""
_SETTLED = 1e-9
"""The step that is none any more."""
_OPTIONS: dict[str, dict[str, Any]] = {  # what others take a solution for is too rough for torques
    "clarabel": {"tol_gap_abs": _FINE, "tol_gap_rel": _FINE, "tol_feas": _FINE},
    "highs": {
        "primal_feasibility_tolerance": 1e-10,
        "dual_feasibility_tolerance": 1e-10,
        "qp_regularization_value": 0.0,
        "time_limit": 1.0,  # s; on some programs it would go on for minutes
    },
    "osqp": {"eps_abs": 1e-11, "eps_rel": 0.0, "max_iter": 200_000, "polishing": False},
    "piqp": {"eps_abs": _FINE, "eps_rel": 0.0, "eps_duality_gap_abs": _FINE, "eps_duality_gap_rel": 0.0},
    "scs": {"eps_abs": _TOLERANCE, "eps_rel": 0.0, "max_iters": 200_000},
}
_ROUGH = {"ecos": "solves by second-order cones, accurate only to about 1e-4"}


def solver_named(name: str) -> Solver:
    """Return the solver of that name; raise `OspaceError` where it is unknown or not installed.

    A program that it finds no solution of is solved by DAQP in proximal steps, which stands worse conditioned ones.
    """
    return partial(_solve, _back_end(name))


def solver_of(given: str | Solver) -> Solver:
    """Return the solver of a name, or one that calls a user's function and checks what it returns.

    Raises
    ------
    OspaceError
        It is neither; or later, the function fails, or returns neither None nor finite numbers, one for each of f.
    """
    if isinstance(given, str):
        return solver_named(given)
    if not callable(given):
        raise OspaceError(f"solver {given!r:.60}: give a name, or a function from a Program to z or None")
    return partial(_solve, partial(_by_function, given))


def _by_function(function: Solver, program: Program) -> Floats | None:
    name = f"solver '{getattr(function, '__name__', type(function).__name__)}'"
    try:
        returned = function(program)
    except Exception as error:
        raise OspaceError(f"{name} failed: {type(error).__name__}: {error}") from error
    if returned is None:
        return None
    try:
        z = real_numbers(returned)
    except (TypeError, ValueError):
        z = np.full(1, np.nan)
    if z.shape != program.f.shape or not np.isfinite(z).all():
        raise OspaceError(
            f"{name} returned {returned!r:.60}: give {len(program.f)} finite numbers, one for each of program.f, or "
            f"None where it finds no solution"
        )
    value = np.concatenate([z, program.C @ z])
    kept = (value >= program.lower - _PASSED * np.maximum(1.0, np.abs(program.lower))).all()
    kept &= (value <= program.upper + _PASSED * np.maximum(1.0, np.abs(program.upper))).all()
    return z if kept else None


def _solve(first: Solver, program: Program) -> Floats | None:
    z = first(program)
    return by_proximal_steps(program) if z is None else z


def _back_end(name: str) -> Solver:
    if name in OWN:
        return OWN[name]
    import qpsolvers

    known = list(dict.fromkeys([*OWN, *qpsolvers.available_solvers]))
    if name in _ROUGH:
        raise OspaceError(
            f"solver '{name}' {_ROUGH[name]}: take one of {', '.join(one for one in known if one != name)}"
        )
    if name not in known:
        raise OspaceError(f"solver '{name}' is unknown, or not installed{closest(str(name), known)}")
    return partial(_by_qpsolvers, name)


def _daqp(program: Program) -> Floats | None:
    import daqp

    z, _, flag, _ = daqp.solve(program.H, program.f, program.C, program.upper, program.lower, primal_tol=_TOLERANCE)
    return np.asarray(z) if flag > 0 else None


def by_proximal_steps(program: Program) -> Floats | None:
    """Solve by DAQP in proximal steps: they stand worse conditioned programs, and take longer."""
    import daqp

    scale = 1.0 / program.H.diagonal().max()
    H, f = scale * program.H, scale * program.f
    for weight in _PROXIMAL:
        z, _, flag, _ = daqp.solve(
            H, f, program.C, program.upper, program.lower, primal_tol=_TOLERANCE, eps_prox=weight, eta_prox=_SETTLED
        )
        if flag > 0:
            return np.asarray(z)
    return None


def _proxqp(program: Program) -> Floats | None:
    from proxsuite import proxqp

    size, rows = len(program.f), len(program.C)
    lower, upper = (np.clip(bound, -1e20, 1e20) for bound in (program.lower, program.upper))
    qp = proxqp.dense.QP(size, 0, rows, True)
    qp.settings.eps_abs, qp.settings.eps_rel = _TOLERANCE, 0.0
    qp.settings.max_iter = qp.settings.max_iter_in = 100  # some 30 do; its own bounds take seconds to find nothing
    qp.init(program.H, program.f, None, None, program.C, lower[size:], upper[size:], lower[:size], upper[:size])
    qp.solve()
    return np.asarray(qp.results.x) if qp.results.info.status == proxqp.QPSolverOutput.PROXQP_SOLVED else None


OWN: dict[str, Solver] = {"daqp": _daqp, "proxqp": _proxqp}
"""Solvers that are called without qpsolvers, by name."""


def _by_qpsolvers(name: str, program: Program) -> Floats | None:
    import qpsolvers

    rows = np.vstack([np.eye(len(program.f)), program.C])
    equal = program.upper <= program.lower  # as two inequalities, some solvers would find these contradictory
    above, below = ~equal & (program.upper < UNLIMITED), ~equal & (program.lower > -UNLIMITED)
    G = np.vstack([rows[above], -rows[below]])
    h = np.concatenate([program.upper[above], -program.lower[below]])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # on formats, and on problems without a solution, which are reported here
        problem = qpsolvers.Problem(program.H, program.f, G, h, rows[equal], program.upper[equal])
        try:
            found = qpsolvers.solve_problem(problem, name, **_OPTIONS.get(name, {}))
        except (qpsolvers.exceptions.QPError, ValueError):
            return None
    return found.x if found.found else None

"""Rows of the program that tasks and inequalities written in Python are: functions y(q, t) with their derivatives.

With ẏ = J v + ∂y/∂t and ÿ = J v̇ + c in the coordinates of q and v, and the base eliminated as in `tasks`,

    v̇ = [Rᵀ ẍ_b − [ω_b × ν_b; 0]; φ̈],   ẍ_b = J_b* φ̈ + H_b⁻¹ B û + ẍ_b(z = 0)                (7)
    ÿ = A z + a⁰

A task brings its error y to zero, A z = −d ẏ − k y − a⁰, saturated as other tasks are. An inequality keeps y ≥ 0 as
`joint_limits` keeps a joint from its lower limit: with the deceleration a, the period h and the horizon T,

    ÿ ≥ min((−ceiling(y + h ẏ/2) − ẏ)/r, a),   r = max(h, T/4)
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ospace.kernels.jit.compile import Number, entry, inlined
from ospace.kernels.jit.load_store import load6, load9, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.qp.joint_limits import ceiling
from ospace.kernels.qp.tables import Program
from ospace.kernels.spatial import cross, dot3, dot6, rotate
from ospace.kernels.tasks.rows import LEAST_STIFFNESS, base_response, saturation_factor
from ospace.kernels.tasks.tables import BaseActuation, TaskRows
from ospace.kernels.tree import Floats, Ints
from ospace.kernels.workspace import Work, open_work


class CustomRows(NamedTuple):
    """Functions y(q, t) of all tasks, then of all inequalities, M rows in all."""

    first: Ints
    """(c + 1,) where the rows of each function begin."""
    row: Ints
    """(c,) where they go to: of a task's rows, or of `Program.C`."""
    tasks: int
    """How many are errors of tasks."""
    gain: Floats
    """(c, 2) stiffness and damping of a task; deceleration of an inequality."""
    given: Ints
    """(c, 2) whether ẏ is given, and c; else they are J v, and the difference of ẏ over a step while v stays."""
    value: Floats
    """(M,) y."""
    jacobian: Floats
    """(M, nv) J."""
    rate: Floats
    """(M,) ẏ."""
    drift: Floats
    """(M,) c."""
    later_jacobian: Floats
    """(M, nv) J a step later."""
    later_rate: Floats
    """(M,) ẏ a step later."""
    smallest: Floats
    """(1,) of the values of inequalities; written."""


@entry
def write_custom_rows(
    memory: Floats,
    base: BaseActuation,
    h: float,
    horizon: float,
    step: float,
    custom: CustomRows,
    rows: TaskRows,
    program: Program,
) -> int:
    """Write the rows of all functions; return the number of the first that is not finite, or −1."""
    w = open_work(unowned(memory), zeros(1))
    base_response(w, base)
    size, smallest = program.f.size, math.inf
    T = max(h, horizon)
    r = max(h, 0.25 * T)
    for c in range(custom.row.size):
        first, last, at = custom.first[c], custom.first[c + 1], custom.row[c]
        square = 0.0
        for i in range(first, last):
            if not differentiate(w, custom, c, i, step):
                return c
            demanded = custom.gain[c, 0] * custom.value[i] + custom.gain[c, 1] * custom.rate[i]
            square += demanded * demanded
        for i in range(first, last):
            y, rate, row = custom.value[i], custom.rate[i], at + i - first
            if c < custom.tasks:
                demanded = custom.gain[c, 0] * y + custom.gain[c, 1] * rate
                rows.b[row] = -saturation_factor(square) * demanded - write_row(w, base, custom, i, rows.A, row)
                rows.error[row], rows.equivalent_error[row] = y, demanded / max(custom.gain[c, 0], LEAST_STIFFNESS)
            else:
                a = custom.gain[c, 0]
                least = min((-ceiling(y + 0.5 * h * rate, a, T) - rate) / r, a)
                program.lower[size + row] = least - write_row(w, base, custom, i, program.C, row)
                smallest = min(smallest, y)
    custom.smallest[0] = smallest
    return -1


@inlined
def differentiate(w: Work, custom: CustomRows, c: int, i: int, step: float) -> bool:
    """Complete ẏ and c of row `i`, of function `c`; return whether all of it is finite."""
    J, J_later, rate, later = custom.jacobian, custom.later_jacobian, 0.0, 0.0
    for k in range(J.shape[1]):
        if not (math.isfinite(J[i, k]) and math.isfinite(J_later[i, k])):
            return False
        rate += J[i, k] * w.velocity[k, 0]
        later += J_later[i, k] * w.velocity[k, 0]
    if custom.given[c, 0]:
        later = custom.later_rate[i]
    else:
        custom.rate[i] = rate
    if not custom.given[c, 1]:
        custom.drift[i] = (later - custom.rate[i]) / step
    return math.isfinite(custom.value[i]) and math.isfinite(custom.rate[i]) and math.isfinite(custom.drift[i])


@inlined
def write_row(w: Work, base: BaseActuation, custom: CustomRows, i: int, A: Floats, row: int) -> Number:
    """Write the row of A z + a⁰ that row `i` of J v̇ + c is; return a⁰."""
    n, J = w.J_m_star.shape[0], custom.jacobian
    f = rotate(load9(w.R, 0), (J[i, 0], J[i, 1], J[i, 2])) + rotate(load9(w.R, 0), (J[i, 3], J[i, 4], J[i, 5]))
    for k in range(A.shape[1]):
        A[row, k] = dot6(f, load6(w.J_b_star, k + 1)) + J[i, k + 6] if k < n else dot6(f, load6(base.response, k - n))
    nu = (w.velocity[0, 0], w.velocity[1, 0], w.velocity[2, 0])
    omega = (w.velocity[3, 0], w.velocity[4, 0], w.velocity[5, 0])
    turning = dot3((J[i, 0], J[i, 1], J[i, 2]), cross(omega, nu))
    return custom.drift[i] + dot6(f, load6(w.base_drift, 0)) - turning

"""Rows of the program that tasks and inequalities written in Python are: functions y(q, t) with their derivatives.

With ẏ = J v + ∂y/∂t and ÿ = J v̇ + c in the coordinates of q and v, and the base eliminated as in `tasks`,

    v̇ = [Rᵀ ẍ_b − [ω_b × ν_b; 0]; φ̈],   ẍ_b = J_b* φ̈ + H_b⁻¹ B û + ẍ_b(z = 0)                (7)
    ÿ = A z + a⁰

A task brings its error y to zero, A z = −d ẏ − k y − a⁰, saturated as other tasks are. An inequality keeps y ≥ 0 as
`joint_limits` keeps a joint from its lower limit: with the deceleration a and the period h,

    ÿ ≥ min((−ceiling(y + h ẏ/2) − ẏ)/h, a)
"""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.jit.compile import entry, inlined
from ospace.kernels.jit.load_store import load6, load9, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.qp.joint_limits import ceiling
from ospace.kernels.qp.tables import Program
from ospace.kernels.spatial import cross, dot3, dot6, rotate
from ospace.kernels.tasks.rows import base_response, saturation_factor
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
    value: Floats
    """(M,) y."""
    rate: Floats
    """(M,) ẏ."""
    drift: Floats
    """(M,) c."""
    jacobian: Floats
    """(M, nv) J."""


@entry
def write_custom_rows(
    memory: Floats, base: BaseActuation, h: float, custom: CustomRows, rows: TaskRows, program: Program
) -> int:
    """Write the rows of all functions; return the number of the first that is not finite, or −1."""
    w = open_work(unowned(memory), zeros(1))
    base_response(w, base)
    size = program.f.size
    for c in range(custom.row.size):
        first, last, at = custom.first[c], custom.first[c + 1], custom.row[c]
        nonfinite, square = 0.0, 0.0
        for i in range(first, last):
            nonfinite += 0.0 * (custom.value[i] + custom.rate[i] + custom.drift[i])
            for k in range(custom.jacobian.shape[1]):
                nonfinite += 0.0 * custom.jacobian[i, k]
            demanded = custom.gain[c, 0] * custom.value[i] + custom.gain[c, 1] * custom.rate[i]
            square += demanded * demanded
        if nonfinite != 0.0:
            return c
        for i in range(first, last):
            y, rate, row = custom.value[i], custom.rate[i], at + i - first
            if c < custom.tasks:
                demanded = custom.gain[c, 0] * y + custom.gain[c, 1] * rate
                rows.b[row] = -saturation_factor(square) * demanded - write_row(w, base, custom, i, rows.A, row)
                rows.error[row] = y
            else:
                a = custom.gain[c, 0]
                least = min((-ceiling(y + 0.5 * h * rate, a, h) - rate) / h, a)
                program.lower[size + row] = least - write_row(w, base, custom, i, program.C, row)
    return -1


@inlined
def write_row(w: Work, base: BaseActuation, custom: CustomRows, i: int, A: Floats, row: int) -> float:
    """Write the row of A z + a⁰ that row `i` of J v̇ + c is; return a⁰."""
    n, J = w.J_m_star.shape[0], custom.jacobian
    f = rotate(load9(w.R, 0), (J[i, 0], J[i, 1], J[i, 2])) + rotate(load9(w.R, 0), (J[i, 3], J[i, 4], J[i, 5]))
    for k in range(A.shape[1]):
        A[row, k] = dot6(f, load6(w.J_b_star, k + 1)) + J[i, k + 6] if k < n else dot6(f, load6(base.response, k - n))
    nu = (w.velocity[0, 0], w.velocity[1, 0], w.velocity[2, 0])
    omega = (w.velocity[3, 0], w.velocity[4, 0], w.velocity[5, 0])
    turning = dot3((J[i, 0], J[i, 1], J[i, 2]), cross(omega, nu))
    return custom.drift[i] + dot6(f, load6(w.base_drift, 0)) - turning

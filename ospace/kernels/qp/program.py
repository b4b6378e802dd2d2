"""The quadratic program of one control cycle, from the tables that `evaluation` leaves.

With z = [φ̈; û] as in `tasks`, and W the weights of the rows,

    minimize ½ zᵀ H z + fᵀ z,   H = Aᵀ W A + ε + damping,   f = −Aᵀ W b
    subject to  lower ≤ [z; C z] ≤ upper,   C = [H_m*, −J_b*ᵀ B],   τ = C z + c_m* − τ_f    (7)

τ_f is the torque of friction (`joint_friction`), for which drives make up within their limits. The program has it at φ̇.
The torque, which is held over the period, makes up for it at φ̇ + h φ̈, so that a light joint with much friction, which
is as fast as its torque allows long before the period ends, is then as fast as it is to be.
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import entry, inlined
from ospace.kernels.jit.load_store import load6, store6, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.qp.joint_limits import clamp_joints, friction_at, limit_torque
from ospace.kernels.qp.tables import Answer, Program, ProgramLimits, Resistance, Weights
from ospace.kernels.spatial import add6, scale6
from ospace.kernels.tasks.all_tasks import assemble_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.tree import Floats
from ospace.kernels.workspace import open_robot, open_work

NOTHING, DEPENDENT = 1e-20, 1e-14
"""Square of a row that moves nothing; share of a row's square that is rounding."""


@inlined
def independence(A: Floats, first: int, last: int, work: Floats) -> float:
    """Smallest part of a row of A, from `first` to `last`, that is across those before, squared, over its own square.

    These are the pivots of A Aᵀ at unit diagonal: 1 for orthogonal rows, 0 for dependent ones. Rows of nothing, such as
    those across the plane of a planar robot, do not count. `work` has as many rows as A.
    """
    smallest, columns = 1.0, A.shape[1]
    for row in range(first, last):
        whole = 0.0
        for k in range(columns):
            work[row, k] = A[row, k]
            whole += A[row, k] * A[row, k]
        if whole < NOTHING:
            for k in range(columns):
                work[row, k] = 0.0
            continue
        left = whole
        for other in range(first, row):
            along = 0.0
            for k in range(columns):
                along += work[other, k] * work[row, k]
            for k in range(columns):
                work[row, k] -= along * work[other, k]
        left = 0.0
        for k in range(columns):
            left += work[row, k] * work[row, k]
        smallest = min(smallest, left / whole)
        scale = 1.0 / math.sqrt(left) if left > DEPENDENT * whole else 0.0
        for k in range(columns):
            work[row, k] *= scale
    return smallest


@inlined
def assemble_objective(tasks: Tasks, rows: TaskRows, weights: Weights, program: Program, n: int) -> None:
    """H and f."""
    H, f = program.H, program.f
    size = f.size
    for i in range(size):
        f[i] = 0.0
        for j in range(size):
            H[i, j] = 0.0
        H[i, i] = weights.regularization
    for t in range(tasks.kind.size):
        weight = weights.task[t]
        first, last = tasks.first[t], tasks.first[t + 1]
        weights.independence[t] = 1.0
        if tasks.geometric[t]:
            pivot = independence(rows.A, first, last, weights.orthogonal)
            weights.independence[t] = pivot
            if pivot < weights.singular and weight > 0.0:
                trace = 0.0
                for row in range(first, last):
                    for k in range(size):
                        trace += rows.A[row, k] * rows.A[row, k]
                near = 1.0 - pivot / weights.singular
                for k in range(n):
                    H[k, k] += weight * weights.damping * near * near * trace / (last - first)
        if weight > 0.0:
            for row in range(first, last):
                for i in range(size):
                    a = weight * rows.A[row, i]
                    if a != 0.0:
                        f[i] -= a * rows.b[row]
                        for j in range(size):
                            H[i, j] += a * rows.A[row, j]


@entry
def assemble(
    time: float,
    memory: Floats,
    base: BaseActuation,
    tasks: Tasks,
    limits: ProgramLimits,
    resistance: Resistance,
    weights: Weights,
    rows: TaskRows,
    program: Program,
    outside: Floats,
) -> float:
    """Fill rows and program for the state that was evaluated last in `memory`.

    Write by how much each joint is outside its position limits to `outside` (n,), and return the largest.
    """
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    assemble_rows(w, robot, base, tasks, rows, time)
    farthest = clamp_joints(robot.joints, w, limits, program, outside)
    limit_torque(w, base, limits, resistance, program)
    assemble_objective(tasks, rows, weights, program, limits.velocity.size)
    return farthest


@entry
def recover_solution(
    z: Floats,
    memory: Floats,
    base: BaseActuation,
    h: float,
    resistance: Resistance,
    rows: TaskRows,
    program: Program,
    answer: Answer,
) -> float:
    """Torque, base acceleration and residuals of a solution; return by how much it passes a bound, relative to that."""
    w = open_work(unowned(memory), zeros(1))
    n, excess = answer.torque.size, 0.0
    for k in range(z.size):
        excess = max(excess, bound_violation(z[k], program.lower[k], program.upper[k]))
    for j in range(n):
        value = 0.0
        for k in range(z.size):
            value += program.C[j, k] * z[k]
        rate = w.velocity[j + 6, 0] + h * z[j]
        answer.torque[j] = value + w.generalized_bias[j, 0] - friction_at(resistance, j, rate)
        excess = max(excess, bound_violation(value, program.lower[z.size + j], program.upper[z.size + j]))
    a = load6(w.base_drift, 0)
    for k in range(z.size):
        column = load6(w.J_b_star, k + 1) if k < n else load6(base.response, k - n)
        a = add6(a, scale6(column, z[k]))
    store6(answer.base_acceleration, 0, a)
    for row in range(rows.b.size):
        s = -rows.b[row]
        for k in range(z.size):
            s += rows.A[row, k] * z[k]
        answer.residual[row] = s
    return excess


@inlined
def bound_violation(value: float, lower: float, upper: float) -> float:
    """By how much `value` is outside its bounds, relative to them and at least to 1; infinite if it is not finite."""
    if not math.isfinite(value):
        return math.inf
    above = (value - upper) / max(1.0, abs(upper))
    below = (lower - value) / max(1.0, abs(lower))
    return max(above, below)

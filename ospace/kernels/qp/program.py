"""The quadratic program of one control cycle, from the tables that `evaluation` leaves.

With z = [φ̈; û] as in `tasks`, and W the weights of the rows,

    minimize ½ zᵀ H z + fᵀ z,   H = Aᵀ W A + ε + D,   f = −Aᵀ W b + D_s d φ̇
    subject to  lower ≤ [z; C z] ≤ upper,   C = [H_m*, −J_b*ᵀ B; G],   τ = (C z)_τ + c_m* − τ_f    (7)

G has the rows of inequalities that users bring; they are there before (`custom_rows`).

The joints are damped by the diagonal D = D_s + D_0. A task of r rows A, error e, stiffness k and damping d adds to
these, with a_k the column of joint k, ā² = |A|² / r and ê = e + ė d/k,

    D_s:  w s (|a_k|² + 0.03 ā²),   s = min(1, |ê|² / (δ ā)²)     min ½ w s (|a_k|² + 0.03 ā²) (φ̈_k + d φ̇_k)²
    D_0:  w damping (1 − p / singular)² ā²,   if p < singular     p the smallest pivot of A Aᵀ at unit diagonal

D_s is Levenberg's and Marquardt's: |ê| / ā is about how far joints have to move for what spring and damper ask, as much
as a spring alone does at the error ê, and the rows hold only within a trust radius δ of here. The error's rate is in it
because a reference that leaves the reach is seen by that first, and because an error that falls needs no damping.
Beyond the radius, as where a target is out of reach, b pulls a stretched arm straight from either side, while the
damping that it demands of the error's rate vanishes, as d σ² does along a direction of singular value σ: the arm would
swing at full torque. So joints are damped by d themselves, those that move the task by their share.

In passing a singularity ê is next to nothing, and so is s. D_0 bounds φ̈ there, and leaves φ̇ alone. With a `damping` of
about `singular` it sets in smoothly; with a larger one it is a switch, at which torques jump.

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
from ospace.kernels.tasks.rows import LEAST_STIFFNESS
from ospace.kernels.tasks.tables import CENTRE_OF_MASS, BaseActuation, TaskRows, Tasks
from ospace.kernels.tree import Floats
from ospace.kernels.workspace import Work, open_robot, open_work

NOTHING, DEPENDENT = 1e-20, 1e-14
"""Square of a row that moves nothing; share of a row's square that is rounding."""
EVENLY = 0.03
"""Of the mean square of rows, by which all joints are damped beside those that move the task: it may rest on others, as
where a joint is at a limit or another task stands against it."""


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
def damp_joints(A: Floats, error: Floats, first: int, last: int, t: int, weights: Weights) -> None:
    """D_0 + D_s and D_s of one task, over its weight."""
    n = weights.damped.shape[1]
    whole, far = 0.0, 0.0
    for row in range(first, last):
        far += error[row] * error[row]
        for k in range(A.shape[1]):
            whole += A[row, k] * A[row, k]
    mean = whole / (last - first)
    trusted = weights.trust_radius * weights.trust_radius * mean
    s = far / trusted if far < trusted else 1.0
    near = max(0.0, 1.0 - weights.independence[t] / weights.singular)
    for k in range(n):
        square = EVENLY * mean
        for row in range(first, last):
            square += A[row, k] * A[row, k]
        weights.slowed[t, k] = s * square
        weights.damped[t, k] = weights.slowed[t, k] + weights.damping * near * near * mean


@inlined
def assemble_objective(w: Work, tasks: Tasks, rows: TaskRows, weights: Weights, program: Program, n: int) -> None:
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
        if tasks.geometric[t]:
            weights.independence[t] = independence(rows.A, first, last, weights.orthogonal)
            damp_joints(rows.A, rows.equivalent_error, first, last, t, weights)
            for k in range(n):
                weights.slowed[t, k] *= tasks.gain[t, 1] * w.velocity[k + 6, 0]
                H[k, k] += weight * weights.damped[t, k]
                f[k] += weight * weights.slowed[t, k]
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
    assemble_objective(w, tasks, rows, weights, program, limits.velocity.size)
    return farthest


@entry
def recover_solution(
    z: Floats,
    memory: Floats,
    base: BaseActuation,
    h: float,
    resistance: Resistance,
    tasks: Tasks,
    rows: TaskRows,
    program: Program,
    answer: Answer,
) -> tuple[float, bool]:
    """Torque, base acceleration and residuals of a solution.

    Return by how much it passes a bound, relative to that, and whether a task falls short of its reference.
    """
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
    for j in range(n, program.C.shape[0]):
        value = 0.0
        for k in range(z.size):
            value += program.C[j, k] * z[k]
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
    return excess, fall_short(tasks, answer)


@inlined
def fall_short(tasks: Tasks, answer: Answer) -> bool:
    """Write by how much each geometric task stays short; return whether one does by more than it may.

    A residual A z − b that lasts is an error that rests at |A z − b| / k: there the spring alone asks for as much.
    """
    short = False
    for t in range(tasks.kind.size):
        if not tasks.geometric[t] and tasks.kind[t] != CENTRE_OF_MASS:
            continue
        linear, angular, k = 0.0, 0.0, max(tasks.gain[t, 0], LEAST_STIFFNESS)
        for row in range(tasks.first[t], tasks.first[t + 1]):
            square = answer.residual[row] * answer.residual[row]
            if tasks.rows[row] < 3:
                linear += square
            else:
                angular += square
        answer.short[t, 0], answer.short[t, 1] = math.sqrt(linear) / k, math.sqrt(angular) / k
        short |= answer.short[t, 0] > answer.allowed[t, 0] or answer.short[t, 1] > answer.allowed[t, 1]
    return short


@inlined
def bound_violation(value: float, lower: float, upper: float) -> float:
    """By how much `value` is outside its bounds, relative to them and at least to 1; infinite if it is not finite."""
    if not math.isfinite(value):
        return math.inf
    above = (value - upper) / max(1.0, abs(upper))
    below = (lower - value) / max(1.0, abs(lower))
    return max(above, below)

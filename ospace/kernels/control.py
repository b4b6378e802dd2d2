"""The quadratic program of one control cycle, from the tables that `evaluation` leaves.

With z = [φ̈; û] as in `tasks`, and W the weights of the rows,

    minimize ½ zᵀ H z + fᵀ z,   H = Aᵀ W A + ε + damping,   f = −Aᵀ W b
    subject to  lower ≤ [z; C z] ≤ upper,   C = [H_m*, −J_b*ᵀ B],   τ = C z + c_m* − τ_f    (7)

τ_f is the torque of friction (`joint_friction`), for which drives make up within their limits. The program has it at φ̇.
The torque, which is held over the period, makes up for it at φ̇ + h φ̈, so that a light joint with much friction, which
is as fast as its torque allows long before the period ends, is then as fast as it is to be.

The bounds on φ̈ come of position, velocity and acceleration limits in one clamp. With h the period, over which φ̈ is
held, a the deceleration at hand and d the way to a position limit that is left if the speed falls to zero in it,

    ceiling(d) = √((a h)² + 2 a d) − a h   for d ≥ 0,   −ceiling(−d) beyond
    φ̇_max = min(v, ceiling(φ_max − φ − h φ̇/2)),   φ̇_min = −min(v, ceiling(φ + h φ̇/2 − φ_min))
    (φ̇_min − φ̇)/h ≤ φ̈ ≤ (φ̇_max − φ̇)/h

at most ± the acceleration limit; and where a joint is outside already, no more than a is asked of it to come back.
Since ceiling grows with d, φ̇_min ≤ φ̇_max wherever φ is; so the bounds never contradict each other. The φ̈ of a joint
without a drive, whose torque limit is 0, has no bounds: nothing of its own could keep them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ospace.kernels.jit.compile import entry, inlined
from ospace.kernels.jit.load_store import load6, store6, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.joint_friction import friction_torque
from ospace.kernels.spatial import add6, dot6, scale6
from ospace.kernels.tasks import LOOK_AT, Actuation, Rows, Tasks, fill, wrench_of
from ospace.kernels.tree import HELICAL, PRISMATIC, REVOLUTE, Floats, Ints, Joints
from ospace.kernels.workspace import Work, open_robot, open_work

UNLIMITED = 1e30
"""What bounds beyond count as none."""
NOTHING, DEPENDENT = 1e-20, 1e-14
"""Square of a row that moves nothing; share of a row's square that is rounding."""
POSITION, VELOCITY, ACCELERATION = range(3)


class Limits(NamedTuple):
    """What must not be passed; ±`UNLIMITED` where there is no limit."""

    torque: Floats
    """(2, n) lower, upper."""
    position: Floats
    """(2, n)."""
    velocity: Floats
    """(n,)."""
    acceleration: Floats
    """(n,)."""
    wrench: Floats
    """(2, k) of û."""
    reaction: float
    """h, s."""
    braking: float
    """Share of what the torque limit could decelerate that the clamp counts on."""


class Resistance(NamedTuple):
    """Torques that drives provide while all accelerations are zero."""

    damping: Floats
    """(n,)."""
    coulomb: Floats
    """(2, n) at negative, then at positive rates."""
    bias: Floats
    """(n,) work: c_m* − τ_f at φ̇."""


class Program(NamedTuple):
    """The quadratic program."""

    H: Floats
    f: Floats
    C: Floats
    lower: Floats
    upper: Floats
    """(n + k + n,)."""
    cause: Ints
    """(2, n) which limit each bound on φ̈ comes of."""


class Weights(NamedTuple):
    """What counts how much."""

    task: Floats
    """(T,); zero for tasks of a strict level."""
    regularization: float
    """ε on φ̈ and û."""
    singular: float
    """Independence of a task's rows below which they are damped."""
    damping: float
    """Largest damping, relative to the mean diagonal of A Aᵀ."""
    independence: Floats
    """(T,) work: smallest pivot of A Aᵀ of each task at unit diagonal."""
    orthogonal: Floats
    """(m, n + k) work."""


class Answer(NamedTuple):
    """What comes of a solution."""

    torque: Floats
    base_acceleration: Floats
    """(1, 6)."""
    residual: Floats
    """(m,) A z − b."""


@inlined
def ceiling(d: float, a: float, h: float) -> float:
    """Largest speed at the end of a period of h from which a stop within d is possible; back inside for d < 0."""
    speed = 2.0 * a * abs(d) / (math.sqrt(a * h * a * h + 2.0 * a * abs(d)) + a * h + 1e-300)
    return speed if d >= 0.0 else -speed


@inlined
def clamp_joints(joints: Joints, w: Work, limits: Limits, program: Program, outside: Floats) -> float:
    """Bounds on φ̈; write by how much each joint is outside its position limits (n,), and return the largest."""
    h, farthest = limits.reaction, 0.0
    for j in range(limits.velocity.size):
        rate, most, v = w.velocity[j + 6, 0], limits.acceleration[j], limits.velocity[j]
        fast, slow = v, -v
        outside[j] = 0.0
        if joints.kind[j + 1] in (REVOLUTE, PRISMATIC, HELICAL):
            angle = w.q[joints.first[j + 1], 0]
            outside[j] = max(0.0, limits.position[0, j] - angle, angle - limits.position[1, j])
            farthest = max(farthest, outside[j])
        if limits.torque[0, j] == limits.torque[1, j]:
            program.lower[j], program.upper[j] = -UNLIMITED, UNLIMITED
            continue
        force = min(limits.torque[1, j], -limits.torque[0, j])
        a = max(min(most, limits.braking * force / w.generalized_inertia[j, j]), 1e-6)
        if joints.kind[j + 1] in (REVOLUTE, PRISMATIC, HELICAL):
            angle = w.q[joints.first[j + 1], 0] + 0.5 * h * rate
            fast = min(v, max(-v, ceiling(limits.position[1, j] - angle, a, h)))
            slow = -min(v, max(-v, ceiling(angle - limits.position[0, j], a, h)))
        low, high = min((slow - rate) / h, a), max((fast - rate) / h, -a)
        program.lower[j], program.upper[j] = min(max(low, -most), most), min(max(high, -most), most)
        program.cause[0, j] = ACCELERATION if low <= -most else VELOCITY if slow == -v else POSITION
        program.cause[1, j] = ACCELERATION if high >= most else VELOCITY if fast == v else POSITION
    return farthest


@inlined
def limit_torque(w: Work, base: Actuation, limits: Limits, resistance: Resistance, program: Program) -> None:
    """Rows of torque, and bounds on them and on û."""
    n, k = limits.velocity.size, base.component.size
    for j in range(n):
        for i in range(n):
            program.C[j, i] = w.generalized_inertia[j, i]
        J_b = load6(w.J_b_star, j + 1)
        for i in range(k):
            program.C[j, n + i] = -dot6(J_b, wrench_of(w, base, i))
        resistance.bias[j] = w.generalized_bias[j, 0] - friction_at(resistance, j, w.velocity[j + 6, 0])
        program.lower[n + k + j] = limits.torque[0, j] - resistance.bias[j]
        program.upper[n + k + j] = limits.torque[1, j] - resistance.bias[j]
    for i in range(k):
        program.lower[n + i] = limits.wrench[0, i]
        program.upper[n + i] = limits.wrench[1, i]


@inlined
def friction_at(resistance: Resistance, j: int, rate: float) -> float:
    """τ_f of joint `j`."""
    return friction_torque(resistance.damping[j], resistance.coulomb[0, j], resistance.coulomb[1, j], rate)


@inlined
def independence(A: Floats, first: int, last: int, work: Floats) -> float:
    """Smallest part of a row of A, from `first` to `last`, that is across those before, squared, over its own square.

    These are the pivots of A Aᵀ at unit diagonal: 1 for orthogonal rows, 0 for dependent ones. Rows of nothing, such
    as those across the plane of a planar robot, do not count. `work` has as many rows as A.
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
def weigh(tasks: Tasks, rows: Rows, weights: Weights, program: Program, n: int) -> None:
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
        if tasks.kind[t] <= LOOK_AT:
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
    base: Actuation,
    tasks: Tasks,
    limits: Limits,
    resistance: Resistance,
    weights: Weights,
    rows: Rows,
    program: Program,
    outside: Floats,
) -> float:
    """Fill rows and program for the state that was evaluated last in `memory`.

    Write by how much each joint is outside its position limits to `outside` (n,), and return the largest.
    """
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    fill(w, robot, base, tasks, rows, time)
    farthest = clamp_joints(robot.joints, w, limits, program, outside)
    limit_torque(w, base, limits, resistance, program)
    weigh(tasks, rows, weights, program, limits.velocity.size)
    return farthest


@entry
def finish(
    z: Floats,
    memory: Floats,
    base: Actuation,
    h: float,
    resistance: Resistance,
    rows: Rows,
    program: Program,
    answer: Answer,
) -> float:
    """Torque, base acceleration and residuals of a solution; return by how much it passes a bound, relative to that."""
    w = open_work(unowned(memory), zeros(1))
    n, excess = answer.torque.size, 0.0
    for k in range(z.size):
        excess = max(excess, passed(z[k], program.lower[k], program.upper[k]))
    for j in range(n):
        value = 0.0
        for k in range(z.size):
            value += program.C[j, k] * z[k]
        rate = w.velocity[j + 6, 0] + h * z[j]
        answer.torque[j] = value + w.generalized_bias[j, 0] - friction_at(resistance, j, rate)
        excess = max(excess, passed(value, program.lower[z.size + j], program.upper[z.size + j]))
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
def passed(value: float, lower: float, upper: float) -> float:
    """By how much `value` is outside its bounds, relative to them and at least to 1; infinite if it is not finite."""
    if not math.isfinite(value):
        return math.inf
    above = (value - upper) / max(1.0, abs(upper))
    below = (lower - value) / max(1.0, abs(lower))
    return max(above, below)

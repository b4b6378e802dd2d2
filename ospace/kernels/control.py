"""The quadratic program of one control cycle, from the tables that `evaluation` leaves.

With z = [φ̈; û] as in `tasks`, and W the weights of the rows,

    minimize ½ zᵀ H z + fᵀ z,   H = Aᵀ W A + ε + damping,   f = −Aᵀ W b
    subject to  lower ≤ [z; C z] ≤ upper,   C = [H_m*, −J_b*ᵀ B],   τ = C z + c_m*          (7)

The bounds on φ̈ come of position, velocity and acceleration limits in one clamp. With h the reaction time, a the
deceleration at hand and d the way to a position limit,

    ceiling(d) = √((a h/2)² + 2 a d) − a h/2   for d ≥ 0,   −ceiling(−d) beyond
    φ̇_max = min(v, ceiling(φ_max − φ)),   φ̇_min = −min(v, ceiling(φ − φ_min))
    clip((φ̇_min − φ̇)/h) ≤ φ̈ ≤ clip((φ̇_max − φ̇)/h),   clip to ± the acceleration limit

Since ceiling grows with d, φ̇_min ≤ φ̇_max wherever φ is; so the bounds never contradict each other.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ospace.kernels.kinematics import CONTINUOUS, Joints
from ospace.kernels.lanes import entry, inlined, load6, store6
from ospace.kernels.memory import Work, open_robot, open_work
from ospace.kernels.simd import zeros
from ospace.kernels.spatial import add6, dot6, scale6
from ospace.kernels.tables import Floats, Ints
from ospace.kernels.tasks import LOOK_AT, Actuation, Rows, Tasks, fill, wrench_of

UNLIMITED = 1e30
"""What bounds beyond count as none."""
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
    gram: Floats
    """(6, 6) work."""


class Answer(NamedTuple):
    """What comes of a solution."""

    torque: Floats
    base_acceleration: Floats
    """(1, 6)."""
    residual: Floats
    """(m,) A z − b."""


@inlined
def ceiling(d: float, a: float, h: float) -> float:
    """Largest speed from which a stop within d is possible, by deceleration a begun after h; back inside for d < 0."""
    half = 0.5 * a * h
    speed = 2.0 * a * abs(d) / (math.sqrt(half * half + 2.0 * a * abs(d)) + half + 1e-300)
    return speed if d >= 0.0 else -speed


@inlined
def clamp_joints(joints: Joints, w: Work, limits: Limits, program: Program) -> None:
    """Bounds on φ̈."""
    h = limits.reaction
    for j in range(limits.velocity.size):
        rate, most, v = w.velocity[j + 6, 0], limits.acceleration[j], limits.velocity[j]
        fast, slow = v, -v
        if joints.kind[j + 1] != CONTINUOUS:
            force = min(limits.torque[1, j], -limits.torque[0, j])
            a = max(min(most, limits.braking * force / w.generalized_inertia[j, j]), 1e-6)
            angle = w.q[joints.first[j + 1], 0]
            fast = min(v, max(-v, ceiling(limits.position[1, j] - angle, a, h)))
            slow = -min(v, max(-v, ceiling(angle - limits.position[0, j], a, h)))
        low, high = (slow - rate) / h, (fast - rate) / h
        program.lower[j], program.upper[j] = min(max(low, -most), most), min(max(high, -most), most)
        program.cause[0, j] = ACCELERATION if abs(low) >= most else VELOCITY if slow == -v else POSITION
        program.cause[1, j] = ACCELERATION if abs(high) >= most else VELOCITY if fast == v else POSITION


@inlined
def limit_torque(w: Work, base: Actuation, limits: Limits, program: Program) -> None:
    """Rows of torque, and bounds on them and on û."""
    n, k = limits.velocity.size, base.component.size
    for j in range(n):
        for i in range(n):
            program.C[j, i] = w.generalized_inertia[j, i]
        J_b = load6(w.J_b_star, j + 1)
        for i in range(k):
            program.C[j, n + i] = -dot6(J_b, wrench_of(w, base, i))
        program.lower[n + k + j] = limits.torque[0, j] - w.generalized_bias[j, 0]
        program.upper[n + k + j] = limits.torque[1, j] - w.generalized_bias[j, 0]
    for i in range(k):
        program.lower[n + i] = limits.wrench[0, i]
        program.upper[n + i] = limits.wrench[1, i]


@inlined
def independence(A: Floats, first: int, last: int, gram: Floats) -> float:
    """Smallest pivot of A Aᵀ over rows `first` to `last`, at unit diagonal: 1 for orthogonal rows, 0 for dependent."""
    r, smallest = last - first, 1.0
    for i in range(r):
        for j in range(i + 1):
            s = 0.0
            for k in range(A.shape[1]):
                s += A[first + i, k] * A[first + j, k]
            gram[i, j] = s
    for i in range(r):
        diagonal = gram[i, i]
        for j in range(i + 1):
            s = gram[i, j]
            for k in range(j):
                s -= gram[i, k] * gram[j, k]
            if i == j:
                pivot = s / diagonal if diagonal > 0.0 else 0.0
                smallest = min(smallest, pivot)
                gram[i, i] = math.sqrt(max(s, 1e-300))
            else:
                gram[i, j] = s / gram[j, j]
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
            pivot = independence(rows.A, first, last, weights.gram)
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
    weights: Weights,
    rows: Rows,
    program: Program,
) -> None:
    """Fill rows and program for the state that was evaluated last in `memory`."""
    robot, w = open_robot(memory), open_work(memory, zeros(1))
    fill(w, robot, base, tasks, rows, time)
    clamp_joints(robot.joints, w, limits, program)
    limit_torque(w, base, limits, program)
    weigh(tasks, rows, weights, program, limits.velocity.size)


@entry
def finish(z: Floats, memory: Floats, base: Actuation, rows: Rows, program: Program, answer: Answer) -> None:
    """Torque, base acceleration and residuals of a solution."""
    w = open_work(memory, zeros(1))
    n = answer.torque.size
    for j in range(n):
        torque = w.generalized_bias[j, 0]
        for k in range(z.size):
            torque += program.C[j, k] * z[k]
        answer.torque[j] = torque
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

"""Bounds of the program: the clamp of joint accelerations, and torque limits.

The bounds on φ̈ come of position, velocity and acceleration limits in one clamp. With h the period, over which φ̈ is
held, T ≥ h the horizon, a the deceleration at hand and d the way to a position limit that is left if the speed falls to
zero in a period,

    ceiling(d) = √((a T)² + 2 a d) − a T   for d ≥ 0,   −ceiling(−d) beyond
    φ̇_max = min(v, ceiling(φ_max − φ − h φ̇/2)),   φ̇_min = −min(v, ceiling(φ + h φ̇/2 − φ_min))
    (φ̇_min − φ̇)/r ≤ φ̈ ≤ (φ̇_max − φ̇)/r,   r = max(h, T/4)

ceiling(d) is the speed from which a stop is possible after the way of one horizon: T ceiling + ceiling²/(2 a) = d.
Next to a limit, where ceiling(d) = d/T, a joint that is pushed against it comes to rest as the critically damped
T²/4 φ̈ + T φ̇ + (φ − φ_max) = 0 does, which stands delays of T/8 and some noise. With T = h it rests by deadbeat, in one
period, and swings under any delay and any noise.

The bounds are at most ± the acceleration limit; and where a joint is outside already, no more than a is asked of it to
come back. Since ceiling grows with d, φ̇_min ≤ φ̇_max wherever φ is; so the bounds never contradict each other. The φ̈ of
a joint without a drive, whose torque limit is 0, has no bounds: nothing of its own could keep them.
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load6
from ospace.kernels.joint_friction import friction_torque
from ospace.kernels.qp.tables import ACCELERATION, POSITION, UNLIMITED, VELOCITY, Program, ProgramLimits, Resistance
from ospace.kernels.spatial import dot6
from ospace.kernels.tasks.rows import wrench_of
from ospace.kernels.tasks.tables import BaseActuation
from ospace.kernels.tree import HELICAL, PRISMATIC, REVOLUTE, Floats, Joints
from ospace.kernels.workspace import Work


@inlined
def ceiling(d: float, a: float, h: float) -> float:
    """Largest speed from which a stop within d is possible, one horizon of h later; back inside for d < 0."""
    speed = 2.0 * a * abs(d) / (math.sqrt(a * h * a * h + 2.0 * a * abs(d)) + a * h + 1e-300)
    return speed if d >= 0.0 else -speed


@inlined
def clamp_joints(joints: Joints, w: Work, limits: ProgramLimits, program: Program, outside: Floats) -> float:
    """Bounds on φ̈; write by how much each joint is outside its position limits (n,), and return the largest."""
    h, farthest = limits.reaction, 0.0
    T = max(h, limits.horizon)
    r = max(h, 0.25 * T)
    for j in range(limits.velocity.size):
        rate, most, v, i = w.velocity[j + 6, 0], limits.acceleration[j], limits.velocity[j], joints.link_of[j]
        fast, slow = v, -v
        outside[j] = 0.0
        if joints.kind[i] in (REVOLUTE, PRISMATIC, HELICAL):
            angle = w.q[joints.first[i], 0]
            outside[j] = max(0.0, limits.position[0, j] - angle, angle - limits.position[1, j])
            farthest = max(farthest, outside[j])
        if limits.torque[0, j] == limits.torque[1, j]:
            program.lower[j], program.upper[j] = -UNLIMITED, UNLIMITED
            continue
        force = min(limits.torque[1, j], -limits.torque[0, j])
        a = max(min(most, limits.braking * force / w.generalized_inertia[j, j]), 1e-6)
        if joints.kind[i] in (REVOLUTE, PRISMATIC, HELICAL):
            angle = w.q[joints.first[i], 0] + 0.5 * h * rate
            fast = min(v, max(-v, ceiling(limits.position[1, j] - angle, a, T)))
            slow = -min(v, max(-v, ceiling(angle - limits.position[0, j], a, T)))
        low, high = min((slow - rate) / r, a), max((fast - rate) / r, -a)
        program.lower[j], program.upper[j] = min(max(low, -most), most), min(max(high, -most), most)
        program.cause[0, j] = ACCELERATION if low <= -most else VELOCITY if slow == -v else POSITION
        program.cause[1, j] = ACCELERATION if high >= most else VELOCITY if fast == v else POSITION
    return farthest


@inlined
def limit_torque(w: Work, base: BaseActuation, limits: ProgramLimits, resistance: Resistance, program: Program) -> None:
    """TaskRows of torque, and bounds on them and on û."""
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

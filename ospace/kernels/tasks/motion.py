"""A point follows a reference: position, orientation, or both; along inertial axes, or its own.

In axes of the point, which turn with ω, the error e of the place is e' = Rᵀ e, and

    ë' = Rᵀ (ë − ω̇ × e − 2 ω × ė + ω × (ω × e)),     ω̇ = J_ω z + drift

so that the rows are Rᵀ (J_v z + (J_ω z) × e). The turn r that is left is r' = Rᵀ r, where, at r = 0,

    r̈ = α_ref − α − ω_ref × ω,     r̈' = Rᵀ (α_ref − α + ω_ref × ω)

Where one of the three rotations is not taken, about the unit vector a in axes of the point, that axis is brought in
line with the same axis u = Rᵀ R_ref a of the reference: r' = a × u θ/sin θ, θ the angle between them, for any roll.
With w = Rᵀ (ω_ref − ω), at θ = 0,

    r̈' = Rᵀ (α_ref − α + ω_ref × ω) + (w·a) (a × w)      across a
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Mat3, Vec3, Vec6, inlined
from ospace.kernels.jit.load_store import load6, store6
from ospace.kernels.so3 import rotation_vector
from ospace.kernels.spatial import add3, add6, cross, dot3, mat3_mul, mat3_transpose, rotate, scale3, sub3, sub6
from ospace.kernels.tasks.reference import follow
from ospace.kernels.tasks.rows import base_velocity, column_of, position_of, rotation_of, velocity_of, write_task_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Robot, Work

ALIGNED = 1e-9
"""Sine of an angle below which two axes count as in line."""


@inlined
def motion_rows(w: Work, robot: Robot, base: BaseActuation, tasks: Tasks, rows: TaskRows, t: int, time: float) -> None:
    """A point follows the reference: place, rotation, or both."""
    e = tasks.point[t, 0]
    place, R_ref, v_ref, a_ref = follow(tasks, t, time)
    from_base = sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0]))
    if tasks.own_axes[t]:
        own_rows(w, robot, base, tasks, rows, t, from_base, R_ref, v_ref, a_ref)
        return
    turn = rotation_vector(mat3_mul(R_ref, mat3_transpose(rotation_of(w, robot, tasks, e))))
    error = sub3(from_base, position_of(w, tasks, e)) + turn
    v = velocity_of(w, robot, tasks, e)
    rate = sub3(sub3(v_ref[0:3], base_velocity(w)), v[0:3]) + sub3(v_ref[3:6], v[3:6])
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, column_of(w, base, tasks, e, k))
    turning = (0.0, 0.0, 0.0) + cross(v_ref[3:6], v[3:6])
    write_task_rows(tasks, rows, t, error, rate, sub6(add6(load6(w.drift, e), turning), a_ref))


@inlined
def own_rows(
    w: Work,
    robot: Robot,
    base: BaseActuation,
    tasks: Tasks,
    rows: TaskRows,
    t: int,
    place: Vec3,
    R_ref: Mat3,
    v_ref: Vec6,
    a_ref: Vec6,
) -> None:
    """Rows along and about the axes of the point; `place` is that of the reference about the base."""
    e = tasks.point[t, 0]
    R = rotation_of(w, robot, tasks, e)
    R_T = mat3_transpose(R)
    v, drift = velocity_of(w, robot, tasks, e), load6(w.drift, e)
    omega, left = v[3:6], sub3(place, position_of(w, tasks, e))
    left_rate = sub3(sub3(v_ref[0:3], base_velocity(w)), v[0:3])
    spin = rotate(R_T, sub3(v_ref[3:6], omega))
    turning = add3(scale3(cross(omega, left_rate), 2.0), scale3(cross(omega, cross(omega, left)), -1.0))
    linear = add3(sub3(add3(drift[0:3], cross(drift[3:6], left)), a_ref[0:3]), turning)
    angular = rotate(R_T, sub3(sub3(drift[3:6], a_ref[3:6]), cross(v_ref[3:6], omega)))
    a = roll_axis(tasks, t)
    if dot3(a, a) > 0.0:
        u = rotate(R_T, rotate(R_ref, a))
        off = cross(a, u)
        sine, cosine = math.sqrt(dot3(off, off)), dot3(a, u)
        if sine > ALIGNED:
            turn = scale3(off, math.atan2(sine, cosine) / sine)
        else:  # in line; or straight behind, where any axis across will do
            turn = scale3((a[1], a[2], a[0]), math.pi if cosine < 0.0 else 0.0)
        angular = sub3(angular, scale3(cross(a, spin), dot3(spin, a)))
    else:
        turn = rotation_vector(mat3_mul(R_T, R_ref))
    for k in range(rows.block.shape[0]):
        column = column_of(w, base, tasks, e, k)
        store6(rows.block, k, rotate(R_T, add3(column[0:3], cross(column[3:6], left))) + rotate(R_T, column[3:6]))
    rate = rotate(R_T, sub3(left_rate, cross(omega, left))) + spin
    write_task_rows(tasks, rows, t, rotate(R_T, left) + turn, rate, rotate(R_T, linear) + angular)


@inlined
def roll_axis(tasks: Tasks, t: int) -> Vec3:
    """The axis of the point that the task leaves alone while it takes the other two; zero without such an axis."""
    taken = (0.0, 0.0, 0.0)
    for row in range(tasks.first[t], tasks.first[t + 1]):
        c = tasks.rows[row]
        taken = (
            1.0 if c == 3 else taken[0],
            1.0 if c == 4 else taken[1],
            1.0 if c == 5 else taken[2],
        )
    one = 1.0 if taken[0] + taken[1] + taken[2] == 2.0 else 0.0
    return scale3(sub3((1.0, 1.0, 1.0), taken), one)

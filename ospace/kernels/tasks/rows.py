"""Rows of a task, and what they are made of: motion of the points, columns of joints and of the base wrench."""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Mat3, Number, Vec3, Vec6, inlined
from ospace.kernels.jit.load_store import load3, load3_at, load6, load6_at, load9, load21, store6
from ospace.kernels.spatial import add6, force_from, mat3_mul, motion_at, rotate, scale3, sub6, sym6_mul
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Robot, Work

LARGEST = 1e3
"""m/s², rad/s²."""
LEAST_STIFFNESS = 1.0
"""1/s², over which an acceleration is taken for an error at the least."""


@inlined
def wrench_of(w: Work, base: BaseActuation, k: int) -> Vec6:
    """The wrench on the base, at the base, that a unit of û_k is."""
    c, none = base.component[k], (0.0, 0.0, 0.0)
    axis = scale3(load3_at(w.R, 0, 3 * (c % 3)), base.scale[k])
    return axis + none if c < 3 else none + axis


@inlined
def base_response(w: Work, base: BaseActuation) -> None:
    """ẍ_b per unit of each û, to the rows of `base.response`."""
    for k in range(base.component.size):
        store6(base.response, k, sym6_mul(load21(w.base_inverse, 0), wrench_of(w, base, k)))


@inlined
def base_velocity(w: Work) -> Vec3:
    """v_b, inertial axes: what velocities of the work lack."""
    return rotate(load9(w.R, 0), (w.velocity[0, 0], w.velocity[1, 0], w.velocity[2, 0]))


@inlined
def rotation_of(w: Work, robot: Robot, tasks: Tasks, e: int) -> Mat3:
    """Rotation of point `e`."""
    return mat3_mul(load9(w.R, robot.nodes.link[tasks.node[e]]), load9(tasks.turn, e))


@inlined
def position_of(w: Work, tasks: Tasks, e: int) -> Vec3:
    """Place of point `e` about the base."""
    return load3(w.place, tasks.node[e])


@inlined
def velocity_of(w: Work, robot: Robot, tasks: Tasks, e: int) -> Vec6:
    """ẋ_e, seen from the frame that moves along with the base."""
    node = tasks.node[e]
    return motion_at(load3(w.arm, node), load6(w.v, robot.nodes.link[node]))


@inlined
def column_of(w: Work, base: BaseActuation, tasks: Tasks, e: int, k: int) -> Vec6:
    """Column `k` of what moves point `e`: of J_m*, then of the base's actuation."""
    n = w.J_m_star.shape[0]
    if k < n:
        return load6_at(w.J_m_star, k, 6 * e)
    return motion_at(position_of(w, tasks, e), load6(base.response, k - n))


@inlined
def write_task_rows(tasks: Tasks, rows: TaskRows, t: int, error: Vec6, rate: Vec6, drift: Vec6) -> None:
    """Write the rows taken of the task's block: b = d rate + k error − drift, where `rate` is ẋ_ref − ẋ."""
    k_l, d_l, k_a, d_a = tasks.gain[t, 0], tasks.gain[t, 1], tasks.gain[t, 2], tasks.gain[t, 3]
    demanded = add6(scale3(error[0:3], k_l) + scale3(error[3:6], k_a), scale3(rate[0:3], d_l) + scale3(rate[3:6], d_a))
    equivalent = scale3(demanded[0:3], 1.0 / max(k_l, LEAST_STIFFNESS)) + scale3(
        demanded[3:6], 1.0 / max(k_a, LEAST_STIFFNESS)
    )
    linear, angular = 0.0, 0.0
    for row in range(tasks.first[t], tasks.first[t + 1]):
        c = tasks.rows[row]
        if c < 3:
            linear += component(demanded, c) * component(demanded, c)
        else:
            angular += component(demanded, c) * component(demanded, c)
    demanded = sub6(
        scale3(demanded[0:3], saturation_factor(linear)) + scale3(demanded[3:6], saturation_factor(angular)), drift
    )
    for row in range(tasks.first[t], tasks.first[t + 1]):
        c = tasks.rows[row]
        rows.b[row] = component(demanded, c)
        rows.error[row] = component(error, c)
        rows.equivalent_error[row] = component(equivalent, c)
        for k in range(rows.A.shape[1]):
            rows.A[row, k] = rows.block[k, c]


@inlined
def saturation_factor(square: float) -> float:
    """Factor that cuts an acceleration to `LARGEST`, by its square."""
    return LARGEST / math.sqrt(square) if square > LARGEST * LARGEST else 1.0


@inlined
def component(x: Vec6, c: int) -> Number:
    """Component `c` of six."""
    low = x[0] if c == 0 else x[1] if c == 1 else x[2]
    high = x[3] if c == 3 else x[4] if c == 4 else x[5]
    return low if c < 3 else high


@inlined
def write_base_wrench_columns(w: Work, base: BaseActuation, rows: TaskRows, linear: float, angular: float) -> None:
    """Write the wrench of each û, about the centre of mass, times `linear` and `angular`, to the block."""
    for k in range(base.component.size):
        wrench = force_from(scale3(load3(w.mass_centre, 0), -1.0), wrench_of(w, base, k))
        at = w.J_m_star.shape[0] + k
        store6(rows.block, at, scale3(wrench[0:3], linear) + scale3(wrench[3:6], angular))

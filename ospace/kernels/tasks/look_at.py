"""An axis of a point looks at a position."""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Vec3, inlined
from ospace.kernels.jit.load_store import load6, store6
from ospace.kernels.spatial import add3, cross, dot3, rotate, scale3, sub3
from ospace.kernels.tasks.reference import follow
from ospace.kernels.tasks.rows import base_velocity, column_of, position_of, rotation_of, velocity_of, write_task_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Robot, Work


@inlined
def look_at_rows(w: Work, robot: Robot, base: BaseActuation, tasks: Tasks, rows: TaskRows, t: int, time: float) -> None:
    """An axis of a point looks at a position: the turn between them, about two axes across the line of sight d.

    With ω_d = d × ḋ the turning of the line of sight, ω̇_d = d × (a_ref − a_e)/r − 2 (ṙ/r) ω_d is its acceleration; an
    angular drift ω·d about it turns the error along.
    """
    e = tasks.point[t, 0]
    place, _, v_ref, a_ref = follow(tasks, t, time)
    line = sub3(sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0])), position_of(w, tasks, e))
    r = max(math.sqrt(dot3(line, line)), 1e-9)
    d = scale3(line, 1.0 / r)
    v = velocity_of(w, robot, tasks, e)
    closing = sub3(sub3(v_ref[0:3], base_velocity(w)), v[0:3])
    omega_d, range_rate_ratio = scale3(cross(d, closing), 1.0 / r), dot3(d, closing) / r
    n = rotate(rotation_of(w, robot, tasks, e), (tasks.axis[t, 0], tasks.axis[t, 1], tasks.axis[t, 2]))
    x, y = orthonormal_complement(d)
    off = cross(n, d)
    sine, cosine = math.sqrt(dot3(off, off)), dot3(n, d)
    if sine < 1e-9:
        off, sine = x, 1.0 if cosine < 0.0 else 0.0  # straight behind: turn about any axis across
        angle = math.pi if cosine < 0.0 else 0.0
    else:
        angle = math.atan2(sine, cosine)
        off = scale3(off, 1.0 / sine)
    turn, rate = scale3(off, angle), sub3(omega_d, v[3:6])
    drift = load6(w.drift, e)
    sight_acceleration = add3(
        scale3(cross(d, sub3(a_ref[0:3], drift[0:3])), 1.0 / r), scale3(omega_d, -2.0 * range_rate_ratio)
    )
    angular_drift = add3(sub3(drift[3:6], sight_acceleration), scale3(cross(d, v[3:6]), dot3(d, v[3:6])))
    for k in range(rows.block.shape[0]):
        column = column_of(w, base, tasks, e, k)
        c = add3(column[3:6], scale3(cross(d, column[0:3]), 1.0 / r))
        store6(rows.block, k, (0.0, 0.0, 0.0, dot3(x, c), dot3(y, c), 0.0))
    none = (0.0, 0.0, 0.0)
    write_task_rows(
        tasks,
        rows,
        t,
        none + (dot3(x, turn), dot3(y, turn), 0.0),
        none + (dot3(x, rate), dot3(y, rate), 0.0),
        none + (dot3(x, angular_drift), dot3(y, angular_drift), 0.0),
    )


@inlined
def orthonormal_complement(d: Vec3) -> tuple[Vec3, Vec3]:
    """Two unit vectors across the unit vector d and each other."""
    aside = (1.0, 0.0, 0.0) if abs(d[0]) < 0.6 else (0.0, 1.0, 0.0)
    x = cross(d, aside)
    x = scale3(x, 1.0 / math.sqrt(dot3(x, x)))
    return x, cross(d, x)

"""A point follows a reference as seen from another point of the robot."""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load6, store6
from ospace.kernels.so3 import rotation_vector
from ospace.kernels.spatial import add3, cross, mat3_mul, mat3_transpose, motion_at, rotate, scale3, sub3, sub6
from ospace.kernels.tasks.reference import follow
from ospace.kernels.tasks.rows import column_of, position_of, rotation_of, velocity_of, write_task_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Robot, Work


@inlined
def relative_pose_rows(
    w: Work, robot: Robot, base: BaseActuation, tasks: Tasks, rows: TaskRows, t: int, time: float
) -> None:
    """A point follows the reference as seen from a second one, whose axes the reference is in."""
    a, b = tasks.point[t, 0], tasks.point[t, 1]
    place, R_ref, v_ref, a_ref = follow(tasks, t, time)
    R_b = rotation_of(w, robot, tasks, b)
    r = sub3(position_of(w, tasks, a), position_of(w, tasks, b))
    v_a, v_b = velocity_of(w, robot, tasks, a), motion_at(r, velocity_of(w, robot, tasks, b))
    v, omega = sub6(v_a, v_b), v_b[3:6]  # as seen from b
    turn = rotation_vector(mat3_mul(mat3_mul(R_b, R_ref), mat3_transpose(rotation_of(w, robot, tasks, a))))
    error = sub3(rotate(R_b, place), r) + turn
    asked_v = rotate(R_b, v_ref[0:3]) + rotate(R_b, v_ref[3:6])
    rate = sub6(asked_v, v)
    for k in range(rows.block.shape[0]):
        moved = motion_at(r, column_of(w, base, tasks, b, k))
        store6(rows.block, k, sub6(column_of(w, base, tasks, a, k), moved))
    drift = sub6(load6(w.drift, a), motion_at(r, load6(w.drift, b)))
    turning = add3(cross(omega, cross(omega, r)), scale3(cross(omega, v[0:3]), 2.0)) + cross(omega, v[3:6])
    turning = sub6(turning, (0.0, 0.0, 0.0) + cross(asked_v[3:6], v[3:6]))
    demanded = rotate(R_b, a_ref[0:3]) + rotate(R_b, a_ref[3:6])
    write_task_rows(tasks, rows, t, error, rate, sub6(sub6(drift, turning), demanded))

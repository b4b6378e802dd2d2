"""A point follows a reference: position, orientation, or both."""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load6, store6
from ospace.kernels.so3 import rotation_vector
from ospace.kernels.spatial import add6, cross, mat3_mul, mat3_transpose, sub3, sub6
from ospace.kernels.tasks.reference import follow
from ospace.kernels.tasks.rows import base_velocity, column_of, position_of, rotation_of, velocity_of, write_task_rows
from ospace.kernels.tasks.tables import BaseActuation, TaskRows, Tasks
from ospace.kernels.workspace import Robot, Work


@inlined
def motion_rows(w: Work, robot: Robot, base: BaseActuation, tasks: Tasks, rows: TaskRows, t: int, time: float) -> None:
    """A point follows the reference: place, rotation, or both."""
    e = tasks.point[t, 0]
    place, R_ref, v_ref, a_ref = follow(tasks, t, time)
    from_base = sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0]))
    turn = rotation_vector(mat3_mul(R_ref, mat3_transpose(rotation_of(w, robot, tasks, e))))
    error = sub3(from_base, position_of(w, tasks, e)) + turn
    v = velocity_of(w, robot, tasks, e)
    rate = sub3(sub3(v_ref[0:3], base_velocity(w)), v[0:3]) + sub3(v_ref[3:6], v[3:6])
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, column_of(w, base, tasks, e, k))
    turning = (0.0, 0.0, 0.0) + cross(v_ref[3:6], v[3:6])
    write_task_rows(tasks, rows, t, error, rate, sub6(add6(load6(w.drift, e), turning), a_ref))

"""Joints approach a posture, or come to rest."""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Number, Table, inlined
from ospace.kernels.kinematics import quaternion_in, rotation
from ospace.kernels.so3 import rotation_vector
from ospace.kernels.spatial import mat3_mul, mat3_transpose, rotate
from ospace.kernels.tasks.rows import LARGEST, component
from ospace.kernels.tasks.tables import POSTURE, TaskRows, Tasks
from ospace.kernels.tree import CONTINUOUS, FLOATING, PLANAR, SAME_JOINT, SPHERICAL, Floats, Joints
from ospace.kernels.workspace import Robot, Work


@inlined
def position_error(joints: Joints, q: Table, posture: Floats, t: int, j: int) -> Number:
    """Position error of joint rate `j`, along or about the axis of its column, from `q` to the posture."""
    i = own = joints.link_of[j]
    while joints.kind[i] == SAME_JOINT:
        i -= 1
    k, kind, column = joints.first[i], joints.kind[i], own - i
    if kind == CONTINUOUS:
        return angle_between(q[k, 0], q[k + 1, 0], posture[t, k], posture[t, k + 1])
    if kind == PLANAR and column == 2:
        return angle_between(q[k + 2, 0], q[k + 3, 0], posture[t, k + 2], posture[t, k + 3])
    if kind == PLANAR:
        x, y = posture[t, k] - q[k, 0], posture[t, k + 1] - q[k + 1, 0]
        c, s = q[k + 2, 0], q[k + 3, 0]
        return c * x + s * y if column == 0 else c * y - s * x
    if kind == FLOATING and column < 3:
        way = (posture[t, k] - q[k, 0], posture[t, k + 1] - q[k + 1, 0], posture[t, k + 2] - q[k + 2, 0])
        R_T = mat3_transpose(rotation(quaternion_in(q, k + 3)))
        return component(rotate(R_T, way) + (0.0, 0.0, 0.0), column)
    if kind in (SPHERICAL, FLOATING):
        first = k + 3 if kind == FLOATING else k
        R = rotation(quaternion_in(q, first))
        R_ref = rotation((posture[t, first], posture[t, first + 1], posture[t, first + 2], posture[t, first + 3]))
        turn = rotation_vector(mat3_mul(mat3_transpose(R), R_ref))
        return component(turn + turn, column)
    return posture[t, k] - q[k, 0]


@inlined
def angle_between(c: float, s: float, c_ref: float, s_ref: float) -> float:
    """Angle from one direction to the other, each by cosine and sine."""
    return math.atan2(s_ref * c - c_ref * s, c_ref * c + s_ref * s)


@inlined
def joint_rows(w: Work, robot: Robot, tasks: Tasks, rows: TaskRows, t: int) -> None:
    """Joints approach a posture, or come to rest: one row for each joint."""
    k, d = tasks.gain[t, 0], tasks.gain[t, 1]
    for row in range(tasks.first[t], tasks.first[t + 1]):
        j = tasks.rows[row]
        rate = w.velocity[j + 6, 0]
        error = position_error(robot.joints, w.q, tasks.posture, t, j) if tasks.kind[t] == POSTURE else -rate
        demanded = (k * error if tasks.kind[t] == POSTURE else 0.0) - d * rate
        rows.b[row] = min(max(demanded, -LARGEST), LARGEST)
        rows.error[row] = error
        for column in range(rows.A.shape[1]):
            rows.A[row, column] = 0.0
        rows.A[row, j] = 1.0

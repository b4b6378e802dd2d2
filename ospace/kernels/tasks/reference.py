"""Place and motion of a task's reference."""

from __future__ import annotations

from ospace.kernels.jit.compile import Mat3, Vec3, Vec6, inlined
from ospace.kernels.jit.load_store import load3_at, load6_at
from ospace.kernels.minimum_jerk import minimum_jerk
from ospace.kernels.so3 import exponential
from ospace.kernels.spatial import add3, add6, mat3_mul, scale3
from ospace.kernels.tasks.tables import (
    ACCELERATION,
    DISPLACEMENT,
    DURATION,
    POSITION,
    ROTATION,
    ROTATION_VECTOR,
    START,
    VELOCITY,
    Tasks,
)


@inlined
def follow(tasks: Tasks, t: int, time: float) -> tuple[Vec3, Mat3, Vec6, Vec6]:
    """Place, rotation, velocity and acceleration of the reference of task `t`."""
    row = tasks.reference
    s, rate, curve = 0.0, 0.0, 0.0
    if row[t, DURATION] > 0.0:
        T = row[t, DURATION]
        s, rate, curve = minimum_jerk((time - row[t, START]) / T)
        rate, curve = rate / T, curve / (T * T)
    place, way = load3_at(row, t, POSITION), load3_at(row, t, DISPLACEMENT)
    turning = load3_at(row, t, ROTATION_VECTOR)
    R_0 = load3_at(row, t, ROTATION) + load3_at(row, t, ROTATION + 3) + load3_at(row, t, ROTATION + 6)
    v = add6(load6_at(row, t, VELOCITY), scale3(way, rate) + scale3(turning, rate))
    a = add6(load6_at(row, t, ACCELERATION), scale3(way, curve) + scale3(turning, curve))
    return add3(place, scale3(way, s)), mat3_mul(exponential(scale3(turning, s)), R_0), v, a

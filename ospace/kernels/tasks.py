"""Rows of tasks: what each asks of the accelerations z = [φ̈; û] of the reduced dynamics.

With û the actuated part of the base wrench over its scale, B its columns, and a⁰ the drift while z = 0,

    ẍ_e = J_m* φ̈ + J_b H_b⁻¹ B û + a⁰_e                             (5), (7)
    A z = ẍ_ref + d (ẋ_ref − ẋ) + k e − a⁰ = b

where e is the error, k a stiffness (1/s²) and d = 2 ζ √k. All in inertial axes at the point. What k e + d ė asks for in
the rows taken is cut to `LARGEST`, linear and angular by themselves, so that a target out of reach leaves the program
well scaled.

The error of an orientation is the vector of the turn that is left, R_ref Rᵀ; its rate is ω_ref − ω, and that of its
rate α_ref − α − ω_ref × ω, for small errors.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ospace.kernels.jit.compile import Number, Row, Table, inlined
from ospace.kernels.jit.load_store import load3, load3_at, load6, load6_at, load9, load21, store6
from ospace.kernels.kinematics import quaternion_in, rotation
from ospace.kernels.so3 import exponential, rotation_vector
from ospace.kernels.spatial import (
    add3,
    add6,
    cross,
    dot3,
    force_from,
    mat3_mul,
    mat3_transpose,
    motion_at,
    rotate,
    scale3,
    scale6,
    sub3,
    sub6,
    sym6_mul,
    zero6,
)
from ospace.kernels.tree import CONTINUOUS, FLOATING, PLANAR, SAME_JOINT, SPHERICAL, Floats, Ints, Joints
from ospace.kernels.workspace import Robot, Work

LARGEST = 1e3
"""m/s², rad/s²."""

MOTION, RELATIVE, LOOK_AT, CENTRE_OF_MASS, MOMENTUM, POSTURE, DAMPING = range(7)

# Columns of a reference: start and duration of a minimum-jerk motion, place, way, rotation by columns, its vector,
# and velocity and acceleration on top.
START, DURATION, PLACE, WAY, TURN, TURNING, VELOCITY, ACCELERATION, REFERENCE = 0, 1, 2, 5, 8, 17, 20, 26, 32


class Tasks(NamedTuple):
    """What is asked for."""

    kind: Ints
    point: Ints
    """(T, 2) points, of those of the evaluation."""
    first: Ints
    """(T + 1,) where the rows of each task begin."""
    rows: Ints
    """(m,) which of the six components, or which joint, each row is."""
    gain: Floats
    """(T, 4) stiffness and damping, linear, then angular."""
    axis: Floats
    """(T, 3) in the point's axes."""
    reference: Floats
    """(T, REFERENCE)."""
    posture: Floats
    """(T, nq) positions of the joints as in q."""
    node: Ints
    """(p,) node of each point."""
    turn: Floats
    """(p, 9) rotation of each point in its link's axes, by columns."""


class Actuation(NamedTuple):
    """How the base is acted upon."""

    component: Ints
    """(k,) components of the wrench, base axes, at the base."""
    scale: Floats
    """(k,) N or N m per unit of û."""
    response: Floats
    """(k, 6) work: ẍ_b per unit of û."""


class Rows(NamedTuple):
    """What is asked, row by row."""

    A: Floats
    b: Floats
    error: Floats
    block: Floats
    """(n + k, 6) work: columns of one task."""


@inlined
def minimum_jerk(u: float) -> Row:
    """Way, velocity and acceleration of the quintic from 0 to 1, at rest at both ends."""
    if u <= 0.0:
        return (0.0, 0.0, 0.0)
    if u >= 1.0:
        return (1.0, 0.0, 0.0)
    return (
        u * u * u * (10.0 + u * (-15.0 + 6.0 * u)),
        30.0 * u * u * (1.0 - u) * (1.0 - u),
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )


@inlined
def follow(tasks: Tasks, t: int, time: float) -> tuple[Row, Row, Row, Row]:
    """Place, rotation, velocity and acceleration of the reference of task `t`."""
    row = tasks.reference
    s, rate, curve = 0.0, 0.0, 0.0
    if row[t, DURATION] > 0.0:
        T = row[t, DURATION]
        s, rate, curve = minimum_jerk((time - row[t, START]) / T)
        rate, curve = rate / T, curve / (T * T)
    place, way = load3_at(row, t, PLACE), load3_at(row, t, WAY)
    turning = load3_at(row, t, TURNING)
    R_0 = load3_at(row, t, TURN) + load3_at(row, t, TURN + 3) + load3_at(row, t, TURN + 6)
    v = add6(load6_at(row, t, VELOCITY), scale3(way, rate) + scale3(turning, rate))
    a = add6(load6_at(row, t, ACCELERATION), scale3(way, curve) + scale3(turning, curve))
    return add3(place, scale3(way, s)), mat3_mul(exponential(scale3(turning, s)), R_0), v, a


@inlined
def wrench_of(w: Work, base: Actuation, k: int) -> Row:
    """The wrench on the base, at the base, that a unit of û_k is."""
    c, none = base.component[k], (0.0, 0.0, 0.0)
    axis = scale3(load3_at(w.R, 0, 3 * (c % 3)), base.scale[k])
    return axis + none if c < 3 else none + axis


@inlined
def respond(w: Work, base: Actuation) -> None:
    """ẍ_b per unit of each û, to the rows of `base.response`."""
    for k in range(base.component.size):
        store6(base.response, k, sym6_mul(load21(w.base_inverse, 0), wrench_of(w, base, k)))


@inlined
def base_velocity(w: Work) -> Row:
    """v_b, inertial axes: what velocities of the work lack."""
    return rotate(load9(w.R, 0), (w.velocity[0, 0], w.velocity[1, 0], w.velocity[2, 0]))


@inlined
def turn_of(w: Work, robot: Robot, tasks: Tasks, e: int) -> Row:
    """Rotation of point `e`."""
    return mat3_mul(load9(w.R, robot.nodes.link[tasks.node[e]]), load9(tasks.turn, e))


@inlined
def place_of(w: Work, tasks: Tasks, e: int) -> Row:
    """Place of point `e` about the base."""
    return load3(w.place, tasks.node[e])


@inlined
def velocity_of(w: Work, robot: Robot, tasks: Tasks, e: int) -> Row:
    """ẋ_e, seen from the frame that moves along with the base."""
    node = tasks.node[e]
    return motion_at(load3(w.arm, node), load6(w.v, robot.nodes.link[node]))


@inlined
def column_of(w: Work, base: Actuation, tasks: Tasks, e: int, k: int) -> Row:
    """Column `k` of what moves point `e`: of J_m*, then of the base's actuation."""
    n = w.J_m_star.shape[0]
    if k < n:
        return load6_at(w.J_m_star, k, 6 * e)
    return motion_at(place_of(w, tasks, e), load6(base.response, k - n))


@inlined
def ask(tasks: Tasks, rows: Rows, t: int, error: Row, rate: Row, drift: Row) -> None:
    """Write the rows taken of the task's block: b = d rate + k error − drift, where `rate` is ẋ_ref − ẋ."""
    k_l, d_l, k_a, d_a = tasks.gain[t, 0], tasks.gain[t, 1], tasks.gain[t, 2], tasks.gain[t, 3]
    asked = add6(scale3(error[0:3], k_l) + scale3(error[3:6], k_a), scale3(rate[0:3], d_l) + scale3(rate[3:6], d_a))
    linear, angular = 0.0, 0.0
    for row in range(tasks.first[t], tasks.first[t + 1]):
        c = tasks.rows[row]
        if c < 3:
            linear += component(asked, c) * component(asked, c)
        else:
            angular += component(asked, c) * component(asked, c)
    asked = sub6(scale3(asked[0:3], share(linear)) + scale3(asked[3:6], share(angular)), drift)
    for row in range(tasks.first[t], tasks.first[t + 1]):
        c = tasks.rows[row]
        rows.b[row] = component(asked, c)
        rows.error[row] = component(error, c)
        for k in range(rows.A.shape[1]):
            rows.A[row, k] = rows.block[k, c]


@inlined
def share(square: float) -> float:
    """What is left of an acceleration, by its square, when it is cut to `LARGEST`."""
    return LARGEST / math.sqrt(square) if square > LARGEST * LARGEST else 1.0


@inlined
def component(x: Row, c: int) -> Number:
    """Component `c` of six."""
    low = x[0] if c == 0 else x[1] if c == 1 else x[2]
    high = x[3] if c == 3 else x[4] if c == 4 else x[5]
    return low if c < 3 else high


@inlined
def motion_rows(w: Work, robot: Robot, base: Actuation, tasks: Tasks, rows: Rows, t: int, time: float) -> None:
    """A point follows the reference: place, rotation, or both."""
    e = tasks.point[t, 0]
    place, R_ref, v_ref, a_ref = follow(tasks, t, time)
    from_base = sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0]))
    turn = rotation_vector(mat3_mul(R_ref, mat3_transpose(turn_of(w, robot, tasks, e))))
    error = sub3(from_base, place_of(w, tasks, e)) + turn
    v = velocity_of(w, robot, tasks, e)
    rate = sub3(sub3(v_ref[0:3], base_velocity(w)), v[0:3]) + sub3(v_ref[3:6], v[3:6])
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, column_of(w, base, tasks, e, k))
    turning = (0.0, 0.0, 0.0) + cross(v_ref[3:6], v[3:6])
    ask(tasks, rows, t, error, rate, sub6(add6(load6(w.drift, e), turning), a_ref))


@inlined
def relative_rows(w: Work, robot: Robot, base: Actuation, tasks: Tasks, rows: Rows, t: int, time: float) -> None:
    """A point follows the reference as seen from a second one, whose axes the reference is in."""
    a, b = tasks.point[t, 0], tasks.point[t, 1]
    place, R_ref, v_ref, a_ref = follow(tasks, t, time)
    R_b = turn_of(w, robot, tasks, b)
    r = sub3(place_of(w, tasks, a), place_of(w, tasks, b))
    v_a, v_b = velocity_of(w, robot, tasks, a), motion_at(r, velocity_of(w, robot, tasks, b))
    v, omega = sub6(v_a, v_b), v_b[3:6]  # as seen from b
    turn = rotation_vector(mat3_mul(mat3_mul(R_b, R_ref), mat3_transpose(turn_of(w, robot, tasks, a))))
    error = sub3(rotate(R_b, place), r) + turn
    asked_v = rotate(R_b, v_ref[0:3]) + rotate(R_b, v_ref[3:6])
    rate = sub6(asked_v, v)
    for k in range(rows.block.shape[0]):
        moved = motion_at(r, column_of(w, base, tasks, b, k))
        store6(rows.block, k, sub6(column_of(w, base, tasks, a, k), moved))
    drift = sub6(load6(w.drift, a), motion_at(r, load6(w.drift, b)))
    turning = add3(cross(omega, cross(omega, r)), scale3(cross(omega, v[0:3]), 2.0)) + cross(omega, v[3:6])
    turning = sub6(turning, (0.0, 0.0, 0.0) + cross(asked_v[3:6], v[3:6]))
    asked = rotate(R_b, a_ref[0:3]) + rotate(R_b, a_ref[3:6])
    ask(tasks, rows, t, error, rate, sub6(sub6(drift, turning), asked))


@inlined
def look_at_rows(w: Work, robot: Robot, base: Actuation, tasks: Tasks, rows: Rows, t: int, time: float) -> None:
    """An axis of a point looks at a place: the turn between them, about two axes across the line of sight d.

    With ω_d = d × ḋ the turning of the line of sight, ω̇_d = d × (a_ref − a_e)/r − 2 (ṙ/r) ω_d; a spin ω·d about it
    turns the error along.
    """
    e = tasks.point[t, 0]
    place, _, v_ref, a_ref = follow(tasks, t, time)
    line = sub3(sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0])), place_of(w, tasks, e))
    r = max(math.sqrt(dot3(line, line)), 1e-9)
    d = scale3(line, 1.0 / r)
    v = velocity_of(w, robot, tasks, e)
    closing = sub3(sub3(v_ref[0:3], base_velocity(w)), v[0:3])
    omega_d, growth = scale3(cross(d, closing), 1.0 / r), dot3(d, closing) / r
    n = rotate(turn_of(w, robot, tasks, e), (tasks.axis[t, 0], tasks.axis[t, 1], tasks.axis[t, 2]))
    x, y = across(d)
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
    sight = add3(scale3(cross(d, sub3(a_ref[0:3], drift[0:3])), 1.0 / r), scale3(omega_d, -2.0 * growth))
    spin = add3(sub3(drift[3:6], sight), scale3(cross(d, v[3:6]), dot3(d, v[3:6])))
    for k in range(rows.block.shape[0]):
        column = column_of(w, base, tasks, e, k)
        c = add3(column[3:6], scale3(cross(d, column[0:3]), 1.0 / r))
        store6(rows.block, k, (0.0, 0.0, 0.0, dot3(x, c), dot3(y, c), 0.0))
    none = (0.0, 0.0, 0.0)
    ask(
        tasks,
        rows,
        t,
        none + (dot3(x, turn), dot3(y, turn), 0.0),
        none + (dot3(x, rate), dot3(y, rate), 0.0),
        none + (dot3(x, spin), dot3(y, spin), 0.0),
    )


@inlined
def across(d: Row) -> tuple[Row, Row]:
    """Two unit vectors across the unit vector d and each other."""
    aside = (1.0, 0.0, 0.0) if abs(d[0]) < 0.6 else (0.0, 1.0, 0.0)
    x = cross(d, aside)
    x = scale3(x, 1.0 / math.sqrt(dot3(x, x)))
    return x, cross(d, x)


@inlined
def centre_of_mass_rows(w: Work, base: Actuation, tasks: Tasks, rows: Rows, t: int, time: float) -> None:
    """The centre of mass follows the reference: moved by the base wrench alone, m c̈ = f."""
    place, _, v_ref, a_ref = follow(tasks, t, time)
    from_base = sub3(place, (w.q[0, 0], w.q[1, 0], w.q[2, 0]))
    momentum, none = load6(w.momentum, 0), (0.0, 0.0, 0.0)
    v = scale3(momentum[0:3], 1.0 / w.IC[0, 0])
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, none + none)
    act(w, base, rows, 1.0 / w.IC[0, 0], 0.0)
    error, rate = sub3(from_base, load3(w.mass_centre, 0)), sub3(v_ref[0:3], v)
    ask(tasks, rows, t, error + none, rate + none, scale3(a_ref[0:3], -1.0) + none)


@inlined
def momentum_rows(w: Work, base: Actuation, tasks: Tasks, rows: Rows, t: int, time: float) -> None:
    """Linear momentum, and angular about the centre of mass, approach h_ref: ḣ = ḣ_ref + k (h_ref − h)."""
    _, _, h_ref, rate_ref = follow(tasks, t, time)
    momentum = load6(w.momentum, 0)
    h = momentum[0:3] + sub3(momentum[3:6], cross(load3(w.mass_centre, 0), momentum[0:3]))
    for k in range(rows.block.shape[0]):
        store6(rows.block, k, zero6(h))
    act(w, base, rows, 1.0, 1.0)
    ask(tasks, rows, t, sub6(h_ref, h), zero6(h), scale6(rate_ref, -1.0))


@inlined
def act(w: Work, base: Actuation, rows: Rows, linear: float, angular: float) -> None:
    """Write the wrench of each û, about the centre of mass, times `linear` and `angular`, to the block."""
    for k in range(base.component.size):
        wrench = force_from(scale3(load3(w.mass_centre, 0), -1.0), wrench_of(w, base, k))
        at = w.J_m_star.shape[0] + k
        store6(rows.block, at, scale3(wrench[0:3], linear) + scale3(wrench[3:6], angular))


@inlined
def position_error(joints: Joints, q: Table, posture: Floats, t: int, j: int) -> Number:
    """What is left to go for joint rate `j`, along or about the axis of its column, from `q` to the posture."""
    i = j + 1
    while joints.kind[i] == SAME_JOINT:
        i -= 1
    k, kind, column = joints.first[i], joints.kind[i], j + 1 - i
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
def joint_rows(w: Work, robot: Robot, tasks: Tasks, rows: Rows, t: int) -> None:
    """Joints approach a posture, or come to rest: one row for each joint."""
    k, d = tasks.gain[t, 0], tasks.gain[t, 1]
    for row in range(tasks.first[t], tasks.first[t + 1]):
        j = tasks.rows[row]
        rate = w.velocity[j + 6, 0]
        error = position_error(robot.joints, w.q, tasks.posture, t, j) if tasks.kind[t] == POSTURE else -rate
        asked = (k * error if tasks.kind[t] == POSTURE else 0.0) - d * rate
        rows.b[row] = min(max(asked, -LARGEST), LARGEST)
        rows.error[row] = error
        for column in range(rows.A.shape[1]):
            rows.A[row, column] = 0.0
        rows.A[row, j] = 1.0


@inlined
def fill(w: Work, robot: Robot, base: Actuation, tasks: Tasks, rows: Rows, time: float) -> None:
    """Fill the rows of all tasks."""
    respond(w, base)
    for t in range(tasks.kind.size):
        kind = tasks.kind[t]
        if kind == MOTION:
            motion_rows(w, robot, base, tasks, rows, t, time)
        elif kind == RELATIVE:
            relative_rows(w, robot, base, tasks, rows, t, time)
        elif kind == LOOK_AT:
            look_at_rows(w, robot, base, tasks, rows, t, time)
        elif kind == CENTRE_OF_MASS:
            centre_of_mass_rows(w, base, tasks, rows, t, time)
        elif kind == MOMENTUM:
            momentum_rows(w, base, tasks, rows, t, time)
        else:
            joint_rows(w, robot, tasks, rows, t)

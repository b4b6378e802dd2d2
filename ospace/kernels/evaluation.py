"""Operational-space dynamics of points straight from q and v: one state a call, or one in each lane."""

from __future__ import annotations

from ospace.kernels import propagated, symmetric
from ospace.kernels.articulated import NO_INERTIA
from ospace.kernels.composite import add_joint_inertia, base_columns, compose, sum_momenta
from ospace.kernels.kinematics import CONTINUOUS, REVOLUTE, Frames, Joints, move_links, place_links, sines_cosines
from ospace.kernels.lanes import (
    Table,
    add_to6,
    entry,
    inlined,
    load3,
    load6,
    load9,
    load21,
    store6,
    store21,
    store_part6,
)
from ospace.kernels.memory import Robot, Wide, Work, open_robot, open_wide, open_work
from ospace.kernels.propagated import Spread
from ospace.kernels.simd import largest, least, like, root, size, zeros
from ospace.kernels.spatial import add6, classical, dot6, motion_at, rotate, scale6, sym6_mul
from ospace.kernels.tables import Floats, Ints

FINE, BAD_INPUT, SINGULAR, DEPENDENT = 0, 1, 2, 3
# What is wanted, bits: Γ_e⁻¹; Γ_e; μ; J_e; J_m*, M_0 and composite bodies; H_m* of these; c_m* and drifts of these
MOBILITY, INERTIA, BIAS, JACOBIAN, FLOATING, GENERALIZED_INERTIA, GENERALIZED_BIAS = 1, 2, 4, 8, 16, 32, 64

SMALLEST_PIVOT = 1e-10
"""Of Γ_e⁻¹ at unit diagonal: below it, rows of the points may depend on each other."""
UNIT_LENGTH = 2e-6
"""How far the square of a quaternion's length may be from one: twice the tolerance of a state."""
FAR_ANGLE = 1e5
"""Largest joint angle, rad, for which sine and cosine hold to the last digits."""


@inlined
def take_input(joints: Joints, w: Work) -> None:
    """Bring quaternion and (cos, sin) pairs in `w.q` to unit length; note how far they were, and what is not finite.

    Angles count as far from unit length where they pass what `sine_cosine` is good for.
    """
    blemish, stray = like(0.0, w.q[0, 0]), like(0.0, w.q[0, 0])
    for k in range(w.q.shape[0]):
        blemish = blemish + 0.0 * w.q[k, 0]  # not zero for what is not finite
    for k in range(w.velocity.shape[0]):
        blemish = blemish + 0.0 * w.velocity[k, 0]
    x, y, z, u = w.q[3, 0], w.q[4, 0], w.q[5, 0], w.q[6, 0]
    length = x * x + y * y + z * z + u * u
    stray = largest(stray, size(length - 1.0))
    scale = 1.0 / root(length)
    w.q[3, 0], w.q[4, 0], w.q[5, 0], w.q[6, 0] = x * scale, y * scale, z * scale, u * scale
    for i in range(1, joints.parent.size):
        k = joints.first[i]
        if joints.kind[i] == CONTINUOUS:
            x, y = w.q[k, 0], w.q[k + 1, 0]
            length = x * x + y * y
            stray = largest(stray, size(length - 1.0))
            scale = 1.0 / root(length)
            w.q[k, 0], w.q[k + 1, 0] = x * scale, y * scale
        elif joints.kind[i] == REVOLUTE:
            stray = largest(stray, size(w.q[k, 0]) * (UNIT_LENGTH / FAR_ANGLE))
    w.health[0, 0] = blemish
    w.health[0, 1] = stray


@inlined
def run(robot: Robot, w: Work, wide: Wide) -> None:
    """From `w.q` and `w.velocity` to the results."""
    joints, nodes, frames, want = robot.joints, robot.nodes, Frames(w.R, w.r), robot.want[0]
    moving = want & (BIAS | FLOATING) != 0
    take_input(joints, w)
    sines_cosines(wide.q, wide.sine, wide.cosine)
    place_links(joints, w.q, w.sine, w.cosine, frames, w.S, w.I)
    propagated.place_points(nodes, frames, w.place)
    w.health[0, 2] = w.health[0, 3] = like(1.0, w.q[0, 0])
    w.health[0, 4] = w.health[0, 5] = like(0.0, w.q[0, 0])
    if moving:
        move_links(joints, w.velocity, frames, w.S, w.v, w.a)
    if want & JACOBIAN:
        differentiate(robot, w)
    if want & FLOATING:
        float_freely(robot, w)
        if want & GENERALIZED_INERTIA:
            reduce_inertia(joints, w)
        if want & GENERALIZED_BIAS:
            reduce_bias(robot, w)
    if want & MOBILITY:
        operate(robot, w, want & BIAS != 0)
        if want & INERTIA:
            rows = symmetric.Rows(w.scratch, wide.scratch, wide.unit, w.scale)
            w.health[0, 3] = symmetric.inverse(w.inertia_inverse, rows, w.inertia)
            for i in range(w.inertia.shape[0]):
                w.health[0, 4] = w.health[0, 4] + 0.0 * w.inertia[i, i]
            if want & BIAS:
                load_bias(w)


@inlined
def operate(robot: Robot, w: Work, biased: bool) -> None:
    """Γ_e⁻¹ by the sweeps of `propagated`, and μ where it is wanted."""
    nodes, rows = robot.nodes, robot.rows
    at = Spread(w.place, w.K, w.L, w.G)
    propagated.begin(nodes, at, w.y)
    if biased:
        propagated.load_links(w.I, w.v, w.a, w.p)
        propagated.sweep_inward(robot.joints, nodes, w.S, w.I, w.share, at, w.p, w.y)
        propagated.spread_bias(nodes, w.I, w.v, w.a, w.p, w.y, at, w.acceleration)
        for i in range(rows.size):
            w.bias_acceleration[i, 0] = -w.acceleration[rows[i] // 6, rows[i] % 6]
            w.health[0, 5] = w.health[0, 5] + 0.0 * w.bias_acceleration[i, 0]
    else:
        propagated.sweep_inward(robot.joints, nodes, w.S, w.I, w.share, at, None, None)
    for i in range(1, w.share.shape[0]):
        w.health[0, 2] = least(w.health[0, 2], w.share[i, 0])
    propagated.sweep_outward(nodes, w.I, at)
    if rows.size == w.all_rows.shape[0]:
        propagated.collect(nodes, at, w.inertia_inverse)
    else:
        propagated.collect(nodes, at, w.all_rows)
        for i in range(rows.size):
            for j in range(rows.size):
                w.inertia_inverse[i, j] = w.all_rows[rows[i], rows[j]]
    for i in range(rows.size):
        w.health[0, 5] = w.health[0, 5] + 0.0 * w.inertia_inverse[i, i]


@inlined
def load_bias(w: Work) -> None:
    """μ_e = Γ_e μ (10)."""
    for i in range(w.bias_force.shape[0]):
        force = like(0.0, w.q[0, 0])
        for j in range(w.bias_force.shape[0]):
            force = force + w.inertia[i, j] * w.bias_acceleration[j, 0]
        w.bias_force[i, 0] = force
        w.health[0, 4] = w.health[0, 4] + 0.0 * force


@inlined
def differentiate(robot: Robot, w: Work) -> None:
    """J_e, by columns in `w.columns`, and the rows taken of it."""
    nodes = robot.nodes
    o, i = like(0.0, w.q[0, 0]), like(1.0, w.q[0, 0])
    for k in range(w.columns.shape[0]):
        for row in range(w.columns.shape[1]):
            w.columns[k, row] = o
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e >= 0:
            p, link = load3(w.place, n), nodes.link[n]
            store_part6(w.columns, 0, 6 * e, (i, o, o, o, o, o))
            store_part6(w.columns, 1, 6 * e, (o, i, o, o, o, o))
            store_part6(w.columns, 2, 6 * e, (o, o, i, o, o, o))
            store_part6(w.columns, 3, 6 * e, motion_at(p, (o, o, o, i, o, o)))
            store_part6(w.columns, 4, 6 * e, motion_at(p, (o, o, o, o, i, o)))
            store_part6(w.columns, 5, 6 * e, motion_at(p, (o, o, o, o, o, i)))
            while link > 0:
                store_part6(w.columns, link + 5, 6 * e, motion_at(p, load6(w.S, link)))
                link = robot.joints.parent[link]
    take_rows(w.columns, robot.rows, w.jacobian)


@inlined
def take_rows(columns: Table, rows: Ints, matrix: Table) -> None:
    """Write the `rows` taken of a matrix that lies by columns."""
    for j in range(rows.size):
        for k in range(columns.shape[0]):
            matrix[j, k] = columns[k, rows[j]]


@inlined
def float_freely(robot: Robot, w: Work) -> None:
    """J_b*, J_m* and the momentum (25), (27)–(31), of the links as they are before any is eliminated."""
    parent, nodes = robot.joints.parent, robot.nodes
    for i in range(parent.size):
        store21(w.IC, i, load21(w.I, i))
    sum_momenta(w.I, w.v, w.momentum)
    compose(parent, w.S, w.IC, w.F)
    store21(w.base_inverse, 0, base_columns(w.IC, w.F, w.J_b_star))
    v_b = rotate(load9(w.R, 0), (w.velocity[0, 0], w.velocity[1, 0], w.velocity[2, 0]))
    o = like(0.0, v_b[0])
    add_to6(w.momentum, 0, sym6_mul(load21(w.IC, 0), v_b + (o, o, o)))
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e >= 0:
            p, link = load3(w.place, n), nodes.link[n]
            for k in range(1, parent.size):
                store_part6(w.J_m_star, k - 1, 6 * e, motion_at(p, load6(w.J_b_star, k)))
            while link > 0:
                column = motion_at(p, add6(load6(w.J_b_star, link), load6(w.S, link)))
                store_part6(w.J_m_star, link - 1, 6 * e, column)
                link = parent[link]
    take_rows(w.J_m_star, robot.rows, w.generalized_jacobian)
    for k in range(6):
        w.health[0, 5] = w.health[0, 5] + 0.0 * w.momentum[0, k]
    for k in range(w.J_m_star.shape[0]):
        for i in range(w.J_m_star.shape[1]):
            w.health[0, 5] = w.health[0, 5] + 0.0 * w.J_m_star[k, i]


@inlined
def reduce_inertia(joints: Joints, w: Work) -> None:
    """H_m* = H_m − H_bmᵀ H_b⁻¹ H_bm = H_m + H_bmᵀ J_b* (7)."""
    H = w.generalized_inertia
    for i in range(H.shape[0]):
        F = load6(w.F, i + 1)
        for j in range(i + 1):
            h = dot6(F, load6(w.J_b_star, j + 1))
            H[i, j] = h
            H[j, i] = h
        H[i, i] = H[i, i] + joints.mass[i + 1, 1]
    add_joint_inertia(joints.parent, w.S, w.F, H)
    for i in range(H.shape[0]):
        w.health[0, 5] = w.health[0, 5] + 0.0 * H[i, i]


@inlined
def reduce_bias(robot: Robot, w: Work) -> None:
    """c_m* = c_m + J_b*ᵀ c_b (7), and ẍ_b and ẍ_e while no joint accelerates and nothing acts."""
    parent, nodes = robot.joints.parent, robot.nodes
    propagated.load_links(w.I, w.v, w.a, w.p)
    for i in range(parent.size - 1, 0, -1):
        w.generalized_bias[i - 1, 0] = dot6(load6(w.S, i), load6(w.p, i))
        add_to6(w.p, parent[i], load6(w.p, i))
    c_b = load6(w.p, 0)
    for i in range(1, parent.size):
        c = w.generalized_bias[i - 1, 0] + dot6(load6(w.J_b_star, i), c_b)
        w.generalized_bias[i - 1, 0] = c
        w.health[0, 5] = w.health[0, 5] + 0.0 * c
    a_b = scale6(sym6_mul(load21(w.base_inverse, 0), c_b), -1.0)
    store6(w.base_drift, 0, a_b)
    for n in range(1, nodes.parent.size):
        if nodes.point[n] >= 0:
            place, link = load3(w.place, n), nodes.link[n]
            a = motion_at(place, add6(a_b, load6(w.a, link)))
            store6(w.drift, nodes.point[n], classical(a, motion_at(place, load6(w.v, link))))


@inlined
def verdict(blemish: float, stray: float, share: float, pivot: float, inverse: float, result: float) -> int:
    """What became of a state, by its health."""
    if not (blemish == 0.0 and stray <= UNIT_LENGTH):
        return BAD_INPUT
    if share <= NO_INERTIA:
        return SINGULAR
    if not (result == 0.0 and share > NO_INERTIA):
        return BAD_INPUT
    if not pivot > SMALLEST_PIVOT:
        return DEPENDENT
    return FINE if inverse == 0.0 else BAD_INPUT


@entry
def evaluate(q: Floats, v: Floats, memory: Floats) -> int:
    """Evaluate one state; results lie in `memory`. Return FINE, or what is wrong."""
    robot, w = open_robot(memory), open_work(memory, zeros(1))
    if q.size != w.q.shape[0] or v.size != w.velocity.shape[0]:
        return BAD_INPUT
    for k in range(q.size):
        w.q[k, 0] = q[k]
    for k in range(v.size):
        w.velocity[k, 0] = v[k]
    run(robot, w, open_wide(memory))
    h = load6(w.health, 0)
    return verdict(h[0], h[1], h[2], h[3], h[4], h[5])

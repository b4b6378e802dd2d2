"""Operational-space dynamics of points straight from q and v: one state a call, or one in each lane.

Constants and work lie in flat memory; `layout` says where each table of work begins, and nothing else does.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ospace.kernels import propagated, symmetric
from ospace.kernels.articulated import NO_INERTIA
from ospace.kernels.composite import base_columns, compose, sum_momenta
from ospace.kernels.kinematics import CONTINUOUS, Frames, Joints, move_links, place_links
from ospace.kernels.lanes import (
    Number,
    Table,
    add_to6,
    entry,
    inlined,
    load3,
    load6,
    load9,
    load21,
    store21,
    store_part6,
)
from ospace.kernels.propagated import Nodes, Spread
from ospace.kernels.simd import largest, like, part, root, size, table, zeros
from ospace.kernels.spatial import add3, add6, motion_at, rotate, sym6_mul
from ospace.kernels.tables import Floats, Ints

FINE, BAD_INPUT, SINGULAR, DEPENDENT = 0, 1, 2, 3
MOBILITY, INERTIA, BIAS, FLOATING, JACOBIAN = 1, 2, 4, 8, 16  # what is wanted, bits: Γ_e⁻¹; Γ_e; μ; J_m*, M_0; J_e

SMALLEST_PIVOT = 1e-10
"""Of the Cholesky factor of Γ_e⁻¹, over the diagonal: below it, rows of the points may depend on each other."""
UNIT_LENGTH = 2e-6
"""How far the square of a quaternion's length may be from one: twice the tolerance of a state."""
FAR_ANGLE = 1e5
"""Largest joint angle or displacement, rad or m, for which sine and cosine hold to the last digits."""


class Robot(NamedTuple):
    """All that is constant."""

    joints: Joints
    nodes: Nodes
    rows: Ints
    """Rows taken, out of the 6p of all points."""


class Work(NamedTuple):
    """All tables of one state."""

    q: Table
    velocity: Table
    R: Table
    r: Table
    S: Table
    I: Table
    v: Table
    c: Table
    p: Table
    place: Table
    K: Table
    L: Table
    y: Table
    G: Table
    all_rows: Table
    acceleration: Table
    inertia_inverse: Table
    inertia: Table
    bias_acceleration: Table
    bias_force: Table
    IC: Table
    F: Table
    J_b_star: Table
    J_m_star: Table
    """(n, 6p): the columns of J_m* as rows."""
    momentum: Table
    columns: Table
    """(nv, 6p): the columns of J_e as rows."""
    jacobian: Table
    scratch: Table
    health: Table
    """(1, 4): zero, or not a number where input or result is not finite; how far quaternions are from unit length; the
    smallest share of inertia;
    the smallest pivot of Γ_e⁻¹."""


(
    _Q,
    _VELOCITY,
    _INERTIA_INVERSE,
    _INERTIA,
    _BIAS_ACCELERATION,
    _BIAS_FORCE,
    _J_M_STAR,
    _MOMENTUM,
    _SCRATCH,
    _HEALTH,
) = (
    Work._fields.index(name)
    for name in (
        *("q", "velocity", "inertia_inverse", "inertia", "bias_acceleration", "bias_force", "J_m_star"),
        *("momentum", "scratch", "health"),
    )
)


def layout(links: int, nodes: int, points: int, rows: int, nq: int, nv: int, lanes: int) -> tuple[Ints, int]:
    """Return start, rows and columns of every table of `Work`, (tables, 3), and the length of the memory."""
    shapes = Work(
        q=(nq, 1),
        velocity=(nv, 1),
        R=(links, 9),
        r=(links, 3),
        S=(links, 6),
        I=(links, 21),
        v=(links, 6),
        c=(links, 6),
        p=(links, 6),
        place=(nodes, 3),
        K=(nodes, 36),
        L=(nodes, 21),
        y=(nodes, 6),
        G=(nodes * (nodes + 1) // 2, 36),
        all_rows=(6 * points, 6 * points),
        acceleration=(points, 6),
        inertia_inverse=(rows, rows),
        inertia=(rows, rows),
        bias_acceleration=(rows, 1),
        bias_force=(rows, 1),
        IC=(links, 21),
        F=(links, 6),
        J_b_star=(links, 6),
        J_m_star=(links - 1, 6 * points),
        momentum=(1, 6),
        columns=(nv, 6 * points),
        jacobian=(rows, nv),
        scratch=(rows, rows if lanes > 1 else -(-rows // 8) * 8),
        health=(1, 4),
    )
    sizes = np.array(shapes, dtype=np.int64)
    ends = np.cumsum(sizes.prod(axis=1) * lanes)
    starts = np.concatenate([[0], ends[:-1]])
    return np.column_stack([starts, sizes]), int(ends[-1])


@inlined
def open_table(memory: Floats, at: Ints, k: int, number: Number) -> Table:
    """Table `k` of the layout `at`."""
    return table(memory, at[k, 0], at[k, 1], at[k, 2], number)


@inlined
def open_work(memory: Floats, at: Ints, number: Number) -> Work:
    """All tables in `memory`, of numbers such as `number`."""
    return Work(
        open_table(memory, at, 0, number),
        open_table(memory, at, 1, number),
        open_table(memory, at, 2, number),
        open_table(memory, at, 3, number),
        open_table(memory, at, 4, number),
        open_table(memory, at, 5, number),
        open_table(memory, at, 6, number),
        open_table(memory, at, 7, number),
        open_table(memory, at, 8, number),
        open_table(memory, at, 9, number),
        open_table(memory, at, 10, number),
        open_table(memory, at, 11, number),
        open_table(memory, at, 12, number),
        open_table(memory, at, 13, number),
        open_table(memory, at, 14, number),
        open_table(memory, at, 15, number),
        open_table(memory, at, 16, number),
        open_table(memory, at, 17, number),
        open_table(memory, at, 18, number),
        open_table(memory, at, 19, number),
        open_table(memory, at, 20, number),
        open_table(memory, at, 21, number),
        open_table(memory, at, 22, number),
        open_table(memory, at, 23, number),
        open_table(memory, at, 24, number),
        open_table(memory, at, 25, number),
        open_table(memory, at, 26, number),
        open_table(memory, at, 27, number),
        open_table(memory, at, 28, number),
    )


@inlined
def take_input(joints: Joints, w: Work, moving: bool) -> None:
    """Bring quaternion and (cos, sin) pairs in `w.q` to unit length; note how far they were, and what is not finite.

    Angles count as far from unit length where they pass what `sine_cosine` is good for.
    """
    blemish, stray = like(0.0, w.q[0, 0]), like(0.0, w.q[0, 0])
    for k in range(w.q.shape[0]):
        blemish = blemish + 0.0 * w.q[k, 0]  # not zero for what is not finite
    if moving:
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
        else:
            stray = largest(stray, size(w.q[k, 0]) * (UNIT_LENGTH / FAR_ANGLE))
    w.health[0, 0] = blemish
    w.health[0, 1] = stray


@inlined
def run(robot: Robot, w: Work, wide: Table, want: int) -> None:
    """From `w.q` and `w.velocity` to the results; `wide` is `w.scratch` in numbers as wide as may be."""
    joints = robot.joints
    moving = want & (BIAS | FLOATING) != 0
    take_input(joints, w, moving)
    place_links(joints, w.q, Frames(w.R, w.r), w.S, w.I)
    w.health[0, 2] = w.health[0, 3] = like(1.0, w.q[0, 0])
    if moving:
        move_links(joints, w.velocity, Frames(w.R, w.r), w.S, w.v, w.c)
    if want & JACOBIAN:
        differentiate(robot, w)
    if want & FLOATING:
        float_freely(robot, w)
    if want & (MOBILITY | INERTIA | BIAS):
        operate(robot, w, wide, want)


@inlined
def operate(robot: Robot, w: Work, wide: Table, want: int) -> None:
    """Γ_e⁻¹ by the sweeps of `propagated`, with Γ_e and the bias where they are wanted."""
    joints, nodes, frames = robot.joints, robot.nodes, Frames(w.R, w.r)
    at = Spread(w.place, w.K, w.L, w.G)
    if want & BIAS:
        propagated.load_links(w.I, w.v, w.p)
        propagated.place_nodes(nodes, frames, at, w.y)
        w.health[0, 2] = propagated.sweep_inward(joints, nodes, w.S, w.I, at, w.c, w.p, w.y)
    else:
        propagated.place_nodes(nodes, frames, at, None)
        w.health[0, 2] = propagated.sweep_inward(joints, nodes, w.S, w.I, at, None, None, None)
    propagated.sweep_outward(nodes, w.I, at)
    if robot.rows.size == w.all_rows.shape[0]:
        propagated.collect(nodes, at, w.inertia_inverse)
    else:
        propagated.collect(nodes, at, w.all_rows)
        for i in range(robot.rows.size):
            for j in range(robot.rows.size):
                w.inertia_inverse[i, j] = w.all_rows[robot.rows[i], robot.rows[j]]
    for i in range(robot.rows.size):
        w.health[0, 0] = w.health[0, 0] + 0.0 * w.inertia_inverse[i, i]
    if want & BIAS:
        propagated.spread_bias(nodes, w.I, w.v, w.p, w.y, at, w.acceleration)
        for i in range(robot.rows.size):
            row = robot.rows[i]
            w.bias_acceleration[i, 0] = -w.acceleration[row // 6, row % 6]
            w.health[0, 0] = w.health[0, 0] + 0.0 * w.bias_acceleration[i, 0]
    if want & INERTIA:
        w.health[0, 3] = symmetric.inverse(w.inertia_inverse, w.scratch, wide, w.inertia)
    if want & INERTIA and want & BIAS:
        for i in range(robot.rows.size):
            s = like(0.0, w.q[0, 0])
            for j in range(robot.rows.size):
                s = s + w.inertia[i, j] * w.bias_acceleration[j, 0]
            w.bias_force[i, 0] = s
            w.health[0, 0] = w.health[0, 0] + 0.0 * s


@inlined
def differentiate(robot: Robot, w: Work) -> None:
    """J_e: by columns in `w.columns`, then the rows taken."""
    parent, nodes = robot.joints.parent, robot.nodes
    o, i = like(0.0, w.q[0, 0]), like(1.0, w.q[0, 0])
    zero6 = (o, o, o, o, o, o)
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e >= 0:
            link = nodes.link[n]
            p = add3(load3(w.r, link), rotate(load9(w.R, link), load3(nodes.offset, n)))
            for k in range(w.columns.shape[0]):
                store_part6(w.columns, k, 6 * e, zero6)
            store_part6(w.columns, 0, 6 * e, (i, o, o, o, o, o))
            store_part6(w.columns, 1, 6 * e, (o, i, o, o, o, o))
            store_part6(w.columns, 2, 6 * e, (o, o, i, o, o, o))
            store_part6(w.columns, 3, 6 * e, motion_at(p, (o, o, o, i, o, o)))
            store_part6(w.columns, 4, 6 * e, motion_at(p, (o, o, o, o, i, o)))
            store_part6(w.columns, 5, 6 * e, motion_at(p, (o, o, o, o, o, i)))
            while link > 0:
                store_part6(w.columns, link + 5, 6 * e, motion_at(p, load6(w.S, link)))
                link = parent[link]
    for j in range(robot.rows.size):
        for k in range(w.columns.shape[0]):
            w.jacobian[j, k] = w.columns[k, robot.rows[j]]


@inlined
def float_freely(robot: Robot, w: Work) -> None:
    """J_b*, J_m* and the momentum (25), (27)–(31), of the links as they are before any is eliminated."""
    parent, nodes = robot.joints.parent, robot.nodes
    for i in range(parent.size):
        store21(w.IC, i, load21(w.I, i))
    sum_momenta(w.I, w.v, w.momentum)
    compose(parent, w.S, w.IC, w.F)
    base_columns(w.IC, w.F, w.J_b_star)
    v_b = rotate(load9(w.R, 0), (w.velocity[0, 0], w.velocity[1, 0], w.velocity[2, 0]))
    o = like(0.0, v_b[0])
    add_to6(w.momentum, 0, sym6_mul(load21(w.IC, 0), v_b + (o, o, o)))
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e >= 0:
            link = nodes.link[n]
            p = add3(load3(w.r, link), rotate(load9(w.R, link), load3(nodes.offset, n)))
            for k in range(1, parent.size):
                store_part6(w.J_m_star, k - 1, 6 * e, motion_at(p, load6(w.J_b_star, k)))
            while link > 0:
                column = motion_at(p, add6(load6(w.J_b_star, link), load6(w.S, link)))
                store_part6(w.J_m_star, link - 1, 6 * e, column)
                link = parent[link]
    for k in range(6):
        w.health[0, 0] = w.health[0, 0] + 0.0 * w.momentum[0, k]
    for k in range(w.J_m_star.shape[0]):
        for i in range(w.J_m_star.shape[1]):
            w.health[0, 0] = w.health[0, 0] + 0.0 * w.J_m_star[k, i]


@inlined
def verdict(blemish: float, stray: float, share: float, pivot: float) -> int:
    """What became of a state, by its health."""
    if not (blemish == 0.0 and stray <= UNIT_LENGTH):
        return BAD_INPUT
    if not share > NO_INERTIA:
        return SINGULAR
    return FINE if pivot > SMALLEST_PIVOT else DEPENDENT


@inlined
def open_robot(integers: Ints, constants: Floats) -> Robot:
    """The constants, as `pack` laid them."""
    links, nodes, o = integers[0], integers[1], 3
    parent = part(integers, o, links)
    kind = part(integers, o + links, links)
    first = part(integers, o + 2 * links, links)
    of_link = part(integers, o + 3 * links, links)
    o += 4 * links
    up = part(integers, o, nodes)
    link = part(integers, o + nodes, nodes)
    point = part(integers, o + 2 * nodes, nodes)
    until = part(integers, o + 3 * nodes, nodes)
    rows = part(integers, o + 4 * nodes, integers[2])
    joints = Joints(
        parent,
        kind,
        first,
        table(constants, 0, links, 9, 0.0),
        table(constants, 9 * links, links, 3, 0.0),
        table(constants, 12 * links, links, 3, 0.0),
        table(constants, 15 * links, links, 6, 0.0),
        table(constants, 21 * links, links, 2, 0.0),
    )
    return Robot(joints, Nodes(up, link, point, table(constants, 23 * links, nodes, 3, 0.0), until, of_link), rows)


def pack(robot: Robot) -> tuple[Ints, Floats]:
    """Lay the constants in two flat arrays: a call takes 50 ns for each array that it is given."""
    joints, nodes = robot.joints, robot.nodes
    header = [[joints.parent.size, nodes.parent.size, robot.rows.size]]
    whole = [joints.parent, joints.kind, joints.first, nodes.of_link]
    whole += [nodes.parent, nodes.link, nodes.point, nodes.until, robot.rows]
    parts = [joints.A, joints.b, joints.com, joints.inertia, joints.mass, nodes.offset]
    return np.concatenate([*header, *whole]), np.concatenate([part.ravel() for part in parts])


@entry
def evaluate(q: Floats, v: Floats, want: int, integers: Ints, constants: Floats, memory: Floats, at: Ints) -> int:
    """Evaluate one state; results lie in `memory`. Return FINE, or what is wrong."""
    robot, w = open_robot(integers, constants), open_work(memory, at, zeros(1))
    if q.size != w.q.shape[0] or v.size != w.velocity.shape[0]:
        return BAD_INPUT
    for k in range(q.size):
        w.q[k, 0] = q[k]
    for k in range(v.size):
        w.velocity[k, 0] = v[k]
    wide = table(memory, at[_SCRATCH, 0], at[_SCRATCH, 1], at[_SCRATCH, 2] // 8, zeros(8))
    run(robot, w, wide, want)
    return verdict(w.health[0, 0], w.health[0, 1], w.health[0, 2], w.health[0, 3])


class Results(NamedTuple):
    """Where the results of many states go: leading N; no rows where a result is not wanted."""

    inertia_inverse: Floats
    inertia_inverse_packed: Floats
    inertia: Floats
    bias_acceleration: Floats
    bias_force: Floats
    generalized_jacobian: Floats
    momentum: Floats
    status: Ints


@inlined
def scatter(memory: Floats, start: int, lanes: int, count: int, out: Floats, first: int) -> None:
    """Write `count` numbers of each lane to the rows of `out`, (N, …), from row `first` on."""
    flat = out.reshape(out.shape[0], count) if out.shape[0] > 0 else out.reshape(0, 0)
    for lane in range(min(lanes, out.shape[0] - first)):
        for k in range(count):
            flat[first + lane, k] = memory[start + k * lanes + lane]


@inlined
def scatter_packed(memory: Floats, start: int, lanes: int, rows: int, out: Floats, first: int) -> None:
    """Write the lower rows of a symmetric matrix of each lane to the rows of `out`."""
    for lane in range(min(lanes, out.shape[0] - first)):
        at = 0
        for i in range(rows):
            for j in range(i + 1):
                out[first + lane, at] = memory[start + (i * rows + j) * lanes + lane]
                at += 1


@inlined
def scatter_jacobian(memory: Floats, start: int, lanes: int, rows: Ints, points: int, out: Floats, first: int) -> None:
    """Write J_m*, which lies by columns, to (N, r, n)."""
    for lane in range(min(lanes, out.shape[0] - first)):
        for i in range(rows.size):
            for k in range(out.shape[2]):
                out[first + lane, i, k] = memory[start + (k * 6 * points + rows[i]) * lanes + lane]


@inlined
def evaluate_lanes(
    Q: Floats, V: Floats, want: int, robot: Robot, memory: Floats, at: Ints, number: Number, lanes: int, out: Results
) -> None:
    """Evaluate all states of `Q` and `V`, `lanes` at a time."""
    w = open_work(memory, at, number)
    nq, nv, N = Q.shape[1], V.shape[1], Q.shape[0]
    r, points = robot.rows.size, w.acceleration.shape[0]
    for first in range(0, N, lanes):
        for lane in range(lanes):
            s = min(first + lane, N - 1)
            for k in range(nq):
                memory[at[_Q, _Q] + k * lanes + lane] = Q[s, k]
            for k in range(nv):
                memory[at[_VELOCITY, 0] + k * lanes + lane] = V[s, k]
        run(robot, w, w.scratch, want)
        scatter(memory, at[_INERTIA_INVERSE, 0], lanes, r * r, out.inertia_inverse, first)
        scatter_packed(memory, at[_INERTIA_INVERSE, 0], lanes, r, out.inertia_inverse_packed, first)
        scatter(memory, at[_INERTIA, 0], lanes, r * r, out.inertia, first)
        scatter(memory, at[_BIAS_ACCELERATION, 0], lanes, r, out.bias_acceleration, first)
        scatter(memory, at[_BIAS_FORCE, 0], lanes, r, out.bias_force, first)
        scatter_jacobian(memory, at[_J_M_STAR, 0], lanes, robot.rows, points, out.generalized_jacobian, first)
        scatter(memory, at[_MOMENTUM, 0], lanes, 6, out.momentum, first)
        health = at[_HEALTH, 0]
        for lane in range(min(lanes, N - first)):
            out.status[first + lane] = verdict(
                memory[health + lane],
                memory[health + lanes + lane],
                memory[health + 2 * lanes + lane],
                memory[health + 3 * lanes + lane],
            )


@entry
def evaluate_8(
    Q: Floats, V: Floats, want: int, integers: Ints, constants: Floats, memory: Floats, at: Ints, out: Results
) -> None:
    """Evaluate many states, eight at a time."""
    evaluate_lanes(Q, V, want, open_robot(integers, constants), memory, at, zeros(8), 8, out)


@entry
def evaluate_4(
    Q: Floats, V: Floats, want: int, integers: Ints, constants: Floats, memory: Floats, at: Ints, out: Results
) -> None:
    """Evaluate many states, four at a time."""
    evaluate_lanes(Q, V, want, open_robot(integers, constants), memory, at, zeros(4), 4, out)


@entry
def evaluate_2(
    Q: Floats, V: Floats, want: int, integers: Ints, constants: Floats, memory: Floats, at: Ints, out: Results
) -> None:
    """Evaluate many states, two at a time."""
    evaluate_lanes(Q, V, want, open_robot(integers, constants), memory, at, zeros(2), 2, out)


BY_WIDTH = {2: evaluate_2, 4: evaluate_4, 8: evaluate_8}

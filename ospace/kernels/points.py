"""Operational points: positions, Jacobians and drift, each in inertial axes at the point.

With p_e the position of point e about the base and r_k, S_k of joint k on the way to it,

    J_e = [ X(p_e) … X(p_e − r_k) S_k … ],   X(d) = [1 −d̃; 0 1]              (16), (29)
    ẍ_e = X(p_e − r_i) a_i + [ω_e × v_e; 0]     on link i                      (44)
"""

from __future__ import annotations

from ospace.kernels.jit.compile import Table, Vec3, Vec6, inlined
from ospace.kernels.jit.load_store import load3, load6, load6_at, load9, store3, store6_at
from ospace.kernels.jit.simd import full_like
from ospace.kernels.spatial import add3, add6, classical, motion_at, rotate, sub3
from ospace.kernels.tree import Ints, Nodes
from ospace.kernels.workspace import Robot, Work


@inlined
def place_points(nodes: Nodes, w: Work) -> None:
    """Write where the points are: about their link's origin to `arm`, about the base to `place`."""
    for n in range(1, nodes.parent.size):
        if nodes.point[n] >= 0:
            link = nodes.link[n]
            arm = rotate(load9(w.R, link), load3(nodes.offset, n))
            store3(w.arm, n, arm)
            store3(w.place, n, add3(load3(w.r, link), arm))


@inlined
def acceleration_at(nodes: Nodes, w: Work, n: int, a: Vec6) -> Vec6:
    """Classical acceleration of the point at node `n`, where `a` is its spatial one beyond that at zero φ̈."""
    arm, link = load3(w.arm, n), nodes.link[n]
    a_link, v = motion_at(arm, load6(w.a, link)), motion_at(arm, load6(w.v, link))
    return classical(add6(a, a_link), v)


@inlined
def point_jacobians(robot: Robot, w: Work) -> None:
    """J_e, by columns in `w.columns`, and the rows taken of it."""
    nodes = robot.nodes
    o, i = full_like(0.0, w.R[0, 0]), full_like(1.0, w.R[0, 0])
    for k in range(w.columns.shape[0]):
        for row in range(w.columns.shape[1]):
            w.columns[k, row] = o
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e >= 0:
            p, link = load3(w.place, n), nodes.link[n]
            store6_at(w.columns, 0, 6 * e, (i, o, o, o, o, o))
            store6_at(w.columns, 1, 6 * e, (o, i, o, o, o, o))
            store6_at(w.columns, 2, 6 * e, (o, o, i, o, o, o))
            store6_at(w.columns, 3, 6 * e, motion_at(p, (o, o, o, i, o, o)))
            store6_at(w.columns, 4, 6 * e, motion_at(p, (o, o, o, o, i, o)))
            store6_at(w.columns, 5, 6 * e, motion_at(p, (o, o, o, o, o, i)))
            while link > 0:
                k = robot.joints.column[link] + 5
                store6_at(w.columns, k, 6 * e, add6(load6_at(w.columns, k, 6 * e), joint_column(w, p, link)))
                link = robot.joints.parent[link]
    take_rows(w.columns, robot.rows, w.jacobian)


@inlined
def joint_column(w: Work, p: Vec3, k: int) -> Vec6:
    """Motion of a point at `p` per unit rate of joint `k` below it."""
    return motion_at(sub3(p, load3(w.r, k)), load6(w.S, k))


@inlined
def take_rows(columns: Table, rows: Ints, matrix: Table) -> None:
    """Write the `rows` taken of a matrix that lies by columns."""
    for j in range(rows.size):
        for k in range(columns.shape[0]):
            matrix[j, k] = columns[k, rows[j]]

"""Composite bodies: momentum, joint-space inertia, inverse dynamics and the generalized Jacobians (§4.2, §5).

In one frame for all links, h the parent of i:

    I_h^C = I_h + Σ I_i^C                                    (21)
    H_b = I_0^C,   H_bm = [… I_i^C S_i …],   (H_m)_ij = S_jᵀ I_i^C S_i for j on the way from i to the base
    L_0 = Σ I_k v_k                                          (20, 25)
    J_b* = −(I_0^C)⁻¹ Σ I_k^C S_k                            (27)
    J_m* = Σ_{k above e} S_k − (I_0^C)⁻¹ Σ I_k^C S_k         (29–31), at the point e
    a_i = a_h + c_i + S_i φ̈_i                               (17)
    f_h = I_h a_h + v_h ×̂ I_h v_h + Σ f_i                    (18, 19)
"""

from __future__ import annotations

import numpy as np

from ospace.kernels.lanes import (
    Row,
    Table,
    add_to6,
    add_to21,
    entry,
    inlined,
    load3,
    load6,
    load9,
    load21,
    load_translation,
    store3,
    store6,
    store21,
)
from ospace.kernels.spatial import (
    add3,
    add6,
    body_force,
    classical,
    dot6,
    motion_at,
    rotate,
    scale6,
    sym6_inverse,
    sym6_mul,
)
from ospace.kernels.tables import Floats, Ints, Links, Points, Tree


@inlined
def sum_momenta(I: Table, v: Table, L_0: Table) -> None:
    """Momentum of all links about the base, to the one row of `L_0`."""
    store6(L_0, 0, sym6_mul(load21(I, 0), load6(v, 0)))
    for k in range(1, v.shape[0]):
        add_to6(L_0, 0, sym6_mul(load21(I, k), load6(v, k)))


@entry
def momentum(tree: Tree) -> Floats:
    """Momentum of all links about the base, (6,)."""
    L_0 = np.empty((1, 6))
    sum_momenta(tree.I, tree.v, L_0)
    return L_0.reshape(6)


@inlined
def compose(parent: Ints, S: Table, IC: Table, F: Table) -> None:
    """Turn the inertias in `IC` into composite ones, and write I_i^C S_i to the rows of `F`."""
    for i in range(parent.size - 1, 0, -1):
        I = load21(IC, i)
        store6(F, i, sym6_mul(I, load6(S, i)))
        add_to21(IC, parent[i], I)


@inlined
def base_columns(IC: Table, F: Table, J_b_star: Table) -> Row:
    """Columns of J_b* (27), to the rows of `J_b_star` (n + 1, 6); return (I_0^C)⁻¹."""
    I_inv = sym6_inverse(load21(IC, 0))
    for k in range(1, F.shape[0]):
        store6(J_b_star, k, scale6(sym6_mul(I_inv, load6(F, k)), -1.0))
    return I_inv


@inlined
def add_joint_inertia(parent: Ints, S: Table, F: Table, H_m: Table) -> None:
    """Add S_jᵀ I_i^C S_i for every j on the way from i to the base to `H_m` (n, n)."""
    for i in range(1, parent.size):
        j = i
        while j > 0:
            h = H_m[i - 1, j - 1] + dot6(load6(S, j), load6(F, i))
            H_m[i - 1, j - 1] = h
            H_m[j - 1, i - 1] = h
            j = parent[j]


@entry
def composite_inertia(links: Links, tree: Tree) -> tuple[Floats, Floats, Floats]:
    """I^C (n + 1, 21), the columns I_i^C S_i of H_bm as rows (n + 1, 6; row 0 is zero), and H_m (n, n)."""
    n = links.parent.size - 1
    IC, F, H_m = tree.I.copy(), np.zeros((n + 1, 6)), np.zeros((n, n))
    compose(links.parent, tree.S, IC, F)
    add_joint_inertia(links.parent, tree.S, F, H_m)
    for i in range(n):
        H_m[i, i] += links.armature[i + 1]
    return IC, F, H_m


@entry
def base_generalized_jacobian(IC: Floats, F: Floats) -> tuple[Floats, Floats]:
    """J_b* (27) as rows (n, 6), and (I_0^C)⁻¹ as lower rows (1, 21)."""
    I_inv, J_b_star = np.empty((1, 21)), np.empty((F.shape[0], 6))
    store21(I_inv, 0, base_columns(IC, F, J_b_star))
    return J_b_star[1:], I_inv


@entry
def composite_force(links: Links, tree: Tree, a_0: Floats, qdd: Floats) -> tuple[Floats, Floats]:
    """Forces that make the links move with base acceleration `a_0` (6,) and joint accelerations `qdd` (n,).

    Returns the wrench on the base (6,) and the joint torques (n,).
    """
    n = links.parent.size - 1
    a, f, torque = np.empty((n + 1, 6)), np.empty((n + 1, 6)), np.empty(n)
    for i in range(n + 1):
        if i == 0:
            store6(a, 0, (a_0[0], a_0[1], a_0[2], a_0[3], a_0[4], a_0[5]))
        else:
            own = add6(load6(tree.c, i), scale6(load6(tree.S, i), qdd[i - 1]))
            store6(a, i, add6(load6(a, links.parent[i]), own))
        store6(f, i, body_force(load21(tree.I, i), load6(tree.v, i), load6(a, i)))
    for i in range(n, 0, -1):
        torque[i - 1] = dot6(load6(tree.S, i), load6(f, i)) + links.armature[i] * qdd[i - 1]
        add_to6(f, links.parent[i], load6(f, i))
    return f[0], torque


@inlined
def place_points(points: Points, placements: Floats, position: Floats) -> None:
    """Where the points are, about the base."""
    for e in range(points.link.size):
        b = points.body[e]
        r = rotate(load9(placements, b), load3(points.offset, e))
        store3(position, e, add3(load_translation(placements, b), r))


@entry
def point_jacobian(points: Points, placements: Floats, tree: Tree) -> Floats:
    """J_e as columns: (6 + n, p, 6), each column at its point."""
    position = np.empty((points.link.size, 3))
    place_points(points, placements, position)
    J = np.zeros((tree.S.shape[0] + 5, points.link.size, 6))
    for e in range(points.link.size):
        p = load3(position, e)
        for k in range(3):  # motion_at for the unit motions of the base: [1 −p̃; 0 1]
            J[k, e, k] = J[k + 3, e, k + 3] = 1.0
        J[4, e, 0], J[5, e, 0] = p[2], -p[1]
        J[3, e, 1], J[5, e, 1] = -p[2], p[0]
        J[3, e, 2], J[4, e, 2] = p[1], -p[0]
        for step in range(points.depth[e]):
            k = points.path[e, step]
            store6(J[k + 5], e, motion_at(p, load6(tree.S, k)))
    return J


@entry
def point_motion(points: Points, placements: Floats, tree: Tree) -> tuple[Floats, Floats, Floats]:
    """Position about the base (p, 3), velocity ẋ_e (p, 6) and acceleration J̇_e ẋ at zero q̈ (p, 6)."""
    p = points.link.size
    position, velocity, drift = np.empty((p, 3)), np.empty((p, 6)), np.zeros((p, 6))
    place_points(points, placements, position)
    for e in range(p):
        for step in range(points.depth[e]):
            add_to6(drift, e, load6(tree.c, points.path[e, step]))
        r = load3(position, e)
        v = motion_at(r, load6(tree.v, points.link[e]))
        store6(velocity, e, v)
        store6(drift, e, classical(motion_at(r, load6(drift, e)), v))
    return position, velocity, drift

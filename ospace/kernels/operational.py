"""Operational-space dynamics of p points by the forward chain (§6.2).

With L_i = 1 − U_i S_iᵀ/β_i from the inward sweep (38), (42), outward:

    Λ_00 = (I_0^A)⁻¹,   Λ_ii = S_i S_iᵀ/β_i + L_iᵀ Λ_hh L_i                    (39)
    Λ_ij = L_iᵀ Λ_hj on i's side of the nearest common ancestor, Λ_ih L_j on j's (40)
    Γ⁻¹_ij = ᵉXᵀ Λ_ij X                                                        (41)
    a_0 = −(I_0^A)⁻¹ p_0^A,   a_i = a_h + c_i + S_i b_i                        (43)
    b_i = −(U_iᵀ a_h + S_iᵀ(p_i^A + I_i^A c_i))/β_i
    ẍ_e = ᵉXᵀ a_i − [v_e × ω_e; 0]                                             (44), (45)

The response of every joint to a force at a point is the same pair of sweeps with the force in place of the bias;
it gives H⁻¹ J_eᵀ, and with it the dynamically consistent inverse (11), (13) and the torque map of (12).
"""

from __future__ import annotations

import numpy as np

from ospace.kernels.articulated import inertia_share, sweep_inward
from ospace.kernels.composite import place_points
from ospace.kernels.lanes import (
    Number,
    Row,
    entry,
    inlined,
    load3,
    load6,
    load21,
    load36,
    store6,
    store36,
    store_part6,
)
from ospace.kernels.spatial import (
    add6,
    between_points,
    classical,
    dot6,
    forces_from,
    mat6_add_outer,
    mat6_mul,
    mat6_product,
    motion_at,
    mul_mat6,
    scale6,
    sub6,
    sym6_inverse,
    sym6_mul,
    sym6_to_mat,
)
from ospace.kernels.tables import Articulated, Floats, Links, Points, Tree


@inlined
def beyond(K: Row, S: Row, U: Row, beta_inv: Number) -> Row:
    """Lᵀ K = K − S Uᵀ K/β: motions of the parent become motions of the link."""
    return mat6_add_outer(K, S, scale6(mul_mat6(U, K), -beta_inv))


@inlined
def before(K: Row, S: Row, U: Row, beta_inv: Number) -> Row:
    """K L = K − K U Sᵀ/β: forces on the link become forces on the parent."""
    return mat6_add_outer(K, scale6(mat6_mul(K, U), -beta_inv), S)


@inlined
def block_diagonal(links: Links, points: Points, tree: Tree, body: Articulated, Lambda: Floats) -> None:
    """Λ_ii (39) of every link between the base and a point; rows of `Lambda`."""
    store36(Lambda, 0, sym6_to_mat(sym6_inverse(load21(body.I, 0))))
    for e in range(points.link.size):
        for step in range(points.depth[e]):
            i = points.path[e, step]
            S, U, beta_inv = load6(tree.S, i), load6(body.U, i), body.beta_inv[i]
            inner = before(load36(Lambda, links.parent[i]), S, U, beta_inv)
            store36(Lambda, i, mat6_add_outer(beyond(inner, S, U, beta_inv), S, scale6(S, beta_inv)))


@inlined
def cross_coupling(points: Points, tree: Tree, body: Articulated, Lambda: Floats, e: int, d: int) -> Row:
    """Λ_ij (40) between the links of the points `e` and `d`."""
    shared = 0
    while (
        shared < points.depth[e]
        and shared < points.depth[d]
        and points.path[e, shared] == points.path[d, shared]
    ):  # fmt: skip
        shared += 1
    K = load36(Lambda, points.path[e, shared - 1] if shared > 0 else 0)
    for step in range(shared, points.depth[e]):
        i = points.path[e, step]
        K = beyond(K, load6(tree.S, i), load6(body.U, i), body.beta_inv[i])
    for step in range(shared, points.depth[d]):
        j = points.path[d, step]
        K = before(K, load6(tree.S, j), load6(body.U, j), body.beta_inv[j])
    return K


@inlined
def bias_acceleration(
    links: Links, points: Points, position: Floats, tree: Tree, body: Articulated, a: Floats, acceleration: Floats
) -> None:
    """ẍ_e of the points when no force acts (43)–(45); `a` (n + 1, 6) is scratch."""
    a_0 = sym6_mul(sym6_inverse(load21(body.I, 0)), load6(body.p, 0))
    store6(a, 0, scale6(a_0, -1.0))
    for e in range(points.link.size):
        for step in range(points.depth[e]):
            i = points.path[e, step]
            a_h = load6(a, links.parent[i])
            b = -(dot6(load6(body.U, i), a_h) + body.u[i]) * body.beta_inv[i]
            store6(a, i, add6(add6(a_h, load6(tree.c, i)), scale6(load6(tree.S, i), b)))
        p, i = load3(position, e), points.link[e]
        store6(acceleration, e, classical(motion_at(p, load6(a, i)), motion_at(p, load6(tree.v, i))))


@inlined
def response(links: Links, points: Points, position: Floats, tree: Tree, body: Articulated, Y: Floats) -> None:
    """H⁻¹ J_eᵀ: accelerations of base and joints per unit of each wrench at the points; rows of `Y`."""
    n = links.parent.size - 1
    A, unit, pull = np.empty((n + 1, 36)), np.zeros((1, 36)), np.empty((n + 1, 6))
    unit[0, ::7] = 1.0
    for e in range(points.link.size):
        P = forces_from(load3(position, e), load36(unit, 0))
        pull[:] = 0.0
        for step in range(points.depth[e] - 1, -1, -1):
            i = points.path[e, step]
            f = mul_mat6(load6(tree.S, i), P)
            P = mat6_add_outer(P, load6(body.U, i), scale6(f, -body.beta_inv[i]))
            store6(pull, i, f)
        I_inv = sym6_inverse(load21(body.I, 0))
        P = mat6_product(sym6_to_mat(I_inv), P)
        store36(A, 0, P)
        for k in range(6):
            store_part6(Y, k, 6 * e, (P[6 * k], P[6 * k + 1], P[6 * k + 2], P[6 * k + 3], P[6 * k + 4], P[6 * k + 5]))
        for i in range(1, n + 1):
            A_h = load36(A, links.parent[i])
            b = scale6(sub6(load6(pull, i), mul_mat6(load6(body.U, i), A_h)), body.beta_inv[i])
            store36(A, i, mat6_add_outer(A_h, load6(tree.S, i), b))
            store_part6(Y, i + 5, 6 * e, b)


@entry
def forward_chain(
    links: Links, points: Points, placements: Floats, tree: Tree
) -> tuple[Floats, Floats, Floats, Floats]:
    """Γ_e⁻¹ (6p, 6p), ẍ_e when nothing acts (p, 6), H⁻¹J_eᵀ (6 + n, 6p), and `inertia_share` of each link (n + 1,)."""
    n, p = links.parent.size - 1, points.link.size
    position = np.empty((p, 3))
    place_points(points, placements, position)
    body = sweep_inward(links, tree)

    Lambda = np.empty((n + 1, 36))
    block_diagonal(links, points, tree, body, Lambda)
    Gamma_inv = np.empty((6 * p, 6 * p))
    for e in range(p):
        for d in range(e + 1):
            K = cross_coupling(points, tree, body, Lambda, e, d)
            store_block(Gamma_inv, e, d, between_points(load3(position, e), K, load3(position, d)))

    acceleration = np.empty((p, 6))
    bias_acceleration(links, points, position, tree, body, np.empty((n + 1, 6)), acceleration)
    Y = np.empty((n + 6, 6 * p))
    response(links, points, position, tree, body, Y)

    share = np.ones(n + 1)
    for i in range(1, n + 1):
        share[i] = inertia_share(load21(body.I, i), load6(tree.S, i), 1.0 / body.beta_inv[i])
    return Gamma_inv, acceleration, Y, share


@inlined
def store_block(Gamma_inv: Floats, e: int, d: int, K: Row) -> None:
    """Write block (e, d) and its mirror image; `d` ≤ `e`."""
    for r in range(6):
        for c in range(6):
            if d < e or c <= r:
                Gamma_inv[6 * e + r, 6 * d + c] = Gamma_inv[6 * d + c, 6 * e + r] = K[6 * r + c]

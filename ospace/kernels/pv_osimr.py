"""Inverse operational inertia and bias of p points in one inward and one outward sweep (PV-OSIMr).

What (38)–(43) do link by link outward, is gathered on the way inward: along each stretch of links between two *nodes*
(points, and links in which the ways to several points meet) the motion of the outer node n by that of the link i is

    a_n = K a_i + y,   with a force on n adding L to what it moves.

Passing joint i, with U = I_i^A S_i and β = S_iᵀ U as in (38) and f = K S_i,

    L ← L + f fᵀ/β,   y ← y − f S_iᵀ p_i^A/β,   K ← K − f Uᵀ/β

which are the propagators L_iᵀ of (39), (40) multiplied up. I^A, p^A, S and U stand at the links' own origins, K and y
at the base and, at a point's node, at the point. Accelerations are counted from what they are at q̈ = 0, so that p_i
begins as the inertial force then (19), and the c_i of (42) are in it. Then, outward over the nodes,

    G_00 = (I_0^A)⁻¹,   G_nb = K_n G_hb + δ_nb L_n,   a_0 = −(I_0^A)⁻¹ p_0^A,   a_n = K_n a_h + y_n

and G is Γ_e⁻¹ where both nodes are points, since K starts there as the shift to the point. (Sathya et al.,
arXiv 2310.03676, for a floating base: n rank-one updates, and a 6×6 product for each pair of nodes.)
"""

from __future__ import annotations

from ospace.kernels.articulated_body import (
    force_across,
    inertia_across,
    pivot_terms,
    relative_pivot,
    trace_angular,
)
from ospace.kernels.jit.compile import Mat6, Number, Table, inlined
from ospace.kernels.jit.load_store import (
    add_to6,
    add_to21,
    load3,
    load6,
    load21,
    load36,
    store6,
    store6_at,
    store21,
    store36,
)
from ospace.kernels.jit.simd import full_like, minimum
from ospace.kernels.points import acceleration_at
from ospace.kernels.spatial import (
    add6,
    body_force,
    dot3,
    dot6,
    force_from,
    inertia_from,
    mat6_add,
    mat6_add_outer,
    mat6_mul,
    mat6_product,
    mat6_transpose,
    motion_at,
    motions_at,
    scale3,
    scale6,
    sym6_add,
    sym6_inverse_and_pivot,
    sym6_mul,
    sym6_mul_angular,
    sym6_outer,
    sym6_to_mat,
    unit36,
    zero6,
    zero21,
)
from ospace.kernels.tree import Joints, Nodes
from ospace.kernels.workspace import Work


@inlined
def block(n: int, b: int) -> int:
    """Row of G in which block (n, b) stands, b ≤ n."""
    return n * (n + 1) // 2 + b


@inlined
def begin(nodes: Nodes, w: Work) -> None:
    """K is the shift to the point, or 1 at a junction; L and y are zero."""
    one = unit36((w.R[0, 0],))
    none = zero6(one)
    none21 = zero21(one[0])
    for n in range(1, nodes.parent.size):
        store36(w.K, n, motions_at(load3(w.place, n), one) if nodes.point[n] >= 0 else one)
        store21(w.L, n, none21)
        store6(w.y, n, none)


@inlined
def initial_bias_forces(w: Work, I: Table) -> None:
    """p_i = I_i a_i + v_i ×̂ I_i v_i (19): inertial forces at q̈ = 0, of links with the inertias `I`."""
    for i in range(I.shape[0]):
        store6(w.p, i, body_force(load21(I, i), load6(w.v, i), load6(w.a, i)))


@inlined
def sweep_inward(joints: Joints, nodes: Nodes, w: Work, biased: bool) -> Number:
    """Eliminate all links, the outermost first: `IA` holds their own inertia before, the articulated one after.

    `p` and `y` carry the bias where it is wanted. Return the smallest relative pivot.
    """
    smallest, nothing = full_like(1.0, w.R[0, 0]), zero21(w.R[0, 0])
    felt = nothing  # what link i feels of link i + 1, if that hangs from it: a way through memory would take longer
    for i in range(joints.parent.size - 1, 0, -1):
        h, n = joints.parent[i], nodes.of_link[i]
        S, I, d = load6(w.S, i), sym6_add(load21(w.IA, i), felt), load3(w.d, i)
        store21(w.IA, i, I)
        if joints.turning[i]:
            U = sym6_mul_angular(I, S[3:6])
            beta = dot3(S[3:6], U[3:6])
            terms = trace_angular(I)
        else:
            U = sym6_mul(I, S)
            beta = dot6(S, U)
            terms = pivot_terms(I, S)
        beta = beta + joints.armature[i, 0]
        beta_inv = 1.0 / beta
        pivot = relative_pivot(beta, terms)
        w.relative_pivot[i, 0] = pivot
        smallest = minimum(smallest, pivot)
        # at the parent's origin already: so it is done by when β is known
        felt = inertia_across(inertia_from(d, I), force_from(d, U), beta_inv)
        if h == 0 or h != i - 1:
            add_to21(w.IA, h, felt)
            felt = nothing
        u = full_like(0.0, beta)
        if biased:
            p = load6(w.p, i)
            u = dot6(S, p)
            add_to6(w.p, h, force_from(d, force_across(p, U, u, beta_inv)))
        if n > 0:
            K, r = load36(w.K, n), load3(w.r, i)
            f = mat6_mul(K, motion_at(scale3(r, -1.0), S))
            g = scale6(f, beta_inv)
            add_to21(w.L, n, sym6_outer(f, g))
            store36(w.K, n, mat6_add_outer(K, g, scale6(force_from(r, U), -1.0)))
            if biased:
                add_to6(w.y, n, scale6(g, -u))
    return smallest


@inlined
def invert_base(w: Work) -> Number:
    """G_00 = (I_0^A)⁻¹; return the smallest relative pivot: a base beside which all it carries is heavy has none."""
    inverse, pivot = sym6_inverse_and_pivot(load21(w.IA, 0))
    store36(w.G, 0, sym6_to_mat(inverse))
    return pivot


@inlined
def sweep_outward(nodes: Nodes, w: Work) -> None:
    """Spread the mobility of the base over the nodes."""
    for n in range(1, nodes.parent.size):
        h = nodes.parent[n]
        K = load36(w.K, n)
        for b in range(n):
            if n > nodes.last_descendant[b]:
                continue
            inner = load36(w.G, block(h, b)) if h >= b else mat6_transpose(load36(w.G, block(b, h)))
            store36(w.G, block(n, b), mat6_product(K, inner))
        own = mat6_product(K, mat6_transpose(load36(w.G, block(n, h))))
        store36(w.G, block(n, n), mat6_add(own, sym6_to_mat(load21(w.L, n))))


@inlined
def spread_bias(nodes: Nodes, w: Work) -> None:
    """ẍ_e of the points when no force acts, to rows of `acceleration`; `y` becomes the nodes' own acceleration."""
    store6(w.y, 0, scale6(mat6_mul(load36(w.G, 0), load6(w.p, 0)), -1.0))
    for n in range(1, nodes.parent.size):
        y = add6(load6(w.y, n), mat6_mul(load36(w.K, n), load6(w.y, nodes.parent[n])))
        store6(w.y, n, y)
        if nodes.point[n] >= 0:
            store6(w.acceleration, nodes.point[n], acceleration_at(nodes, w, n, y))


@inlined
def collect(nodes: Nodes, w: Work, Gamma_inv: Table) -> None:
    """Γ_e⁻¹ (6p, 6p) from the blocks of the points."""
    for n in range(1, nodes.parent.size):
        for b in range(1, n + 1):
            e, d = nodes.point[n], nodes.point[b]
            if e >= 0 and d >= 0:
                K = load36(w.G, block(n, b))
                store_block(Gamma_inv, e, d, K)
                if n != b:
                    store_block(Gamma_inv, d, e, mat6_transpose(K))


@inlined
def store_block(matrix: Table, e: int, d: int, K: Mat6) -> None:
    """Write the 6×6 block (e, d)."""
    store6_at(matrix, 6 * e, 6 * d, K[0:6])
    store6_at(matrix, 6 * e + 1, 6 * d, K[6:12])
    store6_at(matrix, 6 * e + 2, 6 * d, K[12:18])
    store6_at(matrix, 6 * e + 3, 6 * d, K[18:24])
    store6_at(matrix, 6 * e + 4, 6 * d, K[24:30])
    store6_at(matrix, 6 * e + 5, 6 * d, K[30:36])

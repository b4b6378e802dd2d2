"""Inverse operational inertia and bias of p points in one inward and one outward sweep (PV-OSIMr).

What (38)–(43) do link by link outward, is gathered on the way inward: along each stretch of links between two *nodes*
(points, and links in which the ways to several points meet) the motion of the outer node n by that of the link i is

    a_n = K a_i + y,   with a force on n adding L to what it moves.

Passing joint i, with U = I_i^A S_i and β = S_iᵀ U as in (38) and f = K S_i,

    L ← L + f fᵀ/β,   y ← y − f S_iᵀ p_i^A/β,   K ← K − f Uᵀ/β

which are the propagators L_iᵀ of (39), (40) multiplied up. Accelerations are counted from what they are while no joint
accelerates, so that p_i begins as the force which that takes (19), and the c_i of (42) are in it. Then, outward over
the nodes,

    G_00 = (I_0^A)⁻¹,   G_nb = K_n G_hb + δ_nb L_n,   a_0 = −(I_0^A)⁻¹ p_0^A,   a_n = K_n a_h + y_n

and G is Γ_e⁻¹ where both nodes are points, since K starts there as the shift to the point. (Sathya et al.,
arXiv 2310.03676, for a floating base: n rank-one updates, and a 6×6 product for each pair of nodes.)
"""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.articulated import force_across, inertia_across, inertia_share
from ospace.kernels.kinematics import Frames, Joints
from ospace.kernels.lanes import (
    Row,
    Table,
    add_to6,
    add_to21,
    inlined,
    load3,
    load6,
    load9,
    load21,
    load36,
    store3,
    store6,
    store21,
    store36,
    store_part6,
)
from ospace.kernels.simd import like
from ospace.kernels.spatial import (
    add3,
    add6,
    body_force,
    classical,
    dot6,
    mat6_add,
    mat6_add_outer,
    mat6_mul,
    mat6_product,
    mat6_transpose,
    motion_at,
    motions_at,
    rotate,
    scale6,
    sym6_inverse,
    sym6_mul,
    sym6_outer,
    sym6_to_mat,
    zero6,
)
from ospace.kernels.tables import Floats, Ints


class Nodes(NamedTuple):
    """Points and junctions in the tree: node 0 is the base, parents come first."""

    parent: Ints
    link: Ints
    point: Ints
    """Number of the point, or −1 for a junction."""
    offset: Floats
    """(nodes, 3) of points: their place in the link's axes."""
    until: Ints
    """The last node whose block with this one is wanted: for a junction, its last child."""
    of_link: Ints
    """(n + 1,) the node next below each link, itself included, with no other node between; 0 where there is none."""


class Spread(NamedTuple):
    """What the sweeps leave at the nodes."""

    place: Table
    K: Table
    L: Table
    G: Table
    """Blocks (n, b), b ≤ n, row by row."""


@inlined
def block(n: int, b: int) -> int:
    """Row of G in which block (n, b) stands, b ≤ n."""
    return n * (n + 1) // 2 + b


@inlined
def place_points(nodes: Nodes, frames: Frames, place: Table) -> None:
    """Where the points are, about the base."""
    for n in range(1, nodes.parent.size):
        if nodes.point[n] >= 0:
            link = nodes.link[n]
            store3(place, n, add3(load3(frames.r, link), rotate(load9(frames.R, link), load3(nodes.offset, n))))


@inlined
def begin(nodes: Nodes, at: Spread, y: Table) -> None:
    """K is the shift to the point, or 1 at a junction; L and y are zero."""
    o, i = like(0.0, at.K[0, 0]), like(1.0, at.K[0, 0])
    one = (
        (i, o, o, o, o, o) + (o, i, o, o, o, o) + (o, o, i, o, o, o)
        + (o, o, o, i, o, o) + (o, o, o, o, i, o) + (o, o, o, o, o, i)
    )  # fmt: skip
    none = zero6(one)
    for n in range(1, nodes.parent.size):
        store36(at.K, n, motions_at(load3(at.place, n), one) if nodes.point[n] >= 0 else one)
        store21(at.L, n, none + none + none + (o, o, o))
        store6(y, n, none)


@inlined
def load_links(I: Table, v: Table, a: Table, p: Table) -> None:
    """p_i = I_i a_i + v_i ×̂ I_i v_i: inertial forces at q̈ = 0 (19)."""
    for i in range(I.shape[0]):
        store6(p, i, body_force(load21(I, i), load6(v, i), load6(a, i)))


@inlined
def sweep_inward(
    joints: Joints, nodes: Nodes, S: Table, I: Table, share: Table, at: Spread, p: Table | None, y: Table | None
) -> None:
    """Eliminate all links, the outermost first; `I` and `p` become articulated, `share` the links' shares of inertia.

    `p` and `y` carry the bias; with None for each, none is computed.
    """
    for i in range(joints.parent.size - 1, 0, -1):
        h, n = joints.parent[i], nodes.of_link[i]
        S_i, I_i = load6(S, i), load21(I, i)
        U = sym6_mul(I_i, S_i)
        beta = dot6(S_i, U) + joints.mass[i, 1]
        beta_inv = 1.0 / beta
        share[i, 0] = inertia_share(I_i, S_i, beta)
        add_to21(I, h, inertia_across(I_i, U, beta_inv))
        if p is not None:
            p_i = load6(p, i)
            u = dot6(S_i, p_i)
            add_to6(p, h, force_across(p_i, U, u, beta_inv))
        if n > 0:
            K = load36(at.K, n)
            f = mat6_mul(K, S_i)
            g = scale6(f, beta_inv)
            add_to21(at.L, n, sym6_outer(f, g))
            store36(at.K, n, mat6_add_outer(K, g, scale6(U, -1.0)))
            if p is not None:
                add_to6(y, n, scale6(g, -u))


@inlined
def sweep_outward(nodes: Nodes, I: Table, at: Spread) -> None:
    """Spread the mobility of the base over the nodes."""
    store36(at.G, 0, sym6_to_mat(sym6_inverse(load21(I, 0))))
    for n in range(1, nodes.parent.size):
        h = nodes.parent[n]
        K = load36(at.K, n)
        for b in range(n):
            if n > nodes.until[b]:
                continue
            inner = load36(at.G, block(h, b)) if h >= b else mat6_transpose(load36(at.G, block(b, h)))
            store36(at.G, block(n, b), mat6_product(K, inner))
        own = mat6_product(K, mat6_transpose(load36(at.G, block(n, h))))
        store36(at.G, block(n, n), mat6_add(own, sym6_to_mat(load21(at.L, n))))


@inlined
def spread_bias(
    nodes: Nodes, I: Table, v: Table, a: Table, p: Table, y: Table, at: Spread, acceleration: Table
) -> None:
    """ẍ_e of the points when no force acts, into rows of `acceleration`; `y` becomes the nodes' own."""
    store6(y, 0, scale6(sym6_mul(sym6_inverse(load21(I, 0)), load6(p, 0)), -1.0))
    for n in range(1, nodes.parent.size):
        store6(y, n, add6(load6(y, n), mat6_mul(load36(at.K, n), load6(y, nodes.parent[n]))))
        if nodes.point[n] >= 0:
            place, link = load3(at.place, n), nodes.link[n]
            a_n = add6(load6(y, n), motion_at(place, load6(a, link)))
            store6(acceleration, nodes.point[n], classical(a_n, motion_at(place, load6(v, link))))


@inlined
def collect(nodes: Nodes, at: Spread, Gamma_inv: Table) -> None:
    """Γ_e⁻¹ (6p, 6p) from the blocks of the points."""
    for n in range(1, nodes.parent.size):
        for b in range(1, n + 1):
            e, d = nodes.point[n], nodes.point[b]
            if e >= 0 and d >= 0:
                K = load36(at.G, block(n, b))
                store_block(Gamma_inv, e, d, K)
                if n != b:
                    store_block(Gamma_inv, d, e, mat6_transpose(K))


@inlined
def store_block(matrix: Table, e: int, d: int, K: Row) -> None:
    """Write the 6×6 block (e, d)."""
    store_part6(matrix, 6 * e, 6 * d, K[0:6])
    store_part6(matrix, 6 * e + 1, 6 * d, K[6:12])
    store_part6(matrix, 6 * e + 2, 6 * d, K[12:18])
    store_part6(matrix, 6 * e + 3, 6 * d, K[18:24])
    store_part6(matrix, 6 * e + 4, 6 * d, K[24:30])
    store_part6(matrix, 6 * e + 5, 6 * d, K[30:36])

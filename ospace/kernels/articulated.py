"""Articulated bodies of the forward chain: the inward sweep (38), (42).

U_i = I_i^A S_i,   β_i = S_iᵀ U_i
I_h^A = I_h + Σ ( I_i^A − U_i U_iᵀ/β_i )                                   (38)
p_h^A = p_h + Σ ( p_i^A + I_i^A c_i − U_i S_iᵀ(p_i^A + I_i^A c_i)/β_i )    (42)
"""

from __future__ import annotations

import numpy as np

from ospace.kernels.lanes import Number, Row, add_to6, add_to21, inlined, load6, load21, store6
from ospace.kernels.simd import size
from ospace.kernels.spatial import add6, cross_force, dot6, scale6, sub6, sym6_mul, sym6_outer, sym6_sub
from ospace.kernels.tables import Articulated, Links, Tree


@inlined
def loaded_links(tree: Tree) -> Articulated:
    """Return the links before any is eliminated: I_i and p_i = v_i ×̂ I_i v_i."""
    rows = tree.v.shape[0]
    p = np.empty((rows, 6))
    for i in range(rows):
        v = load6(tree.v, i)
        store6(p, i, cross_force(v, sym6_mul(load21(tree.I, i), v)))
    return Articulated(tree.I.copy(), p, np.zeros((rows, 6)), np.zeros(rows), np.zeros(rows))


@inlined
def inertia_across(I: Row, U: Row, beta_inv: Number) -> Row:
    """I L = I − U Uᵀ/β: what is felt of the inertia I beyond the joint."""
    return sym6_sub(I, sym6_outer(U, scale6(U, beta_inv)))


@inlined
def force_across(p: Row, U: Row, u: Number, beta_inv: Number) -> Row:
    """Return p − U u/β: what is felt of the force p beyond the joint, u = Sᵀ p."""
    return sub6(p, scale6(U, u * beta_inv))


@inlined
def eliminate(links: Links, tree: Tree, body: Articulated, i: int) -> None:
    """Pass link `i` with all it carries on to its parent."""
    S, I = load6(tree.S, i), load21(body.I, i)
    U = sym6_mul(I, S)
    beta_inv = 1.0 / (dot6(S, U) + links.armature[i])
    p = add6(load6(body.p, i), sym6_mul(I, load6(tree.c, i)))
    u = dot6(S, p)
    add_to21(body.I, links.parent[i], inertia_across(I, U, beta_inv))
    add_to6(body.p, links.parent[i], force_across(p, U, u, beta_inv))
    store6(body.U, i, U)
    body.beta_inv[i] = beta_inv
    body.u[i] = u


NO_INERTIA = 1e-13
"""A joint whose share of inertia is smaller moves nothing: so near rounding, all that would follow is noise."""


@inlined
def inertia_share(I: Row, S: Row, beta: Number) -> Number:
    """β over the terms that it is made of, Σ S_k² I_kk: where it falls to rounding, the joint has no inertia left."""
    terms = (
        S[0] * S[0] * size(I[0]) + S[1] * S[1] * size(I[2]) + S[2] * S[2] * size(I[5])
        + S[3] * S[3] * size(I[9]) + S[4] * S[4] * size(I[14]) + S[5] * S[5] * size(I[20])
    )  # fmt: skip
    return beta / (terms + 1e-300)  # no terms, no inertia


@inlined
def sweep_inward(links: Links, tree: Tree) -> Articulated:
    """Eliminate every link, the outermost first."""
    body = loaded_links(tree)
    for i in range(links.parent.size - 1, 0, -1):
        eliminate(links, tree, body, i)
    return body

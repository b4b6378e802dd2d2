"""Operational-space dynamics of one point by the inverted chain (§6.1), on any tree.

The tree is re-rooted at the point's link e: Γ_e is then the articulated-body inertia of the new root. Branches
off the path from base to e enter first, with their articulated inertia and bias (38), (42); then along the path,
outward, h handing over to i:

    α_i = S_iᵀ I_h^A S_i
    I_i^A = I_i + I_h^A L_i,   L_i = 1 − S_i S_iᵀ I_h^A/α_i                    (33)
    p_i^A = p_i + p_h^A − I_h^A L_i c_i − I_h^A S_i S_iᵀ p_h^A/α_i             (35)
    Γ_e = X I_e^A Xᵀ,   μ_e = X p_e^A + Γ_e [v_e × ω_e; 0]                     (34), (36)
"""

from __future__ import annotations

import numpy as np

from ospace.kernels.articulated import eliminate, force_across, inertia_across, inertia_share, loaded_links
from ospace.kernels.composite import place_points
from ospace.kernels.lanes import add_to6, add_to21, entry, inlined, load3, load6, load21, store6, store36
from ospace.kernels.spatial import (
    classical,
    dot6,
    force_from,
    forces_from,
    mat6_mul,
    mat6_transpose,
    motion_at,
    scale3,
    sub6,
    sym6_mul,
    sym6_to_mat,
    zero6,
)
from ospace.kernels.tables import Articulated, Floats, Links, Points, Tree


@inlined
def hand_outward(links: Links, tree: Tree, body: Articulated, i: int) -> None:
    """Pass the base's side of joint `i` on to link `i`; from there the joint runs backwards, so c_i changes sign."""
    h = links.parent[i]
    S, I = load6(tree.S, i), load21(body.I, h)
    U = sym6_mul(I, S)
    alpha_inv = 1.0 / (dot6(S, U) + links.armature[i])
    p = sub6(load6(body.p, h), sym6_mul(I, load6(tree.c, i)))
    add_to21(body.I, i, inertia_across(I, U, alpha_inv))
    add_to6(body.p, i, force_across(p, U, dot6(S, p), alpha_inv))
    store6(body.U, i, U)
    body.beta_inv[i] = alpha_inv


@entry
def inverted_chain(links: Links, point: Points, placements: Floats, tree: Tree) -> tuple[Floats, Floats, Floats]:
    """Γ_e (6, 6), μ_e (6,) of the one `point`, and `inertia_share` of each link (n + 1,)."""
    n, e = links.parent.size - 1, point.link[0]
    position, on_path = np.empty((1, 3)), np.zeros(n + 1, np.bool_)
    place_points(point, placements, position)
    body, share = loaded_links(tree), np.ones(n + 1)
    for step in range(point.depth[0]):
        on_path[point.path[0, step]] = True

    for i in range(n, 0, -1):
        if not on_path[i]:
            eliminate(links, tree, body, i)
            share[i] = inertia_share(load21(body.I, i), load6(tree.S, i), 1.0 / body.beta_inv[i])
    for step in range(point.depth[0]):
        i = point.path[0, step]
        hand_outward(links, tree, body, i)
        share[i] = inertia_share(load21(body.I, links.parent[i]), load6(tree.S, i), 1.0 / body.beta_inv[i])

    back = scale3(load3(position, 0), -1.0)
    Gamma = forces_from(back, mat6_transpose(forces_from(back, sym6_to_mat(load21(body.I, e)))))
    turning = classical(zero6(back), motion_at(load3(position, 0), load6(tree.v, e)))
    mu = sub6(force_from(back, load6(body.p, e)), mat6_mul(Gamma, turning))
    Gamma_e, mu_e = np.empty((1, 36)), np.empty((1, 6))
    store36(Gamma_e, 0, Gamma)
    store6(mu_e, 0, mu)
    return Gamma_e.reshape(6, 6), mu_e[0], share

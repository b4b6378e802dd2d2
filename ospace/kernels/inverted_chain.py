"""Inverted chain of the paper (§6.1): operational-space dynamics of one point, in link frames, on any tree.

The tree is re-rooted at the point's link e: Γ_e is then the articulated-body inertia of the new root. Branches off the
path from base to e enter first, with their articulated inertia and bias (38), (42). Then along the path, outward, h
handing over to i, with ⁱX_h = (ʰX_i)⁻¹ the transform of forces from h to i (15):

    ⁱI_h = ⁱX_h I_h^A ⁱX_hᵀ,   ⁱp_h = ⁱX_h p_h^A
    α_i = S_iᵀ ⁱI_h S_i + a_r,   L_i = 1 − S_i S_iᵀ ⁱI_h/α_i
    I_i^A = I_i + ⁱI_h L_i                                                     (33)
    p_i^A = p_i + L_iᵀ ⁱp_h − ⁱI_h L_i c_i                                      (35)
    Γ_e = ᴵX I_e^A ᴵXᵀ,   μ_e = ᴵX p_e^A + Γ_e [v_e × ω_e; 0]                   (34), (36)

c_i enters with the opposite sign: the joint runs backwards, and a_h = a_i − c_i − S_i b_i (23).
"""

from __future__ import annotations

import numpy as np

from ospace.kernels.forward_chain import (
    ArticulatedBodies,
    Chain,
    Ends,
    classical,
    inverse_transform,
    links_alone,
    motion_at,
    pass_inward,
    propagate,
    relative_pivot,
    solve,
)
from ospace.kernels.tree import Floats, path_to


def pass_outward(chain: Chain, body: ArticulatedBodies, i: int) -> None:
    """Pass the base's side of joint `i` on to link `i` (33), (35)."""
    h, S, X = chain.parent[i], chain.S[i], inverse_transform(chain.X[i])
    L_T, I_L, body.beta[i] = propagate(X @ body.I[h] @ X.T, S, chain.armature[i])
    body.moved[i] = X @ body.IC[h] @ X.T
    body.I[i] += I_L
    body.p[i] += L_T @ (X @ body.p[h]) - I_L @ chain.c[i]
    body.IC[i] += body.moved[i]


@np.errstate(divide="ignore", invalid="ignore")  # a joint without inertia is reported by its pivot
def inverted_chain(chain: Chain, end: Ends) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Compute the operational-space dynamics of the one point `end` by the inverted chain.

    Returns
    -------
    Gamma, mu_e : (6, 6), (6,)
        Γ_e (34) and μ_e (36), inertial axes, at the point.
    Gamma_inv, acceleration : (6, 6), (6,)
        Γ_e⁻¹, and ẍ_e when no force acts, −μ: both solved for in the frame of the link, where what is heavy and what
        is light lie on axes of their own.
    relative_pivot : (n + 1,)
        Of the joint of each link, see `relative_pivot`; row 0 means nothing.
    """
    body, X, e = links_alone(chain), end.X[0], int(end.link[0])
    path = path_to(chain.parent, e)
    for i in range(len(chain.parent) - 1, 0, -1):
        if i not in path:
            pass_inward(chain, body, i)
    own = body.IC[e].copy()
    for i in path:
        pass_outward(chain, body, i)

    I, p, v_e = body.I[e], body.p[e], motion_at(end, chain.v)
    X_inv = inverse_transform(X)
    Gamma = X_inv @ I @ X_inv.T
    mu_e = X_inv @ p - Gamma @ classical(np.zeros((1, 6)), v_e)[0]
    acceleration = classical(-(X.T @ solve(I, p))[None, :], v_e)[0]
    pivots = relative_pivot(body.beta, chain.S, body.moved)
    if path:  # nothing of the base's side resists the last joint: it has to be the link itself
        S = chain.S[e]
        pivots[e] = min(pivots[e], relative_pivot(S @ I @ S, S[None], own[None])[0])
    return Gamma, mu_e, X.T @ solve(I, X), acceleration, pivots

"""Forward chain of the paper (§6.2): operational-space dynamics of p points, in link frames.

With ʰX_i the transform of forces from link i to its parent h (14), and a_r the armature of joint i, inward:

    β_i = S_iᵀ I_i^A S_i + a_r,   L_i = ʰX_i (1 − I_i^A S_i S_iᵀ/β_i)
    I_h^A = I_h + Σ ( L_i I_i^A L_iᵀ + (a_r/β_i²) ʰX_i I_i^A S_i S_iᵀ I_i^A ʰX_iᵀ )   (38)
    p_h^A = p_h + Σ L_i (p_i^A + I_i^A c_i),   p_i = v_i ×̂ I_i v_i                     (42)

(38) is the printed ʰL_i I_i^A ʰX_iᵀ, in the symmetric form that Kalman filters call Joseph's: a sum of positive terms,
in which rounding is not left over along the axis of the joint. Outward:

    Λ_00 = (I_0^A)⁻¹,   Λ_ii = S_i S_iᵀ/β_i + L_iᵀ Λ_hh L_i                            (39)
    Λ_ij = L_iᵀ Λ_hj where j is not below i,   Λ_ij = Λ_ih L_j where i is not below j   (40)
    Γ⁻¹_ij = ᴵXᵀ Λ_ij ᴵX, to inertial axes at the points                                (41)
    a_0 = −(I_0^A)⁻¹ p_0^A,   a_i = ʰX_iᵀ a_h + c_i + S_i b_i
    b_i = −S_iᵀ( I_i^A (ʰX_iᵀ a_h + c_i) + p_i^A )/β_i                                  (43)
    ẍ_e = ᴵXᵀ a_i − [v_e × ω_e; 0]                                                      (44), (45)

Every quantity stands at the origin of its own link, in the axes of that link. Where the third axis is the joint's, as
in the paper, a light link at the end of a long boom costs no digits.

This is the form to read: plain NumPy, one line for one equation. The fast form is PV-OSIMr.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ospace.kernels.tree import Floats, Ints

_ONE = np.eye(6)


class Chain(NamedTuple):
    """Links of one state in their own frames, rows 0…n; row 0 is the base and has no joint."""

    parent: Ints
    """h, always the smaller number."""
    X: Floats
    """(n + 1, 6, 6) ʰX_i: forces of link i to forces of its parent."""
    S: Floats
    """(n + 1, 6) joint columns."""
    I: Floats
    """(n + 1, 6, 6) inertias."""
    v: Floats
    """(n + 1, 6) velocities."""
    c: Floats
    """(n + 1, 6) velocity-product accelerations across the joints (17)."""
    armature: Floats
    """(n + 1,) inertia of the drives."""


class Ends(NamedTuple):
    """Operational points of one state."""

    link: Ints
    """(p,) the links that carry them."""
    X: Floats
    """(p, 6, 6) forces at the point in inertial axes, to forces of its link."""


class ArticulatedBodies(NamedTuple):
    """Articulated bodies, rows 0…n."""

    I: Floats
    """(n + 1, 6, 6) I^A."""
    p: Floats
    """(n + 1, 6) p^A."""
    IC: Floats
    """(n + 1, 6, 6) I^C, the same with all joints locked."""
    moved: Floats
    """(n + 1, 6, 6) what of I^C the joint of the link moves."""
    L: Floats
    """(n + 1, 6, 6) propagators: forces of the link to what its parent feels of them."""
    beta: Floats
    """(n + 1,)."""


def skew(r: Floats) -> Floats:
    """Return r̃ (k, 3, 3), r̃ a = r × a, of vectors (k, 3)."""
    x, y, z = r.T
    R = np.zeros((len(r), 3, 3))
    R[:, 0, 1], R[:, 0, 2], R[:, 1, 2] = -z, y, -x
    R[:, 1, 0], R[:, 2, 0], R[:, 2, 1] = z, -y, x
    return R


def force_transform(R: Floats, r: Floats) -> Floats:
    """Return X (14) = [R 0; r̃R R], (k, 6, 6), of rotations (k, 3, 3) and origins (k, 3)."""
    X = np.zeros((len(R), 6, 6))
    X[:, :3, :3] = X[:, 3:, 3:] = R
    X[:, 3:, :3] = skew(r) @ R
    return X


def inverse_transform(X: Floats) -> Floats:
    """Return X⁻¹ (15) = [Rᵀ 0; (r̃R)ᵀ Rᵀ], (6, 6)."""
    inverse = np.zeros((6, 6))
    inverse[:3, :3] = inverse[3:, 3:] = X[:3, :3].T
    inverse[3:, :3] = X[3:, :3].T
    return inverse


def cross_force(v: Floats) -> Floats:
    """Return v ×̂ = [ω̃ 0; ṽ ω̃] on forces, (k, 6, 6), of velocities (k, 6): the dual of the operator on motions."""
    operator = np.zeros((len(v), 6, 6))
    operator[:, :3, :3] = operator[:, 3:, 3:] = skew(v[:, 3:])
    operator[:, 3:, :3] = skew(v[:, :3])
    return operator


def initial_bias_forces(chain: Chain) -> Floats:
    """Return p_i = v_i ×̂ I_i v_i (n + 1, 6)."""
    momenta = chain.I @ chain.v[:, :, None]
    return np.asarray(cross_force(chain.v) @ momenta)[:, :, 0]


def classical(a: Floats, v: Floats) -> Floats:
    """Return ẍ = a − [v × ω; 0] of points, from their spatial accelerations and velocities, rows (p, 6)."""
    turning = skew(v[:, :3]) @ v[:, 3:, None]
    return a - np.hstack([turning[:, :, 0], np.zeros((len(v), 3))])


def solve(I: Floats, B: Floats) -> Floats:
    """Return I⁻¹ B, scaled to unit diagonal first: kilograms beside grams cost no digits."""
    scale = 1.0 / np.sqrt(np.diag(I))
    X: Floats = (scale * np.linalg.solve(I * np.outer(scale, scale), (scale * B.T).T).T).T
    return X


def motion_at(ends: Ends, motion: Floats) -> Floats:
    """Return ᴵXᵀ v_i (p, 6): motions of the links that carry the points, at the points in inertial axes."""
    X_T = ends.X.transpose(0, 2, 1)
    return np.asarray(X_T @ motion[ends.link, :, None])[:, :, 0]


def relative_pivot(beta: Floats, S: Floats, IC: Floats) -> Floats:
    """Return β over the diagonal of the composite inertia that each joint moves, (n + 1,).

    Rounding of β is of the size of that diagonal: where the ratio falls to it, nothing resists the joint.
    """
    diagonal = np.diagonal(IC, axis1=1, axis2=2).reshape(-1, 2, 3).sum(axis=2)
    moved = (np.square(S).reshape(-1, 2, 3).sum(axis=2) * diagonal).sum(axis=1)
    return np.asarray(beta / np.maximum(moved, 1e-300))  # nothing moved, no pivot


def propagate(I: Floats, S: Floats, armature: float) -> tuple[Floats, Floats, float]:
    """Return L = 1 − I S Sᵀ/β, I L, and β = Sᵀ I S + a_r for one joint, all in one frame.

    Along its own axis L is set to what it must be, Sᵀ L = a_r Sᵀ/β: without armature exactly no force passes along the
    axis then, however heavy the body and light the next one.
    """
    U = I @ S
    beta = float(S @ U) + armature
    u = U / beta
    L = _ONE - u[:, None] * S
    L += (S / (S @ S))[:, None] * (armature / beta * S - S @ L)
    return L, L @ I @ L.T + (armature * u)[:, None] * u, beta


def links_alone(chain: Chain) -> ArticulatedBodies:
    """Return the links before any joint is eliminated."""
    I = chain.I
    L, moved, beta = np.zeros_like(I), np.zeros_like(I), np.zeros(len(I))
    return ArticulatedBodies(I.copy(), initial_bias_forces(chain), I.copy(), moved, L, beta)


def pass_inward(chain: Chain, body: ArticulatedBodies, i: int) -> None:
    """Eliminate joint `i`: pass link `i` with all it carries on to its parent (38), (42)."""
    h, X, S = chain.parent[i], chain.X[i], chain.S[i]
    L, I_L, body.beta[i] = propagate(body.I[i], S, chain.armature[i])
    body.L[i] = X @ L
    body.I[h] += X @ I_L @ X.T
    body.p[h] += body.L[i] @ (body.p[i] + body.I[i] @ chain.c[i])
    body.moved[i] = body.IC[i]
    body.IC[h] += X @ body.IC[i] @ X.T


def pass_outward_blocks(chain: Chain, body: ArticulatedBodies) -> Floats:
    """Return Λ_ii (39) of all links, (n + 1, 6, 6)."""
    Lambda = np.empty_like(body.I)
    Lambda[0] = solve(body.I[0], _ONE)
    for i in range(1, len(Lambda)):
        S, L = chain.S[i], body.L[i]
        Lambda[i] = S[:, None] * (S / body.beta[i]) + L.T @ Lambda[chain.parent[i]] @ L
    return Lambda


def cross_coupling(chain: Chain, body: ArticulatedBodies, Lambda: Floats, i: int, j: int) -> Floats:
    """Return Λ_ij (40), (6, 6): from the nearest common ancestor outward to both links."""
    left = right = _ONE
    while i != j:
        if i > j:  # j is not below i
            left, i = body.L[i] @ left, chain.parent[i]
        else:
            right, j = body.L[j] @ right, chain.parent[j]
    K: Floats = left.T @ Lambda[i] @ right
    return K


def pass_outward_accelerations(chain: Chain, body: ArticulatedBodies) -> Floats:
    """Return the accelerations a_i (43) of all links when no force acts, (n + 1, 6)."""
    a = np.empty_like(chain.v)
    a[0] = -solve(body.I[0], body.p[0])
    for i in range(1, len(a)):
        S = chain.S[i]
        a[i] = chain.X[i].T @ a[chain.parent[i]] + chain.c[i]
        a[i] -= S * (S @ (body.I[i] @ a[i] + body.p[i]) / body.beta[i])
    return a


def response(chain: Chain, ends: Ends, body: ArticulatedBodies) -> Floats:
    """Return H⁻¹ J_eᵀ (n + 6, 6p): accelerations of the base, in its own axes, and of the joints per unit wrench.

    It is the pair of sweeps (42), (43) with the wrenches in the place of −p^A, and without c_i.
    """
    n, p = len(chain.parent) - 1, len(ends.link)
    P = np.zeros((n + 1, 6, 6 * p))
    for e, i in enumerate(ends.link):
        P[i, :, 6 * e : 6 * e + 6] += ends.X[e]
    for i in range(n, 0, -1):
        P[chain.parent[i]] += body.L[i] @ P[i]

    Y, A = np.empty((n + 6, 6 * p)), np.empty_like(P)
    Y[:6] = A[0] = solve(body.I[0], P[0])
    for i in range(1, n + 1):
        S = chain.S[i]
        A[i] = chain.X[i].T @ A[chain.parent[i]]
        Y[i + 5] = S @ (P[i] - body.I[i] @ A[i]) / body.beta[i]
        A[i] += S[:, None] * Y[i + 5]
    return Y


@np.errstate(divide="ignore", invalid="ignore")  # a joint without inertia is reported by its pivot
def forward_chain(chain: Chain, ends: Ends) -> tuple[Floats, Floats, Floats, Floats]:
    """Compute the operational-space dynamics of p points by the forward chain.

    Returns
    -------
    Gamma_inv : (6p, 6p)
        Γ_e⁻¹ (37), inertial axes, at the points.
    acceleration : (p, 6)
        ẍ_e when no force acts, likewise: −μ.
    response : (n + 6, 6p)
        H⁻¹ J_eᵀ, rows of the base in its own axes.
    relative_pivot : (n + 1,)
        Of the joint of each link, see `relative_pivot`; row 0 means nothing.
    """
    body = links_alone(chain)
    for i in range(len(chain.parent) - 1, 0, -1):
        pass_inward(chain, body, i)

    Lambda, p = pass_outward_blocks(chain, body), len(ends.link)
    Gamma_inv = np.empty((6 * p, 6 * p))
    for e, i in enumerate(ends.link):
        for d, j in enumerate(ends.link[: e + 1]):
            K = ends.X[e].T @ cross_coupling(chain, body, Lambda, i, j) @ ends.X[d]  # (41)
            Gamma_inv[6 * e : 6 * e + 6, 6 * d : 6 * d + 6] = K
            Gamma_inv[6 * d : 6 * d + 6, 6 * e : 6 * e + 6] = K.T

    a = motion_at(ends, pass_outward_accelerations(chain, body))  # (44)
    acceleration = classical(a, motion_at(ends, chain.v))  # (45)
    pivots = relative_pivot(body.beta, chain.S, body.moved)
    return Gamma_inv, acceleration, response(chain, ends, body), pivots

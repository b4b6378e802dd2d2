"""Responses to forces at the points, from the articulated bodies that `pv_osimr` leaves: H⁻¹ J_eᵀ, and Λ of (12).

For a unit of each wrench at a point, inward along its path, with P the forces on link i and f_i what the joint feels,

    f_i = S_iᵀ P,   P ← X (P − U_i f_i/β_i),

at the base and outward over all links, with A the accelerations,

    A_0 = (I_0^A)⁻¹ P,   φ̈_i = (f_i − U_iᵀ Xᵀ A_h)/β_i,   A_i = Xᵀ A_h + S_i φ̈_i

which are the sweeps of (38)–(43) with a force in place of the bias. By (7) the rows of the joints are H_m*⁻¹ J_m*ᵀ, so

    torque map = J_m* H_m*⁻¹,   Λ⁻¹ = J_m* H_m*⁻¹ J_m*ᵀ,   Λ_b⁻¹ = J_b H_b⁻¹ J_bᵀ,
    μ = J_m* H_m*⁻¹ c_m* − ẍ_e(φ̈ = 0)                                           (12)
"""

from __future__ import annotations

from ospace.kernels.jit.compile import inlined
from ospace.kernels.jit.load_store import load3, load6, load21, load36, store6, store36
from ospace.kernels.spatial import (
    dot6,
    force_from,
    forces_from,
    mat6_add_outer,
    mat6_product,
    motion_at,
    motions_at,
    mul_mat6,
    scale6,
    sub6,
    sym6_mul,
    unit36,
    zero6,
)
from ospace.kernels.tree import Joints
from ospace.kernels.workspace import Robot, Work


@inlined
def respond(robot: Robot, w: Work) -> None:
    """H⁻¹ J_eᵀ (nv, r)."""
    joints, nodes = robot.joints, robot.nodes
    store_pivots(joints, w)
    I_inv = load36(w.G, 0)
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e < 0:
            continue
        for i in range(w.f.shape[0]):
            store6(w.f, i, zero6(I_inv))
        P, i = forces_from(load3(w.arm, n), unit36(I_inv)), nodes.link[n]
        while i > 0:
            f = mul_mat6(load6(w.S, i), P)
            store6(w.f, i, f)
            P = forces_from(load3(w.d, i), mat6_add_outer(P, load6(w.U, i), scale6(f, -w.beta_inv[i, 0])))
            i = joints.parent[i]
        store36(w.response_of_link, 0, mat6_product(I_inv, P))
        for i in range(1, joints.parent.size):
            A = motions_at(load3(w.d, i), load36(w.response_of_link, joints.parent[i]))
            rates = scale6(sub6(load6(w.f, i), mul_mat6(load6(w.U, i), A)), w.beta_inv[i, 0])
            store6(w.f, i, rates)
            store36(w.response_of_link, i, mat6_add_outer(A, load6(w.S, i), rates))
        for j in range(robot.rows.size):
            if robot.rows[j] // 6 == e:
                c = robot.rows[j] % 6
                for k in range(6):
                    w.response[k, j] = w.response_of_link[0, 6 * k + c]
                for i in range(1, joints.parent.size):
                    w.response[i + 5, j] = w.f[i, c]


@inlined
def store_pivots(joints: Joints, w: Work) -> None:
    """U_i and 1/β_i of all links."""
    for i in range(1, joints.parent.size):
        S = load6(w.S, i)
        U = sym6_mul(load21(w.IA, i), S)
        store6(w.U, i, U)
        w.beta_inv[i, 0] = 1.0 / (dot6(S, U) + joints.armature[i, 0])


@inlined
def free_floating(robot: Robot, w: Work) -> None:
    """Λ⁻¹, Λ_b⁻¹ and μ (12), from the response and the composite bodies."""
    rows, n = robot.rows, w.J_m_star.shape[0]
    for i in range(rows.size):
        for j in range(i + 1):
            s = 0.0
            for k in range(n):
                s += w.response[k + 6, i] * w.generalized_jacobian[j, k]
                s += w.response[k + 6, j] * w.generalized_jacobian[i, k]
            w.floating_inertia_inverse[i, j] = w.floating_inertia_inverse[j, i] = 0.5 * s
        s = -w.drift[rows[i] // 6, rows[i] % 6]
        for k in range(n):
            s += w.response[k + 6, i] * w.generalized_bias[k, 0]
        w.floating_bias[i, 0] = s


@inlined
def base_inertia_inverse(robot: Robot, w: Work) -> None:
    """Λ_b⁻¹ = J_b H_b⁻¹ J_bᵀ: a force at one point moves the locked robot, and with it the others."""
    nodes, rows = robot.nodes, robot.rows
    for j in range(rows.size):
        for n in range(1, nodes.parent.size):
            if nodes.point[n] == rows[j] // 6:
                c = rows[j] % 6
                force = (
                    (1.0 if c == 0 else 0.0, 1.0 if c == 1 else 0.0, 1.0 if c == 2 else 0.0)
                    + (1.0 if c == 3 else 0.0, 1.0 if c == 4 else 0.0, 1.0 if c == 5 else 0.0)
                )  # fmt: skip
                a = sym6_mul(load21(w.base_inverse, 0), force_from(load3(w.place, n), force))
                store6(w.base_mobility, j, a)
    for n in range(1, nodes.parent.size):
        for i in range(rows.size):
            if nodes.point[n] == rows[i] // 6:
                for j in range(rows.size):
                    a = motion_at(load3(w.place, n), load6(w.base_mobility, j))
                    w.base_inertia_inverse[i, j] = a[rows[i] % 6]

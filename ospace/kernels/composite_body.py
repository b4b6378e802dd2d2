"""Composite bodies: momentum, joint-space inertia, inverse dynamics and the generalized Jacobians (§4.2, §5).

Inertias, forces and motions stand at the links' own origins, d_i away from the parent's; X shifts them inward:

    I_h^C = I_h + Σ X I_i^C Xᵀ                               (21)
    F_i = I_i^C S_i,   H_b = I_0^C,   H_bm = [… X F_i …]
    (H_m)_ij = S_jᵀ X F_i for j on the way from i to the base; links that share a column add up
    J_b* = −(I_0^C)⁻¹ H_bm                                   (27)
    J_m* = Xᵀ S_k [k below e] + Xᵀ J_b*, at the point e      (29–31)
    f_h = I_h a_h + v_h ×̂ I_h v_h + Σ X f_i,   τ_i = S_iᵀ f_i  (17–19)
    H_m* = H_m + H_bmᵀ J_b*,   c_m* = c_m + J_b*ᵀ c_b        (7)
"""

from __future__ import annotations

from ospace.kernels.jit.compile import Number, Table, Vec6, inlined
from ospace.kernels.jit.load_store import (
    add_to6,
    add_to21,
    load3,
    load6,
    load6_at,
    load9,
    load21,
    store3,
    store6,
    store6_at,
    store21,
)
from ospace.kernels.jit.simd import full_like, minimum
from ospace.kernels.points import acceleration_at, joint_column, take_rows
from ospace.kernels.pv_osimr import initial_bias_forces
from ospace.kernels.spatial import (
    add6,
    body_force,
    diagonal,
    dot3,
    dot6,
    force_from,
    inertia_from,
    inertia_inverse_and_pivot,
    mass_centre,
    motion_at,
    rotate,
    scale6,
    sub3,
    sym6_mul,
    zero6,
)
from ospace.kernels.tree import Joints, Nodes
from ospace.kernels.workspace import Robot, Work

CANCELLED = 1e-11
"""Share of (H_m)_ii below which (H_m*)_ii is dominated by the round-off of what is subtracted."""


@inlined
def compose(joints: Joints, w: Work) -> None:
    """Fill `IC` and `F` at the links' origins, the columns of H_bm as rows, the diagonal of H and the mass centre."""
    coupled = joints.followers.size > 0
    for i in range(joints.parent.size):
        store21(w.IC, i, load21(w.I, i))
    if coupled:
        clear6(w.H_bm)
        for k in range(6, w.inertia_diagonal.shape[0]):
            w.inertia_diagonal[k, 0] = full_like(0.0, w.R[0, 0])
    for i in range(joints.parent.size - 1, 0, -1):
        IC = load21(w.IC, i)
        F = sym6_mul(IC, load6(w.S, i))
        store6(w.F, i, F)
        if coupled:
            add_to6(w.H_bm, joints.column[i], force_from(load3(w.r, i), F))
            add_coupled_diagonal(joints, w, i, F)
        else:
            store6(w.H_bm, i, force_from(load3(w.r, i), F))
            w.inertia_diagonal[i + 5, 0] = dot6(load6(w.S, i), F) + joints.armature[i, 0]
        add_to21(w.IC, joints.parent[i], inertia_from(load3(w.d, i), IC))
    H_b = load21(w.IC, 0)
    on_diagonal = diagonal(H_b)
    for k in range(6):
        w.inertia_diagonal[k, 0] = on_diagonal[k]
    store3(w.mass_centre, 0, mass_centre(H_b))


@inlined
def add_coupled_diagonal(joints: Joints, w: Work, i: int, F: Vec6) -> None:
    """Add what link `i` and those below it that share its column add to the diagonal of H; F = I_i^C S_i."""
    k = joints.column[i] + 5
    along, j = dot6(load6(w.S, i), F) + joints.armature[i, 0], joints.parent[i]
    while j > 0:
        if joints.column[j] == joints.column[i]:  # once as row, once as column
            along = along + 2.0 * dot6(load6(w.S, j), force_from(sub3(load3(w.r, i), load3(w.r, j)), F))
        j = joints.parent[j]
    w.inertia_diagonal[k, 0] = w.inertia_diagonal[k, 0] + along


@inlined
def clear6(rows: Table) -> None:
    """Set rows of six to zero."""
    for k in range(rows.shape[0]):
        store6(rows, k, zero6((rows[0, 0],)))


@inlined
def base_generalized_jacobian(w: Work) -> Number:
    """Columns of J_b* (27) as rows of `J_b_star` (n + 1, 6), and (I_0^C)⁻¹; return its smallest relative pivot."""
    I_inv, pivot = inertia_inverse_and_pivot(load21(w.IC, 0))
    store21(w.base_inverse, 0, I_inv)
    for k in range(1, w.H_bm.shape[0]):
        store6(w.J_b_star, k, scale6(sym6_mul(I_inv, load6(w.H_bm, k)), -1.0))
    return pivot


@inlined
def momentum(joints: Joints, w: Work) -> None:
    """M_0 = H_b ẋ_b + H_bm φ̇ (1, 25), about the base; and H_b⁻¹ M_0 (26), its motion while the joints rest."""
    R, u = load9(w.R, 0), w.velocity
    x_b = rotate(R, (u[0, 0], u[1, 0], u[2, 0])) + rotate(R, (u[3, 0], u[4, 0], u[5, 0]))
    of_joints = zero6(x_b)
    for k in range(1, w.H_bm.shape[0]):
        of_joints = add6(of_joints, scale6(load6(w.H_bm, k), u[k + 5, 0]))
    store6(w.momentum, 0, add6(sym6_mul(load21(w.IC, 0), x_b), of_joints))
    store6(w.base_momentum_velocity, 0, add6(x_b, sym6_mul(load21(w.base_inverse, 0), of_joints)))


@inlined
def generalized_jacobian(robot: Robot, w: Work) -> None:
    """J_m*, by columns in `J_m_star`, and the rows taken of it; J_b H_b⁻¹ M_0 of these."""
    joints, nodes = robot.joints, robot.nodes
    for n in range(1, nodes.parent.size):
        e = nodes.point[n]
        if e >= 0:
            p, link = load3(w.place, n), nodes.link[n]
            store6(w.momentum_velocity, e, motion_at(p, load6(w.base_momentum_velocity, 0)))
            for k in range(1, w.J_b_star.shape[0]):
                store6_at(w.J_m_star, k - 1, 6 * e, motion_at(p, load6(w.J_b_star, k)))
            while link > 0:
                k = joints.column[link] - 1
                column = add6(load6_at(w.J_m_star, k, 6 * e), joint_column(w, p, link))
                store6_at(w.J_m_star, k, 6 * e, column)
                link = joints.parent[link]
    take_rows(w.J_m_star, robot.rows, w.generalized_jacobian)


@inlined
def manipulator_inertia(joints: Joints, w: Work) -> None:
    """H_m (21), with the drives' inertia."""
    H = w.manipulator_inertia
    for i in range(H.shape[0]):
        for j in range(i + 1):
            H[i, j] = full_like(0.0, w.R[0, 0])
    add_manipulator_inertia(joints, w, H)


@inlined
def generalized_inertia(joints: Joints, w: Work) -> Number:
    """H_m* = H_m − H_bmᵀ H_b⁻¹ H_bm = H_m + H_bmᵀ J_b* (7); return a number below one where no digit is left of it."""
    H = w.generalized_inertia
    for i in range(H.shape[0]):
        F = load6(w.H_bm, i + 1)
        for j in range(i + 1):
            H[i, j] = dot6(F, load6(w.J_b_star, j + 1))
    add_manipulator_inertia(joints, w, H)
    excess = full_like(0.0, w.R[0, 0])
    for i in range(H.shape[0]):
        excess = minimum(excess, H[i, i] - CANCELLED * w.inertia_diagonal[i + 6, 0])
    return 1.0 + 1e300 * excess  # no division for each joint; below zero for whatever is lost


@inlined
def add_manipulator_inertia(joints: Joints, w: Work, H: Table) -> None:
    """Add H_m to `H`, whose lower rows are filled; fill the upper ones."""
    coupled = joints.followers.size > 0
    for i in range(1, joints.parent.size):
        F, r, j = load6(w.F, i), load3(w.r, i), i
        k = joints.column[i] - 1
        H[k, k] = H[k, k] + joints.armature[i, 0]
        while j > 0:
            S, f = load6(w.S, j), force_from(sub3(r, load3(w.r, j)), F)
            along = dot3(S[3:6], f[3:6]) if joints.turning[j] else dot6(S, f)
            if coupled:
                a, b = joints.column[i] - 1, joints.column[j] - 1
                if a == b and i != j:  # once as row, once as column
                    along = along + along
                a, b = max(a, b), min(a, b)
                H[a, b] = H[a, b] + along
            else:
                H[i - 1, j - 1] = H[i - 1, j - 1] + along
            j = joints.parent[j]
    for i in range(H.shape[0]):
        for j in range(i):
            H[j, i] = H[i, j]


@inlined
def sum_forces(joints: Joints, w: Work) -> None:
    """Turn the links' own forces in `p` into those across the joints: `base_force` and `joint_force`."""
    for k in range(w.joint_force.shape[0]):
        w.joint_force[k, 0] = full_like(0.0, w.R[0, 0])
    for i in range(joints.parent.size - 1, 0, -1):
        f, k = load6(w.p, i), joints.column[i] - 1
        w.joint_force[k, 0] = w.joint_force[k, 0] + dot6(load6(w.S, i), f)
        add_to6(w.p, joints.parent[i], force_from(load3(w.d, i), f))
    store6(w.base_force, 0, load6(w.p, 0))


@inlined
def bias(joints: Joints, w: Work) -> None:
    """c_b and c_m (6): forces of the motion with ẍ_b = 0 and φ̈ = 0, to `base_force` and `joint_force`."""
    initial_bias_forces(w, w.I)
    sum_forces(joints, w)


@inlined
def generalized_bias(nodes: Nodes, w: Work) -> None:
    """c_m* (7); and ẍ_b, ẍ_e while no joint accelerates and nothing acts."""
    c_b = load6(w.base_force, 0)
    for i in range(1, w.J_b_star.shape[0]):
        w.generalized_bias[i - 1, 0] = w.joint_force[i - 1, 0] + dot6(load6(w.J_b_star, i), c_b)
    a_b = scale6(sym6_mul(load21(w.base_inverse, 0), c_b), -1.0)
    store6(w.base_drift, 0, a_b)
    for n in range(1, nodes.parent.size):
        if nodes.point[n] >= 0:
            drift = acceleration_at(nodes, w, n, motion_at(load3(w.place, n), a_b))
            store6(w.drift, nodes.point[n], drift)


@inlined
def inverse_dynamics(joints: Joints, w: Work) -> None:
    """Forces (6) that make base and joints accelerate as in `given` (nv, 1), by (17)–(19), to the same tables."""
    for i in range(joints.parent.size):
        own = (w.given[0, 0], w.given[1, 0], w.given[2, 0], w.given[3, 0], w.given[4, 0], w.given[5, 0])
        if i > 0:
            across = scale6(load6(w.S, i), w.given[joints.column[i] + 5, 0])
            own = add6(motion_at(load3(w.d, i), load6(w.accelerated, joints.parent[i])), across)
        store6(w.accelerated, i, own)
        store6(w.p, i, body_force(load21(w.I, i), load6(w.v, i), add6(load6(w.a, i), own)))
    sum_forces(joints, w)
    for i in range(1, joints.parent.size):
        k = joints.column[i]
        w.joint_force[k - 1, 0] = w.joint_force[k - 1, 0] + joints.armature[i, 0] * w.given[k + 5, 0]

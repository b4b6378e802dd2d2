"""The paper's own sweeps, forward (38)–(45) and inverted (33)–(36), for a state and points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from ospace.kernels.forward_chain import Chain, Ends, force_transform, forward_chain
from ospace.kernels.inverted_chain import inverted_chain
from ospace.kernels.tree import Floats, Joints
from ospace.model.points import OperationalPoint, rows_of
from ospace.model.state import State


def forward(state: State, points: Sequence[OperationalPoint]) -> tuple[Floats, Floats, Floats, Floats]:
    """Run the forward chain.

    Returns
    -------
    Gamma_inv : (r, r)
        Γ_e⁻¹; inertial axes, at the points.
    mu : (r,)
        μ, likewise.
    response : (nv, r)
        H⁻¹ J_eᵀ; rows of the base in inertial axes, at the base.
    relative_pivot : (n + 1,)
        Of the joint of each link; see `ospace.kernels.forward_chain.relative_pivot`.
    """
    chain, ends = paper_frames(state, points)
    rows = rows_of(points)
    Gamma_inv, acceleration, response, pivots = forward_chain(chain, ends)
    Gamma_inv = 0.5 * (Gamma_inv + Gamma_inv.T)
    R = state.T_WB.rotation
    response[:3], response[3:6] = R @ response[:3], R @ response[3:6]
    return Gamma_inv[np.ix_(rows, rows)], -acceleration.ravel()[rows], response[:, rows], pivots


def inverted(state: State, points: Sequence[OperationalPoint]) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Run the inverted chain for one point.

    Returns
    -------
    Gamma, mu_e : (6, 6), (6,)
        Γ_e and μ_e of all six rows; inertial axes, at the point.
    Gamma_inv, mu : (r, r), (r,)
        Γ_e⁻¹ and μ of the rows taken.
    relative_pivot : (n + 1,)
        Of the joint of each link.
    """
    chain, end = paper_frames(state, points)
    rows = rows_of(points)
    Gamma, mu_e, Gamma_inv, acceleration, pivots = inverted_chain(chain, end)
    Gamma, Gamma_inv = 0.5 * (Gamma + Gamma.T), 0.5 * (Gamma_inv + Gamma_inv.T)
    return Gamma, mu_e, Gamma_inv[np.ix_(rows, rows)], -acceleration[rows], pivots


def paper_frames(state: State, points: Sequence[OperationalPoint]) -> tuple[Chain, Ends]:
    """Return links and points in Pinocchio's joint frames, each turned until its third axis is the joint's.

    Pinocchio knows how a joint lies to its parent without a difference of positions, so the distance from the base
    costs no digits. A joint of several columns keeps the axes of its frame, and all its links lie in that frame.

    Velocities are seen, link by link, from the inertial frame that moves along with the link's origin now, where they
    are [0; ω_i]: by Galilean invariance the same equations, without the forces m ω × v that the speed at the end of a
    boom puts into p_i and takes out again by a_i. Accelerations are then the classical ones of the origins. With
    v' = ʰX_iᵀ [0; ω_h] + S_i φ̇_i, the velocity as seen from the parent, and S_i° what S_i changes by in its own frame,

        c_i = v' ×̂ S_i φ̇_i + S_i° φ̇_i + [ω_i × v'; 0]
    """
    robot, model, scratch = state.robot, state.robot.model, state.robot.scratch
    scratch.place(state.q, state.v)
    data, links, base, joints = scratch.data, robot.links, 1, range(2, model.njoints)
    n, last = len(links.parent) - 1, robot.link_of_joint
    first, parents = [model.idx_vs[j] - 5 for j in joints], [model.parents[j] for j in joints]

    S, v, c, moved = np.zeros((4, n + 1, 6))
    v[0] = _turning(data.v[base])
    for j in joints:
        joint, i = data.joints[j], last[j]
        S[i - model.nvs[j] + 1 : i + 1] = np.reshape(joint.S, (6, -1), order="F").T
        seen = data.liMi[j].actInv(pin.Motion(_turning(data.v[model.parents[j]]))) + joint.v
        v[i], moved[i], c[i] = _turning(data.v[j]), seen.vector, (seen.cross(joint.v) + joint.c).vector
    c[:, :3] += np.cross(v[:, 3:], moved[:, :3])

    A = np.array(robot.link_axes)  # axes of the links, in Pinocchio's
    A_T = A.transpose(0, 2, 1)
    S, v, c = (_rotate(A_T[links.body], motion) for motion in (S, v, c))
    single = [last[j] for j in joints if model.nvs[j] == 1]
    S[single] = S[single].round(15)  # Sᵀ = [0 0 0 0 0 1] to the last digit

    R, r = np.tile(np.eye(3), (n + 1, 1, 1)), np.zeros((n + 1, 3))
    R[first] = A_T[parents] @ _rotations([data.liMi[j] for j in joints]) @ A[joints]
    r[first] = np.einsum("kij,kj->ki", A_T[parents], _translations([data.liMi[j] for j in joints]))
    chain = Chain(links.parent, force_transform(R, r), S, _rigid_inertia(links), v, c, links.armature[:, 0])

    bodies = [point.joint for point in points]
    R_e = _rotations([data.oMi[j] for j in bodies]) @ A[bodies]  # inertial axes of the links
    offset = np.einsum("kij,kj->ki", A_T[bodies], [point.placement.translation for point in points])
    return chain, Ends(last[bodies], force_transform(R_e.transpose(0, 2, 1), offset))


def _turning(v: pin.Motion) -> Floats:
    """Return [0; ω]: a velocity as seen from an inertial frame that moves along with the origin, now."""
    return np.concatenate([np.zeros(3), v.angular])


def _rotate(R: Floats, motions: Floats) -> Floats:
    """Turn both parts of motions (k, 6) by R (k, 3, 3)."""
    return np.asarray(np.einsum("kij,ksj->ksi", R, motions.reshape(-1, 2, 3)).reshape(-1, 6))


def _rotations(placements: Sequence[pin.SE3]) -> Floats:
    return np.array([M.rotation for M in placements]).reshape(-1, 3, 3)


def _translations(placements: Sequence[pin.SE3]) -> Floats:
    return np.array([M.translation for M in placements]).reshape(-1, 3)


def _rigid_inertia(links: Joints) -> Floats:
    """Return [m −m c̃; m c̃ I] (n + 1, 6, 6), I about the link's origin."""
    I = np.zeros((len(links.mass), 6, 6))
    I[:, :3, :3] = np.eye(3) * links.mass[:, :, None]
    row, column = np.tril_indices(3)
    I[:, 3 + row, 3 + column] = I[:, 3 + column, 3 + row] = links.inertia
    X = force_transform(np.tile(np.eye(3), (len(links.mass), 1, 1)), links.first_moments)  # [1 0; m c̃ 1]
    I[:, 3:, :3], I[:, :3, 3:] = X[:, 3:, :3], -X[:, 3:, :3]
    return I

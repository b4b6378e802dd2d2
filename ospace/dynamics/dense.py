"""The oracle: every quantity of the paper from Pinocchio's dense algorithms and nothing else.

Pinocchio's base twist stands in base axes, the paper's in inertial axes at the same point. With T = diag(R, R, 1)

    ẋ = T v,   H = T H_pin Tᵀ,   J = J_pin Tᵀ,   c = T c_pin − H [ω_b × v_b; 0; 0]

where the last term, which turns Pinocchio's spatial base acceleration into the classical one of the paper, is zero
for a base without linear velocity. That is how Pinocchio is asked here (`State.beside_base`): about the world
origin and at orbital velocity its own arithmetic would lose the digits that it is to check.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from ospace.kernels.tables import Floats
from ospace.points import OperationalPoint
from ospace.state import State


def base_rotation(state: State) -> Floats:
    """Return T = diag(R, R, 1), (nv, nv)."""
    T = np.eye(state.robot.nv)
    T[:3, :3] = T[3:6, 3:6] = state.T_WB.rotation
    return T


def inertia(state: State) -> Floats:
    """Return H (nv, nv) from `pin.crba`."""
    model, data = state.robot.model, state.robot.scratch.data
    upper = np.triu(pin.crba(model, data, state.beside_base()[0]))
    T = base_rotation(state)
    H: Floats = T @ (upper + np.triu(upper, 1).T) @ T.T
    return H


def inertia_inverse(state: State) -> Floats:
    """Return H⁻¹ (nv, nv) from `pin.computeMinverse`."""
    model, data = state.robot.model, state.robot.scratch.data
    upper = np.triu(pin.computeMinverse(model, data, state.beside_base()[0]))
    T = base_rotation(state)
    H_inv: Floats = T @ (upper + np.triu(upper, 1).T) @ T.T
    return H_inv


def bias(state: State) -> Floats:
    """Return [c_b; c_m] (nv,) from `pin.rnea`."""
    q, v = state.beside_base()
    c = pin.rnea(state.robot.model, state.robot.scratch.data, q, v, np.zeros(state.robot.nv))
    return np.asarray(base_rotation(state) @ c)


def jacobian(state: State, points: Sequence[OperationalPoint]) -> Floats:
    """Return J_e (r, nv) from Pinocchio's Jacobians at the points, LOCAL_WORLD_ALIGNED."""
    model, data = state.robot.model, state.robot.scratch.data
    pin.computeJointJacobians(model, data, state.beside_base()[0])
    blocks = [
        pin.getFrameJacobian(model, data, one.joint, one.placement, pin.LOCAL_WORLD_ALIGNED)[np.array(one.axes)]
        for one in points
    ]
    return np.asarray(np.vstack(blocks) @ base_rotation(state).T)


def accelerations(state: State, points: Sequence[OperationalPoint], a: Floats | None = None) -> Floats:
    """Return the classical accelerations ẍ_e (r,) at Pinocchio's q̈ = `a` (nv,), zero without it.

    `a` belongs to the base at its full velocity, as `pin.aba` returns it.
    """
    model, data = state.robot.model, state.robot.scratch.data
    q, v = state.beside_base()
    if a is None:
        pin.forwardKinematics(model, data, q, v, np.zeros(state.robot.nv))
    else:
        pin.forwardKinematics(model, data, q, state.v, a)
    parts = [
        pin.getFrameClassicalAcceleration(model, data, one.joint, one.placement, pin.LOCAL_WORLD_ALIGNED).vector
        for one in points
    ]
    return np.concatenate([part[np.array(one.axes)] for part, one in zip(parts, points, strict=True)])


def operational_space(
    state: State, points: Sequence[OperationalPoint]
) -> tuple[Floats, Floats, Floats, Floats]:
    """Return Γ_e⁻¹ (r, r), μ (r,), H⁻¹ J_eᵀ (nv, r) and J_e (r, nv): (9) and (10), with H by Cholesky."""
    H, J_e = inertia(state), jacobian(state, points)
    response = solve(H, J_e.T)
    Gamma_inv = J_e @ response
    mu = response.T @ bias(state) - accelerations(state, points)
    return 0.5 * (Gamma_inv + Gamma_inv.T), mu, response, J_e


def solve(H: Floats, B: Floats) -> Floats:
    """Return H⁻¹ B for a symmetric positive definite `H`, scaled to unit diagonal first."""
    scale = 1.0 / np.sqrt(np.diag(H))
    X: Floats = scale[:, None] * np.linalg.solve(H * np.outer(scale, scale), scale[:, None] * B)
    return X

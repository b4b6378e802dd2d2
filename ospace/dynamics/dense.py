"""The oracle: every quantity of the paper from Pinocchio's dense algorithms and nothing else.

Pinocchio's base twist stands in base axes, the paper's in inertial axes at the same point. With T = diag(R, R, 1)

    ẋ = T v,   H = T H_pin Tᵀ,   J = J_pin Tᵀ,   c = T c_pin − H [ω_b × v_b; 0; 0]

where the last term, which turns Pinocchio's spatial base acceleration into the classical one of the paper, is zero
for a base without linear velocity. That is how Pinocchio is asked here (`State.base_frame_state`): about the world
origin and at orbital velocity its own arithmetic would lose the digits that it is to check. Where the motion of the
base itself is what is checked (momentum, accelerations under load), it is asked at the full velocity.

Where joints mimic others, Pinocchio is asked about the robot with these joints free, and G of `ospace.model.mimic`
couples them: H = Gᵀ H_free G. (Its own crba is wrong for joints that hang from a follower.)
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, points_of
from ospace.model.state import State

RANK_CUTOFF = 1e-6
"""Scaled singular values of a Jacobian below this share of the largest, or of 1, count as zero."""


class Dense:
    """Dense forms in one state, each computed when it is first asked for.

    Names are the kernels' names of the paper's symbols; rows are those that the points take.
    """

    def __init__(self, state: State, points: Sequence[OperationalPoint]) -> None:
        self.state = state
        self.points = points_of(state.robot, points) if points else ()  # H needs none
        q, v = state.base_frame_state()
        free = state.robot.free
        self._model, self._G = (state.robot.model, np.eye(state.robot.nv)) if free is None else (free.model, free.G)
        self._q, self._v = (q, v) if free is None else (free.configuration(q), free.G @ v)
        self._own_v = state.v if free is None else free.G @ state.v
        self._still = np.zeros(self._model.nv)
        self.T = np.eye(state.robot.nv)
        self.T[:3, :3] = self.T[3:6, 3:6] = state.T_WB.rotation

    @property
    def _data(self) -> pin.Data:
        return self.state.robot.scratch.data

    # -- §2 --------------------------------------------------------------------------------------------------

    @cached_property
    def H(self) -> Floats:
        """H (nv, nv), `pin.crba`."""
        return self._to_paper(pin.crba(self._model, self._data, self._q))

    @cached_property
    def H_inv(self) -> Floats:
        """H⁻¹ (nv, nv), `pin.computeMinverse`; by elimination where joints mimic others."""
        if self.state.robot.free:
            return solve(self.H, np.eye(len(self.H)))
        return self._to_paper(pin.computeMinverse(self._model, self._data, self._q))

    def _to_paper(self, upper: Floats) -> Floats:
        full = np.triu(upper) + np.triu(upper, 1).T
        return np.asarray(self.T @ (self._G.T @ full @ self._G) @ self.T.T)

    @cached_property
    def c(self) -> Floats:
        """[c_b; c_m] (nv,), `pin.rnea`."""
        return np.asarray(self.T @ self._G.T @ pin.rnea(self._model, self._data, self._q, self._v, self._still))

    @cached_property
    def velocity(self) -> Floats:
        """[ẋ_b; φ̇] (nv,)."""
        return np.asarray(self.T @ self.state.v)

    @cached_property
    def M_0(self) -> Floats:
        """Momentum about the base (6,): `pin.computeCentroidalMomentum`, shifted."""
        h = pin.computeCentroidalMomentum(self._model, self._data, self._q, self._own_v).vector
        return np.concatenate([h[:3], h[3:] + np.cross(self._data.com[0], h[:3])])

    @cached_property
    def A_G(self) -> Floats:
        """Momentum about the mass centre by ẋ (6, nv), inertial axes: `pin.computeCentroidalMap`."""
        A_G = pin.computeCentroidalMap(self._model, self._data, self._q)
        return np.asarray(A_G @ self._G @ self.T.T)

    @cached_property
    def centre_of_mass(self) -> Floats:
        """Mass centre in the inertial frame (3,), `pin.centerOfMass`."""
        return np.asarray(pin.centerOfMass(self._model, self._data, self._q) + self.state.q[:3])

    @cached_property
    def placements(self) -> Floats:
        """Positions and quaternions x, y, z, w of the points in the inertial frame (p, 7), `pin.forwardKinematics`."""
        pin.forwardKinematics(self._model, self._data, self._q)
        poses = np.array([pin.SE3ToXYZQUAT(self._data.oMi[one.joint] * one.placement) for one in self.points])
        poses[:, :3] += self.state.q[:3]
        return poses

    @cached_property
    def link_velocities(self) -> Floats:
        """Velocities of all joint frames (njoints − 1, 6), inertial axes, each at its own origin."""
        pin.forwardKinematics(self._model, self._data, self._q, self._own_v)
        joints = range(1, self._model.njoints)
        return np.array([pin.getVelocity(self._model, self._data, j, pin.LOCAL_WORLD_ALIGNED).vector for j in joints])

    @cached_property
    def J_b_star(self) -> Floats:
        """−H_b⁻¹ H_bm (3)."""
        return -solve(self.H[:6, :6], self.H[:6, 6:])

    @cached_property
    def H_m_star(self) -> Floats:
        """H_m − H_bmᵀ H_b⁻¹ H_bm (7)."""
        return np.asarray(self.H[6:, 6:] + self.H[6:, :6] @ self.J_b_star)

    @cached_property
    def c_m_star(self) -> Floats:
        """c_m − H_bmᵀ H_b⁻¹ c_b (7)."""
        return np.asarray(self.c[6:] + self.J_b_star.T @ self.c[:6])

    # -- points ----------------------------------------------------------------------------------------------

    @cached_property
    def J_e(self) -> Floats:
        """[J_b J_m] (r, nv), Pinocchio's Jacobians at the points, LOCAL_WORLD_ALIGNED."""
        pin.computeJointJacobians(self._model, self._data, self._q)
        J = [
            pin.getFrameJacobian(self._model, self._data, one.joint, one.placement, pin.LOCAL_WORLD_ALIGNED)
            for one in self.points
        ]
        return self._taken(J) @ self._G @ self.T.T

    def _taken(self, of_points: Sequence[Floats]) -> Floats:
        rows = [full[np.array(one.axes)] for full, one in zip(of_points, self.points, strict=True)]
        return np.concatenate(rows)

    def _accelerations(self) -> Floats:
        frame = pin.LOCAL_WORLD_ALIGNED
        return self._taken(
            [
                pin.getFrameClassicalAcceleration(self._model, self._data, one.joint, one.placement, frame).vector
                for one in self.points
            ]
        )

    @cached_property
    def drift(self) -> Floats:
        """J̇_e ẋ (r,): classical accelerations of the points while base and joints do not accelerate."""
        pin.forwardKinematics(self._model, self._data, self._q, self._v, self._still)
        return self._accelerations()

    def accelerations_under(self, load: Floats, F_e: Floats) -> tuple[Floats, Floats]:
        """Return ẍ_e (r,) and [ẍ_b; φ̈] (nv,) under `load` = [F_b; τ] and forces `F_e` (r,), by `pin.aba`.

        Where joints mimic others, which `pin.aba` does not know, by H, c and J_e.
        """
        if self.state.robot.free:
            acceleration = solve(self.H, (load - self.c + self.J_e.T @ F_e)[:, None])[:, 0]
            return self.J_e @ acceleration + self.drift, acceleration
        model, data = self._model, self._data
        pin.forwardKinematics(model, data, self._q)
        external = [pin.Force.Zero() for _ in range(model.njoints)]
        for one, wrench in zip(self.points, self.wrenches(F_e), strict=True):
            at_point = pin.SE3(np.eye(3), (data.oMi[one.joint] * one.placement).translation)
            external[one.joint] += (data.oMi[one.joint].inverse() * at_point).act(pin.Force(wrench))
        a = pin.aba(model, data, self._q, self.state.v, self.T.T @ load, external).copy()
        pin.forwardKinematics(model, data, self._q, self.state.v, a)
        acceleration = self.T @ a
        acceleration[:3] += np.cross(self.velocity[3:6], self.velocity[:3])
        return self._accelerations(), acceleration

    def wrenches(self, F_e: Floats) -> list[Floats]:
        """Spread the rows `F_e` (r,) to one (6,) wrench a point."""
        taken = np.concatenate([one.axes for one in self.points])
        full = np.zeros(6 * len(self.points))
        full[taken] = F_e
        return list(full.reshape(-1, 6))

    # -- §3 --------------------------------------------------------------------------------------------------

    @cached_property
    def response(self) -> Floats:
        """H⁻¹ J_eᵀ (nv, r)."""
        return solve(self.H, self.J_e.T)

    @cached_property
    def Gamma_e_inv(self) -> Floats:
        """J_e H⁻¹ J_eᵀ (9)."""
        Gamma_e_inv = self.J_e @ self.response
        return np.asarray(0.5 * (Gamma_e_inv + Gamma_e_inv.T))

    @cached_property
    def rank(self) -> int:
        """Rank of the rows, from the singular values of J_e with inertias and mobilities scaled out."""
        return rank_of(self.J_e, np.diag(self.Gamma_e_inv), np.diag(self.H))

    @cached_property
    def Gamma_e(self) -> Floats:
        """Γ_e; the pseudo-inverse where rows depend on each other."""
        return inverse_of_rank(self.Gamma_e_inv, self.rank)

    @cached_property
    def mu(self) -> Floats:
        """μ = J_e H⁻¹ c − J̇_e ẋ: (10) without its factor Γ_e."""
        return np.asarray(self.response.T @ self.c - self.drift)

    @cached_property
    def J_m_star(self) -> Floats:
        """J_m − J_b H_b⁻¹ H_bm (5)."""
        return np.asarray(self.J_e[:, 6:] + self.J_e[:, :6] @ self.J_b_star)

    @cached_property
    def torque_map(self) -> Floats:
        """J_m* H_m*⁻¹ (12)."""
        return solve(self.H_m_star, self.J_m_star.T).T

    @cached_property
    def Lambda_inv(self) -> Floats:
        """J_m* H_m*⁻¹ J_m*ᵀ (12)."""
        Lambda_inv = self.torque_map @ self.J_m_star.T
        return np.asarray(0.5 * (Lambda_inv + Lambda_inv.T))

    @cached_property
    def floating_rank(self) -> int:
        """Rank of Λ⁻¹, likewise from J_m*."""
        return rank_of(self.J_m_star, np.diag(self.Gamma_e_inv), np.diag(self.H_m_star))

    @cached_property
    def Lambda(self) -> Floats:
        """Λ; the pseudo-inverse where joints cannot move the rows independently."""
        return inverse_of_rank(self.Lambda_inv, self.floating_rank)

    @cached_property
    def Lambda_b_inv(self) -> Floats:
        """J_b H_b⁻¹ J_bᵀ (12)."""
        J_b = self.J_e[:, :6]
        return np.asarray(J_b @ solve(self.H[:6, :6], J_b.T))


def scaled_singular_values(J: Floats, mobility: Floats, inertia: Floats) -> Floats:
    """Return the singular values of `J`, rows over √mobility and columns over √inertia."""
    return np.asarray(np.linalg.svd(J / np.sqrt(np.outer(mobility, inertia)), compute_uv=False), dtype=np.float64)


def rank_of(J: Floats, mobility: Floats, inertia: Floats) -> int:
    """Return the rank of `J` by its scaled singular values, those below `RANK_CUTOFF` being zero."""
    values = scaled_singular_values(J, mobility, inertia)
    return int((values > RANK_CUTOFF * max(1.0, values.max(initial=0.0))).sum())


def inverse_of_rank(A: Floats, rank: int) -> Floats:
    """Return A⁻¹, or the Moore–Penrose pseudo-inverse of the part of `A` of that rank."""
    if rank == len(A):
        return solve(A, np.eye(len(A)))
    left, values, right = np.linalg.svd(A)
    X: Floats = right[:rank].T / values[:rank] @ left[:, :rank].T
    return X


def solve(H: Floats, B: Floats) -> Floats:
    """Return H⁻¹ B for a symmetric positive definite `H`, scaled to unit diagonal first."""
    scale = 1.0 / np.sqrt(np.diag(H))
    X: Floats = scale[:, None] * np.linalg.solve(H * np.outer(scale, scale), scale[:, None] * B)
    return X

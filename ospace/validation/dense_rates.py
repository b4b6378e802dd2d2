"""The oracle of rates: dense forms along the motion of a state, by Pinocchio's derivatives and nothing else.

Along the displacement and the change of velocity that are the state's own v, in the coordinates of `Dense`,

    Ḣ = T (C + Cᵀ) Tᵀ + Ṫ T⁻¹ H + H (Ṫ T⁻¹)ᵀ,   Ṫ T⁻¹ = diag(ω̃_b, ω̃_b, 0)      C by `pin.computeCoriolisMatrix`

and likewise of J_e, c and J̇_e ẋ, by `pin.computeJointJacobiansTimeVariation`, `pin.computeRNEADerivatives` and
`pin.computeForwardKinematicsDerivatives`.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import pinocchio as pin

from ospace.dynamics.dense import Dense, solve
from ospace.kernels.tree import Floats
from ospace.model.layout import Layout

_TURNING_COLUMNS = ("JointModelUniversal", "JointModelSphericalZYX", "JointModelComposite", "JointModelEllipsoid")


def has_rates(robot: Layout) -> bool:
    """Return whether Pinocchio knows the derivatives: not of joints whose columns turn within the joint (pin 4.1)."""
    names = {joint.shortname() for joint in robot.model.joints}
    return robot.own_kinematics and names.isdisjoint(_TURNING_COLUMNS)


class DenseRates(Dense):
    """Rates of the dense forms in one state, each computed when it is first asked for."""

    @cached_property
    def _turning(self) -> Floats:
        """Ṫ T⁻¹ (nv, nv)."""
        turning = np.zeros_like(self.T)
        turning[:3, :3] = turning[3:6, 3:6] = pin.skew(self.velocity[3:6])
        return turning

    @cached_property
    def H_dot(self) -> Floats:
        """Ḣ (nv, nv)."""
        C = pin.computeCoriolisMatrix(self._model, self._data, self._q, self._v)
        turned = self._turning @ self.H
        return np.asarray(self.T @ (self._G.T @ (C + C.T) @ self._G) @ self.T.T + turned + turned.T)

    @cached_property
    def J_e_dot(self) -> Floats:
        """J̇_e (r, nv)."""
        pin.computeJointJacobiansTimeVariation(self._model, self._data, self._q, self._v)
        data, rates = self._data, []
        for point in self.points:
            at_joint = (self._model, data, point.joint, pin.LOCAL_WORLD_ALIGNED)
            J, J_dot = pin.getJointJacobian(*at_joint), pin.getJointJacobianTimeVariation(*at_joint)
            arm = data.oMi[point.joint].rotation @ point.placement.translation
            omega = J[3:] @ self._v
            J_dot[:3] -= pin.skew(arm) @ J_dot[3:] + pin.skew(np.cross(omega, arm)) @ J[3:]
            rates.append(J_dot)
        return np.asarray(self._taken(rates) @ self._G @ self.T.T - self.J_e @ self._turning)

    @cached_property
    def J_m_star_terms(self) -> tuple[Floats, ...]:
        """J̇_m, J̇_b J_b* and J_b J̇_b* (r, n), of (5)."""
        J_b_star_dot = -solve(self.H[:6, :6], self.H_dot[:6, 6:] + self.H_dot[:6, :6] @ self.J_b_star)
        J_b_dot, J_m_dot = self.J_e_dot[:, :6], self.J_e_dot[:, 6:]
        return J_m_dot, J_b_dot @ self.J_b_star, self.J_e[:, :6] @ J_b_star_dot

    @cached_property
    def J_m_star_dot(self) -> Floats:
        """Rate of J_m* (r, n)."""
        return np.asarray(sum(self.J_m_star_terms))

    @cached_property
    def Gamma_e_inv_terms(self) -> tuple[Floats, ...]:
        """J̇_e Φ, its transpose and −Φᵀ Ḣ Φ (r, r), of (9) with Φ = H⁻¹ J_eᵀ."""
        half = self.J_e_dot @ self.response
        return half, half.T, -self.response.T @ self.H_dot @ self.response

    @cached_property
    def Gamma_e_inv_dot(self) -> Floats:
        """Rate of Γ_e⁻¹ (r, r)."""
        return np.asarray(sum(self.Gamma_e_inv_terms))

    @cached_property
    def c_dot(self) -> Floats:
        """Rate of c (nv,)."""
        of_q, of_v, _ = pin.computeRNEADerivatives(self._model, self._data, self._q, self._v, self._still)
        return np.asarray(self.T @ (self._G.T @ ((of_q + of_v) @ self._v)) + self._turning @ self.c)

    @cached_property
    def drift_dot(self) -> Floats:
        """Rate of J̇_e ẋ (r,)."""
        model, data = self._model, self._data
        pin.computeForwardKinematicsDerivatives(model, data, self._q, self._v, self._still)
        pin.updateFramePlacements(model, data)
        rates = []
        for point in self.points:
            at_point = (model, data, point.joint, point.placement, pin.LOCAL)
            V_of_q, a_of_q, a_of_v, J = pin.getFrameAccelerationDerivatives(*at_point)
            V, a = pin.getFrameVelocity(*at_point), pin.getFrameAcceleration(*at_point)
            V_dot, a_dot, omega = (V_of_q + J) @ self._v, (a_of_q + a_of_v) @ self._v, J[3:] @ self._v
            acceleration = a.linear + np.cross(V.angular, V.linear)
            rate = a_dot[:3] + np.cross(V_dot[3:], V.linear) + np.cross(V.angular, V_dot[:3])
            R = data.oMi[point.joint].rotation @ point.placement.rotation
            linear, angular = rate + np.cross(omega, acceleration), a_dot[3:] + np.cross(omega, a.angular)
            rates.append(np.r_[R @ linear, R @ angular])
        return self._taken(rates)

    @cached_property
    def mu_terms(self) -> tuple[Floats, ...]:
        """J̇_e x, Φᵀ ċ, −Φᵀ Ḣ x and −(J̇_e ẋ)˙ (r,) with x = H⁻¹ c, of (10)."""
        x = solve(self.H, self.c[:, None])[:, 0]
        of_H = self.response.T @ (self.H_dot @ x)
        return self.J_e_dot @ x, self.response.T @ self.c_dot, -of_H, -self.drift_dot

    @cached_property
    def mu_dot(self) -> Floats:
        """Rate of μ (r,)."""
        return np.asarray(sum(self.mu_terms))

"""The symplectic integrator: the variational midpoint rule on the manifold.

With ξ the mean velocity of a step, q⁺ = q ⊕ hξ and the midpoint q_m = q ⊕ ½hξ, the action of a step is h T(q_m, ξ),
T = ½ ξᵀ H(q_m) ξ. Its derivatives in q and q⁺ are the momenta at both ends (J. Marsden, M. West, "Discrete mechanics
and variational integrators", 2001),

    w   = H ξ + ½h E_vᵀ g,    g = ∂T/∂q at q_m
    p   = Lᵀ w − h E_qᵀ g,    p⁺ = Rᵀ w

where E_q, E_v are the derivatives of q ⊕ ½hξ in q and in its increment, L = −∂(q⁺ ⊖ q)/∂q and R = ∂(q⁺ ⊖ q)/∂q⁺. The
forces of the step act as half an impulse at either end; that of friction is taken at the mean velocity ξ, so that it
takes energy in every step, and the rule is stable however steep friction is. The equation for p is solved for ξ;
velocities are v = H⁻¹ p.

The action does not change when all of space is moved or turned, so the momenta, linear and angular, are kept to
rounding whatever the joint torques (Noether); the energy swings within O(h²) and does not drift. Order 2.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ospace.dynamics.joint_friction import JointFriction
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.simulation.lie import EXP, LOG, LOG_BACK, TRANSPORT, Adjoint, series, terms_of
from ospace.simulation.plant import Plant
from ospace.simulation.runge_kutta import IntegratedMotion

_AXES_TURN = ("JointModelSphericalZYX", "JointModelUniversal", "JointModelComposite")
_NO_VECTOR = ("JointModelFreeFlyer", "JointModelPlanar", "JointModelSpherical")
_ITERATIONS = 30
_NEWTON_STEPS = 30
_CLOSE = 1e-15
_STALLED = 1e-12
_NO_SPEED = 1e-300


class VariationalMidpoint:
    """Steps of a plant by the variational midpoint rule."""

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        model = plant.model
        for j in range(1, model.njoints):
            _refuse(model, j)
        self._adjoint = Adjoint(model)
        self._still = np.zeros(plant.bodies.nv)
        self._lead = np.zeros(model.nv)  # of ξ before v, in the last step: where the next one starts to look

    def step(self, t: float, h: float, motion: IntegratedMotion) -> None:
        """Bring `motion` from time `t` to `t` + `h`, s."""
        plant, model = self.plant, self.plant.model
        q, friction = motion.q, plant.friction
        before = 0.5 * h * plant.generalized_force(t, q)
        impulse = 0.5 * h * plant.impulse_rate
        p = self.plant.inertia(q) @ motion.v + before

        xi, last = motion.v + self._lead, np.inf
        terms = terms_of(h * xi)
        H = self.plant.inertia(pin.integrate(model, q, 0.5 * h * xi))
        H_inv = np.linalg.inv(H)
        for _ in range(_ITERATIONS):
            w, g, A_T = self._at_midpoint(q, xi, h, terms)
            # p + ½h τ_f = Lᵀ w − h E_qᵀ g, solved for ξ with ∂p/∂ξ ≈ H
            off = p - series(LOG_BACK, A_T, w, terms) + h * series(TRANSPORT, 0.5 * A_T, g, terms)
            correction = H_inv @ off if friction is None else _resisted(friction, H, H @ xi + off, xi, h) - xi
            xi = xi + correction
            size = float(np.abs(correction).max()) / max(_NO_SPEED, float(np.abs(xi).max()))
            if size <= _CLOSE or _STALLED >= size >= 0.5 * last:
                break
            last = size
        else:
            raise OspaceError(f"the symplectic step at {t:.6g} s did not converge: take a smaller step than {h:g} s")

        w, _, A_T = self._at_midpoint(q, xi, h, terms)
        self._lead = xi - motion.v
        motion.q = pin.integrate(model, q, h * xi)
        after = 0.5 * h * plant.generalized_force(t + h, motion.q)
        p = series(LOG, A_T, w, terms) + after
        if friction is not None:
            resistance = friction.torque(xi[6:])
            p[6:] += 0.5 * h * resistance
            motion.dissipated -= h * float(resistance @ xi[6:])
        motion.v = np.asarray(np.linalg.solve(self.plant.inertia(motion.q), p))
        motion.work += float((before + after) @ xi)
        if not plant.isolated:
            motion.impulse = motion.impulse + impulse + 0.5 * h * plant.impulse_rate

    def _at_midpoint(self, q: Floats, xi: Floats, h: float, terms: int) -> tuple[Floats, Floats, Floats]:
        """Return w, g and (ad_{hξ})ᵀ of the mean velocity `xi`."""
        plant, data = self.plant, self.plant.data
        q_m = pin.integrate(plant.model, q, 0.5 * h * xi)
        own_q, own_xi = plant.bodies_at(q_m, xi)
        pin.computeRNEADerivatives(plant.bodies, data, own_q, self._still, own_xi)  # ∂(H ξ)/∂q
        g: Floats = plant.coupled(0.5 * (own_xi @ data.dtau_dq))
        A_T = self._adjoint.at(h * xi).T
        w: Floats = plant.inertia(q_m) @ xi + 0.5 * h * series(EXP, 0.5 * A_T, g, terms)
        return w, g, A_T


def _resisted(friction: JointFriction, H: Floats, b: Floats, xi: Floats, h: float) -> Floats:
    """Solve H ξ − ½h τ_f(ξ) = b, from `xi` on.

    The solution is the minimum of a convex function. From where friction is flat, Newton's steps lead far past where it
    is steep: they are halved until the function rises at their end no more than half as steeply as it fell.
    """
    joints = np.arange(6, len(xi))

    def missing(xi: Floats) -> Floats:
        rest: Floats = b - H @ xi
        rest[6:] += 0.5 * h * friction.torque(xi[6:])
        return rest

    rest = missing(xi)
    for _ in range(_NEWTON_STEPS):
        steep = H.copy()
        steep[joints, joints] += 0.5 * h * friction.slope(xi[6:])
        way = np.linalg.solve(steep, rest)
        fall, share = float(rest @ way), 1.0
        while -float(missing(xi + share * way) @ way) > 0.5 * fall:
            share *= 0.5
        xi = xi + share * way
        rest = missing(xi)
        if float(np.abs(way).max()) <= _CLOSE * max(_NO_SPEED, float(np.abs(xi).max())):
            break
    return xi


def _refuse(model: pin.Model, j: int) -> None:
    """Raise `OspaceError` where joint `j` has no Lagrangian that Pinocchio can differentiate."""
    kind, columns = model.joints[j].shortname(), slice(model.idx_vs[j], model.idx_vs[j] + model.nvs[j])
    if kind in _AXES_TURN:
        raise OspaceError(
            f"joint '{model.names[j]}' is a {kind[10:]} joint, whose axes turn with its own position: "
            f"Pinocchio has no ∂T/∂q of these; take integrator='rk4'"
        )
    if kind in _NO_VECTOR and model.armature[columns].any():
        raise OspaceError(
            f"joint '{model.names[j]}' is a {kind[10:]} joint with armature {model.armature[columns]}: "
            f"Pinocchio's drives on such joints have no gyroscopic torque, so no Lagrangian; take integrator='rk4'"
        )

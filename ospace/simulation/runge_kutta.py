"""The classical Runge–Kutta method on the manifold, without commutators.

Configurations are no vectors: a step is an increment in the tangent space, q ⊕ u (`pin.integrate`). With velocities
V_i, accelerations A_i of four stages (E. Celledoni, A. Marthinsen, B. Owren, "Commutator-free Lie group
methods", 2003)

    q_1 = q                     V_1 = v
    q_2 = q ⊕ h/2 V_1           V_2 = v + h/2 A_1
    q_3 = q ⊕ h/2 V_2           V_3 = v + h/2 A_2
    q_4 = q_2 ⊕ h (V_3 − V_1/2) V_4 = v + h A_3

    q⁺ = q ⊕ h/12 (3 V_1 + 2 V_2 + 2 V_3 − V_4) ⊕ h/12 (−V_1 + 2 V_2 + 2 V_3 + 3 V_4)
    v⁺ = v + h/6 (A_1 + 2 A_2 + 2 A_3 + A_4)

which is of order 4 for every joint type, needs exponentials alone, and is the classical method where the configuration
is a vector. Work, dissipated energy and impulses are integrated along with the weights of v.

The method is stable while h λ < 2.78, λ the rate at which friction acts: a small link that is damped well has more than
that at any usual step. With friction, steps are therefore taken in equal parts: as many as stability needs, and more
until the step keeps the balance of energy, which it does not where friction stops a joint within a part.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.runge_kutta import finish, stage_2_3, stage_4
from ospace.kernels.tree import Floats
from ospace.simulation.plant import Plant

_WEIGHTS = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
_LARGEST_DECAY = 2.0
_LARGEST_LOSS = 1e-11
"""Of energy in a step, relative to the most that there was."""
_MOST_PARTS = 1000
"""Of a step, beyond which a run would not end."""
_MOST_DOUBLINGS = 5
"""Of the parts of a step; a balance still missing after them is left to the certificate."""


@dataclass
class IntegratedMotion:
    """Motion that is integrated.

    Attributes
    ----------
    q, v : (nq,), (nv,) arrays
    work, dissipated : float
        Work of all forces but friction since the start, and energy that friction took, J.
    impulse : (6,) array
        ∫ of external forces, and of their moments about the frame's origin, since the start; N s, N m s.
    """

    q: Floats
    v: Floats
    work: float
    dissipated: float
    impulse: Floats

    @classmethod
    def starting(cls, q: Floats, v: Floats) -> IntegratedMotion:
        """Return a motion that begins at (q, v)."""
        return cls(q, v, 0.0, 0.0, np.zeros(6))


class RungeKutta4:
    """Classical Runge–Kutta steps of a plant."""

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self._V, self._A = np.empty((2, 4, plant.robot.nv))
        self._u, self._u_2 = np.empty((2, plant.robot.nv))
        self._stages = list(zip(self._V, self._A, strict=True))
        self._rates = np.empty((4, 7))
        self._parts = 1  # of the last step with friction
        self._scale = 0.0  # of energy so far, J

    def step(self, t: float, h: float, motion: IntegratedMotion) -> None:
        """Bring `motion` from time `t` to `t` + `h`, s."""
        if self.plant.friction is None:
            self._part(t, h, motion)
            return
        parts = max(1, math.ceil(h * self.plant.friction_rate(motion.q) / _LARGEST_DECAY))
        if parts > _MOST_PARTS:
            raise OspaceError(
                f"friction of the joints of '{self.plant.robot.name}' is too steep for steps of {h:g} s: take steps "
                f"below {h * _MOST_PARTS / parts:.1g} s, or integrator='symplectic', which is stable with any friction"
            )
        most = parts << _MOST_DOUBLINGS
        parts = max(parts, self._parts // 2)  # what the last step took, and whether fewer do
        while True:
            trial = replace(motion)
            for k in range(parts):
                self._part(t + k * h / parts, h / parts, trial)
            if self._kept(motion, trial) or 2 * parts > most:
                break
            parts *= 2
        self._parts = parts
        motion.q, motion.v, motion.impulse = trial.q, trial.v, trial.impulse
        motion.work, motion.dissipated = trial.work, trial.dissipated

    def _kept(self, before: IntegratedMotion, after: IntegratedMotion) -> bool:
        """Return whether a step kept the balance of energy, or it is not finite, which is reported elsewhere."""
        energies = [self.plant.momentum(one.q, one.v)[2] for one in (before, after)]
        work = after.work - before.work
        off = energies[1] - energies[0] - work + after.dissipated - before.dissipated
        self._scale = max(self._scale, energies[0] + abs(before.work))
        return not abs(off) > _LARGEST_LOSS * (self._scale + abs(work))

    def _part(self, t: float, h: float, motion: IntegratedMotion) -> None:
        plant, u = self.plant, self._u
        model, accelerate, q, v = plant.model, plant.accelerate, motion.q, motion.v
        (V_1, A_1), (V_2, A_2), (V_3, A_3), (V_4, A_4) = self._stages
        watched = plant.friction is not None or not plant.isolated

        V_1[:] = v
        P_1 = accelerate(t, q, V_1, A_1)
        if watched:
            self._rates[0] = plant.rates
        stage_2_3(v, V_1, A_1, 0.5 * h, u, V_2)
        q_2 = pin.integrate(model, q, u)
        P_2 = accelerate(t + 0.5 * h, q_2, V_2, A_2)
        if watched:
            self._rates[1] = plant.rates
        stage_2_3(v, V_2, A_2, 0.5 * h, u, V_3)
        q_3 = pin.integrate(model, q, u)
        P_3 = accelerate(t + 0.5 * h, q_3, V_3, A_3)
        if watched:
            self._rates[2] = plant.rates
        stage_4(v, self._V, self._A, h, u)
        q_4 = pin.integrate(model, q_2, u)
        P_4 = accelerate(t + h, q_4, V_4, A_4)

        v = v.copy()
        finish(v, self._V, self._A, h, u, self._u_2)
        if watched:
            self._rates[3] = plant.rates
            change = (h * _WEIGHTS) @ self._rates
            motion.impulse = motion.impulse + change[:6]
            motion.dissipated += float(change[6])
        motion.work += h / 6.0 * (P_1 + 2.0 * (P_2 + P_3) + P_4)
        motion.q, motion.v = pin.integrate(model, pin.integrate(model, q, u), self._u_2), v

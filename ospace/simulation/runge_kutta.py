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
is a vector. Work and impulses are integrated along with the weights of v.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.kernels.tables import Floats
from ospace.simulation.plant import Plant

_FIRST_HALF = np.array([3.0, 2.0, 2.0, -1.0]) / 12.0
_SECOND_HALF = np.array([-1.0, 2.0, 2.0, 3.0]) / 12.0
_WEIGHTS = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0


@dataclass
class Motion:
    """What is integrated.

    Attributes
    ----------
    q, v : (nq,), (nv,) arrays
    work : float
        Work of all forces since the start, J.
    impulse : (6,) array
        ∫ of external forces, and of their moments about the frame's origin, since the start; N s, N m s.
    """

    q: Floats
    v: Floats
    work: float
    impulse: Floats


class RungeKutta4:
    """Classical Runge–Kutta steps of a plant."""

    def __init__(self, plant: Plant) -> None:
        self.plant = plant
        self._V, self._A = np.empty((2, 4, plant.robot.nv))
        self._rates = np.empty((4, 6))
        self._stages = list(zip(self._V, self._A, strict=True))
        self._u = np.empty(plant.robot.nv)

    def step(self, t: float, h: float, motion: Motion) -> None:
        """Bring `motion` from time `t` to `t` + `h`, s."""
        model, u, q, v = self.plant.model, self._u, motion.q, motion.v
        (V_1, V_2, V_3, V_4), (A_1, A_2, A_3, _) = self._V, self._A

        V_1[:] = v
        P_1 = self._stage(0, t, q)

        np.multiply(V_1, 0.5 * h, u)
        q_2 = pin.integrate(model, q, u)
        np.multiply(A_1, 0.5 * h, V_2)
        V_2 += v
        P_2 = self._stage(1, t + 0.5 * h, q_2)

        np.multiply(V_2, 0.5 * h, u)
        q_3 = pin.integrate(model, q, u)
        np.multiply(A_2, 0.5 * h, V_3)
        V_3 += v
        P_3 = self._stage(2, t + 0.5 * h, q_3)

        np.multiply(V_1, -0.5, u)
        u += V_3
        u *= h
        q_4 = pin.integrate(model, q_2, u)
        np.multiply(A_3, h, V_4)
        V_4 += v
        P_4 = self._stage(3, t + h, q_4)

        half = pin.integrate(model, q, (h * _FIRST_HALF) @ self._V)
        motion.q = pin.integrate(model, half, (h * _SECOND_HALF) @ self._V)
        motion.v = v + (h * _WEIGHTS) @ self._A
        motion.work += h / 6.0 * (P_1 + 2.0 * (P_2 + P_3) + P_4)
        if not self.plant.isolated:
            motion.impulse = motion.impulse + (h * _WEIGHTS) @ self._rates

    def _stage(self, i: int, t: float, q: Floats) -> float:
        V, A = self._stages[i]
        power = self.plant.accelerate(t, q, V, A)
        if not self.plant.isolated:
            self._rates[i] = self.plant.impulse_rate
        return power

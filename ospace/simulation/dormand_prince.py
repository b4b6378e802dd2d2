"""Error-controlled steps: the Dormand–Prince pair of order 5(4), lifted to the manifold by Munthe-Kaas.

In the chart q = q_0 ⊕ u of a step, u is a vector with

    u̇ = J(u) v,      J(u) = ∂(q ⊖ q_0)/∂q,

so any Runge–Kutta method applies to (u, v, work, impulse, dissipated energy); J is LOG of `ospace.simulation.lie`.
The two results of the pair differ by the error of the step, which sets the next one's length.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.simulation.lie import LOG, Adjoint, series
from ospace.simulation.plant import Plant
from ospace.simulation.runge_kutta import IntegratedMotion

_NODES = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_WEIGHTS = np.array(
    [
        [0, 0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0],
    ]
)
_FOURTH_ORDER = np.array([5179 / 57600, 0, 7571 / 16695, 393 / 640, -92097 / 339200, 187 / 2100, 1 / 40])
_ERROR = _WEIGHTS[6] - _FOURTH_ORDER
_SAFETY, _SHRINK, _GROW, _TINY = 0.9, 0.2, 5.0, 1e-10
_MOST_TRIALS = 10_000
"""Most divisions of one given step."""


class DormandPrince:
    """Steps of a plant, divided until each makes an error of at most `tolerance` · (1 + |v|) in u and v."""

    def __init__(self, plant: Plant, tolerance: float) -> None:
        self.plant, self.tolerance = plant, tolerance
        self._nv = plant.robot.nv
        self._K = np.zeros((7, 2 * self._nv + 8))  # rates of u, v, work, impulse and dissipated energy
        self._adjoint = Adjoint(plant.model)
        self._last = np.inf

    def step(self, t: float, h: float, motion: IntegratedMotion) -> None:
        """Bring `motion` from time `t` to `t` + `h`, s, in as many steps as it takes."""
        done = 0.0
        for _ in range(_MOST_TRIALS):
            rest = h - done
            trial = min(self._last, rest)
            change, error = self._try(t + done, trial, motion)
            factor = _SHRINK
            if np.isfinite(error):
                factor = min(max(_SAFETY * max(error, _TINY) ** -0.2, _SHRINK), _GROW)
            if not error <= 1.0:
                self._last = trial * factor
                continue
            self._accept(motion, change)
            if trial == rest:
                self._last = max(trial * factor, self._last)
                return
            done += trial
            self._last = trial * factor
        raise OspaceError(
            f"the step from {t:.6g} s on was divided {_MOST_TRIALS} times without an end: forces or speeds grow "
            f"without bound, or the tolerance {self.tolerance:g} is below rounding"
        )

    def _try(self, t: float, h: float, motion: IntegratedMotion) -> tuple[Floats, float]:
        """Return how (u, v, work, impulse, dissipated energy) change in a step, and the error over what is allowed."""
        plant, K, nv = self.plant, self._K, self._nv
        q, v = motion.q, motion.v
        for i in range(7):
            change = (h * _WEIGHTS[i, :i]) @ K[:i]
            V = v + change[nv : 2 * nv]
            here = pin.integrate(plant.model, q, change[:nv])
            K[i, 2 * nv] = plant.accelerate(t + _NODES[i] * h, here, V, K[i, nv : 2 * nv])
            K[i, :nv] = V if i == 0 else series(LOG, self._adjoint.at(change[:nv]), V)
            K[i, 2 * nv + 1 :] = plant.rates
        error = np.abs((h * _ERROR) @ K[:, : 2 * nv])
        allowed = self.tolerance * (1.0 + np.abs(v))
        return change, float(max((error[:nv] / allowed).max(), (error[nv:] / allowed).max()))

    def _accept(self, motion: IntegratedMotion, change: Floats) -> None:
        nv = self._nv
        motion.q = pin.integrate(self.plant.model, motion.q, change[:nv])
        motion.v = motion.v + change[nv : 2 * nv]
        motion.work += float(change[2 * nv])
        motion.impulse = motion.impulse + change[2 * nv + 1 : -1]
        motion.dissipated += float(change[-1])

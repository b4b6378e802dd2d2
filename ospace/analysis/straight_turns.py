"""Turn of a floating base while joints go straight from one posture to each of many others.

Without momentum and seen in base axes, the rate of the base depends on the joints alone. Along x(s) = x₀ + s Δx

    R' = R [ω(s)]_×,   ω = J_b*(x(s)) Δx, its angular part                                              (2)
    R ← R exp(h/2 (ω₁ + ω₂) + √3/12 h² ω₁ × ω₂)       a Magnus integrator of fourth order, ω₁, ω₂ at its Gauss points

The number of steps is doubled until turns of a sample change by less than 1e-5 rad.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from ospace.analysis.arm import Arm
from ospace.kernels.tree import Floats

_CLOSE = 1e-5
"""rad."""
_MOST_STEPS = 1024
_GAUSS = 0.5 - math.sqrt(3.0) / 6.0, 0.5 + math.sqrt(3.0) / 6.0


def turned(arm: Arm, x: Floats, steps: int) -> Rotation:
    """Compute attitudes of the base after paths from `arm.home` to postures.

    Parameters
    ----------
    arm : Arm
    x : (N, n)
        Where the joints that vary end; rad, m.
    steps : int
        Of the integrator; `steps_for` returns enough.

    Returns
    -------
    scipy.spatial.transform.Rotation
        N attitudes, as seen from the first.
    """
    way = x - arm.home
    rates = way / arm.scale
    attitude = Rotation.identity(len(x))
    for step in range(steps):
        first, second = (arm.base_rotation(arm.home + (step + part) / steps * way, rates) for part in _GAUSS)
        attitude = attitude * Rotation.from_rotvec(
            0.5 / steps * (first + second) + math.sqrt(3.0) / (12.0 * steps**2) * np.cross(first, second)
        )
    return attitude


def steps_for(arm: Arm, x: Floats) -> tuple[int, float]:
    """Return how many steps paths to postures like `x` (N, n) take, and by how much half of them differ, rad."""
    steps, before = 1, turned(arm, x, 1)
    while True:
        steps *= 2
        after = turned(arm, x, steps)
        change = float((before.inv() * after).magnitude().max(initial=0.0))
        if change < _CLOSE or steps >= _MOST_STEPS:
            return steps, change
        before = after

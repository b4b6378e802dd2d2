"""Viscous and Coulomb friction of a joint, by its rate φ̇.

    τ = −d φ̇ − f tanh(φ̇ / s),     −∂τ/∂φ̇ = d + (f / s) (1 − tanh²(φ̇ / s))

d is the damping, f the Coulomb friction for that sense of motion, s the velocity `FRICTION_VELOCITY` that regularizes
the jump at rest: friction reaches 96 % of f at 2 s. The torque opposes the rate, so it never does positive work.
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import entry, inlined
from ospace.kernels.tree import Floats

FRICTION_VELOCITY = 0.02
"""s; rad/s, or m/s for prismatic joints."""


@inlined
def friction_torque(damping: float, backward: float, forward: float, rate: float) -> float:
    """τ of one joint, with f = `forward` for positive rates and `backward` for negative ones."""
    coulomb = forward if rate > 0.0 else backward
    return -damping * rate - coulomb * math.tanh(rate / FRICTION_VELOCITY)


@entry
def friction_torques(damping: Floats, coulomb: Floats, rate: Floats, torque: Floats) -> None:
    """Write τ of all joints to `torque` (n,); `damping`, `rate` (n,), `coulomb` (2, n) backward, forward."""
    for j in range(damping.size):
        torque[j] = friction_torque(damping[j], coulomb[0, j], coulomb[1, j], rate[j])

"""Drift of accelerations while torques are held.

A torque τ' that is held over a period h does not hold φ̈: as the arm moves on, φ̈ goes from what was commanded, φ̈', to

    φ̈_end = H_m*⁻¹ (τ' − c_m* + τ_f − C_u û'),      C φ̈ = H_m* φ̈ + C_u û

with all of the right side but τ' and û' at the end of the period. So its mean is more than φ̈' by δ = (φ̈_end − φ̈')/2, of
the order of h. What δ was over the last period it will be over the next one, but for a change of the order of h².
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import inlined
from ospace.kernels.qp.tables import UNLIMITED, Held, Program, ProgramLimits, Resistance
from ospace.kernels.tree import Floats
from ospace.kernels.workspace import Work

CONSECUTIVE = 1e-3
"""Share of a period by which cycles that follow each other may be early or late."""
NEAR = 0.98
"""Share of a velocity limit from which on the drift is of any use."""


@inlined
def drift_of_held_torque(
    w: Work, limits: ProgramLimits, resistance: Resistance, program: Program, held: Held, time: float
) -> None:
    """Write δ of every joint to `held.drift`; zero where no joint is fast, or the last cycle was not a period ago."""
    n, fast = limits.velocity.size, False
    for j in range(n):
        held.drift[j] = 0.0
        v = limits.velocity[j]
        fast = fast or (v < UNLIMITED and abs(w.velocity[j + 6, 0]) >= NEAR * v)
    follows = abs(time - held.time[0] - limits.reaction) <= CONSECUTIVE * limits.reaction
    held.time[0] = time
    if not (fast and follows):
        return
    for j in range(n):
        missing = held.torque[j] - resistance.bias[j]
        for k in range(held.z.size):
            missing -= program.C[j, k] * held.z[k]
        held.drift[j] = 0.5 * missing
    solve_in_place(program.C, held.factor, held.drift)


@inlined
def solve_in_place(A: Floats, L: Floats, x: Floats) -> None:
    """Solve A y = x by Cholesky, A the upper left part of the size of `x`; y is written to `x`, the factor to `L`."""
    n = x.size
    for i in range(n):
        for j in range(i + 1):
            left = A[i, j]
            for k in range(j):
                left -= L[i, k] * L[j, k]
            L[i, j] = math.sqrt(max(left, 1e-300)) if i == j else left / L[j, j]
    for i in range(n):
        for k in range(i):
            x[i] -= L[i, k] * x[k]
        x[i] /= L[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            x[i] -= L[k, i] * x[k]
        x[i] /= L[i, i]

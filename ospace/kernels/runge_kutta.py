"""Sums of the commutator-free Runge–Kutta method: `ospace.simulation.runge_kutta` has its equations."""

from __future__ import annotations

from ospace.kernels.jit.compile import entry
from ospace.kernels.tree import Floats


@entry
def stage_2_3(v: Floats, V: Floats, A: Floats, h: float, u: Floats, V_next: Floats) -> None:
    """Write u = h V and V_next = v + h A."""
    for i in range(v.size):
        u[i] = h * V[i]
        V_next[i] = v[i] + h * A[i]


@entry
def stage_4(v: Floats, V: Floats, A: Floats, h: float, u: Floats) -> None:
    """Write u = h (V_3 − V_1/2) and V_4 = v + h A_3; rows of `V` and `A` are the stages."""
    for i in range(v.size):
        u[i] = h * (V[2, i] - 0.5 * V[0, i])
        V[3, i] = v[i] + h * A[2, i]


@entry
def finish(v: Floats, V: Floats, A: Floats, h: float, u_1: Floats, u_2: Floats) -> None:
    """Write the two increments of q, and v⁺ in place of `v`."""
    for i in range(v.size):
        middle = 2.0 * (V[1, i] + V[2, i])
        u_1[i] = h / 12.0 * (3.0 * V[0, i] + middle - V[3, i])
        u_2[i] = h / 12.0 * (-V[0, i] + middle + 3.0 * V[3, i])
        v[i] += h / 6.0 * (A[0, i] + 2.0 * (A[1, i] + A[2, i]) + A[3, i])

"""Integrators by name."""

from __future__ import annotations

import math
from typing import Protocol

from ospace.exceptions import OspaceError, closest
from ospace.simulation.dormand_prince import DormandPrince
from ospace.simulation.plant import Plant
from ospace.simulation.runge_kutta import IntegratedMotion, RungeKutta4
from ospace.simulation.variational import VariationalMidpoint

INTEGRATORS = ("rk4", "symplectic")


class Integrator(Protocol):
    """Advances a motion."""

    def step(self, t: float, h: float, motion: IntegratedMotion) -> None:
        """Bring `motion` from time `t` to `t` + `h`, s, under what the plant holds."""
        ...


def integrator_of(plant: Plant, name: str, tolerance: float | None) -> Integrator:
    """Return an integrator of `plant`; raises `OspaceError` for an unknown name or a tolerance without use."""
    if name not in INTEGRATORS:
        raise OspaceError(f"integrator '{name}' is unknown{closest(str(name), INTEGRATORS)}")
    if tolerance is None:
        return RungeKutta4(plant) if name == "rk4" else VariationalMidpoint(plant)
    if not (math.isfinite(tolerance) and tolerance > 0.0):
        raise OspaceError(f"tolerance {tolerance!r}: give a number above zero, such as 1e-10")
    if name != "rk4":
        raise OspaceError(f"integrator '{name}' has a fixed step: leave out tolerance {tolerance!r}, or take 'rk4'")
    return DormandPrince(plant, tolerance)

"""The certificate of a run: what the laws of motion conserve, and how well the run conserved it.

Between the start and each record

    linear momentum      p − p_0 = ∫ f
    angular momentum     h + h_w − h_0 − h_w,0 = ∫ (moments about the centre of mass of thrusters and external wrenches)
    work and energy      T − T_0 = W − D
    rotations            |quaternion| = 1

where nothing of the right side is taken from the left: W, the energy D that friction took and the impulses are
integrated beside the state, to its accuracy. Errors are relative to scales that do not vanish when the momentum does:

    linear momentum      √(2 m T) + |∫ f|           the largest momentum that so much kinetic energy can carry, and what
    angular momentum     √(2 λ T) + |∫ n| + |h_w|   went in; λ the largest inertia of the locked robot at the start
    work and energy      T + |W|

each term at its peak over the run, T the kinetic energy in the frame that moves along with the start of the base.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ospace.kernels.tree import Floats

LIMITS = {"linear momentum": 1e-9, "angular momentum": 1e-9, "work and energy": 1e-8, "unit rotations": 1e-9}
"""Largest error relative to its scale that passes."""
SYMPLECTIC_LIMITS = LIMITS | {"work and energy": 1e-4}
"""Likewise for the symplectic integrator: its energy swings within O(h²) and does not drift."""


@dataclass(frozen=True)
class Conserved:
    """One quantity of the certificate.

    Attributes
    ----------
    name : str
    error : float
        Worst error of any record over `scale`.
    limit : float
        What passes.
    scale : float
        In `unit`.
    unit : str
    time : float
        When the error was worst, s.
    given : float
        The most that thrusters and external wrenches had given by any record, in `unit`: what is balanced with it, and
        not conserved.
    """

    name: str
    error: float
    limit: float
    scale: float
    unit: str
    time: float
    given: float = 0.0

    @property
    def passed(self) -> bool:
        """True where the error is within the limit, of a scale that is a number."""
        return self.error <= self.limit and math.isfinite(self.scale)

    def cells(self) -> tuple[str, str, str, str, str]:
        """Return the cells of its row in a table.

        Returns
        -------
        tuple of str
            Name, error, limit, scale and verdict.
        """
        verdict = "pass" if self.passed else f"FAIL (worst at {self.time:.6g} s)"
        if not math.isfinite(self.error + self.scale):
            verdict = f"FAIL (not computable at {self.time:.6g} s)"
        scale = f"of {self.scale:10.4g} {self.unit:<7}"
        return self.name, f"{self.error:9.2e}", f"limit {self.limit:.0e}", scale, verdict

    def __str__(self) -> str:
        name, error, limit, scale, verdict = self.cells()
        return f"{name:<16}  {error}  {limit}  {scale}  {verdict}"


@dataclass(frozen=True, eq=False)
class Balance:
    """Error of one quantity of the certificate at every record.

    Attributes
    ----------
    name : str
    error : (N,)
        Over `scale`.
    limit : float
        What passes.
    scale : float
        In `unit`.
    unit : str
    given : float
        As of `Conserved`.
    """

    name: str
    error: Floats
    limit: float
    scale: float
    unit: str
    given: float = 0.0

    def worst(self, time: Floats) -> Conserved:
        """Return the largest error, of records at `time` (N,), s."""
        k = int(np.argmax(self.error))
        return Conserved(self.name, float(self.error[k]), self.limit, self.scale, self.unit, float(time[k]), self.given)


@dataclass(frozen=True)
class Certificate:
    """Certificate of a run: how well it conserved each quantity.

    Attributes
    ----------
    quantities : tuple of Conserved
    """

    quantities: tuple[Conserved, ...]

    @property
    def passed(self) -> bool:
        """True where every quantity is within its limit."""
        return all(one.passed for one in self.quantities)

    def __getitem__(self, name: str) -> Conserved:
        return {one.name: one for one in self.quantities}[name]

    @property
    def from_outside(self) -> str:
        """Momentum that thrusters and external wrenches gave, in words; empty where momentum is conserved."""
        given = [f"{one.given:.4g} {one.unit}" for one in self.quantities if one.given > 0.0]
        if not given:
            return ""
        return f"not conserved but balanced: from outside came up to {', '.join(given)}"

    def __str__(self) -> str:
        return "\n".join(filter(None, [*map(str, self.quantities), self.from_outside]))


class Recorded(Protocol):
    """Run in N records, with these attributes of `ospace.simulation.Trajectory`."""

    @property
    def time(self) -> Floats: ...  # noqa: D102
    @property
    def momentum(self) -> Floats: ...  # noqa: D102
    @property
    def wheel_momentum(self) -> Floats: ...  # noqa: D102
    @property
    def mass_centre(self) -> Floats: ...  # noqa: D102
    @property
    def kinetic_energy(self) -> Floats: ...  # noqa: D102
    @property
    def work(self) -> Floats: ...  # noqa: D102
    @property
    def dissipated(self) -> Floats: ...  # noqa: D102
    @property
    def impulse(self) -> Floats: ...  # noqa: D102
    @property
    def rotation_drift(self) -> Floats: ...  # noqa: D102
    @property
    def total_mass(self) -> float: ...  # noqa: D102
    @property
    def largest_inertia(self) -> float: ...  # noqa: D102
    @property
    def integrator(self) -> str: ...  # noqa: D102


def certify(run: Recorded) -> Certificate:
    """Return the certificate of a run: the worst of each balance."""
    return Certificate(tuple(balance.worst(run.time) for balance in balances(run)))


def balances(run: Recorded) -> tuple[Balance, ...]:
    """Return what the certificate is made of, record by record."""
    with np.errstate(invalid="ignore", over="ignore"):  # what that leaves is not computable, and fails
        return _balances(run)


def _balances(run: Recorded) -> tuple[Balance, ...]:
    f, moment = run.impulse[:, :3], run.impulse[:, 3:]
    p, h = run.momentum[:, :3], run.momentum[:, 3:]
    linear = p - p[0] - f

    # Moments are known about the origin; the angular momentum about the mass centre c is L − c × p.
    predicted = p[0] + f
    moment_about_centre = moment - np.cross(run.mass_centre, predicted) + np.cross(run.mass_centre[0], p[0])
    wheels = run.wheel_momentum
    angular = h - h[0] + wheels - wheels[0] - moment_about_centre

    energy = run.kinetic_energy - run.kinetic_energy[0] - run.work + run.dissipated
    T = run.kinetic_energy.max()
    scales = (
        np.sqrt(2.0 * run.total_mass * T) + _peak(f),
        np.sqrt(2.0 * run.largest_inertia * T) + _peak(moment_about_centre) + _peak(wheels),
        T + np.abs(run.work).max(),
        1.0,
    )
    pushed = bool(run.impulse.any())
    given = pushed * _peak(f), pushed * _peak(moment_about_centre), 0.0, 0.0
    limits = SYMPLECTIC_LIMITS if run.integrator == "symplectic" else LIMITS
    units = ("kg m/s", "kg m²/s", "J", "")
    errors = (_lengths(linear), _lengths(angular), np.abs(energy), run.rotation_drift)
    return tuple(
        Balance(name, relative(error, float(scale)), limit, float(scale), unit, of_outside)
        for (name, limit), error, scale, unit, of_outside in zip(
            limits.items(), errors, scales, units, given, strict=True
        )
    )


def _lengths(vectors: Floats) -> Floats:
    return np.asarray(np.linalg.norm(vectors, axis=1))


def _peak(vectors: Floats) -> float:
    return float(_lengths(vectors).max())


def relative(errors: Floats, scale: float) -> Floats:
    """Return errors over their scale; no error is none of a scale of zero either, and NaN of one that is not finite."""
    if not math.isfinite(scale):
        return np.full_like(errors, math.nan)
    with np.errstate(divide="ignore"):
        return np.divide(errors, scale, out=np.zeros_like(errors), where=errors != 0.0)

"""Noise of the sensors by which a controller sees the state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import real_numbers
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True)
class Noise:
    """White noise on the measured state, drawn anew each control period.

    Attributes
    ----------
    q : float or (nv,)
        Standard deviation of each tangent coordinate of q: base pose in base axes, then joints; m, rad.
    v : float or (nv,)
        Standard deviation of each of v; m/s, rad/s.
    seed : int or tuple of int
        The same seed gives the same noise.
    """

    q: npt.ArrayLike = 0.0
    v: npt.ArrayLike = 0.0
    seed: int | tuple[int, ...] = 0


class Sensors:
    """Measures the state of a robot; exactly without `noise`."""

    def __init__(self, robot: SpaceRobot, noise: Noise | None) -> None:
        self._model = robot.model
        self._noisy = noise is not None
        if noise is not None:
            self._q, self._v = (_deviation(given, name, robot) for name, given in (("q", noise.q), ("v", noise.v)))
            self._rng = np.random.default_rng(noise.seed)

    def measure(self, q: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return (q, v) as measured."""
        if not self._noisy:
            return q, v
        q = pin.integrate(self._model, q, self._q * self._rng.standard_normal(len(v)))
        return q, v + self._v * self._rng.standard_normal(len(v))


def _deviation(given: npt.ArrayLike, name: str, robot: SpaceRobot) -> Floats:
    try:
        deviation = np.broadcast_to(real_numbers(given), (robot.nv,))
    except (TypeError, ValueError):
        raise OspaceError(f"noise.{name} {given!r}: give one number, or {robot.nv} for robot '{robot.name}'") from None
    if not (np.isfinite(deviation) & (deviation >= 0.0)).all():
        raise OspaceError(f"noise.{name} {given!r}: standard deviations must be finite and not negative")
    return deviation

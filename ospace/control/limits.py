"""Joint and base limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ospace.checks import checked_number, real_numbers
from ospace.exceptions import OspaceError
from ospace.kernels.qp.tables import UNLIMITED
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, eq=False)
class JointLimits:
    """Limits of all joints; ±infinity where there is none.

    Attributes
    ----------
    torque : (n,)
        To either side; N m, or N for prismatic joints. 0 is a joint without a drive, whose motion limits bind nothing.
    lower, upper : (n,)
        Positions; rad, or m. Infinite for planar, spherical and floating joints, whose rates are no rates of
        coordinates: the controller keeps no position limit of these.
    velocity : (n,)
        To either side; rad/s, or m/s. 0 is a joint that its drive holds still.
    acceleration : (n,)
        To either side; rad/s², or m/s².

    Raises
    ------
    OspaceError
        An array is not of n numbers, a torque or velocity is below 0, an acceleration is not above it, or a lower limit
        is above its upper one.
    """

    torque: Floats
    lower: Floats
    upper: Floats
    velocity: Floats
    acceleration: Floats

    def __post_init__(self) -> None:
        for name in ("torque", "lower", "upper", "velocity", "acceleration"):
            try:
                values = np.array(real_numbers(getattr(self, name)))
            except (TypeError, ValueError):
                values = np.empty((0, 0))
            if values.ndim != 1 or values.shape != np.shape(self.torque) or np.isnan(values).any():
                raise OspaceError(
                    f"{name} limits {getattr(self, name)!r}: give one number for each joint, as for torque"
                )
            values.flags.writeable = False
            object.__setattr__(self, name, values)
        for name in ("torque", "velocity"):
            if not (getattr(self, name) >= 0.0).all():
                raise OspaceError(f"{name} limits must not be below 0: {getattr(self, name)}")
        if not (self.acceleration > 0.0).all():
            raise OspaceError(
                f"acceleration limits must all be above 0, or a joint that moves could not stop: {self.acceleration}"
            )
        if not (self.lower <= self.upper).all():
            j = int(np.argmin(self.lower <= self.upper))
            raise OspaceError(f"position limits of joint number {j} are {self.lower[j]} to {self.upper[j]}")

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by making another: arrays that are pickled as such could be written to."""
        return type(self), (self.torque, self.lower, self.upper, self.velocity, self.acceleration)

    @classmethod
    def of(
        cls,
        robot: SpaceRobot,
        *,
        acceleration: float | Mapping[str, float] = math.inf,
        share: float = 1.0,
        torque_share: float | None = None,
        velocity_share: float | None = None,
    ) -> JointLimits:
        """Take the limits of the robot's model.

        Parameters
        ----------
        robot : SpaceRobot
            Infinite limits alone count as none. A torque limit of zero is a joint without a drive; a velocity limit of
            zero is one that its drive holds still, and without a drive it counts as none.
        acceleration : float or mapping of joint name to float
            URDF has none; rad/s², or m/s². A joint with several rates takes the number for each.
        share : float
            Of the torques and velocities that the model allows.
        torque_share, velocity_share : float, optional
            Of the torques, and of the velocities, alone; `share` without it.

        Returns
        -------
        JointLimits

        Raises
        ------
        OspaceError
            An unknown joint, or a limit that makes no sense.
        """
        model, n = robot.model, robot.n_joints
        most = np.full(n, math.inf)
        if isinstance(acceleration, Mapping):
            for name, value in acceleration.items():
                most[robot.rates_of(name)] = _bound(value, f"acceleration limit of joint '{name}'")
        else:
            most[:] = _bound(acceleration, "acceleration limit")
        shares = [
            checked_number(share if own is None else own, f"{of}share of the limits")
            for of, own in (("torque ", torque_share), ("velocity ", velocity_share))
        ]
        lower, upper = np.full(n, -math.inf), np.full(n, math.inf)
        for j in range(2, model.njoints):
            if model.nqs[j] == model.nvs[j]:
                rates = slice(model.idx_vs[j] - 6, model.idx_vs[j] + model.nvs[j] - 6)
                positions = slice(model.idx_qs[j], model.idx_qs[j] + model.nqs[j])
                lower[rates], upper[rates] = model.lowerPositionLimit[positions], model.upperPositionLimit[positions]
        given = model.effortLimit, model.velocityLimit
        torque, velocity = (_open(one[6:]) * of for one, of in zip(given, shares, strict=True))
        velocity[(torque == 0.0) & (velocity == 0.0)] = math.inf
        return cls(torque, _open(lower), _open(upper), velocity, most)


def _bound(given: object, name: str) -> float:
    """Return a limit, which may be infinite."""
    return math.inf if given == math.inf else checked_number(given, name)


def _open(given: npt.ArrayLike) -> Floats:
    values = np.asarray(given, dtype=np.float64)
    return np.where(np.abs(values) < UNLIMITED, values, np.copysign(math.inf, values))


def bounded(values: Floats) -> Floats:
    """Return limits as kernels and solvers take them, ±`UNLIMITED` for infinite ones."""
    return np.clip(values, -UNLIMITED, UNLIMITED)

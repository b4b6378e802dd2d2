"""Actuation of a robot: a controller, and its commands."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from ospace.checks import real_numbers
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot


class CommandLike(Protocol):
    """Command that a controller returns: constant until the next one, base quantities in inertial axes.

    Attributes
    ----------
    torque : (n,) array
        Joint torques, N m; N for prismatic joints.
    base_wrench : (6,) array
        Force and torque of thrusters on the base, inertial axes, at the base-link frame's origin, linear first; N, N m.
    wheel_torque : (3,) array
        Torque of reaction wheels on the base, inertial axes, gyroscopic part included; N m.
    """

    @property
    def torque(self) -> Floats: ...  # noqa: D102
    @property
    def base_wrench(self) -> Floats: ...  # noqa: D102
    @property
    def wheel_torque(self) -> Floats: ...  # noqa: D102


@dataclass(frozen=True)
class Actuation:
    """The plainest `CommandLike`.

    Attributes
    ----------
    torque : (n,) array
        Joint torques, N m; N for prismatic joints.
    base_wrench : (6,) array
        Thrusters; inertial axes, at the base-link frame's origin, linear first; N, N m.
    wheel_torque : (3,) array
        Reaction wheels, on the base, inertial axes; N m.
    """

    torque: Floats
    base_wrench: Floats = field(default_factory=lambda: np.zeros(6))
    wheel_torque: Floats = field(default_factory=lambda: np.zeros(3))


class ControllerLike(Protocol):
    """Controller that `simulate` calls once a period."""

    def update(self, time: float, q: Floats, v: Floats) -> CommandLike:
        """Return the command of a period.

        Parameters
        ----------
        time : float
            s.
        q : (nq,)
            As measured; m, rad.
        v : (nv,)
            As measured, base twist in base axes; m/s, rad/s.

        Returns
        -------
        CommandLike
        """
        ...


Law = Callable[[float, Floats, Floats], Any]
"""(time, q, v) to joint torques (n,), or to a `CommandLike`."""


def law_of(controller: ControllerLike | Law, robot: SpaceRobot) -> Law:
    """Return `controller` as a function; raises `OspaceError` if it is neither, or made for a robot of other joints.

    Its robot may be another model of the same joints, such as one whose masses are known but roughly.
    """
    own = getattr(controller, "robot", robot)
    if isinstance(own, SpaceRobot) and own.joint_names != robot.joint_names:
        raise OspaceError(
            f"the controller is of robot '{own.name}', whose joints are not those of '{robot.name}': "
            f"make one for this robot, or give a function of (time, q, v)"
        )
    law = getattr(controller, "update", controller)
    if not callable(law):
        raise OspaceError(f"controller {controller!r}: give an object with update(time, q, v), or a function of these")
    return law


def as_command(given: Any, time: float) -> CommandLike:
    """Return what a law gave as a `CommandLike`; raises `OspaceError` where it is none."""
    if hasattr(given, "torque") and hasattr(given, "base_wrench") and hasattr(given, "wheel_torque"):
        return given  # type: ignore[no-any-return]
    try:
        return Actuation(real_numbers(given))
    except (TypeError, ValueError):
        raise OspaceError(
            f"the controller gave {given!r} at {time:.6g} s: give joint torques (n,), or a command with torque, "
            f"base_wrench and wheel_torque"
        ) from None

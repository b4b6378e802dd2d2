"""References of tasks: a pose that stays, one that moves from rest to rest, or any function of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import checked_number, checked_vector
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.kernels.tree import Floats

_UNIT = np.eye(3)
_ROUNDING = 1e-9 + 1e-5 * _UNIT  # as a file rounds it: lengths of axes count less than their angles
Moving = Callable[[float], tuple[pin.SE3, npt.ArrayLike, npt.ArrayLike]]


@dataclass(frozen=True)
class Constant:
    """A pose that stays, or a velocity that does.

    Attributes
    ----------
    pose : pin.SE3
        Inertial axes; m.
    velocity : (6,)
        Linear first; for a momentum task the momentum: N s, N m s.
    """

    pose: pin.SE3
    velocity: npt.ArrayLike = (0.0,) * 6

    def __post_init__(self) -> None:
        _checked_pose(self.pose)
        checked_vector(self.velocity, 6, "velocity of a reference")

    def write(self, row: Floats, time: float) -> None:
        """Write the reference to a row of the kernel's table.

        Parameters
        ----------
        row : (kernel.COLUMNS,)
            Overwritten.
        time : float
            s.
        """
        _write_pose(row, self.pose)
        row[kernel.VELOCITY : kernel.VELOCITY + 6] = self.velocity


@dataclass(frozen=True)
class MinimumJerk:
    """From one pose to another by a quintic, at rest at both ends: a straight line and a turn about one axis.

    Attributes
    ----------
    origin, goal : pin.SE3
        Inertial axes; m.
    start, duration : float
        s. The reference rests at `origin` before, and at `goal` after.

    Raises
    ------
    OspaceError
        A pose is not finite, or the duration is not above zero.
    """

    origin: pin.SE3
    goal: pin.SE3
    start: float
    duration: float

    def __post_init__(self) -> None:
        _checked_pose(self.origin)
        _checked_pose(self.goal)
        checked_number(self.start, "start of a motion")
        if not checked_number(self.duration, "duration of a motion") > 0.0:
            raise OspaceError(
                f"motion from {self.start} s in {self.duration} s: give a finite start, a duration above 0"
            )

    def write(self, row: Floats, time: float) -> None:
        """Write the reference to a row of the kernel's table.

        Parameters
        ----------
        row : (kernel.COLUMNS,)
            Overwritten: the kernel follows the quintic by itself.
        time : float
            s.
        """
        _write_pose(row, self.origin)
        row[kernel.START], row[kernel.DURATION] = self.start, self.duration
        row[kernel.DISPLACEMENT : kernel.DISPLACEMENT + 3] = self.goal.translation - self.origin.translation
        row[kernel.ROTATION_VECTOR : kernel.ROTATION_VECTOR + 3] = pin.log3(self.goal.rotation @ self.origin.rotation.T)


@dataclass(frozen=True)
class Function:
    """Any motion, with feed-forward.

    Attributes
    ----------
    motion : callable
        Returns for a time (s) the pose (pin.SE3), velocity (6,) and classical acceleration (6,); inertial axes,
        linear first, at the point.
    """

    motion: Moving

    def write(self, row: Floats, time: float) -> None:
        """Write the reference at `time` to a row of the kernel's table.

        Parameters
        ----------
        row : (kernel.COLUMNS,)
            Overwritten.
        time : float
            s.

        Raises
        ------
        OspaceError
            The reference is not finite, or velocity and acceleration are not of six numbers.
        """
        pose, velocity, acceleration = self.motion(time)
        _write_pose(row, pose)
        row[kernel.VELOCITY : kernel.VELOCITY + 6] = checked_vector(velocity, 6, f"velocity of a reference at {time} s")
        acceleration = checked_vector(acceleration, 6, f"acceleration of a reference at {time} s")
        row[kernel.ACCELERATION : kernel.ACCELERATION + 6] = acceleration
        if not np.isfinite(row).all():
            raise OspaceError(f"a reference is not finite at {time} s")


Reference = Constant | MinimumJerk | Function


def _checked_pose(pose: pin.SE3) -> pin.SE3:
    if not isinstance(pose, pin.SE3) or not (np.abs(pose.rotation.T @ pose.rotation - _UNIT) <= _ROUNDING).all():
        raise OspaceError(f"{pose!r}: give a pin.SE3 with a rotation")
    return pose


def _write_pose(row: Floats, pose: pin.SE3) -> None:
    row[:] = 0.0
    row[kernel.POSITION : kernel.POSITION + 3] = pose.translation
    row[kernel.ROTATION : kernel.ROTATION + 9] = pose.rotation.ravel(order="F")

"""Common parts of all tasks."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from numbers import Real
from typing import Any, ClassVar

import numpy as np
import pinocchio as pin

from ospace.control.base import Base
from ospace.control.references import Constant, Function, MinimumJerk, Reference
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats, Ints
from ospace.model.points import ROW_NAMES, Axes, OperationalPoint, parse_axes
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True)
class Completion:
    """Completion of a task: all errors below their bounds for some time without a break.

    Attributes
    ----------
    position : float
        Largest norm of the linear rows' error: m; of a momentum task N s, of a zero-reaction task m/s.
    angle : float
        Largest norm of the angular rows' error, or the largest error of a joint: rad (m for prismatic joints); of a
        momentum task N m s, of a damping or zero-reaction task rad/s.
    hold : float
        s.

    Raises
    ------
    OspaceError
        A bound is not above zero, the time to hold is negative or not finite, or nothing is bounded.
    """

    position: float = math.inf
    angle: float = math.inf
    hold: float = 0.0

    def __post_init__(self) -> None:
        if not all(isinstance(one, Real) for one in (self.position, self.angle, self.hold)):
            raise OspaceError(f"{self}: give real numbers")
        if not (self.position > 0.0 and self.angle > 0.0 and 0.0 <= self.hold < math.inf):
            raise OspaceError(f"{self}: bounds must be above 0, and the time to hold finite")
        if math.isinf(self.position) and math.isinf(self.angle):
            raise OspaceError("a completion without a bound always holds: give position or angle")


@dataclass(frozen=True, kw_only=True, eq=False)
class Task(ABC):
    """Goal of a controller, with its weight or level; errors fall as those of a spring with a damper.

    Attributes
    ----------
    name : str
        Its name in a `Command`.
    stiffness : float
        k, 1/s²: the error's natural frequency is √k rad/s.
    damping_ratio : float
        ζ; 1 is critically damped. The error's damping is 2 ζ √k, 1/s.
    weight : float
        How much the squared residual of a row counts, beside other tasks of no strict level.
    level : int, optional
        Strict level, the smallest first: tasks of a level cost those above it nothing. Tasks without one come last.
    completion : Completion, optional
    reference : Constant, MinimumJerk or Function, optional
        What to follow; for most tasks, what is there at the first cycle if it is left out.

    Raises
    ------
    OspaceError
        A number is negative or not finite, the level is no whole number, or the reference is none.
    """

    name: str
    stiffness: float = 25.0
    damping_ratio: float = 1.0
    weight: float = 1.0
    level: int | None = None
    completion: Completion | None = None
    reference: Reference | None = None

    kind: ClassVar[int]
    """Number of the kernel that writes its rows."""
    geometric: ClassVar[bool] = False
    """True where its rows are about the motion of points: rows of a Jacobian."""

    @property
    def own_axes(self) -> bool:
        """True where its rows are along and about the axes of its point, and not inertial ones."""
        return False

    @property
    def units(self) -> tuple[str, str] | None:
        """Of the errors of linear and of angular rows; None where it has no error."""
        return "m", "rad"

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping_ratio", "weight"):
            value = getattr(self, name)
            if not (isinstance(value, int | float) and 0.0 <= value < math.inf):
                raise OspaceError(f"task '{self.name}': {name} is {value!r}: give a finite number from 0 on")
        if self.level is not None and not isinstance(self.level, int):
            raise OspaceError(f"task '{self.name}': level is {self.level!r}: give a whole number, or None")
        if self.reference is not None and not isinstance(self.reference, Constant | MinimumJerk | Function):
            given = f"task '{self.name}': reference is {self.reference!r}"
            raise OspaceError(f"{given}: give a Constant, a MinimumJerk or a Function")

    def check(self, robot: SpaceRobot, base: Base) -> None:  # noqa: B027 (most make sense for any robot)
        """Check that a robot whose base is acted upon so can do the task.

        Parameters
        ----------
        robot : SpaceRobot
        base : Base
            Wrench on the base that the controller may use.

        Raises
        ------
        OspaceError
            It cannot.
        """

    @property
    def gain(self) -> tuple[float, float]:
        """Stiffness k (1/s²) and damping 2 ζ √k (1/s)."""
        return self.stiffness, 2.0 * self.damping_ratio * math.sqrt(self.stiffness)

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """Points that the task is about."""
        return ()

    @property
    def direction(self) -> Floats:
        """Unit vector (3,) in the axes of its point that the kernel needs; zero where it needs none."""
        return np.zeros(3)

    def redirected(self, reference: Reference | Mapping[str, Any]) -> Task:
        """Return the same task with another reference.

        Parameters
        ----------
        reference : Constant, MinimumJerk, Function, or mapping of joint name to position
            The last is for a `PostureTask`.

        Returns
        -------
        Task
            Of the same class.

        Raises
        ------
        OspaceError
            The task cannot follow it.
        """
        if isinstance(reference, Mapping):
            raise OspaceError(f"task '{self.name}' cannot follow {reference!r}: a posture is for a PostureTask")
        made: Task = type(self)(**{**vars(self), "reference": reference})
        return made

    def write(self, robot: SpaceRobot, q: Floats) -> None:  # noqa: B027 (most hold no joints)
        """Write the positions at which the task holds joints to `q`.

        Parameters
        ----------
        robot : SpaceRobot
        q : (nq,)
            Overwritten where the task holds a joint; rad, m.
        """

    def is_within(self, bounds: Completion, rows: Ints, error: Floats) -> bool:
        """Return whether an error is within the bounds of a completion.

        Parameters
        ----------
        bounds : Completion
        rows : (r,)
            As of `rows`.
        error : (r,)
            Of each row; m, rad.

        Returns
        -------
        bool
        """
        position, angle = np.linalg.norm(error[rows < 3]), np.linalg.norm(error[rows >= 3])
        return bool(position <= bounds.position and angle <= bounds.angle)

    @abstractmethod
    def rows(self, robot: SpaceRobot) -> list[int]:
        """Return the components of each row: of six for a point, of n for joints.

        Parameters
        ----------
        robot : SpaceRobot

        Returns
        -------
        list of int
        """

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Return the names of the rows, as ``task.x``.

        Parameters
        ----------
        robot : SpaceRobot

        Returns
        -------
        list of str
        """
        return [f"{self.name}.{ROW_NAMES[row]}" for row in self.rows(robot)]

    def initial(self, poses: list[pin.SE3], mass_centre: np.ndarray) -> pin.SE3:
        """Return the pose to hold where there is no reference.

        Parameters
        ----------
        poses : list of pin.SE3
            Of the task's `points` in the first cycle, inertial axes; m.
        mass_centre : (3,)
            In the first cycle, inertial axes; m.

        Returns
        -------
        pin.SE3
        """
        return poses[0] if poses else pin.SE3.Identity()


def chosen(task: str, axes: Axes, offered: tuple[int, ...]) -> list[int]:
    """Return the rows of `offered` that `axes` takes; raise where it takes none."""
    rows = [row for row, taken in enumerate(parse_axes(axes)) if taken and row in offered]
    if not rows:
        raise OspaceError(f"task '{task}': axes {axes!r} takes none of its rows")
    return rows

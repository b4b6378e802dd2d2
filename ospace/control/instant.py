"""View of a control cycle for tasks and inequalities written in Python: time, state, and how their points move."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ospace.dynamics.workspace import Workspace
from ospace.exceptions import OspaceError
from ospace.kernels import evaluation
from ospace.kernels.observation import observe
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot

_STEP = 4.0 * np.sqrt(np.finfo(np.float64).eps)
"""s at 1 m/s: errors of differences by rounding and by curvature are alike."""


class _Motion(NamedTuple):
    """Of a point: views of what `observe` writes."""

    position: Floats
    rotation: Floats
    velocity: Floats
    drift: Floats
    jacobian: Floats


class Instant:
    """Time and state of a control cycle.

    Vectors and Jacobians of points are in inertial axes, at the point, linear part first. Arrays are read-only, and
    the next cycle overwrites them.

    Parameters
    ----------
    robot : SpaceRobot
    points : sequence of OperationalPoint
        Whose motion can be read.

    Attributes
    ----------
    time : float
        s.
    q, v : (nq,), (nv,)
        The state as the controller has it: v is the twist of the base in base axes, then the joint rates.
    """

    def __init__(self, robot: SpaceRobot, points: Sequence[OperationalPoint]) -> None:
        self.time = 0.0
        self._robot, self._points = robot, tuple(points)
        self._run = Workspace(robot, self._points)
        self._run.wanted[0] = evaluation.JACOBIAN | evaluation.BIAS
        p = len(self._points)
        axes = [(robot.link_axes[one.joint].T @ one.placement.rotation).ravel(order="F") for one in self._points]
        position, rotation, motion, J = (np.zeros(shape) for shape in ((p, 3), (p, 9), (2 * p, 6), (6 * p, robot.nv)))
        self._tables = self._run.memory, np.reshape(axes, (p, 9)), position, rotation, motion, J
        self.q, self.v, position, rotation, motion, J = map(
            _read_only, (self._run.q, self._run.v, position, rotation, motion, J)
        )
        self._motion = {
            one: _Motion(position[e], rotation[e].reshape(3, 3), motion[2 * e], motion[2 * e + 1], J[6 * e : 6 * e + 6])
            for e, one in enumerate(self._points)
        }
        self._later: Instant | None = None
        self._stale = True

    def position(self, point: OperationalPoint) -> Floats:
        """Return where the point is, inertial frame.

        Parameters
        ----------
        point : OperationalPoint
            One of those that tasks and inequalities hold.

        Returns
        -------
        (3,) array
            m.

        Raises
        ------
        OspaceError
            The point is none of these.
        """
        return self._of(point).position

    def rotation(self, point: OperationalPoint) -> Floats:
        """Return the rotation from the point's axes to inertial ones.

        Parameters
        ----------
        point : OperationalPoint
            One of those that tasks and inequalities hold.

        Returns
        -------
        (3, 3) array

        Raises
        ------
        OspaceError
            The point is none of these.
        """
        return self._of(point).rotation

    def velocity(self, point: OperationalPoint) -> Floats:
        """Return ẋ of the point, inertial axes.

        Parameters
        ----------
        point : OperationalPoint
            One of those that tasks and inequalities hold.

        Returns
        -------
        (6,) array
            m/s, rad/s.

        Raises
        ------
        OspaceError
            The point is none of these.
        """
        return self._of(point).velocity

    def jacobian(self, point: OperationalPoint) -> Floats:
        """Return the Jacobian of the point, inertial axes, with which ẋ = J v.

        Parameters
        ----------
        point : OperationalPoint
            One of those that tasks and inequalities hold.

        Returns
        -------
        (6, nv) array

        Raises
        ------
        OspaceError
            The point is none of these.
        """
        return self._of(point).jacobian

    def drift(self, point: OperationalPoint) -> Floats:
        """Return J̇ v: the classical acceleration of the point while v stays.

        Parameters
        ----------
        point : OperationalPoint
            One of those that tasks and inequalities hold.

        Returns
        -------
        (6,) array
            m/s², rad/s².

        Raises
        ------
        OspaceError
            The point is none of these.
        """
        return self._of(point).drift

    def observe(self, time: float, q: Floats, v: Floats) -> None:
        """Take time and state.

        Parameters
        ----------
        time : float
            s.
        q, v : (nq,), (nv,)

        Raises
        ------
        OspaceError
            The kernels cannot place the joints there.
        """
        status = observe(q, v, *self._tables)
        if status:
            raise OspaceError("tasks and inequalities in Python need joint positions below 1e5 rad")
        self.time, self._stale = time, True

    @property
    def arguments(self) -> tuple[Floats, ...]:
        """Arguments of the kernel `observe`."""
        return self._run.q, self._run.v, *self._tables

    def later(self) -> tuple[Instant, float]:
        """Return an instant a little later, with the same v.

        What changes until then, over that time, is a rate of change while v stays.

        Returns
        -------
        Instant
        float
            By how much it is later, s.
        """
        step = float(_STEP * np.sqrt(1.0 + np.abs(self.q[:3]).max()))
        if self._later is None:
            self._later = Instant(self._robot, self._points)
        if self._stale:
            self._later.observe(self.time + step, pin.integrate(self._robot.model, self.q, self.v * step), self.v)
            self._stale = False
        return self._later, step

    def _of(self, point: OperationalPoint) -> _Motion:
        try:
            return self._motion[point]
        except KeyError:
            names = ", ".join(f"'{one.frame}'" for one in self._points) or "none"
            raise OspaceError(
                f"point '{point.frame}' is none of those that tasks and inequalities hold ({names}): keep the point "
                f"that robot.point(…) returns in an attribute, or give it by the property `points`"
            ) from None


def _read_only(array: Floats) -> Floats:
    seen = array.view()
    seen.flags.writeable = False
    return seen

"""The state of a robot: one pass of Pinocchio's kinematics, laid out for the recursions, read-only."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import checked_vector, not_finite
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.kernels.workspace import view_of_links
from ospace.model.joint_positions import norm_error
from ospace.model.layout import Layout
from ospace.model.points import OperationalPoint, check_owner

QUATERNION_TOLERANCE = 1e-6
"""Tolerance of the length of a quaternion, or of a (cos, sin) pair, beside one; it is then set to one."""
_UNIT = 4e-15  # as close to one as rounding leaves its square: set to one again, it would only change in its last digit


class State:
    """A robot at `q` and `v`; made by `SpaceRobot.state`.

    States of one robot are independent of each other: nothing that is computed later changes one.

    Attributes
    ----------
    robot : SpaceRobot
    q, v : (nq,), (nv,) arrays
        Read-only copies; quaternions at unit length.
    links : array
        Pinocchio's placements, joint columns and accelerations as the recursions take them: the tables `velocity` to
        `a` of `ospace.kernels.workspace.Work`, side by side.
    """

    def __init__(self, robot: Layout, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> None:
        self.robot = robot
        q = _copied(q, robot.nq, "q", robot.name)
        v = np.zeros(robot.nv) if v is None else _copied(v, robot.nv, "v", robot.name)
        scratch = robot.scratch
        links = scratch.place(q, v)
        if links is None or not robot.own_kinematics:  # what the kernels do not know, they do not normalize
            q, v = checked_state(robot, q, v)
            links = scratch.place(q, v)
        elif scratch.norm_error > _UNIT:
            q[:] = scratch.q
        if links is None:
            raise not_finite("the motion of the links")
        self.q, self.v, self.links = q, v, links
        for array in (q, v, links):
            array.flags.writeable = False

    @cached_property
    def T_WB(self) -> pin.SE3:
        """Pose of the base in the inertial frame."""
        return pin.XYZQUATToSE3(self.q[:7])

    @cached_property
    def base_twist(self) -> Floats:
        """ẋ_b = [v_b; ω_b] (6,), inertial axes, at the base-link frame's origin; m/s, rad/s."""
        R_WB = self.T_WB.rotation
        twist: Floats = np.concatenate([R_WB @ self.v[:3], R_WB @ self.v[3:6]])
        twist.flags.writeable = False
        return twist

    def base_frame_state(self) -> tuple[Floats, Floats]:
        """Return (q, v) as seen from an inertial frame that is centred on the base and moves along with it, now.

        There the base has neither a distance to the origin nor a linear velocity, which cost no digit then. Momentum
        is the one quantity of the paper that is another one there.

        Returns
        -------
        q : (nq,)
            With the base at the origin; m, rad.
        v : (nv,)
            With the base's linear velocity zero; base axes; m/s, rad/s.
        """
        q, v = self.q.copy(), self.v.copy()
        q[:3] = v[:3] = 0.0
        return q, v

    def placement(self, point: OperationalPoint) -> pin.SE3:
        """Return the pose T_WE of an operational point in the inertial frame.

        Parameters
        ----------
        point : OperationalPoint
            Of the state's robot.

        Returns
        -------
        pin.SE3
            m.

        Raises
        ------
        OspaceError
            The point is another robot's.
        """
        T_BE = self.placement_about_base(point)
        return pin.SE3(T_BE.rotation, T_BE.translation + self.q[:3])

    def placement_about_base(self, point: OperationalPoint) -> pin.SE3:
        """Return the pose of an operational point about the base's origin, inertial axes: exact wherever that is.

        Parameters
        ----------
        point : OperationalPoint
            Of the state's robot.

        Returns
        -------
        pin.SE3
            m.

        Raises
        ------
        OspaceError
            The point is another robot's.
        """
        check_owner(self.robot, point)
        link = int(self.robot.link_of_joint[point.joint])
        R = self.table("R")[link].reshape(3, 3).T @ self.robot.link_axes[point.joint].T
        return pin.SE3(R, self.table("r")[link]) * point.placement

    def table(self, name: str) -> Floats:
        """Return a view of one of the tables in `links`.

        Parameters
        ----------
        name : str
            A table that a pass over the links leaves, as `ospace.kernels.workspace` names it.

        Returns
        -------
        array
            Its rows; shared with the state.
        """
        return view_of_links(self.links, name, len(self.robot.links.parent), self.robot.nv)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by taking the robot's copy to `q` and `v` anew."""
        return type(self), (self.robot, self.q, self.v)

    def __repr__(self) -> str:
        return f"State({self.robot.name!r}, q={self.q}, v={self.v})"


def _copied(given: npt.ArrayLike, size: int, name: str, robot: str) -> Floats:
    """Return a copy of `given` as (size,) float64, whose numbers the kernels look at; raises `OspaceError`."""
    if type(given) is np.ndarray and given.dtype == np.float64 and given.shape == (size,):
        return given.copy()
    return checked_vector(given, size, name, robot)


def checked_state(robot: Layout, q: npt.ArrayLike, v: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Return copies of `q`, its quaternions at unit length, and `v`; raise `OspaceError` where they are no state."""
    q, v = checked_vector(q, robot.nq, "q", robot.name), checked_vector(v, robot.nv, "v", robot.name)
    _normalize(robot, q)
    return q, v


def _normalize(robot: Layout, q: Floats) -> None:
    """Bring quaternions and (cos, sin) pairs to unit length, in place; raise where they are far from it."""
    model = robot.model
    unit = pin.normalize(model, q)
    for j in range(1, model.njoints):
        if not norm_error(model, j, q[None])[0] <= QUATERNION_TOLERANCE:
            whose = "base quaternion q[3:7]" if j == 1 else f"rotation part of q of joint '{model.names[j]}'"
            part = q[model.idx_qs[j] : model.idx_qs[j] + model.nqs[j]]
            raise OspaceError(
                f"the {whose} is not of unit length: {part[3:] if j == 1 else part}; "
                f"divide it by its length, or build q with robot.configuration"
            )
    if not pin.isNormalized(model, q, _UNIT):
        q[:] = unit

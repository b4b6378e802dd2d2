"""The state of a robot: one pass of Pinocchio's kinematics, laid out for the recursions, read-only."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import all_finite, checked_vector
from ospace.exceptions import OspaceError
from ospace.kernels import frames
from ospace.kernels.tables import Floats, Tree
from ospace.points import OperationalPoint, check_owner

if TYPE_CHECKING:
    from ospace.robot import SpaceRobot

QUATERNION_TOLERANCE = 1e-6
"""How far the length of a quaternion, or of a (cos, sin) pair, may be from one; it is then set to one."""
_UNIT = 1e-15  # as close to one as rounding leaves it: set to one again, it would only change in its last digit

_BEFORE_ROTATION = {"JointModelFreeFlyer": 3, "JointModelPlanar": 2}  # numbers of q that are no rotation


class State:
    """A robot at `q` and `v`; made by `SpaceRobot.state`.

    States of one robot are independent of each other: nothing that is computed later changes one.

    Attributes
    ----------
    robot : SpaceRobot
    q, v : (nq,), (nv,) arrays
        Read-only copies; quaternions at unit length.
    T_WB : pin.SE3
        Pose of the base in the inertial frame.
    base_twist : (6,) array
        ẋ_b = [v_b; ω_b], inertial axes, at the base-link frame's origin; m/s, rad/s.
    placements : (njoints, 12) array
        Rotation by columns and translation of every Pinocchio joint; inertial axes, about the base.
    tree : Tree
        The links for the recursions.
    """

    def __init__(self, robot: SpaceRobot, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> None:
        self.robot = robot
        self.q, self.v = checked_state(robot, q, np.zeros(robot.nv) if v is None else v)
        self.q.flags.writeable = self.v.flags.writeable = False

        scratch = robot.scratch
        scratch.run(*self.beside_base())
        self.placements = scratch.placements.copy()
        rows = robot.n_joints + 1
        self.tree = Tree(np.empty((rows, 6)), np.empty((rows, 21)), np.empty((rows, 6)), np.empty((rows, 6)))
        frames.place(robot.links, self.placements, scratch.columns, scratch.accelerations, self.v, self.tree)
        all_finite((self.placements, *self.tree), "the motion of the links")

        R_WB = self.placements[1, :9].reshape(3, 3).T
        self.T_WB = pin.SE3(R_WB, self.q[:3])
        self.base_twist = np.r_[R_WB @ self.v[:3], R_WB @ self.v[3:6]]
        for array in (self.placements, self.base_twist, *self.tree):
            array.flags.writeable = False

    def beside_base(self) -> tuple[Floats, Floats]:
        """Return (q, v) as seen from an inertial frame that is centred on the base and moves along with it, now.

        There the base has neither a distance to the origin nor a linear velocity, which cost no digit then. Momentum
        is the one quantity of the paper that is another one there.
        """
        q, v = self.q.copy(), self.v.copy()
        q[:3] = v[:3] = 0.0
        return q, v

    def placement(self, point: OperationalPoint) -> pin.SE3:
        """Return the pose T_WE of an operational point in the inertial frame, m; `OspaceError` if another robot's."""
        T_BE = self.placement_about_base(point)
        return pin.SE3(T_BE.rotation, T_BE.translation + self.q[:3])

    def placement_about_base(self, point: OperationalPoint) -> pin.SE3:
        """Return the pose of an operational point, inertial axes, as seen from the base: exact wherever that is, m.

        Raises
        ------
        OspaceError
            The point is another robot's.
        """
        check_owner(self.robot, point)
        here = self.placements[point.joint]
        return pin.SE3(here[:9].reshape(3, 3).T, here[9:]) * point.placement

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by taking the robot's copy to `q` and `v` anew."""
        return type(self), (self.robot, self.q, self.v)

    def __repr__(self) -> str:
        return f"State({self.robot.name!r}, q={self.q}, v={self.v})"


def checked_state(robot: SpaceRobot, q: npt.ArrayLike, v: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Return copies of `q`, its quaternions at unit length, and `v`; raise `OspaceError` where they are no state."""
    q, v = checked_vector(q, robot.nq, "q", robot.name), checked_vector(v, robot.nv, "v", robot.name)
    _normalize(robot, q)
    return q, v


def _normalize(robot: SpaceRobot, q: Floats) -> None:
    """Bring quaternions and (cos, sin) pairs to unit length, in place; raise where they are far from it."""
    model = robot.model
    if pin.isNormalized(model, q, _UNIT):
        return
    unit = pin.normalize(model, q)
    for j in range(1, model.njoints):
        part = slice(model.idx_qs[j], model.idx_qs[j] + model.nqs[j])
        rotation = q[part][_BEFORE_ROTATION.get(model.joints[j].shortname(), 0) :]
        simple = len(rotation) in (2, 4) and model.nqs[j] == model.nvs[j] + 1
        off = abs(math.hypot(*rotation) - 1.0) if simple else np.abs(q[part] - unit[part]).max(initial=0.0)
        if not off <= QUATERNION_TOLERANCE:
            whose = "base quaternion q[3:7]" if j == 1 else f"rotation part of q of joint '{model.names[j]}'"
            raise OspaceError(
                f"the {whose} is not of unit length: {rotation}; "
                f"divide it by its length, or build q with robot.configuration"
            )
    q[:] = unit

"""SPART's R0, r0, qm, u0 and um for a robot.

    R0, r0    the base link's inertial frame: its axes as <inertial> has them, its origin at the centre of mass
    u0        [ω; ṙ], ω in axes of that frame, ṙ in inertial axes
    qm, um    joints as `urdf2robot` numbers them: depth first, in the order of the file

https://spart.readthedocs.io. SPART itself is not imported.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.bridge.coordinates import BaseCoordinates, check_joints
from ospace.checks import checked_vector
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.urdf.description import Description

_ROTATION = 1e-6


class Coordinates(BaseCoordinates):
    """Conversions between ospace and SPART, whose positions are the (12 + n,) array [R0 row by row, r0, qm].

    `export_pose` and `import_pose` have them apart. Velocities and matrices are those of u = [u0; um].

    Parameters
    ----------
    robot : SpaceRobot
        Read from a URDF, without mimic joints; each joint has one degree of freedom.
    joints : sequence of str, optional
        Names of the joints in SPART's order, as ``robot_keys.q_id`` has them; that of `urdf2robot` without it.

    Raises
    ------
    OspaceError
        The robot comes of no URDF, or `joints` are not its joints.
    """

    def __init__(self, robot: SpaceRobot, joints: Sequence[str] | None = None) -> None:
        check_joints(robot)
        if robot.description is None:
            raise OspaceError(f"robot '{robot.name}' comes of no URDF, which says where its base's <inertial> is")
        names = _as_numbered(robot.description, robot) if joints is None else list(joints)
        if sorted(names) != sorted(robot.joint_names):
            raise OspaceError(f"joints {names}: give those of robot '{robot.name}' once each, {robot.joint_names}")
        inertial = robot.description.link[robot.description.root].inertial
        assert inertial is not None  # as the base of a sound robot has mass
        self._inertial = pin.SE3(pin.rpy.rpyToMatrix(*inertial.pose.rpy), np.array(inertial.pose.xyz))
        n = len(names)
        order = np.array([names.index(name) for name in robot.joint_names], dtype=np.int64)
        rest = np.r_[np.eye(3).ravel(), np.zeros(3 + n)]
        super().__init__(robot, (range(12), range(6)), (list(12 + order), list(6 + order)), rest, 6 + n)

    def export_pose(self, q: npt.ArrayLike) -> tuple[Floats, Floats, Floats]:
        """Return R0, r0 and qm.

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.

        Returns
        -------
        R0, r0, qm : (3, 3), (3,), (n,) arrays
            m, rad.
        """
        positions, _ = self.export_state(q)
        return positions[:9].reshape(3, 3), positions[9:12], positions[12:]

    def import_pose(self, R0: npt.ArrayLike, r0: npt.ArrayLike, qm: npt.ArrayLike) -> Floats:
        """Return q.

        Parameters
        ----------
        R0, r0, qm : (3, 3), (3,), (n,)
            m, rad.

        Returns
        -------
        (nq,) array

        Raises
        ------
        OspaceError
            An array has a wrong length, a number that is not finite, or R0 is no rotation.
        """
        parts = (
            checked_vector(np.ravel(np.asarray(R0)), 9, "R0"),
            checked_vector(r0, 3, "r0"),
            checked_vector(qm, self.robot.n_joints, "qm", self.robot.name),
        )
        return self.import_state(np.concatenate(parts))[0]

    def _export_base(self, placement: pin.SE3, twist: Floats) -> tuple[Floats, Floats]:
        frame = placement * self._inertial
        own = self._inertial.actInv(pin.Motion(twist))
        return np.r_[frame.rotation.ravel(), frame.translation], np.r_[own.angular, frame.rotation @ own.linear]

    def _import_base(self, position: Floats, velocity: Floats) -> tuple[pin.SE3, Floats]:
        R0 = position[:9].reshape(3, 3)
        if np.abs(R0 @ R0.T - np.eye(3)).max() > _ROTATION or np.linalg.det(R0) < 0.0:
            raise OspaceError(f"R0 is no rotation: {R0.tolist()}")
        frame = pin.SE3(R0, position[9:])
        own = pin.Motion(R0.T @ velocity[3:], velocity[:3])
        return frame * self._inertial.inverse(), self._inertial.act(own).vector

    def _base_map(self, placement: pin.SE3) -> Floats:
        frame = placement * self._inertial
        to_base = placement.translation - frame.translation
        T = np.zeros((6, 6))
        T[:3, 3:] = np.eye(3)
        T[:3, :3] = -pin.skew(to_base) @ frame.rotation
        T[3:, :3] = frame.rotation
        return T


def _as_numbered(description: Description, robot: SpaceRobot) -> list[str]:
    """Return the names of the moving joints, depth first, siblings by their lines in the file."""
    below: dict[str, list[str]] = {}
    for joint in sorted(description.joints, key=lambda one: one.line or 0):
        below.setdefault(joint.parent, []).append(joint.name)
    names, left = [], list(reversed(below.get(description.root, [])))
    while left:
        name = left.pop()
        names.append(name)
        left += reversed(below.get(description.joint[name].child, []))
    moving = set(robot.joint_names)
    return [name for name in names if name in moving]

"""Positions and velocities of another program for a robot: what all bridges share.

ospace has q and v of Pinocchio, and results in the rates ẋ = [ẋ_b; φ̇]: twist of the base-link frame in inertial axes,
linear part first, then joint rates. Another program has velocities u, with

    ẋ = T(q) u,    so that    M = Tᵀ H T,    J_u = J T,    F_u = Tᵀ F

for its inertia matrix M, Jacobians and generalized forces F = [F_b; τ]. A bridge says where its program keeps the
numbers, and what T has for the base.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import check_kind, checked_vector
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats, Ints
from ospace.model.layout import BASE_NQ, BASE_NV
from ospace.model.robot import SpaceRobot


class BaseCoordinates(ABC):
    """Conversions for a robot whose joints have one degree of freedom each.

    Parameters
    ----------
    robot : SpaceRobot
    base : (7,) and (6,) int arrays
        Where the other program keeps position and velocity of the base.
    joints : (n,) and (n,) int arrays
        Where it keeps position and rate of each joint, in the order of ``robot.joint_names``.
    rest : (np,)
        Its positions where nothing is said of them, as of other bodies.
    size : int
        Number of its velocities.

    Attributes
    ----------
    robot : SpaceRobot

    Raises
    ------
    OspaceError
        Joints have several degrees of freedom, or mimic others.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        base: tuple[Sequence[int], Sequence[int]],
        joints: tuple[Sequence[int], Sequence[int]],
        rest: npt.ArrayLike,
        size: int,
    ) -> None:
        self.robot = robot
        self._base_p, self._base_u = (np.array(places, dtype=np.int64) for places in base)
        self._joint_p, self._joint_u = (np.array(places, dtype=np.int64) for places in joints)
        self._rest, self._size = np.array(rest, dtype=np.float64), size
        model = robot.model
        self._q = np.array([model.idx_qs[j] for j in range(2, model.njoints)], dtype=np.int64)
        self._unbounded = np.flatnonzero([model.nqs[j] == 2 for j in range(2, model.njoints)])

    @property
    def _own(self) -> Ints:
        """Return where the robot's velocities stand among those of the other program."""
        own: Ints = np.r_[self._base_u, self._joint_u]
        return own

    # -- states ----------------------------------------------------------------------------------------------

    def export_state(self, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Return positions and velocities of the other program.

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.
        v : (nv,), optional
            Base twist in base axes, then joint rates; zero without it; m/s, rad/s.

        Returns
        -------
        positions, velocities : arrays
            In the other program's order and axes.

        Raises
        ------
        OspaceError
            `q` or `v` has a wrong length, or a number that is not finite.
        """
        q = checked_vector(q, self.robot.nq, "q", self.robot.name)
        v = np.zeros(self.robot.nv) if v is None else checked_vector(v, self.robot.nv, "v", self.robot.name)
        positions, velocities = self._rest.copy(), np.zeros(self._size)
        angles = q[self._q]
        if len(self._unbounded):
            first = self._q[self._unbounded]
            angles[self._unbounded] = np.arctan2(q[first + 1], q[first])
        positions[self._joint_p], velocities[self._joint_u] = angles, v[BASE_NV:]
        base = self._export_base(pin.XYZQUATToSE3(q[:BASE_NQ]), v[:BASE_NV])
        positions[self._base_p], velocities[self._base_u] = base
        return positions, velocities

    def import_state(self, positions: npt.ArrayLike, velocities: npt.ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Return q and v of positions and velocities of the other program.

        Parameters
        ----------
        positions, velocities : arrays
            In its order and axes; velocities are zero without them.

        Returns
        -------
        q : (nq,)
            m, rad.
        v : (nv,)
            Base twist in base axes, then joint rates; m/s, rad/s.

        Raises
        ------
        OspaceError
            An array has a wrong length, a number that is not finite, or a rotation that is none.
        """
        p = checked_vector(positions, len(self._rest), "positions", self.robot.name)
        u = np.zeros(self._size)
        if velocities is not None:
            u = checked_vector(velocities, self._size, "velocities", self.robot.name)
        q, v = np.empty(self.robot.nq), np.empty(self.robot.nv)
        q[self._q] = angles = p[self._joint_p]
        if len(self._unbounded):
            first, turned = self._q[self._unbounded], angles[self._unbounded]
            q[first], q[first + 1] = np.cos(turned), np.sin(turned)
        placement, v[:BASE_NV] = self._import_base(p[self._base_p], u[self._base_u])
        q[:BASE_NQ], v[BASE_NV:] = pin.SE3ToXYZQUAT(placement), u[self._joint_u]
        return q, v

    # -- what goes along with velocities -------------------------------------------------------------------------

    def velocity_map(self, q: npt.ArrayLike) -> Floats:
        """Return T, with ẋ = T u.

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.

        Returns
        -------
        (nv, nu) array
            ẋ: twist of the base-link frame in inertial axes, linear part first, then joint rates in the order of
            ``v[6:]``. Columns of what is not the robot's are zero.

        Raises
        ------
        OspaceError
            `q` has a wrong length, or a number that is not finite.
        """
        q = checked_vector(q, self.robot.nq, "q", self.robot.name)
        T = np.zeros((self.robot.nv, self._size))
        T[:BASE_NV, self._base_u] = self._base_map(pin.XYZQUATToSE3(q[:BASE_NQ]))
        T[np.arange(BASE_NV, self.robot.nv), self._joint_u] = 1.0
        return T

    def export_inertia(self, q: npt.ArrayLike, H: npt.ArrayLike) -> Floats:
        """Return M = Tᵀ H T.

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.
        H : (nv, nv)
            [[H_b, H_bm], [H_bmᵀ, H_m]] of `ospace.joint_space_dynamics`; kg, kg m, kg m².

        Returns
        -------
        (nu, nu) array
            Zero for what is not the robot's.

        Raises
        ------
        OspaceError
            An argument has a wrong shape, or a number that is not finite.
        """
        T = self.velocity_map(q)
        return T.T @ self._square(H, "H", self.robot.nv) @ T

    def import_inertia(self, q: npt.ArrayLike, M: npt.ArrayLike) -> Floats:
        """Return H = T⁻ᵀ M T⁻¹ of the robot's part of M.

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.
        M : (nu, nu)
            Of the other program; kg, kg m, kg m².

        Returns
        -------
        (nv, nv) array
            [[H_b, H_bm], [H_bmᵀ, H_m]], as of `ospace.joint_space_dynamics`.

        Raises
        ------
        OspaceError
            An argument has a wrong shape, or a number that is not finite.
        """
        own = self._own
        inverse = np.linalg.inv(self.velocity_map(q)[:, own])
        part = self._square(M, "M", self._size)[np.ix_(own, own)]
        return np.asarray(inverse.T @ part @ inverse)

    def export_forces(self, q: npt.ArrayLike, forces: npt.ArrayLike) -> Floats:
        """Return generalized forces Tᵀ [F_b; τ].

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.
        forces : (nv,) or (n,)
            [F_b; τ], F_b in inertial axes at the base-link frame's origin; or τ alone. N, N m.

        Returns
        -------
        (nu,) array
            Zero for what is not the robot's.

        Raises
        ------
        OspaceError
            An argument has a wrong length, or a number that is not finite.
        """
        given = np.asarray(forces)
        if given.shape == (self.robot.n_joints,):
            given = np.r_[np.zeros(BASE_NV), given]
        return self.velocity_map(q).T @ checked_vector(given, self.robot.nv, "forces", self.robot.name)

    def _square(self, matrix: npt.ArrayLike, name: str, size: int) -> Floats:
        flat = checked_vector(np.ravel(np.asarray(matrix)), size * size, name, self.robot.name)
        return flat.reshape(size, size)

    # -- what each program has for the base ------------------------------------------------------------------------

    @abstractmethod
    def _export_base(self, placement: pin.SE3, twist: Floats) -> tuple[Floats, Floats]:
        """Return the base's position and velocity of its pose and its twist in base axes, linear part first."""

    @abstractmethod
    def _import_base(self, position: Floats, velocity: Floats) -> tuple[pin.SE3, Floats]:
        """Return pose and twist in base axes of the base's position and velocity."""

    @abstractmethod
    def _base_map(self, placement: pin.SE3) -> Floats:
        """Return the (6, 6) of T that belongs to the base."""


def check_joints(robot: SpaceRobot) -> None:
    """Raise `OspaceError` for a robot with joints of several degrees of freedom, or that mimic others."""
    check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
    if robot.free is not None:
        raise OspaceError(
            f"robot '{robot.name}' has joints that mimic others, which have no coordinate here: read it with "
            f"free_mimic=True, and couple them in the other program"
        )
    several = [str(robot.model.names[j]) for j in range(2, robot.model.njoints) if robot.model.nvs[j] != 1]
    if several:
        raise OspaceError(f"joint '{several[0]}' has several degrees of freedom: only joints with one are converted")


def base_link(robot: SpaceRobot) -> str:
    """Return the name of the link that is the base."""
    for frame in robot.model.frames:
        if frame.type == pin.FrameType.BODY and frame.parentJoint == 1 and frame.placement.isIdentity():
            return str(frame.name)
    raise OspaceError(f"robot '{robot.name}' has no link at its base: name the body of the base")


def quaternion(numbers: Floats) -> pin.Quaternion:
    """Return a unit quaternion of w, x, y, z; raises `OspaceError` where they are none."""
    length = float(np.linalg.norm(numbers))
    if not abs(length - 1.0) < 1e-6:
        raise OspaceError(f"the base's quaternion (w, x, y, z) has length {length:.6g}: give one of unit length")
    w, x, y, z = (float(number) for number in numbers / length)
    return pin.Quaternion(w, x, y, z)


def wxyz(rotation: Floats) -> Floats:
    """Return the quaternion w, x, y, z of a rotation."""
    x, y, z, w = pin.Quaternion(rotation).coeffs()
    return np.array([w, x, y, z])

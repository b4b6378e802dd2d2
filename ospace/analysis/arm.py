"""The part of a robot that a map moves: a hand, the joints that vary and their ranges; all else stands still.

Joints that do not vary are locked, so that J_m*, J_b* and H_m* are those of the joints that do. Lengths of the locked
robot are counted in a characteristic length L, so that its Jacobian mixes no metres with radians: L is the length of
the arm, from the first joint that varies along the way to the hand.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import check_kind, checked_numbers, checked_vector
from ospace.dynamics.batch import operational_space_batch
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import joint_units, unit_of
from ospace.model.points import OperationalPoint, points_of
from ospace.model.robot import SpaceRobot
from ospace.urdf.coupling import Following, couple

_WIDEST = np.pi
"""Of a range on either side of zero where the file has no limit, rad or m."""
_NO_RATE = 1e6
"""rad/s or m/s: files write 1e9 for a limit that is never reached."""
_POSITION = (True, True, True, False, False, False)
_PILOT = 512
_NOTHING = 1e-9
"""Rows and singular values of J_m* below this share of the largest count as zero."""


@dataclass(frozen=True)
class Posture:
    """The hand of an arm in N postures, base at the origin and level, momentum zero.

    Attributes
    ----------
    hand, centre : (N, 3)
        Place of the hand and of the robot's mass centre in the base frame, m.
    J_m_star : (N, 6, n)
        Generalized Jacobian of the hand, inertial axes; in L per unit of the joint, and rad per unit of the joint.
        A joint that slides counts in L.
    J_b_star : (N, 6, n)
        Of the base, likewise.
    """

    hand: Floats
    centre: Floats
    J_m_star: Floats
    J_b_star: Floats

    @property
    def from_centre(self) -> Floats:
        """Place of the hand seen from the mass centre, (N, 3), m: inertial axes while the base is level."""
        return np.asarray(self.hand - self.centre)

    def level_jacobian(self, length: float) -> Floats:
        """Return the derivative of `from_centre` by the joints, the base held level, (N, 3, n), in `length` as L."""
        turn = np.cross(self.from_centre[:, None] / length, self.J_b_star[:, 3:].transpose(0, 2, 1)).transpose(0, 2, 1)
        return np.asarray(self.J_m_star[:, :3] + turn)


class Arm:
    """A hand, and the joints of a robot that vary.

    Parameters
    ----------
    robot : SpaceRobot
    point : OperationalPoint
        The hand. Its rows are those of J_m* whose singularities count.
    joints : sequence of str, optional
        Names of joints that vary, of one degree of freedom each; those between base and hand without it.
    ranges : mapping of str to (low, high), optional
        Of joints that vary, rad or m; their limits without it, and ±π where there is none. What is given counts,
        also beyond limits.
    at : (nq,), optional
        Where other joints stand, and from where paths begin; `robot.neutral()` without it. The base's pose does not
        count.

    Attributes
    ----------
    robot, point, joints
        As given.
    lower, upper : (n,)
        Ranges; rad, m.
    home : (n,)
        Posture of the joints that vary in `at`.
    length : float
        L, m.
    rates : (n,)
        Rate limits, and 1 where there is none; rad/s, m/s.
    units : tuple of str
        Of each joint: "rad" or "m".
    scale : (n,)
        Of each joint, in whose multiples it is counted: L for one that slides, 1 for others.
    locked : SpaceRobot
        The robot with only these joints, lengths in L.

    Raises
    ------
    OspaceError
        A joint is unknown, has several degrees of freedom or mimics another, a range is empty, or nothing varies.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        point: OperationalPoint,
        joints: Iterable[str] | None = None,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        at: npt.ArrayLike | None = None,
    ) -> None:
        check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
        (self.point,) = points_of(robot, point)
        self.robot = robot
        self.at = robot.neutral() if at is None else checked_vector(at, robot.nq, "at", robot.name)
        self.at[:7] = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
        self.joints = _varying(robot, self.point, joints)
        self._numbers = [robot.joint_number(name) for name in self.joints]
        self.units = tuple(unit_of(robot.model.joints[j]) for j in self._numbers)
        self.home = np.array([float(robot.joint_positions(self.at)[name]) for name in self.joints])
        self.lower, self.upper = _ranges(robot, self._numbers, self.joints, ranges or {})
        self.rates = _rates(robot, self._numbers)
        self.length = _length(robot, self.point, self._numbers)
        self.locked, self._hand = _lock(robot, self.point, self.joints, self.at, self.length)
        self._columns = _places(self.locked, self.joints)
        self.scale = np.array([self.length if unit == "m" else 1.0 for unit in self.units])

    def __repr__(self) -> str:
        return f"Arm('{self.robot.name}', '{self.point.frame}', joints={len(self.joints)})"

    # -- configurations --------------------------------------------------------------------------------------

    def configurations(self, x: Floats) -> Floats:
        """Return configurations of the robot, base level at the origin.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.

        Returns
        -------
        (N, nq) array
        """
        return _with_joints(np.tile(self.at, (len(x), 1)), _places(self.robot, self.joints), x)

    def locked_configurations(self, x: Floats) -> Floats:
        """Return configurations of the locked robot, lengths in L.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.

        Returns
        -------
        (N, locked.nq) array
        """
        Q = np.zeros((len(x), self.locked.nq))
        Q[:, 6] = 1.0
        return _with_joints(Q, self._columns, x / self.scale)

    def draw(self, rng: np.random.Generator, count: int) -> Floats:
        """Draw postures, even over the ranges.

        Parameters
        ----------
        rng : numpy.random.Generator
        count : int

        Returns
        -------
        (count, n) array
            rad, m.
        """
        return self.lower + (self.upper - self.lower) * rng.random((count, len(self.joints)))

    # -- what it does there ----------------------------------------------------------------------------------

    def posture(self, x: Floats) -> Posture:
        """Compute where the hand and the mass centre are, J_m* and J_b*.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.

        Returns
        -------
        Posture
        """
        quantities = ("placement", "centre_of_mass", "generalized_jacobian", "base_generalized_jacobian")
        found = operational_space_batch(self.locked, self._hand, self.locked_configurations(x), None, quantities)
        self._check(found.bad, x)
        hand, centre, J_m_star, J_b_star = (np.asarray(getattr(found, name)) for name in quantities)
        return Posture(self.length * hand[:, 0, :3], self.length * centre, J_m_star, J_b_star)

    def base_rotation(self, x: Floats, rates: Floats) -> Floats:
        """Compute the angular velocity of the base at rates of the joints.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.
        rates : (N, n)
            In `scale` per s.

        Returns
        -------
        (N, 3) array
            Base axes, rad/s.
        """
        J_b_star = self._of_locked("base_generalized_jacobian", x)
        return np.asarray(np.einsum("kij,kj->ki", J_b_star[:, 3:], rates))

    def singular_values(self, x: Floats) -> Floats:
        """Compute the singular values of J_m*, of its rows `rows`, lengths in L.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.

        Returns
        -------
        (N, min(r, n)) array
            The largest first.
        """
        frame = OperationalPoint(self.locked, self._hand.frame, self.rows, self._hand.joint, self._hand.placement)
        Q = self.locked_configurations(x)
        found = operational_space_batch(self.locked, frame, Q, None, ("singular_values",)).singular_values
        return np.asarray(found)

    def generalized_inertia(self, x: Floats) -> Floats:
        """Compute H_m*, a joint that slides counted in L.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.

        Returns
        -------
        (N, n, n) array
            kg L².
        """
        return self._of_locked("generalized_inertia", x)

    def inertia(self, x: Floats, centre: Floats) -> Floats:
        """Compute the inertia of the robot about its mass centre.

        Parameters
        ----------
        x : (N, n)
            Postures of the joints that vary; rad, m.
        centre : (N, 3)
            The mass centre in the base frame, m.

        Returns
        -------
        (N, 3, 3) array
            Base axes, kg m².
        """
        columns = []
        for spin in np.eye(3):
            V = np.zeros((len(x), self.locked.nv))
            V[:, 3:6] = spin
            M_0 = self._of_locked("momentum", x, V)
            columns.append(self.length**2 * M_0[:, 3:] - self.length * np.cross(centre, M_0[:, :3]))
        return np.stack(columns, axis=-1)

    def _check(self, bad: npt.NDArray[np.int64], x: Floats) -> None:
        """Raise `OspaceError` where some postures have no dynamics."""
        if bad.size:
            at = ", ".join(f"{name}={value:.4g}" for name, value in zip(self.joints, x[bad[0]], strict=True))
            raise OspaceError(
                f"robot '{self.robot.name}' has no dynamics at {at}: masses, lengths or positions are too large or too "
                f"small to compute with"
            )

    def _of_locked(self, quantity: str, x: Floats, V: Floats | None = None) -> Floats:
        Q = self.locked_configurations(x)
        return np.asarray(getattr(operational_space_batch(self.locked, self._hand, Q, V, (quantity,)), quantity))

    @cached_property
    def span(self) -> float:
        """From the origin of the base to the hand: as far as in any of many postures."""
        hand = self.posture(self.draw(np.random.default_rng(0), _PILOT)).hand
        return float(np.linalg.norm(hand, axis=1).max()) or 1.0

    @cached_property
    def rows(self) -> tuple[bool, ...]:
        """Rows of J_m* that count: those of the point, but for those that no joint moves the hand along."""
        taken = np.array(self.point.axes) & self._moved
        return tuple(map(bool, taken)) if taken.any() else self.point.axes

    @cached_property
    def planar(self) -> bool:
        """True where hand and base move in a plane, along two directions, and turn about the third alone."""
        return bool((self._moved[:3].sum(), self._moved[3:].sum()) == (2, 1) and self._moved[:3] @ self._moved[3:] == 0)

    @cached_property
    def _moved(self) -> npt.NDArray[np.bool_]:
        """Directions that the hand moves along."""
        pilot = self.posture(self.draw(np.random.default_rng(0), _PILOT)).J_m_star
        moved = np.abs(pilot).max(axis=(0, 2))
        return np.asarray(moved > _NOTHING * moved.max(initial=0.0))

    @cached_property
    def rank(self) -> int:
        """Rank of these rows in almost all postures: the hand is singular where theirs is lower."""
        pilot = self.posture(self.draw(np.random.default_rng(0), _PILOT)).J_m_star[:, list(self.rows)]
        values = np.linalg.svd(pilot, compute_uv=False)
        return int((values > _NOTHING * values[:, :1]).sum(axis=1).max(initial=0))


def default_arm(
    robot: SpaceRobot,
    point: OperationalPoint,
    joints: Iterable[str] | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    at: npt.ArrayLike | None = None,
) -> Arm:
    """Return an arm whose hand counts by the rows that it can have: six joints take a pose, fewer a position."""
    arm = Arm(robot, point, joints, ranges, at)
    if len(arm.joints) >= len(point.axes):
        return arm
    return Arm(robot, replace(point, axes=_POSITION), joints, ranges, at)


def _places(robot: SpaceRobot, joints: Iterable[str]) -> list[tuple[int, bool]]:
    """Return where the position of each joint stands in q, and whether as cosine and sine."""
    numbers = [robot.joint_number(name) for name in joints]
    return [(int(robot.model.idx_qs[j]), robot.model.nqs[j] == 2) for j in numbers]


def _with_joints(Q: Floats, places: list[tuple[int, bool]], x: Floats) -> Floats:
    for (k, turns), column in zip(places, x.T, strict=True):
        if turns:
            Q[:, k], Q[:, k + 1] = np.cos(column), np.sin(column)
        else:
            Q[:, k] = column
    return Q


def _varying(robot: SpaceRobot, point: OperationalPoint, joints: Iterable[str] | None) -> tuple[str, ...]:
    """Return the names of the joints that vary, from the base outward; raise where they cannot."""
    on_the_way = set(robot.model.supports[point.joint])
    if joints is None:
        moved = {robot.model.idx_vs[j] for j in on_the_way if robot.model.nvs[j] or robot.free is not None}
        names = [name for name in robot.joint_names if robot.model.idx_vs[robot.joint_number(name)] in moved]
        if not names:
            raise OspaceError(
                f"no joint stands between the base and '{point.frame}': name joints that vary, or another point"
            )
    else:
        given = (joints,) if isinstance(joints, str) else tuple(joints)
        for name in given:
            robot.joint_number(name)
        names = [name for name in robot.joint_names if name in given]
        if not names:
            raise OspaceError("joints is empty: name some that vary, or leave it out for those between base and hand")
    for name in names:
        joint = robot.model.joints[robot.joint_number(name)]
        kind = joint.shortname().removeprefix("JointModel")
        if joint.nv != 1 or not kind.startswith(("R", "P")):
            raise OspaceError(
                f"joint '{name}' is of type {kind}: name joints that turn or slide, and this one stands still"
            )
    return tuple(names)


def _ranges(
    robot: SpaceRobot, numbers: list[int], joints: tuple[str, ...], given: Mapping[str, tuple[float, float]]
) -> tuple[Floats, Floats]:
    for name in given:
        if name not in joints:
            robot.joint_number(name)
            raise OspaceError(f"a range is given for joint '{name}', which does not vary: {', '.join(joints)} do")
    pairs = []
    for name, j in zip(joints, numbers, strict=True):
        low, high = -_WIDEST, _WIDEST
        if robot.model.nqs[j] == 1:
            k = robot.model.idx_qs[j]
            low, high = float(robot.model.lowerPositionLimit[k]), float(robot.model.upperPositionLimit[k])
            if not low <= high:
                low, high = -np.inf, np.inf
            if high - low > 4.0 * _WIDEST or not np.isfinite(high - low):  # more than two turns: as without limits
                low, high = max(low, min(-_WIDEST, high - 2.0 * _WIDEST)), min(high, max(_WIDEST, low + 2.0 * _WIDEST))
        if name in given:
            pair = checked_numbers(given[name], f"range of joint '{name}'")
            if pair.shape != (2,):
                raise OspaceError(f"range of joint '{name}' is {given[name]!r}: give low and high")
            low, high = map(float, pair)
        if not low < high:
            raise OspaceError(
                f"range of joint '{name}' is empty, {low:g} to {high:g}: give low below high, or let it not vary"
            )
        pairs.append((low, high))
    lower, upper = np.array(pairs).T
    return lower, upper


def _rates(robot: SpaceRobot, numbers: list[int]) -> Floats:
    limits = np.array([float(robot.model.velocityLimit[robot.model.idx_vs[j]]) for j in numbers])
    return np.where((limits > 0.0) & (limits < _NO_RATE), limits, 1.0)


def _length(robot: SpaceRobot, point: OperationalPoint, numbers: list[int]) -> float:
    """Return the length of the way from the first joint that varies to the hand; of all where none is on it."""
    way = [j for j in robot.model.supports[point.joint] if j > 1]
    first = next((k for k, j in enumerate(way) if j in numbers), 0)
    beyond = [float(np.linalg.norm(robot.model.jointPlacements[j].translation)) for j in way[first + 1 :]]
    return sum(beyond) + float(np.linalg.norm(point.placement.translation)) or 1.0


def _lock(
    robot: SpaceRobot, point: OperationalPoint, joints: tuple[str, ...], at: Floats, length: float
) -> tuple[SpaceRobot, OperationalPoint]:
    """Return the robot with all but some joints locked, lengths in `length`, and the hand on it, all rows."""
    whole = robot if robot.free is None else robot.free
    followers = {} if robot.free is None else robot.free.followers
    moving = {*joints, *(name for name, one in followers.items() if one.leader in joints)}
    model, data = whole.model, whole.model.createData()
    pin.forwardKinematics(model, data, at if robot.free is None else robot.free.configuration(at))
    locked = pin.Model()
    locked.name = model.name
    body: dict[int, tuple[int, pin.SE3]] = {0: (0, pin.SE3.Identity())}  # the joint that carries it, and where
    armature = []
    for j in range(1, model.njoints):
        parent, at_parent = body[model.parents[j]]
        if j == 1 or model.names[j] in moving:
            joint = model.joints[j]
            placement = _scaled(at_parent * model.jointPlacements[j], length)
            body[j] = locked.addJoint(parent, joint, placement, model.names[j]), pin.SE3.Identity()
            size = 1.0 if j == 1 or unit_of(joint) == "m" else length**2
            armature.extend(model.armature[joint.idx_v : joint.idx_v + joint.nv] / size)
        else:
            body[j] = parent, at_parent * data.liMi[j]
        carrier, placement = body[j]
        inertia = placement.act(model.inertias[j])
        own = pin.Inertia(inertia.mass, inertia.lever / length, inertia.inertia / length**2)
        locked.appendBodyToJoint(carrier, own, pin.SE3.Identity())
    locked.armature = np.array(armature)
    carrier, placement = body[point.joint]
    hand = "hand of a map"
    locked.addFrame(pin.Frame(hand, carrier, 0, _scaled(placement * point.placement, length), pin.FrameType.OP_FRAME))
    units = joint_units(model)
    kept = {}
    for name in moving - set(joints):
        one = followers[name]
        own, leader = (length if units[joint] == "m" else 1.0 for joint in (name, one.leader))
        kept[name] = Following(one.leader, one.ratio * leader / own, one.offset / own)
    made = SpaceRobot(couple(locked, kept) if kept else locked)
    frame = made.model.frames[made.model.getFrameId(hand)]
    return made, OperationalPoint(made, hand, (True,) * 6, int(frame.parentJoint), pin.SE3(frame.placement))


def _scaled(placement: pin.SE3, length: float) -> pin.SE3:
    return pin.SE3(placement.rotation, placement.translation / length)

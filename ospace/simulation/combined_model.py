"""One model of two robots, a link of the second fixed to a link of the first.

The second robot hangs from the link g by which it is held, whatever its own base. From g on outwards, a body b whose
frame stands at C_b as seen from where the new model has it

    child c of b         joint at C_b P_c,                          C_c = 1
    parent p of b        joint of b reversed, at C_b Z,             C_p = Z⁻¹ P_b⁻¹

P the placement of a joint in its parent, Z the rotation that brings the z axis to the joint's negative axis: a reversed
joint moves along or about that, so its position and rate keep their values.

Joints are added depth first: Pinocchio's crba needs every subtree to be numbered without a gap. Those that mimic others
are added free, and coupled at the end, which may number them anew.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats, Ints
from ospace.model.layout import Layout
from ospace.model.mimic import couplings_of
from ospace.model.robot import SpaceRobot
from ospace.urdf.coupling import Following, copy_joint_numbers, couple


@dataclass(frozen=True, eq=False)
class RowMap:
    """Places of the numbers of one of the two: index arrays into its own q and v, and into those of both."""

    own_q: Ints
    own_v: Ints
    joined_q: Ints
    joined_v: Ints

    @classmethod
    def of(cls, own: pin.Model, joined: pin.Model, joints: dict[int, int]) -> RowMap:
        """Find those of `joints`, by their number in either model."""
        found = []
        for model, numbers in ((own, joints.keys()), (joined, joints.values())):
            for first, count in ((model.idx_qs, model.nqs), (model.idx_vs, model.nvs)):
                each = [np.arange(first[j], first[j] + count[j], dtype=np.int64) for j in numbers]
                found.append(np.concatenate([np.zeros(0, dtype=np.int64), *each]))
        return cls(*found)


@dataclass(frozen=True)
class CombinedModel:
    """A robot made of two.

    Attributes
    ----------
    robot : SpaceRobot
        Base, joint names and frame names of the first; names of the second that clash are prefixed with its own.
    first_joints : dict of int to int
        Pinocchio's number in `robot` of each joint of the first.
    first, second : RowMap
        Of the first, and of the second without its base.
    """

    robot: SpaceRobot
    first_joints: dict[int, int]
    first: RowMap
    second: RowMap


def join(first: Layout, at: int, second: Layout, held: int, T_AH: pin.SE3) -> CombinedModel:
    """Fix joint frame `held` of `second` to joint frame `at` of `first`, at the pose `T_AH`.

    Raises
    ------
    OspaceError
        The second is held beyond a joint that cannot be reversed: one of another kind than revolute, continuous,
        prismatic or helical.
    """
    builder = _Builder(first, second)
    last = max(j for j in range(1, first.model.njoints) if at in first.model.supports[j])
    for j in range(1, first.model.njoints):
        builder.add_first(j)
        if j == last:
            builder.hang(held, builder.first_joints[at], T_AH, came_from=0)
    builder.add_frames(at)
    builder.couple()
    robot = SpaceRobot.from_model(builder.model)
    rows = (
        RowMap.of(one.model, robot.model, joints)
        for one, joints in ((first, builder.first_joints), (second, builder.second_joints))
    )
    return CombinedModel(robot, builder.first_joints, *rows)


class _Builder:
    def __init__(self, first: Layout, second: Layout) -> None:
        self.first, self.second = first.model, second.model
        self._robots = first, second
        self._joints = [(robot.free or robot).model.joints for robot in (first, second)]
        self.prefix = f"{second.name}/"
        self.model = pin.Model()
        self.model.name = f"{first.name}+{second.name}"
        self.first_joints: dict[int, int] = {}
        self.second_joints: dict[int, int] = {}
        self._carriers: dict[int, tuple[int, pin.SE3]] = {}  # of each body of the second: new joint, and C
        self._axes = _axes((second.free or second).model)

    def add_first(self, j: int) -> None:
        """Add joint `j` of the first robot as it is."""
        model = self.first
        parent = 0 if j == 1 else self.first_joints[model.parents[j]]
        k = self.model.addJoint(parent, self._joints[0][j], model.jointPlacements[j], model.names[j])
        self.model.appendBodyToJoint(k, model.inertias[j], pin.SE3.Identity())
        copy_joint_numbers(model, j, self.model, k)
        self.first_joints[j] = k

    def hang(self, body: int, joint: int, correction: pin.SE3, came_from: int) -> None:
        """Give body `body` of the second robot to joint `joint` of the new one, and go on outwards."""
        model = self.second
        self.model.appendBodyToJoint(joint, model.inertias[body], correction)
        self._carriers[body] = joint, correction
        for child in model.children[body]:
            if child != came_from:
                placement = correction * model.jointPlacements[child]
                k = self._add_second(child, self._joints[1][child], joint, placement)
                self.hang(child, k, pin.SE3.Identity(), body)
        if body != 1 and model.parents[body] != came_from:
            kind, Z = self._reversed(body)
            k = self._add_second(body, kind, joint, correction * Z)
            self.hang(model.parents[body], k, (model.jointPlacements[body] * Z).inverse(), body)

    def _add_second(self, j: int, kind: pin.JointModel, parent: int, placement: pin.SE3) -> int:
        name = self.second.names[j]
        taken = set(self.first.names)
        k = int(self.model.addJoint(parent, kind, placement, self.prefix + name if name in taken else name))
        copy_joint_numbers(self.second, j, self.model, k)
        self.second_joints[j] = k
        return k

    def _reversed(self, j: int) -> tuple[pin.JointModel, pin.SE3]:
        """Return the joint from the body of joint `j` to its parent, at the same position and rate; and Z."""
        kind, (shift, turn) = self._joints[1][j].shortname(), self._axes[j]
        if kind.startswith(("JointModelRUB", "JointModelRevoluteUnbounded")):
            return pin.JointModelRUBZ(), _z_to(-turn)
        if kind.startswith("JointModelR"):
            return pin.JointModelRZ(), _z_to(-turn)
        if kind.startswith("JointModelP") and kind != "JointModelPlanar":
            return pin.JointModelPZ(), _z_to(-shift)
        if kind.startswith("JointModelH"):
            return pin.JointModelHZ(float(shift @ turn)), _z_to(-turn)
        raise OspaceError(
            f"joint '{self.second.names[j]}' of '{self.second.name}' lies between its base and the link that is "
            f"grasped, and is a {kind[10:]} joint, which cannot be reversed: grasp a link on this side of it"
        )

    def couple(self) -> None:
        """Let joints of both follow those that they mimic, and note their numbers.

        Raises
        ------
        OspaceError
            A joint of the second robot would hang from one that mimics it.
        """
        followers: dict[str, Following] = {}
        for robot, numbers in zip(self._robots, (self.first_joints, self.second_joints), strict=True):
            for j, one in couplings_of(robot.model).items():
                leader = str(self.model.names[numbers[one.leader]])
                followers[str(self.model.names[numbers[j]])] = Following(leader, one.ratio, one.offset)
        if not followers:
            return
        names = [str(name) for name in self.model.names]
        self.model = couple(self.model, followers)
        number = {name: j for j, name in enumerate(self.model.names)}
        for numbers in (self.first_joints, self.second_joints):
            numbers.update({j: number[names[k]] for j, k in numbers.items() if k > 1})

    def add_frames(self, at: int) -> None:
        """Copy frames of both robots; the second's base frames hang from the link that holds."""
        for frame in list(self.first.frames)[1:]:
            self._add_frame(
                frame, frame.name, self.first_joints[frame.parentJoint], frame.parentFrame, pin.SE3.Identity()
            )
        taken = {frame.name for frame in self.model.frames}
        holder = next(k for k, frame in enumerate(self.first.frames) if frame.parentJoint == at)
        known: dict[int, int] = {}
        for k, frame in enumerate(self.second.frames):
            if frame.parentJoint == 0 or (frame.parentJoint == 1 and frame.type == pin.FrameType.JOINT):
                known[k] = holder
                continue
            name = self.prefix + frame.name if frame.name in taken else frame.name
            joint, correction = self._carriers[frame.parentJoint]
            known[k] = self._add_frame(frame, name, joint, known[frame.parentFrame], correction)

    def _add_frame(self, frame: pin.Frame, name: str, joint: int, parent: int, correction: pin.SE3) -> int:
        copy = pin.Frame(name, joint, parent, correction * frame.placement, frame.type)
        return int(self.model.addFrame(copy, False))


def _axes(model: pin.Model) -> list[tuple[Floats, Floats]]:
    """Return translation and rotation per unit rate, own axes, of each joint; of its first column."""
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    axes = [(np.zeros(3), np.zeros(3))]
    for j in range(1, model.njoints):
        column = pin.getJointJacobian(model, data, j, pin.ReferenceFrame.LOCAL)[:, model.idx_vs[j]]
        axes.append((column[:3].copy(), column[3:].copy()))
    return axes


def _z_to(axis: Floats) -> pin.SE3:
    """Return a rotation that brings the z axis to `axis`, of unit length."""
    return pin.SE3(pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), axis).matrix(), np.zeros(3))

"""A Pinocchio model laid out for the recursions: links of one column each, in axes of their own."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError, closest
from ospace.kernels.tree import (
    COLUMNS,
    CONTINUOUS,
    FLOATING,
    HELICAL,
    PLANAR,
    PRISMATIC,
    REVOLUTE,
    SAME_JOINT,
    SPHERICAL,
    UNKNOWN,
    Floats,
    Ints,
    Joints,
    Nodes,
)
from ospace.kernels.workspace import Robot, lay_out
from ospace.model.mimic import FreeJoints, couplings_of
from ospace.model.pinocchio_pass import PinocchioPass
from ospace.urdf.joint_axis import joint_axis

BASE_NV, BASE_NQ = 6, 7

_ONE_COLUMN = (
    dict.fromkeys(("RX", "RY", "RZ", "RevoluteUnaligned"), REVOLUTE)
    | dict.fromkeys(("RUBX", "RUBY", "RUBZ", "RevoluteUnboundedUnaligned"), CONTINUOUS)
    | dict.fromkeys(("PX", "PY", "PZ", "PrismaticUnaligned"), PRISMATIC)
    | dict.fromkeys(("HX", "HY", "HZ", "HelicalUnaligned"), HELICAL)
)
_ALONG_LINK_AXES = {"Spherical": SPHERICAL, "Planar": PLANAR, "FreeFlyer": FLOATING}
_X, _Y, _Z = np.eye(3)


class _Step(NamedTuple):
    """An elementary joint of a Pinocchio joint."""

    kind: int
    axis: Floats
    first: int
    """Where its part of q begins."""
    pitch: float = 0.0
    placement: pin.SE3 = pin.SE3.Identity()
    """Its frame in that of the step before; of the first one, in the joint's placement."""


class Layout:
    """A Pinocchio model with a free-flying base, laid out for the recursions: what states and points know of a robot.

    Attributes
    ----------
    model : pin.Model
        Pinocchio's model; joint 1 is the free-flyer, gravity is zero.
    name : str
    nq, nv : int
        Lengths of q and v.
    links : Joints
        The links and the joints by which they hang, as kernels take them.
    link_axes : sequence of (3, 3) arrays
        Axes of the link that carries each Pinocchio joint's body, in the joint's frame.
    link_of_joint : (njoints,) int array
        That link; −1 for the universe, 0 for the base.
    own_kinematics : bool
        Whether the kernels can place the links themselves; Pinocchio does where they cannot.
    free : FreeJoints or None
        The same robot without its couplings, where joints mimic others.
    local : threading.local
        Memory of each thread to work in.
    """

    def __init__(self, model: pin.Model) -> None:
        self.model = model
        self.name: str = model.name
        self.local = threading.local()
        self.nq, self.nv = int(model.nq), int(model.nv)
        couplings = couplings_of(model)
        columns = [1 if j in couplings else int(model.nvs[j]) for j in range(2, model.njoints)]
        self.link_of_joint: Ints = np.array([-1, 0, *np.cumsum(columns)], dtype=np.int64)
        rows = sum(columns) + 1
        self.link_axes: list[Floats] = [np.eye(3), np.eye(3)]
        parent, kind, first, body, turning, column = np.zeros((6, rows), dtype=np.int64)
        A, b, axes = np.zeros((rows, 9)), np.zeros((rows, 3)), np.zeros((rows, 9))
        moments, inertia, mass, pitch, offset = (np.zeros((rows, k)) for k in (3, 6, 1, 1, 1))
        ratio, armature = np.ones((rows, 1)), np.zeros((rows, 1))
        A[0] = axes[0] = np.eye(3).ravel()
        body[0] = 1
        followers, leaders = [], []
        for j in range(2, model.njoints):
            h, i = int(self.link_of_joint[model.parents[j]]), int(self.link_of_joint[j - 1]) + 1
            turn, before = self.link_axes[model.parents[j]], model.jointPlacements[j]
            count = columns[j - 2]
            own = slice(i, i + count)
            column[own] = np.arange(model.idx_vs[j], model.idx_vs[j] + count) - BASE_NV + 1
            if j in couplings:
                ratio[i], offset[i] = couplings[j].ratio, couplings[j].offset
                leaders.append(int(self.link_of_joint[couplings[j].leader]))
                followers.append(i)
                steps: Iterable[_Step] = [_Step(couplings[j].kind, couplings[j].axis, self.nq + len(followers) - 1)]
            else:
                armature[own] = model.armature[model.idx_vs[j] :][:count, None]
                steps = _steps(model.joints[j])
            for step in steps:
                placement, z_axis = before * step.placement, turn_z_to(step.axis)
                A[i], b[i] = (turn.T @ placement.rotation @ z_axis).ravel(order="F"), turn.T @ placement.translation
                first[i], pitch[i] = step.first, step.pitch
                turn, before = z_axis, pin.SE3.Identity()
                for k in range(COLUMNS[step.kind]):
                    parent[i], kind[i] = h, step.kind if k == 0 else SAME_JOINT
                    h, i = i, i + 1
            body[own], axes[own] = j, turn.ravel(order="F")
            turning[own] = count == 1 and kind[i - 1] in (REVOLUTE, CONTINUOUS)
            self.link_axes.append(turn)
        for j in range(1, model.njoints):
            i, turn = int(self.link_of_joint[j]), self.link_axes[j]
            body_inertia = model.inertias[j]
            mass[i], moments[i] = body_inertia.mass, turn.T @ (body_inertia.mass * body_inertia.lever)
            inertia[i] = (turn.T @ body_inertia.matrix()[3:, 3:] @ turn)[np.tril_indices(3)]
        link_of = np.zeros(self.nv - BASE_NV, dtype=np.int64)
        leading = np.setdiff1d(np.arange(1, rows), followers)
        link_of[column[leading] - 1] = leading
        self.links = Joints(
            parent,
            kind,
            first,
            body,
            turning,
            column,
            link_of,
            np.array(followers, dtype=np.int64),
            np.array(leaders, dtype=np.int64),
            A,
            b,
            moments,
            inertia,
            mass,
            armature,
            pitch,
            ratio,
            offset,
            axes,
        )
        self.own_kinematics = UNKNOWN not in kind
        self.free = FreeJoints(model, couplings) if couplings else None

    @property
    def n_joints(self) -> int:
        """Degrees of freedom of the joints, n = nv − 6."""
        return self.nv - BASE_NV

    @cached_property
    def total_mass(self) -> float:
        """Mass of all links, kg."""
        return float(sum(inertia.mass for inertia in self.model.inertias))

    @property
    def scratch(self) -> PinocchioPass:
        """Pinocchio's working memory of this thread: overwritten by every state that is made."""
        local = self.local
        if not hasattr(local, "scratch"):
            nowhere = self.with_points((), (), np.zeros(0, dtype=np.int64))
            local.scratch = PinocchioPass(self.model, lay_out(nowhere, self.nq), self.free)
        scratch: PinocchioPass = local.scratch
        return scratch

    @property
    def data(self) -> pin.Data:
        """Pinocchio's working memory for `model` on this thread; `scratch` has that of the free joints."""
        if self.free is None:
            return self.scratch.data
        local = self.local
        if not hasattr(local, "data"):
            local.data = self.model.createData()
        return local.data

    def joint_of_link(self, i: int) -> str:
        """Return the name of the joint by which link `i` of the recursions hangs."""
        return str(self.model.names[int(self.links.body[i])])

    @cached_property
    def frame_names(self) -> list[str]:
        """Names of all frames that can carry an operational point, links first."""
        carried = sorted(self._carried_frames, key=lambda frame: frame.type != pin.FrameType.BODY)
        return list(dict.fromkeys(frame.name for frame in carried))

    def frame(self, name: str) -> pin.Frame:
        """Return a frame that can carry an operational point; raises `OspaceError` if unknown or in several places."""
        named = [one for one in self._carried_frames if one.name == name]
        if not named:
            raise OspaceError(f"robot '{self.name}' has no frame '{name}'{closest(str(name), self.frame_names)}")
        first = named[0]
        if any(one.parentJoint != first.parentJoint or one.placement != first.placement for one in named):
            raise OspaceError(
                f"frame '{name}' of robot '{self.name}' is ambiguous: {len(named)} links or joints of that name "
                f"lie in different places; rename one of them in the URDF"
            )
        return first

    @cached_property
    def _carried_frames(self) -> list[pin.Frame]:
        """All frames but those of the universe and of the free-flyer, whose names a link or joint may bear as well."""
        frames = [frame for frame in self.model.frames if frame.parentJoint > 0]
        return [frame for frame in frames if frame.parentJoint > 1 or frame.type != pin.FrameType.JOINT]

    def with_points(self, joints: Sequence[int], positions: Sequence[Floats], rows: Ints) -> Robot:
        """Lay out points for `ospace.kernels.workspace`.

        Parameters
        ----------
        joints : sequence of int
            Pinocchio joint that carries each point.
        positions : sequence of (3,) arrays
            Each point in that joint's frame, m.
        rows : (r,)
            Rows taken, out of six for each point.
        """
        return Robot(self.links, self._nodes(joints, positions), rows, np.zeros(1, dtype=np.int64))

    def _nodes(self, joints: Sequence[int], positions: Sequence[Floats]) -> Nodes:
        """Find the junctions, and number base, junctions and points from the base outward."""
        links = [int(self.link_of_joint[j]) for j in joints]
        parent = self.links.parent
        rows = len(parent)
        ways = np.zeros(rows, dtype=np.int64)  # ways to points that meet in a link: its own points, and its branches
        reached = np.zeros(rows, dtype=bool)
        for link in links:
            ways[link] += 1
            while link > 0 and not reached[link]:
                reached[link] = True
                ways[parent[link]] += 1
                link = int(parent[link])
        junctions = [(i, -1) for i in range(1, rows) if ways[i] >= 2]
        ordered = sorted([*junctions, *((link, e) for e, link in enumerate(links))])

        node_at, of_link = {0: 0}, np.zeros(rows, dtype=np.int64)
        up, link_of, point = [0], [0], [-1]
        offset = [np.zeros(3)]
        for link, e in ordered:
            own = node_at.get(link)
            i = link
            while own is None and i not in node_at:
                of_link[i] = len(up)
                i = int(parent[i])
            up.append(node_at[i] if own is None else own)
            link_of.append(link)
            point.append(e)
            offset.append(np.zeros(3) if e < 0 else self.link_axes[joints[e]].T @ positions[e])
            if e < 0:
                node_at[link] = len(up) - 1
        last = [len(up) if e >= 0 else 0 for e in point]
        for n, h in enumerate(up):
            last[h] = max(last[h], n)
        return Nodes(np.array(up), np.array(link_of), np.array(point), np.array(last), of_link, np.array(offset))


def _steps(joint: pin.JointModel) -> Iterator[_Step]:
    """Take a joint apart into elementary ones, whose frames follow each other."""
    name, q = joint.shortname().removeprefix("JointModel"), int(joint.idx_q)
    if name in _ONE_COLUMN:
        kind = _ONE_COLUMN[name]
        yield _Step(kind, joint_axis(joint), q, float(_extracted(joint).pitch) if kind == HELICAL else 0.0)
    elif name in _ALONG_LINK_AXES:
        yield _Step(_ALONG_LINK_AXES[name], _Z, q)
    elif name == "Translation":
        yield from (_Step(PRISMATIC, axis, q + k) for k, axis in enumerate((_X, _Y, _Z)))
    elif name == "SphericalZYX":
        yield from (_Step(REVOLUTE, axis, q + k) for k, axis in enumerate((_Z, _Y, _X)))
    elif name == "Universal":
        axes = np.asarray(_extracted(joint).axis1), np.asarray(_extracted(joint).axis2)
        yield from (_Step(REVOLUTE, axis, q + k) for k, axis in enumerate(axes))
    elif name == "Composite":
        composite = _extracted(joint)
        for one, placement in zip(composite.joints, composite.jointPlacements, strict=True):
            first, *others = _steps(one)
            yield first._replace(placement=placement * first.placement)
            yield from others
    else:
        yield from (_Step(UNKNOWN, _Z, q) for _ in range(joint.nv))


def _extracted(joint: pin.JointModel) -> pin.JointModel:
    """Return the joint as its own type, which has the attributes of that type."""
    return joint.extract() if hasattr(joint, "extract") else joint


def turn_z_to(axis: Floats) -> Floats:
    """Return a rotation whose third column is along `axis`; the unit matrix for z."""
    axis = axis / np.linalg.norm(axis)
    x = np.eye(3)[np.argmin(np.abs(axis))]
    x = x - (x @ axis) * axis
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])

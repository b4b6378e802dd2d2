"""A robot laid out for kernels that do their own kinematics: link frames whose third axis is the joint's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from ospace.joint_axis import joint_axis
from ospace.kernels.kinematics import CONTINUOUS, PRISMATIC, REVOLUTE, Joints
from ospace.kernels.memory import Robot
from ospace.kernels.propagated import Nodes
from ospace.kernels.tables import Floats, Ints, Links

if TYPE_CHECKING:
    from ospace.points import PointSet
    from ospace.robot import SpaceRobot

_REVOLUTE = ("RX", "RY", "RZ", "RevoluteUnaligned")
_CONTINUOUS = ("RUBX", "RUBY", "RUBZ", "RevoluteUnboundedUnaligned")
_PRISMATIC = ("PX", "PY", "PZ", "PrismaticUnaligned")


class LinkFrames(NamedTuple):
    """A robot in such frames."""

    joints: Joints
    axes: Sequence[Floats]
    """(3, 3) of each Pinocchio joint: the link's axes in the joint's."""


def link_frames(model: pin.Model, links: Links) -> LinkFrames | None:
    """Lay out a model; None where a joint is neither revolute, continuous nor prismatic."""
    kinds = _kinds(model)
    if kinds is None:
        return None
    axes = [np.eye(3), np.eye(3)] + [_turn_z_to(joint_axis(joint)) for joint in list(model.joints)[2:]]
    return LinkFrames(_joints(model, links, kinds, axes), axes)


def flatten(robot: SpaceRobot, given: PointSet) -> Robot | None:
    """Lay out `robot` and points for `ospace.kernels.evaluation`; None as in `link_frames`."""
    frames = robot.link_frames
    if frames is None:
        return None
    nodes = _nodes(robot.links.parent, given, frames.axes)
    return Robot(frames.joints, nodes, given.rows, np.zeros(1, dtype=np.int64))


def _kinds(model: pin.Model) -> list[int] | None:
    kinds = dict.fromkeys(_REVOLUTE, REVOLUTE)
    kinds |= dict.fromkeys(_CONTINUOUS, CONTINUOUS) | dict.fromkeys(_PRISMATIC, PRISMATIC)
    names = [joint.shortname().removeprefix("JointModel") for joint in list(model.joints)[2:]]
    return [kinds[name] for name in names] if all(name in kinds for name in names) else None


def _turn_z_to(axis: Floats) -> Floats:
    """Return a rotation whose third column is along `axis`."""
    axis = axis / np.linalg.norm(axis)
    aside = np.eye(3)[np.argmin(np.abs(axis))]
    x = np.cross(aside, axis)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(axis, x), axis])


def _joints(model: pin.Model, links: Links, kinds: Sequence[int], axes: Sequence[Floats]) -> Joints:
    rows = len(links.parent)
    A, b = np.zeros((rows, 9)), np.zeros((rows, 3))
    com, inertia = np.zeros((rows, 3)), np.zeros((rows, 6))
    first = np.zeros(rows, dtype=np.int64)
    for j in range(1, model.njoints):
        i = j - 1  # each joint behind the base has one column
        if j > 1:
            placement, turn = model.jointPlacements[j], axes[model.parents[j]]
            A[i] = (turn.T @ placement.rotation @ axes[j]).ravel(order="F")
            b[i] = turn.T @ placement.translation
            first[i] = model.idx_qs[j]
        com[i] = axes[j].T @ model.inertias[j].lever
        inertia[i] = (axes[j].T @ model.inertias[j].inertia @ axes[j])[np.tril_indices(3)]
    mass = np.column_stack([links.mass, links.armature])
    return Joints(links.parent, np.array([0, *kinds]), first, A, b, com, inertia, mass)


def _nodes(parent: Ints, given: PointSet, axes: Sequence[Floats]) -> Nodes:
    """Find the junctions, and number base, junctions and points from the base outward."""
    rows = len(parent)
    links = [int(link) for link in given.table.link]
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
        offset.append(np.zeros(3) if e < 0 else axes[given.points[e].joint].T @ given.points[e].placement.translation)
        if e < 0:
            node_at[link] = len(up) - 1
    until = [len(up) if e >= 0 else 0 for e in point]
    for n, h in enumerate(up):
        until[h] = max(until[h], n)
    return Nodes(np.array(up), np.array(link_of), np.array(point), np.array(offset), np.array(until), of_link)

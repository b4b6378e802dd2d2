"""Geometry of a robot for collision: the solids of its links on the joints that carry them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import coal
import pinocchio as pin

from ospace.checks import check_kind
from ospace.collision.shapes import shapes_that_count, solids_of
from ospace.exceptions import OspaceError
from ospace.model.robot import SpaceRobot
from ospace.urdf.lint.meshes import MeshError


class Solid(NamedTuple):
    """A convex solid on a joint.

    Attributes
    ----------
    link : str
        Whose shape it is.
    joint : int
        Pinocchio's number of the joint that carries it.
    placement : pin.SE3
        In the joint's frame, m.
    geometry : coal.CollisionGeometry
    """

    link: str
    joint: int
    placement: pin.SE3
    geometry: coal.CollisionGeometry


class CollisionGeometry:
    """Solids of the links of a robot.

    Make one with `of`.

    Attributes
    ----------
    robot : SpaceRobot
    solids : tuple of Solid
    visual : tuple of str
        Links of which the <visual> shapes count, since they have no <collision>.
    unread : mapping of link name to str
        Links with a mesh that cannot be read, and why.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        solids: tuple[Solid, ...],
        visual: tuple[str, ...],
        unread: Mapping[str, str],
        first: SpaceRobot | None = None,
    ) -> None:
        self.robot, self.solids, self.visual, self.unread = robot, solids, visual, unread
        self._first = first or robot

    @classmethod
    def of(cls, robot: SpaceRobot) -> CollisionGeometry:
        """Return the geometry of a robot that was read from a file; its shapes are read once.

        Parameters
        ----------
        robot : SpaceRobot

        Returns
        -------
        CollisionGeometry
            <collision> shapes, or the <visual> ones of links that have none.

        Raises
        ------
        OspaceError
            The robot was made of a model, which has no shapes.
        """
        check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
        known = _KNOWN.get(robot)
        if known is None:
            known = _KNOWN[robot] = _read(robot)
        return cls(robot, *known)

    @property
    def links(self) -> list[str]:
        """Links that have a solid, from the base outward."""
        return list(dict.fromkeys(solid.link for solid in self.solids))

    @property
    def joint_of(self) -> dict[str, int]:
        """Pinocchio's number of the joint that carries each of these links."""
        return {solid.link: solid.joint for solid in self.solids}

    def on(self, robot: SpaceRobot) -> CollisionGeometry:
        """Return the same solids on another robot that has these joints, as one with other masses or with a load has.

        Parameters
        ----------
        robot : SpaceRobot

        Returns
        -------
        CollisionGeometry
            What the other robot has beside these joints, such as a target that it holds, has no solids.
        """
        if robot is self.robot:
            return self
        names, known = self.robot.model.names, robot.model
        solids = tuple(one._replace(joint=int(known.getJointId(names[one.joint]))) for one in self.solids)
        return CollisionGeometry(robot, solids, self.visual, self.unread, self._first)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by reading it again: solids of Coal are not pickled."""
        return _again, (self._first, self.robot)


def _again(first: SpaceRobot, robot: SpaceRobot) -> CollisionGeometry:
    return CollisionGeometry.of(first).on(robot)


_Shapes = tuple[tuple[Solid, ...], tuple[str, ...], dict[str, str]]
_KNOWN: WeakKeyDictionary[SpaceRobot, _Shapes] = WeakKeyDictionary()
"""Solids, links of which <visual> shapes count, and what is unread; nothing of these holds the robot."""


def _read(robot: SpaceRobot) -> _Shapes:
    description, urdf = robot.description, robot.source
    if description is None or urdf is None:
        raise OspaceError(
            f"robot '{robot.name}' was made of a model, which has no shapes: read it with SpaceRobot.from_urdf(path)"
        )
    solids, visual, unread = [], [], {}
    for frame in robot.model.frames:
        if frame.type != pin.FrameType.BODY or frame.parentJoint == 0:
            continue
        link = description.link[frame.name]
        shapes = shapes_that_count(link)
        if shapes and shapes[0].role == "visual":
            visual.append(link.name)
        for shape in shapes:
            try:
                for geometry, T in solids_of(shape, urdf, robot.package_dirs):
                    solids.append(Solid(link.name, int(frame.parentJoint), frame.placement * T, geometry))
            except (MeshError, ValueError) as error:
                unread[link.name] = str(error)
    return tuple(solids), tuple(visual), unread

"""Placements of all links by yourdfpy, a reader of URDFs that shares no code with Pinocchio."""

from __future__ import annotations

import io
import logging
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pinocchio as pin
import yourdfpy

from ospace.exceptions import OspaceError
from ospace.kernels.tables import Floats
from ospace.robot import SpaceRobot
from ospace.urdf.build import to_xml
from ospace.urdf.description import Description
from ospace.validation.sampling import random_state

_MOVED = ("revolute", "continuous", "prismatic", "fixed")


class IndependentReader:
    """The robot as yourdfpy reads what Pinocchio read.

    Raises
    ------
    OspaceError
        The robot was not read from a file, or yourdfpy rejects it.
    """

    def __init__(self, robot: SpaceRobot) -> None:
        if robot.description is None:
            raise OspaceError(f"robot '{robot.name}' was not read from a URDF")
        self.robot = robot
        self._urdf = _load(robot.description)
        self._parents = {joint.child: joint for joint in self._urdf.joint_map.values()}
        self.links = [link for link in self._urdf.link_map if self._moved(link)]

    def _moved(self, link: str) -> bool:
        """Whether yourdfpy moves all joints on the way from the base to `link`; it leaves planar and floating ones."""
        while link in self._parents:
            if self._parents[link].type not in _MOVED:
                return False
            link = self._parents[link].parent
        return True

    def compare(self, rng: np.random.Generator) -> float:
        """Return the largest difference of a link's placement in the base, over the size of the robot."""
        robot = self.robot
        positions = robot.joint_positions(random_state(robot, rng).q)
        data = robot.scratch.data
        pin.framesForwardKinematics(robot.model, data, robot.configuration(positions))
        base = data.oMi[1].inverse()
        angles = {name: value for name, value in positions.items() if isinstance(value, float)}
        with _quiet():
            self._urdf.update_cfg({name: angles[name] for name in self._urdf.actuated_joint_names if name in angles})
        apart, size = 0.0, 1.0
        for link in self.links:
            ours = (base * data.oMf[robot.model.getFrameId(link, pin.FrameType.BODY)]).homogeneous
            theirs: Floats = self._urdf.get_transform(link, self._urdf.base_link)
            apart = max(apart, float(np.abs(ours - theirs).max()))
            size = max(size, float(np.abs(theirs).max()))
        return apart / size


def _load(description: Description) -> yourdfpy.URDF:
    text = io.BytesIO(to_xml(description).encode())
    with _quiet():
        try:
            return yourdfpy.URDF.load(text, build_scene_graph=True, load_meshes=False, load_collision_meshes=False)
        except Exception as error:  # yourdfpy lets any error of its parts through
            raise OspaceError(f"yourdfpy rejects it: {type(error).__name__}: {error}") from error


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep yourdfpy's log, which goes to the screen, out of the user's table."""
    log = logging.getLogger("yourdfpy.urdf")
    before, log.disabled = log.disabled, True
    try:
        yield
    finally:
        log.disabled = before

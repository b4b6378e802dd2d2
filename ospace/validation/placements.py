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
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import from_q
from ospace.model.robot import SpaceRobot
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
        # Each link as seen from the one it hangs from: where all of these agree, the links agree in the base.
        self._pairs = [(joint.parent, joint.child) for joint in self._urdf.joint_map.values() if joint.type in _MOVED]

    @property
    def compared(self) -> int:
        """Links whose placements are compared; yourdfpy does not move planar and floating joints."""
        return 1 + len(self._pairs)

    def compare(self, rng: np.random.Generator) -> float:
        """Return the largest difference of a link's placement, over the distance from the link it hangs from."""
        robot = self.robot
        q, data = random_state(robot, rng).q, robot.data
        pin.framesForwardKinematics(robot.model, data, q)
        angles = self._angles(q)
        with _quiet():
            self._urdf.update_cfg({name: angles[name] for name in self._urdf.actuated_joint_names if name in angles})
        worst = 0.0
        for parent, child in self._pairs:
            above, below = (data.oMf[robot.model.getFrameId(link, pin.FrameType.BODY)] for link in (parent, child))
            ours = (above.inverse() * below).homogeneous
            theirs: Floats = self._urdf.get_transform(child, parent)
            worst = max(worst, float(np.abs(ours - theirs).max()) / max(1.0, float(np.abs(theirs).max())))
        return worst

    def _angles(self, q: Floats) -> dict[str, float]:
        """Return the positions of joints with one coordinate: followers too, which are free joints to yourdfpy."""
        free = self.robot.free
        model, all_q = (self.robot.model, q) if free is None else (free.model, free.configuration(q))
        at = {
            str(model.names[j]): from_q(model.joints[j], all_q[model.idx_qs[j] :][: model.nqs[j]])
            for j in range(2, model.njoints)
        }
        return {name: position for name, position in at.items() if isinstance(position, float)}


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

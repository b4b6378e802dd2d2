"""The robot as a controller knows it, whose masses are not quite those of the robot."""

from __future__ import annotations

from collections.abc import Sequence

import pinocchio as pin

from ospace.model.robot import SpaceRobot
from ospace.scenario.schema import MassErrorTable


def believed(robot: SpaceRobot, errors: Sequence[MassErrorTable]) -> SpaceRobot:
    """Return a robot of the same joints and frames with other masses; the robot itself where there are no errors.

    Raises
    ------
    OspaceError
        A link is unknown, or the masses make no physical sense.
    """
    if not errors:
        return robot
    model = pin.Model(robot.model)
    for one in errors:
        if one.link is None:
            joints, shift = range(1, model.njoints), one.mass_centre
        else:
            frame = robot.frame(one.link)
            joints, shift = range(frame.parentJoint, frame.parentJoint + 1), frame.placement.rotation @ one.mass_centre
        tensor = 1.0 + (one.mass if one.inertia is None else one.inertia)
        for j in joints:
            own = model.inertias[j]
            model.inertias[j] = pin.Inertia((1.0 + one.mass) * own.mass, own.lever + shift, tensor * own.inertia)
    return SpaceRobot.from_model(model)

"""The option --pose: joint positions by name."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ospace.model.robot import SpaceRobot


def joint_values(text: str, robot: SpaceRobot) -> dict[str, float]:
    """Read joint positions, as ``name=value,name=value``; raise `OspaceError` where they are none."""
    from ospace.exceptions import OspaceError

    positions: dict[str, float] = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        name, equals, value = (piece.strip() for piece in part.rpartition("="))
        if not equals or not name:
            raise OspaceError(
                f"--pose '{part}': write joint=value, such as {robot.joint_names[0]}=0.5"
                if robot.joint_names
                else f"--pose '{part}': robot '{robot.name}' has no joint"
            )
        if name in positions:
            raise OspaceError(f"--pose '{part}': joint '{name}' is given twice")
        positions[name] = position(robot, f"--pose '{part}'", name, value)
    return positions


def position(robot: SpaceRobot, option: str, name: str, value: str) -> float:
    """Read a position of a joint, with a unit or in rad or m; the message of an `OspaceError` begins with `option`."""
    from ospace.exceptions import OspaceError
    from ospace.model.joint_positions import in_si

    try:
        return float(value)
    except ValueError:
        joint = robot.model.joints[robot.joint_number(name)]
    try:
        return float(in_si(joint, name, value))
    except OspaceError as error:
        raise OspaceError(f"{option}: {error}") from None

"""Targets that the robot holds, one grasped after the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.simulation import Grasp


@dataclass(frozen=True, eq=False)
class Hold:
    """A target in the hand of the robot.

    Attributes
    ----------
    target : str
        Its name.
    grasp : Grasp
    before, known_before : SpaceRobot
        The robot before the grasp, with what it held by then; and as its controller knew it.
    frames : mapping of str to str
        Names of the target's frames in the combined robot, by their own.
    """

    target: str
    grasp: Grasp
    before: SpaceRobot
    known_before: SpaceRobot
    frames: Mapping[str, str]


def frames_when_held(target: SpaceRobot, robot: SpaceRobot) -> dict[str, str]:
    """Return the names that frames of a target get when the robot grasps it, by their own."""
    taken = set(robot.frame_names)
    return {name: f"{target.name}/{name}" if name in taken else name for name in target.frame_names}


def parts(holds: Sequence[Hold], q: Floats, v: Floats) -> tuple[State, dict[str, State]]:
    """Return the states of the chaser and of each target that it holds, by name; there is one or more."""
    targets: dict[str, State] = {}
    for hold in reversed(holds):
        chaser, targets[hold.target] = hold.grasp.release(q, v)
        q, v = chaser.q, chaser.v
    return chaser, targets

"""Reach and reaction of the hands of a robot in a few words, for a report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ospace.analysis.arm import default_arm
from ospace.analysis.arm_map import map_arm
from ospace.analysis.map_result import MapResult
from ospace.analysis.workspace_shells import workspaces
from ospace.exceptions import OspaceError
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot

WHAT = ("reach", "singularity", "base-turn", "wheels")
POSTURES, _STARTS, _MOST = 2000, 60, 4
"""Random postures and searches for singular ones of each hand; hands."""


@dataclass(frozen=True)
class Overview:
    """Map of a hand, or why there is none.

    Attributes
    ----------
    frame : str
        Of the hand.
    result : MapResult or None
    reason : str
        Why there is none.
    """

    frame: str
    result: MapResult | None
    reason: str = ""


def overviews(
    robot: SpaceRobot,
    points: Sequence[OperationalPoint],
    *,
    seed: int = 0,
    progress: Callable[[int], None] | None = None,
) -> list[Overview]:
    """Map the first four points that joints carry.

    Parameters
    ----------
    robot : SpaceRobot
    points : sequence of OperationalPoint
    seed : int
        Of random postures.
    progress : function, optional
        Called with the number of points that are done; it may raise.

    Returns
    -------
    list of Overview
    """
    found = []
    for point in hands_of(points):
        try:
            arm = default_arm(robot, point)
            mapped = map_arm(arm, WHAT, random=POSTURES, seed=seed)
            shells = workspaces(arm, starts=_STARTS, seed=seed)
            found.append(Overview(point.frame, MapResult(mapped, shells, None, POSTURES, f"random, seed {seed}")))
        except OspaceError as error:
            found.append(Overview(point.frame, None, str(error)))
        if progress is not None:
            progress(len(found))
    return found


def hands_of(points: Sequence[OperationalPoint]) -> list[OperationalPoint]:
    """Return the points that `overviews` maps: the first four that joints carry."""
    return [point for point in points if point.joint > 1][:_MOST]

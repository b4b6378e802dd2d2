"""Clearance of a scenario's phases: the robot's links from each other, and from the target while it moves by itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ospace.collision import CollisionGeometry
from ospace.control import Clearance, Obstacle
from ospace.control.clearance import link_name
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.scenario.motion import FreeMotion
from ospace.scenario.schema import GraspTable, PhaseTable, Scenario
from ospace.scenario.table import Problem

_Motion = Callable[[float], tuple[Floats, Floats]]


def clearances(
    scenario: Scenario, plan: PhaseTable, robot: SpaceRobot, targets: Mapping[str, FreeMotion], period: float
) -> list[Clearance]:
    """Return the clearance of a phase, if the scenario has one.

    Parameters
    ----------
    scenario : Scenario
    plan : PhaseTable
        Where it ends by a grasp, the body of the hand and all beyond it may touch that target.
    robot : SpaceRobot
        The chaser, as its controller knows it, or chaser and what it holds; of that the chaser's links count.
    targets : mapping of str to FreeMotion
        Those that move by themselves.
    period : float
        Of the cycles of control, s.

    Raises
    ------
    OspaceError
        A link is unknown, or a shape cannot be read.
    """
    limits = scenario.limits
    if limits.clearance is None:
        return []
    geometry = CollisionGeometry.of(scenario.robot).on(robot)
    obstacles = {name: _obstacle(scenario, name, _AtCycles(one, period)) for name, one in targets.items()}
    links = {name: _links(one, scenario.robot) for name, one in obstacles.items()}
    known = {*scenario.robot.frame_names, *(link for names in links.values() for link in names)}
    ignored = [pair for pair in limits.may_touch if len(targets) == len(scenario.targets) or known.issuperset(pair)]
    made = Clearance(
        robot=robot, distance=limits.clearance, obstacles=list(obstacles.values()), ignore=ignored, geometry=geometry
    )
    if plan.grasp is None:
        return [made]
    touched = links[scenario.target_named(plan.grasp.target)]
    touching = [(a, b) for a in _beyond(made, plan.grasp) for b in touched]
    return [replace(made, ignore=(*ignored, *touching))]


def problems(scenario: Scenario) -> Iterator[Problem]:
    """Yield what a clearance cannot be made of."""
    if scenario.limits.clearance is None:
        return
    robot = scenario.robot
    try:
        obstacles = [_obstacle(scenario, name, _nowhere) for name in scenario.targets]
        Clearance(
            robot=robot, distance=scenario.limits.clearance, obstacles=obstacles, ignore=scenario.limits.may_touch
        )
    except OspaceError as error:
        where = "may_touch" if str(error).startswith("clearance: ignore") else "clearance"
        yield scenario.limits.path(where), str(error).removeprefix("clearance: ").replace("ignore: ", "")


class _AtCycles:
    """Motion of a target at cycles."""

    def __init__(self, target: FreeMotion, period: float) -> None:
        self._target, self._period = target, period

    def __call__(self, time: float) -> tuple[Floats, Floats]:
        cycle = round(time / self._period)
        q, v = self._target.states(cycle, cycle + 1)
        return q[0], v[0]


def _obstacle(scenario: Scenario, name: str, motion: _Motion) -> Obstacle:
    """Return a target as an obstacle; where there are several, its links bear its name."""
    return Obstacle(scenario.targets[name].robot, motion, name if len(scenario.targets) > 1 else "")


def _nowhere(time: float) -> Any:
    raise AssertionError("a motion that no cycle asks for")


def _links(obstacle: Obstacle, robot: SpaceRobot) -> list[str]:
    """Return what the links of a target are called beside the robot."""
    return [link_name(obstacle, link, robot.frame_names) for link in CollisionGeometry.of(obstacle.robot).links]


def _beyond(clearance: Clearance, plan: GraspTable) -> Sequence[str]:
    """Return links of the body that carries the hand, and of all that hang from it."""
    model = clearance.robot.model
    carrier = model.frames[model.getFrameId(plan.hand)].parentJoint
    joint_of = clearance.geometry.joint_of
    return [link for link, joint in joint_of.items() if carrier in model.supports[joint]]

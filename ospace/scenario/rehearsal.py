"""Try the phases of a scenario without a simulation, and report all that cannot run.

First by names: frames of the robot that each phase will have, and whether the target moves by itself. Where nothing is
wrong so far, each phase's controller is made. Last by times: a phase ends between the sum of the shortest times of the
phases and the sum of their time-outs, and what cannot be reached at any moment between, wherever the arm may be, is
refused; what cannot be excluded is left to the run.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Generator, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from ospace.control import Controller, Task
from ospace.exceptions import OspaceError, closest
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario import clearance
from ospace.scenario.mass_errors import believed
from ospace.scenario.reach import Region, apart, mass_centre, of_target, reached
from ospace.scenario.schema import (
    ROBOT,
    TARGET,
    DisturbanceTable,
    Follow,
    GraspTable,
    Hold,
    MassErrorTable,
    PhaseTable,
    PluginTable,
    Scenario,
    Shift,
    TaskTable,
    ToMomentum,
    ToPose,
    Via,
)
from ospace.scenario.table import Problem
from ospace.simulation import Grasp, grasp

_LINEAR = (0, 1, 2)
_ROUNDING = 1e-6
_PLACED = ("pose", "position")
"""Types of tasks whose goal is a place of a point in the inertial frame."""


def rehearse(scenario: Scenario, problems: list[Problem], named: Collection[str] | None) -> None:
    """Report what cannot be made or reached, phase by phase with the robot that it will have.

    Parameters
    ----------
    scenario : Scenario
        Where there are problems already, it may be incomplete; names are checked all the same.
    problems : list of (key, what)
        Takes what is found.
    named : collection of str, optional
        Names of the targets that the file has, also of those that could not be made, of which nothing is said; None
        where these are not known.
    """
    problems += scenario.limits.accelerations(scenario.robot)[1]
    problems += scenario.noise.unknown_joints(scenario.robot)
    problems += clearance.problems(scenario)
    problems += _misplaced(scenario, named)
    problems += _unbelievable(scenario, named)
    robots = list(_Names(scenario, problems, named).robots())
    if problems:
        return
    for phase, robot in zip(scenario.phases, robots, strict=True):
        try:
            limits = scenario.limits.of(robot, scenario.robot)
            tasks = [task.task(robot) for task in phase.tasks]
            inequalities = [one.make(robot) for one in phase.inequalities]
            if tasks:
                Controller(
                    robot,
                    tasks,
                    base=scenario.base,
                    limits=limits,
                    inequalities=inequalities,
                    **scenario.control.settings,
                )
        except OspaceError as error:
            problems.append((phase.key, str(error)))
    if problems:
        return
    reach = _Reach(scenario, problems)
    for phase, robot in zip(scenario.phases, robots, strict=True):
        reach.phase(phase, robot)


def _misplaced(scenario: Scenario, named: Collection[str] | None) -> Iterator[Problem]:
    """Yield the disturbances that act on a frame that nothing has."""
    for one in scenario.disturbances:
        robot = yield from _whose(one, scenario, named)
        if robot is not None:
            yield from _unknown_frame(one.path("point"), one.point, robot.name, robot.frame_names)


def _unbelievable(scenario: Scenario, named: Collection[str] | None) -> Iterator[Problem]:
    """Yield the errors of masses of links that nothing has, and those that leave no body."""
    for one in scenario.mass_errors:
        robot = yield from _whose(one, scenario, named)
        if robot is None:
            continue
        unknown = list(_unknown_frame(one.path("link"), one.link or "", robot.name, robot.frame_names))
        yield from unknown
        if unknown or list(one.problems()):
            continue
        try:
            believed(robot, [one])
        except OspaceError as error:
            yield one.key, str(error)


def _whose(
    table: DisturbanceTable | MassErrorTable, scenario: Scenario, named: Collection[str] | None
) -> Generator[Problem, None, SpaceRobot | None]:
    """Return the robot whose frame a table means, where it is known; yield that there is none of the name."""
    if table.of == ROBOT:
        return scenario.robot
    if table.of and named is not None and table.of not in named:
        names = (ROBOT, *named)
        what = "there is no target: give a table [target]" if not named and table.of == TARGET else ""
        yield table.path("of"), what or f"'{table.of}' is unknown{closest(table.of, names)}"
    target = scenario.targets.get(table.of)
    return None if target is None else target.robot


def _unknown_frame(key: str, frame: str, robot: str, known: Iterable[str], where: str = "") -> Iterator[Problem]:
    """Yield a frame that the robot does not have."""
    if frame and frame not in known:
        yield key, f"no frame '{frame}' in robot '{robot}'{closest(frame, known)}{where}"


class _Robot(NamedTuple):
    """The robot of a phase, its state as it could be, and the names of frames that it may have."""

    robot: SpaceRobot
    state: State
    frames: Sequence[str]


class _Names:
    """Checks names of frames and joints, and that a target is there to be followed, grasped or let go."""

    def __init__(self, scenario: Scenario, problems: list[Problem], named: Collection[str] | None) -> None:
        self.scenario, self.problems, self.named = scenario, problems, named
        self._before: list[_Robot] = []  # each grasp
        self._held: list[str | None] = []  # names of targets, in the order of their grasps; None where one is unknown

    def robots(self) -> Iterator[SpaceRobot]:
        """Check the phases in their order, and yield the robot that each has; that before where it is not known."""
        chaser = self.scenario.robot
        now = _Robot(chaser, self.scenario.start, chaser.frame_names)
        for phase in self.scenario.phases:
            for task in phase.tasks:
                self._task(task, phase, now)
            for one in phase.inequalities:
                for key, frame in one.frames.items():
                    where = "" if one in phase.inequality else f" (phase '{phase.name}')"
                    self._frame(one.path(key), frame, now.robot.name, now.frames, where)
            yield now.robot
            if "grasp" in phase.model_fields_set:
                self._before.append(now)
                now = self._with_target(phase.grasp, now)
            elif phase.release:
                now = self._release(phase, now)

    def _with_target(self, table: GraspTable | None, now: _Robot) -> _Robot:
        """Check a grasp; return the robot after it."""
        name = None if table is None else self._target(table, "grasp", table.key)
        held = None if table is None else self._grasp(table, name, now)
        self._held.append(name)
        if held is not None:
            return _Robot(held.robot, held.state, held.robot.frame_names)
        target = self.scenario.targets.get(name or "")
        if target is None:
            return now
        names = target.robot.frame_names
        return now._replace(frames=(*now.frames, *names, *(f"{target.robot.name}/{one}" for one in names)))

    def _release(self, phase: PhaseTable, now: _Robot) -> _Robot:
        """Check that something is let go; return the robot without it."""
        key, name = phase.path("release"), phase.release
        if not self._held:
            self.problems.append((key, "nothing is held at the end of this phase"))
            return now
        last = self._held[-1]
        if isinstance(name, str) and None not in (last, self.named) and name != last:
            first = f"is held, but '{last}' was grasped after it: let that go first"
            self.problems.append((key, f"'{name}' {first if name in self._held else 'is not held'}"))
        self._held.pop()
        return self._before.pop()

    def _target(self, table: Follow | GraspTable, what: str, key: str) -> str | None:
        """Return the name of the target of a goal or grasp, which is not held; None where that is not known."""
        names, name = self.named, table.target
        if names is None:
            return name
        if name is None and len(names) == 1:
            (name,) = names
        if not names:
            self.problems.append((key, f"there is no target to {what}: give a table [target]"))
        elif name is None:
            known = " or ".join(f"'{one}'" for one in names)
            self.problems.append((key, f"there are several targets: give target as well, {known}"))
        elif name not in names:
            self.problems.append((table.path("target"), f"there is no target '{name}'{closest(name, names)}"))
        else:
            return name
        return None

    def _task(self, task: TaskTable, phase: PhaseTable, now: _Robot) -> None:
        robot = now.robot
        where = "" if phase.owns(task) else f" (phase '{phase.name}')"
        known = len(self.problems)
        for key, frame in task.frames.items():
            self._frame(task.path(key), frame, robot.name, now.frames, where)
        self.problems += task.postures(robot)[1]
        goal = task.followed
        if isinstance(goal, Follow):
            key = goal.path("follow")
            name = self._target(goal, "follow", key)
            target = self.scenario.targets.get(name or "")
            if name is not None and name in self._held:
                self.problems.append((key, f"the target is held already{where or f' in phase {phase.name!r}'}"))
            elif target is not None:
                self._frame(key, goal.follow, target.robot.name, target.robot.frame_names)
        if not self.problems[:known] and len(self.problems) == known:
            try:
                task.task(robot).rows(robot)
            except OspaceError as error:
                self.problems.append((task.key, str(error) + where))

    def _grasp(self, table: GraspTable, name: str | None, now: _Robot) -> Grasp | None:
        """Return the grasp as it could be, where it can be made."""
        known = len(self.problems)
        if name is not None and name in self._held:
            remedy = "leave out the grasp, and the task alone brings the hand there, or let go before: release = true"
            self.problems.append((table.key, f"the target is held already, and one hand holds a target: {remedy}"))
        self._frame(table.path("hand"), table.hand, self.scenario.robot.name, self.scenario.robot.frame_names)
        target = self.scenario.targets.get(name or "")
        if target is None:
            return None
        self._frame(table.path("fixture"), table.fixture, target.robot.name, target.robot.frame_names)
        if len(self.problems) > known or not (table.hand and table.fixture) or table.hand not in now.robot.frame_names:
            return None
        try:
            hand, fixture = now.robot.point(table.hand), target.robot.point(table.fixture)
            free = target.start
            q = free.q.copy()  # the target where it will be: at the hand
            there = now.state.placement(hand) * free.placement(fixture).inverse()
            q[:7] = pin.SE3ToXYZQUAT(there * target.robot.base_pose(q))
            return grasp(now.state, hand, target.robot.state(q, free.v), fixture)
        except OspaceError as error:
            self.problems.append((table.key, str(error)))
            return None

    def _frame(self, key: str, frame: str, robot: str, known: Iterable[str], where: str = "") -> None:
        self.problems += _unknown_frame(key, frame, robot, known, where)


class _Reach:
    """Goes through the phases of a scenario in their order.

    Parameters
    ----------
    scenario : Scenario
    problems : list of (key, what)
        Takes what cannot be reached.
    """

    def __init__(self, scenario: Scenario, problems: list[Problem]) -> None:
        self.scenario, self.problems = scenario, problems
        self._begins = self._ends = 0.0  # the earliest and the latest time, s
        start, pushed = scenario.start, scenario.disturbances_of(ROBOT)
        self._force = float(np.linalg.norm(scenario.base.limits[:3])) + _largest_force(pushed)
        inside = not scenario.robot.outside_limits(start.q)
        self._centre = mass_centre((start,), self._force) if inside else None  # else joints may slide to anywhere
        self._free = {
            name: target.start for name, target in scenario.targets.items()
        }  # by themselves from the start on
        self._held: list[State] = []
        self._known = True  # what is held, and nothing was let go
        self._rests = inside and not start.v.any() and not pushed
        self._first = True

    def phase(self, plan: PhaseTable, robot: SpaceRobot) -> None:
        """Note what cannot be reached in a phase, whose robot is `robot`, and go on to its end."""
        first, last, known = self._begins, self._ends + plan.timeout, len(self.problems)
        self._rests = self._rests and all(_stays(task) for task in plan.tasks)
        for task in plan.tasks:
            if task.completion is not None and math.isfinite(task.completion.position):
                self._task(plan, task, robot, first + plan.motion(task), last)
        if plan.grasp is not None and len(self.problems) == known:
            self._grasp(plan, plan.grasp, robot, first + plan.earliest, last)
        self._begins, self._ends, self._first = first + plan.earliest, last, False
        if plan.changes_robot:
            self._centre, self._rests = self._next_centre(plan), False

    def _next_centre(self, plan: PhaseTable) -> Region | None:
        """Return where the mass centre of the robot may be after a phase; unknown once something was let go."""
        if plan.grasp is None:
            self._known = False
            return None
        name = self.scenario.target_named(plan.grasp.target)
        state = self._free.pop(name, None)
        if state is None or not self._known or self._centre is None:
            self._known = False
            return None
        self._held.append(state)
        self._force += _largest_force(self.scenario.disturbances_of(name))
        return mass_centre((self.scenario.start, *self._held), self._force)

    # -- tasks -----------------------------------------------------------------------------------------------

    def _task(self, phase: PhaseTable, plan: TaskTable, robot: SpaceRobot, first: float, last: float) -> None:
        task, goal = plan.task(robot), plan.followed
        rows = tuple(row for row in task.rows(robot) if row in _LINEAR)
        if plan.completion is None or not rows or (task.own_axes and rows != _LINEAR):
            return
        near = plan.completion.position + _ROUNDING
        if plan.type == "relative_pose" and isinstance(goal, ToPose) and goal.position is not None:
            away, most = float(np.linalg.norm(goal.position)), apart(*task.points)
            if rows == _LINEAR and away - near > most:
                point, other = plan.frames["point"], plan.frames["seen_from"]
                what = f"is {away:.4g} m from '{other}', of which '{point}' is {most:.4g} m away at most"
                self._refuse(phase, plan, what)
            return
        if self._centre is None or plan.type not in _PLACED:
            return
        own = reached(task.points[0], self._centre)
        there = self._goal(plan, task)
        if there is not None:
            off = own.distance(there, first, last, rows)
            if off > near:
                self._refuse(phase, plan, f"{_out_of_reach(plan, off)} between {first:g} s and {last:g} s")
        elif isinstance(goal, Shift) and goal.about is None:
            wide = 2.0 * own.radius + float(np.linalg.norm(own.velocity)) * last
            off = float(np.linalg.norm(goal.shift[list(rows)])) - wide - (own.growth * last**2 if own.growth else 0.0)
            if off > near:
                self._refuse(phase, plan, _out_of_reach(plan, off))

    def _goal(self, plan: TaskTable, task: Task) -> Region | None:
        """Return where the goal of a task is, if that is known."""
        start, goal = self.scenario.start, plan.followed
        if isinstance(goal, Follow):
            name = self.scenario.target_named(goal.target)
            point = self.scenario.targets[name].robot.point(goal.follow, offset=goal.offset.pose)
            return self._of_target(name, point) if name in self._free else None
        if isinstance(goal, ToPose) and goal.position is not None:
            return Region.still(goal.position)
        if isinstance(goal, Via):
            given = [one.position for one in goal.via if one.position is not None]
            return Region.still(given[-1]) if given else None
        if isinstance(goal, Shift) and self._first:
            place = start.placement(task.points[0]).translation
            if goal.about is not None:
                place = goal.about + pin.exp3(goal.turn) @ (place - goal.about)
            return Region.still(place + goal.shift)
        return None

    def _of_target(self, name: str, point: OperationalPoint) -> Region:
        """Return where a point of a target may be, as it moves by itself."""
        state, pushed = self._free[name], self.scenario.disturbances_of(name)
        return reached(point, mass_centre((state,), _largest_force(pushed))) if pushed else of_target(state, point)

    def _refuse(self, phase: PhaseTable, plan: TaskTable, why: str) -> None:
        where = "" if phase.owns(plan) else f" (phase '{phase.name}')"
        self.problems.append((f"{plan.key}.goal", f"the goal {why}{where}"))

    # -- grasps ----------------------------------------------------------------------------------------------

    def _grasp(self, phase: PhaseTable, plan: GraspTable, robot: SpaceRobot, first: float, last: float) -> None:
        start, name = self.scenario.start, self.scenario.target_named(plan.target)
        target = self.scenario.targets[name].robot
        if any(self._ends_apart(phase, plan, task, robot, target) for task in phase.tasks) or name not in self._free:
            return
        hand, fixture = robot.point(plan.hand), target.point(plan.fixture)
        there, near = self._of_target(name, fixture), plan.position + _ROUNDING
        if self._centre is not None:
            off = reached(hand, self._centre).distance(there, first, last)
            if off > near:
                what = f"'{plan.fixture}' is at least {off:.3g} m out of reach of '{plan.hand}'"
                self.problems.append((f"{phase.key}.grasp", f"{what} between {first:g} s and {last:g} s"))
                return
        if not self._rests:
            return
        off = Region.still(start.placement(hand).translation).distance(there, first, last)
        if off > near:
            what = f"no task moves '{plan.hand}', which stays at least {off * 1e3:.4g} mm from '{plan.fixture}'"
            self.problems.append((f"{phase.key}.grasp", f"{what}: a grasp needs {plan.position * 1e3:g} mm"))

    def _ends_apart(
        self, phase: PhaseTable, plan: GraspTable, task: TaskTable, robot: SpaceRobot, target: SpaceRobot
    ) -> bool:
        """Return whether a task is done only where hand and fixture are too far from each other, and note that."""
        goal, done = task.followed, task.completion
        if not isinstance(goal, Follow) or done is None or task.type not in _PLACED:
            return False
        if self.scenario.target_named(goal.target) != self.scenario.target_named(plan.target):
            return False
        made, hand, fixture = task.task(robot), robot.point(plan.hand), target.point(plan.fixture)
        (point,), rows = made.points, made.rows(robot)
        followed = target.point(goal.follow, offset=goal.offset.pose)
        if point.joint != hand.joint or followed.joint != fixture.joint:
            return False
        at_point = point.placement.actInv(hand.placement)
        at_goal = followed.placement.actInv(fixture.placement)
        turned = done.angle if {3, 4, 5} <= set(rows) else math.inf
        lever = float(np.linalg.norm(at_point.translation)) * min(turned, 2.0)
        off = float(np.linalg.norm(at_point.translation - at_goal.translation)) - done.position - lever
        if not set(_LINEAR) <= set(rows) or off <= plan.position + _ROUNDING:
            return False
        what = f"'{plan.hand}' is at least {off * 1e3:.4g} mm from '{plan.fixture}' where task '{task.name}' is done"
        self.problems.append((f"{phase.key}.grasp", f"{what}: a grasp needs {plan.position * 1e3:g} mm"))
        return True


def _largest_force(disturbances: Iterable[DisturbanceTable]) -> float:
    """Return the largest force of all together, N."""
    return sum(float(np.linalg.norm(one.force)) for one in disturbances)


def _stays(task: TaskTable) -> bool:
    """Return whether a task leaves a robot at rest where it is."""
    goal = task.followed
    if isinstance(task, PluginTable):
        return False
    if goal is None:
        return not getattr(task, "posture", None)
    return isinstance(goal, Hold) or (isinstance(goal, ToMomentum) and not goal.momentum.any())


def _out_of_reach(plan: TaskTable, off: float) -> str:
    what = "the mass centre, which nothing moves as long as nothing pushes the base"
    if "point" in plan.frames:
        what = f"'{plan.frames['point']}'"
    return f"is at least {off:.3g} m out of reach of {what}"

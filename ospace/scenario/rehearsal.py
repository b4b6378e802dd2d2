"""Try the phases of a scenario without a simulation, and report all that cannot run.

First by names: frames of the robot that each phase will have, and whether the target moves by itself. Where nothing is
wrong so far, each phase's controller is made. Last by times: a phase ends between the sum of the shortest times of the
phases and the sum of their time-outs, and what cannot be reached at any moment between, wherever the arm may be, is
refused; what cannot be excluded is left to the run.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence

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
from ospace.simulation import grasp

_LINEAR = (0, 1, 2)
_ROUNDING = 1e-6
_PLACED = ("pose", "position")
"""Types of tasks whose goal is a place of a point in the inertial frame."""


def rehearse(scenario: Scenario, problems: list[Problem], *, target_known: bool) -> None:
    """Report what cannot be made or reached, phase by phase with the robot that it will have.

    Parameters
    ----------
    scenario : Scenario
        Where there are problems already, it may be incomplete; names are checked all the same.
    problems : list of (key, what)
        Takes what is found.
    target_known : bool
        Whether the target is as the file says; else nothing is said of it.
    """
    problems += scenario.limits.accelerations(scenario.robot)[1]
    problems += scenario.noise.unknown_joints(scenario.robot)
    problems += clearance.problems(scenario)
    problems += _misplaced(scenario, target_known)
    problems += _unbelievable(scenario, target_known)
    robots = list(_Names(scenario, problems, target_known).robots())
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


def _misplaced(scenario: Scenario, target_known: bool) -> Iterator[Problem]:
    """Yield the disturbances that act on a frame that nothing has."""
    for one in scenario.disturbances:
        robot = scenario.robot if one.of == ROBOT else scenario.target_robot
        if robot is None and target_known and one.of == TARGET:
            yield one.path("of"), "there is no target: give a table [target]"
        elif robot is not None:
            yield from _unknown_frame(one.path("point"), one.point, robot.name, robot.frame_names)


def _unbelievable(scenario: Scenario, target_known: bool) -> Iterator[Problem]:
    """Yield the errors of masses of links that nothing has, and those that leave no body."""
    for one in scenario.mass_errors:
        robot = scenario.robot if one.of == ROBOT else scenario.target_robot
        if robot is None and target_known and one.of == TARGET:
            yield one.path("of"), "there is no target: give a table [target]"
        elif robot is not None:
            unknown = list(_unknown_frame(one.path("link"), one.link or "", robot.name, robot.frame_names))
            yield from unknown
            if unknown or list(one.problems()):
                continue
            try:
                believed(robot, [one])
            except OspaceError as error:
                yield one.key, str(error)


def _unknown_frame(key: str, frame: str, robot: str, known: Iterable[str], where: str = "") -> Iterator[Problem]:
    """Yield a frame that the robot does not have."""
    if frame and frame not in known:
        yield key, f"no frame '{frame}' in robot '{robot}'{closest(frame, known)}{where}"


class _Names:
    """Checks names of frames and joints, and that a target is there to be followed, grasped or let go."""

    def __init__(self, scenario: Scenario, problems: list[Problem], target_known: bool) -> None:
        self.scenario, self.problems, self.target_known = scenario, problems, target_known

    def robots(self) -> Iterator[SpaceRobot]:
        """Check the phases in their order, and yield the robot that each has; the chaser where that is not known."""
        chaser, target = self.scenario.robot, self.scenario.target_robot
        robot, held = chaser, False
        frames: Sequence[str] = chaser.frame_names
        for phase in self.scenario.phases:
            for task in phase.tasks:
                self._task(task, phase, robot, frames, held)
            for one in phase.inequalities:
                for key, frame in one.frames.items():
                    where = "" if one in phase.inequality else f" (phase '{phase.name}')"
                    self._frame(one.path(key), frame, robot.name, frames, where)
            yield robot
            if "grasp" in phase.model_fields_set:
                combined = None if phase.grasp is None else self._grasp(phase.grasp, held)
                robot, held = combined or robot, True
                names = target.frame_names if target is not None else ()
                either = (*chaser.frame_names, *names, *(f"{target.name}/{name}" for name in names if target))
                frames = robot.frame_names if combined else either
            elif phase.release:
                if not held:
                    self.problems.append((phase.path("release"), "nothing is held at the end of this phase"))
                robot, frames, held = chaser, chaser.frame_names, False

    def _task(self, task: TaskTable, phase: PhaseTable, robot: SpaceRobot, frames: Iterable[str], held: bool) -> None:
        where = "" if phase.owns(task) else f" (phase '{phase.name}')"
        known = len(self.problems)
        for key, frame in task.frames.items():
            self._frame(task.path(key), frame, robot.name, frames, where)
        self.problems += task.postures(robot)[1]
        goal = task.followed
        if isinstance(goal, Follow):
            key, target = goal.path("follow"), self.scenario.target_robot
            if held:
                self.problems.append((key, f"the target is held already{where or f' in phase {phase.name!r}'}"))
            elif target is not None:
                self._frame(key, goal.follow, target.name, target.frame_names)
            elif self.target_known:
                self.problems.append((key, "there is no target to follow: give a table [target]"))
        if not self.problems[:known] and len(self.problems) == known:
            try:
                task.task(robot).rows(robot)
            except OspaceError as error:
                self.problems.append((task.key, str(error) + where))

    def _grasp(self, table: GraspTable, held: bool) -> SpaceRobot | None:
        """Return the combined robot, where it can be made."""
        robot, target, known = self.scenario.robot, self.scenario.target_robot, len(self.problems)
        if held:
            self.problems.append((table.key, "the target is held already"))
        elif target is None and self.target_known:
            self.problems.append((table.key, "there is no target to grasp: give a table [target]"))
        self._frame(table.path("hand"), table.hand, robot.name, robot.frame_names)
        if target is None or self.scenario.target is None:
            return None
        self._frame(table.path("fixture"), table.fixture, target.name, target.frame_names)
        if len(self.problems) > known or not (table.hand and table.fixture):
            return None
        try:
            hand, fixture = robot.point(table.hand), target.point(table.fixture)
            start, free = self.scenario.start, self.scenario.target
            q = free.q.copy()  # the target where it will be: at the hand
            there = start.placement(hand) * free.placement(fixture).inverse()
            q[:7] = pin.SE3ToXYZQUAT(there * target.base_pose(q))
            return grasp(start, hand, target.state(q, free.v), fixture).robot
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
        self._target_pushed = scenario.disturbances_of(TARGET)
        inside = not scenario.robot.outside_limits(start.q)
        self._centre = mass_centre((start,), self._force) if inside else None  # else joints may slide to anywhere
        self._target = scenario.target  # as long as it moves by itself, from the start on
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
            self._grasp(plan, plan.grasp, first + plan.earliest, last)
        self._begins, self._ends, self._first = first + plan.earliest, last, False
        if plan.changes_robot:
            centre = None  # of either by itself it is not known after a release
            if plan.grasp is not None and self._centre is not None and self._target is not None:
                force = self._force + _largest_force(self._target_pushed)
                centre = mass_centre((self.scenario.start, self._target), force)
            self._centre, self._target, self._rests = centre, None, False

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
        start, target, goal = self.scenario.start, self.scenario.target_robot, plan.followed
        if isinstance(goal, Follow) and target is not None and self._target is not None:
            return self._of_target(self._target, target.point(goal.follow, offset=goal.offset.pose))
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

    def _of_target(self, state: State, point: OperationalPoint) -> Region:
        """Return where a point of the target may be, as it moves by itself."""
        if not self._target_pushed:
            return of_target(state, point)
        return reached(point, mass_centre((state,), _largest_force(self._target_pushed)))

    def _refuse(self, phase: PhaseTable, plan: TaskTable, why: str) -> None:
        where = "" if phase.owns(plan) else f" (phase '{phase.name}')"
        self.problems.append((f"{plan.key}.goal", f"the goal {why}{where}"))

    # -- grasps ----------------------------------------------------------------------------------------------

    def _grasp(self, phase: PhaseTable, plan: GraspTable, first: float, last: float) -> None:
        start, target = self.scenario.start, self.scenario.target_robot
        if target is None or any(self._ends_apart(phase, plan, task, target) for task in phase.tasks):
            return
        if self._target is None:
            return
        hand, fixture = self.scenario.robot.point(plan.hand), target.point(plan.fixture)
        there, near = self._of_target(self._target, fixture), plan.position + _ROUNDING
        if self._centre is not None:
            off = reached(hand, self._centre).distance(there, first, last)
            if off > near:
                what = f"'{plan.fixture}' is at least {off:.3g} m out of reach of '{plan.hand}'"
                self.problems.append((f"{phase.key}.grasp", f"{what} between {first:g} s and {last:g} s"))
                return
        off = Region.still(start.placement(hand).translation).distance(there, first, last)
        if self._rests and off > near:
            what = f"no task moves '{plan.hand}', which stays at least {off * 1e3:.4g} mm from '{plan.fixture}'"
            self.problems.append((f"{phase.key}.grasp", f"{what}: a grasp needs {plan.position * 1e3:g} mm"))

    def _ends_apart(self, phase: PhaseTable, plan: GraspTable, task: TaskTable, target: SpaceRobot) -> bool:
        """Return whether a task is done only where hand and fixture are too far from each other, and note that."""
        goal, done = task.followed, task.completion
        if not isinstance(goal, Follow) or done is None or task.type not in _PLACED:
            return False
        robot = self.scenario.robot
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

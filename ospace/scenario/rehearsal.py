"""A scenario's phases by their times, without a simulation: what can be known beforehand not to be reached.

A phase ends between the sum of the shortest times of the phases and the sum of their time-outs. What is noted here
cannot be reached at any moment between, wherever the arm may be; what cannot be excluded is left to the run.
"""

from __future__ import annotations

import math

import numpy as np

from ospace.control import Task
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.scenario.description import (
    Follow,
    GraspPlan,
    Hold,
    PhasePlan,
    Scenario,
    Shift,
    TaskPlan,
    ToMomentum,
    ToPose,
)
from ospace.scenario.reach import Region, apart, mass_centre, of_target, reached
from ospace.scenario.table import Problems

_LINEAR = (0, 1, 2)
_ROUNDING = 1e-6
_PLACED = ("pose", "position")
"""Types of tasks whose goal is a place of a point in the inertial frame."""


class Rehearsal:
    """Goes through the phases of a scenario in their order.

    Parameters
    ----------
    scenario : Scenario
    problems : Problems
        Takes down what cannot be reached.
    """

    def __init__(self, scenario: Scenario, problems: Problems) -> None:
        self.scenario, self.problems = scenario, problems
        self._begins = self._ends = 0.0  # the earliest and the latest time, s
        start, self._force = scenario.start, float(np.linalg.norm(scenario.base.limits[:3]))
        inside = not start.robot.outside_limits(start.q)
        self._centre = mass_centre((start,), self._force) if inside else None  # else joints may slide to anywhere
        self._target = scenario.target  # as long as it moves by itself, from the start on
        self._rests = inside and not start.v.any()
        self._first = True

    def phase(self, plan: PhasePlan, robot: SpaceRobot) -> None:
        """Note what cannot be reached in a phase, whose robot is `robot`, and go on to its end."""
        first, last, known = self._begins, self._ends + plan.timeout, len(self.problems.found)
        self._rests = self._rests and all(_stays(task) for task in plan.tasks)
        for task in plan.tasks:
            if task.completion is not None and math.isfinite(task.completion.position):
                self._task(plan, task, robot, first + plan.motion(task), last)
        if isinstance(plan.action, GraspPlan) and len(self.problems.found) == known:
            self._grasp(plan, plan.action, first + plan.earliest, last)
        self._begins, self._ends, self._first = first + plan.earliest, last, False
        if plan.action is not None:
            centre = None  # of either by itself it is not known after a release
            if isinstance(plan.action, GraspPlan) and self._centre is not None and self._target is not None:
                centre = mass_centre((self.scenario.start, self._target), self._force)
            self._centre, self._target, self._rests = centre, None, False

    # -- tasks -----------------------------------------------------------------------------------------------

    def _task(self, phase: PhasePlan, plan: TaskPlan, robot: SpaceRobot, first: float, last: float) -> None:
        task, goal = plan.task(robot), plan.goal
        rows = tuple(row for row in task.rows(robot) if row in _LINEAR)
        if plan.completion is None or not rows:
            return
        near = plan.completion.position + _ROUNDING
        if plan.type == "relative_pose" and isinstance(goal, ToPose) and goal.position is not None:
            away, most = float(np.linalg.norm(goal.position)), apart(*task.points)
            if rows == _LINEAR and away - near > most:
                what = f"is {away:.4g} m from '{plan.seen_from}', of which '{plan.point}' is {most:.4g} m away at most"
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
        elif isinstance(goal, Shift):
            wide = 2.0 * own.radius + float(np.linalg.norm(own.velocity)) * last
            off = float(np.linalg.norm(goal.shift[list(rows)])) - wide - (own.growth * last**2 if own.growth else 0.0)
            if off > near:
                self._refuse(phase, plan, _out_of_reach(plan, off))

    def _goal(self, plan: TaskPlan, task: Task) -> Region | None:
        """Return where the goal of a task is, if that is known."""
        start, goal = self.scenario.start, plan.goal
        if isinstance(goal, Follow) and self._target is not None:
            return of_target(self._target, self._target.robot.point(goal.frame, offset=goal.offset))
        if isinstance(goal, ToPose) and goal.position is not None:
            return Region.still(goal.position)
        if isinstance(goal, Shift) and self._first:
            return Region.still(start.placement(task.points[0]).translation + goal.shift)
        return None

    def _refuse(self, phase: PhasePlan, plan: TaskPlan, why: str) -> None:
        where = "" if plan.key.startswith(phase.key) else f" (phase '{phase.name}')"
        self.problems.add(f"{plan.key}.goal", f"the goal {why}{where}")

    # -- grasps ----------------------------------------------------------------------------------------------

    def _grasp(self, phase: PhasePlan, plan: GraspPlan, first: float, last: float) -> None:
        start, target = self.scenario.start, self.scenario.target
        if target is None:
            return
        hand, fixture = start.robot.point(plan.hand), target.robot.point(plan.fixture)
        if any(self._ends_apart(phase, plan, task, hand, fixture) for task in phase.tasks) or self._target is None:
            return
        there, near = of_target(target, fixture), plan.position + _ROUNDING
        if self._centre is not None:
            off = reached(hand, self._centre).distance(there, first, last)
            if off > near:
                what = f"'{plan.fixture}' is at least {off:.3g} m out of reach of '{plan.hand}'"
                self.problems.add(f"{phase.key}.grasp", f"{what} between {first:g} s and {last:g} s")
                return
        off = Region.still(start.placement(hand).translation).distance(there, first, last)
        if self._rests and off > near:
            what = f"no task moves '{plan.hand}', which stays at least {off * 1e3:.4g} mm from '{plan.fixture}'"
            self.problems.add(f"{phase.key}.grasp", f"{what}: a grasp needs {plan.position * 1e3:g} mm")

    def _ends_apart(
        self, phase: PhasePlan, plan: GraspPlan, task: TaskPlan, hand: OperationalPoint, fixture: OperationalPoint
    ) -> bool:
        """Return whether a task is done only where hand and fixture are too far from each other, and note that."""
        goal, done = task.goal, task.completion
        if not isinstance(goal, Follow) or done is None or task.type not in ("pose", "position") or task.point is None:
            return False
        point = hand.robot.point(task.point, offset=task.offset)
        followed = fixture.robot.point(goal.frame, offset=goal.offset)
        if point.joint != hand.joint or followed.joint != fixture.joint:
            return False
        rows = task.task(hand.robot).rows(hand.robot)
        at_point = point.placement.actInv(hand.placement)
        at_goal = followed.placement.actInv(fixture.placement)
        turned = done.angle if {3, 4, 5} <= set(rows) else math.inf
        lever = float(np.linalg.norm(at_point.translation)) * min(turned, 2.0)
        off = float(np.linalg.norm(at_point.translation - at_goal.translation)) - done.position - lever
        if not set(_LINEAR) <= set(rows) or off <= plan.position + _ROUNDING:
            return False
        what = f"'{plan.hand}' is at least {off * 1e3:.4g} mm from '{plan.fixture}' where task '{task.name}' is done"
        self.problems.add(f"{phase.key}.grasp", f"{what}: a grasp needs {plan.position * 1e3:g} mm")
        return True


def _stays(task: TaskPlan) -> bool:
    """Whether a task leaves a robot at rest where it is."""
    if task.goal is None:
        return not task.options.get("posture")
    return isinstance(task.goal, Hold) or (isinstance(task.goal, ToMomentum) and not np.any(task.goal.momentum))


def _out_of_reach(plan: TaskPlan, off: float) -> str:
    what = (
        f"'{plan.point}'" if plan.point else "the mass centre, which nothing moves as long as nothing pushes the base"
    )
    return f"is at least {off:.3g} m out of reach of {what}"

"""References of a phase's tasks, from the state at its start on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.control import Constant, Function
from ospace.control.references import Reference
from ospace.kernels.tasks import tables as kernel
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.scenario.motion import Approach, FreeMotion, Goal, point_motion, still
from ospace.scenario.paths import AlongPath, Path, circle, through
from ospace.scenario.schema import Follow, Hold, Shift, TaskTable, ToMomentum, ToPose, Via


@dataclass(frozen=True, eq=False)
class Start:
    """The state at a phase's start, and the control cycle it is of."""

    robot: SpaceRobot
    q: Floats
    v: Floats
    cycle: int
    period: float
    targets: Mapping[str, FreeMotion]

    def reference(self, plan: TaskTable) -> Reference | None:
        """Return what the task follows; None for one that follows nothing."""
        goal = plan.followed
        if goal is None:
            return None
        if isinstance(goal, ToMomentum):
            return Constant(pin.SE3.Identity(), goal.momentum)
        if plan.type == "momentum":
            data = self.robot.model.createData()
            pin.computeCentroidalMomentum(self.robot.model, data, self.q, self.v)
            return Constant(pin.SE3.Identity(), data.hg.vector.copy())
        pose, velocity = self._now(plan)
        if isinstance(goal, Follow):
            target = self.targets[goal.target] if goal.target else next(iter(self.targets.values()))
            point = target.robot.point(goal.follow, offset=goal.offset.pose)
            return self._approach(plan, pose, velocity, target.frame(point), goal.duration)
        path = _path(goal, pose)
        if path is not None:
            made = AlongPath(
                path, velocity, duration=goal.duration, first=self.cycle, period=self.period, name=plan.name
            )
            return Function(made)
        if goal.duration == 0.0:
            return Constant(self._goal(plan, pose, np.zeros(6))[0])
        there, turn = self._goal(plan, pose, velocity)
        return self._approach(plan, pose, velocity, still(there), goal.duration, turn)

    def _approach(
        self,
        plan: TaskTable,
        pose: pin.SE3,
        velocity: Floats,
        goal: Goal,
        duration: float,
        turn: Floats | None = None,
    ) -> Function:
        first, period = self.cycle, self.period
        return Function(
            Approach(pose, velocity, goal, duration=duration, first=first, period=period, turn=turn, name=plan.name)
        )

    def _goal(self, plan: TaskTable, pose: pin.SE3, velocity: Floats) -> tuple[pin.SE3, Floats | None]:
        """Return where a goal that stays is; and by which rotation vector it is reached, if that is known."""
        goal = plan.followed
        if isinstance(goal, ToPose):
            there = pin.SE3(
                pose.rotation if goal.rotation is None else goal.rotation,
                pose.translation if goal.position is None else goal.position,
            )
            return there, None
        if isinstance(goal, Shift):
            shift, turn = goal.shift, goal.turn
        else:  # where a motion comes to rest whose speed falls as evenly as it may within the duration
            way = 0.5 * (goal.duration if isinstance(goal, Hold) else 0.0) * velocity
            shift, turn = way[:3], way[3:]
        return pin.SE3(pin.exp3(turn) @ pose.rotation, pose.translation + shift), turn

    def _now(self, plan: TaskTable) -> tuple[pin.SE3, Floats]:
        """Return the pose that the task would hold, and its velocity where it is that of one point."""
        model, data = self.robot.model, self.robot.model.createData()
        task = plan.task(self.robot)
        centre = pin.centerOfMass(model, data, self.q, self.v).copy()
        now = self.q[None], self.v[None], np.zeros((1, self.robot.nv))
        motions = [point_motion(one, *now) for one in task.points]
        velocity = np.zeros(6)
        if task.kind == kernel.MOTION:
            velocity = motions[0].velocity[0]
        elif task.kind == kernel.CENTRE_OF_MASS:
            velocity[:3] = data.vcom[0]
        return task.initial([pin.SE3(one.rotation[0], one.place[0]) for one in motions], centre), velocity


def _path(goal: object, pose: pin.SE3) -> Path | None:
    """Return the path of a goal that has one, from `pose` on."""
    if isinstance(goal, Shift) and goal.about is not None:
        return circle(pose, goal.about, goal.turn, goal.shift, goal.turns_along)
    if not isinstance(goal, Via):
        return None
    poses = [pose]
    for one in goal.via:
        last = poses[-1]
        poses.append(
            pin.SE3(
                last.rotation if one.rotation is None else one.rotation,
                last.translation if one.position is None else one.position,
            )
        )
    return through(poses)

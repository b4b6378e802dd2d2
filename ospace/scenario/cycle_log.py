"""Record each control cycle of a phase, and reduce the records when the phase is over."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.control import Command, Task
from ospace.control.shortfall import Shortfall
from ospace.kernels.tasks import tables as kernel
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.scenario.result import BASE, Separation, TaskErrors

COASTING = "coasting"
"""Status of cycles in which nothing acts."""
_AT_ONCE = 256
"""Cycles whose Jacobians and configurations wait for singular values and poses: many at once take a third of the time,
and those of a long run would not fit into memory."""


@dataclass(frozen=True)
class _Cycle:
    time: float
    errors: Floats
    taken: float


class CycleLog:
    """Records the commands of the tasks' controller, or that nothing acts.

    Attributes
    ----------
    statuses, active_limits, near_singularity, shortfalls : Counter
        Cycles by status, by limit, by task, and by why which task fell short.
    """

    def __init__(self, robot: SpaceRobot, tasks: Sequence[Task]) -> None:
        self.robot, self.tasks = robot, tasks
        self.statuses: Counter[str] = Counter()
        self.active_limits: Counter[str] = Counter()
        self.near_singularity: Counter[str] = Counter()
        self.shortfalls: Counter[str] = Counter()
        self._nearest: list[float] = []
        self._closest: dict[str, float] = {}
        self._worst: dict[str, Shortfall] = {}
        self._rows = {task.name: task.rows(robot) for task in tasks}
        self._about_points = [task for task in tasks if task.geometric]
        self._points = _points(self._about_points)
        self._tracked = {name: point for name, point in self._points.items() if name != BASE}
        self._data = robot.model.createData()
        self._cycles: list[_Cycle] = []
        self._waiting: list[tuple[Floats, Floats]] = []
        self._singular: dict[str, list[Floats]] = {task.name: [] for task in self._about_points}
        self._poses: dict[str, list[Floats]] = {name: [] for name in self._tracked}

    def __len__(self) -> int:
        return len(self._cycles)

    def record(self, time: float, q: Floats, command: Command, truth: Command) -> None:
        """Record one cycle, at `time` (s) in the configuration `q`.

        `truth` is what a controller would command that sees the robot as it is: of it are errors and Jacobians.
        """
        if self._about_points:
            self._waiting.append((truth.generalized_jacobian, q.copy()))
        if len(self._waiting) == _AT_ONCE:
            self._reduce()
        self.statuses[command.status] += 1
        self.active_limits.update(command.active_limits)
        self.near_singularity.update(command.near_singularity)
        for one in command.shortfalls:
            self.shortfalls[one.cause] += 1
            known = self._worst.get(one.cause)
            if known is None or (one.distance, one.angle) > (known.distance, known.angle):
                self._worst[one.cause] = one
        if command.nearest is not None:
            self._nearest.append(command.nearest.distance)
            pair = " / ".join(command.nearest.links)
            self._closest[pair] = min(command.nearest.distance, self._closest.get(pair, math.inf))
        # one call that Ctrl-C cannot divide: a cycle counts when it is whole
        self._cycles.append(_Cycle(time, np.concatenate(tuple(truth.errors.values())), command.timing.total))

    def coast(self, time: float) -> None:
        """Record a cycle in which nothing acts, at `time` (s)."""
        self.statuses[COASTING] += 1
        self._cycles.append(_Cycle(time, np.zeros(0), 0.0))

    def separation(self, clearance: float | None) -> Separation | None:
        """Return how near links came to each other; None where no clearance was kept."""
        if clearance is None or not self._nearest:
            return None
        closest = dict(sorted(self._closest.items(), key=lambda item: item[1]))
        return Separation(clearance, np.array(self._nearest[: len(self)]), closest)

    @property
    def most_short(self) -> dict[str, str]:
        """By how much a task fell short at most, by why."""
        return {cause: one.size for cause, one in self._worst.items()}

    @property
    def time(self) -> Floats:
        """Of the cycles (N,), s."""
        return np.array([cycle.time for cycle in self._cycles])

    @property
    def cycle_time(self) -> Floats:
        """Time that each took (N,), s."""
        return np.array([cycle.taken for cycle in self._cycles])

    @property
    def errors(self) -> dict[str, TaskErrors]:
        """Of each task that has one: those that damp, and bare rows, have none."""
        E, found, column = np.array([cycle.errors for cycle in self._cycles]), {}, 0
        for task in self.tasks:
            rows = np.array(self._rows[task.name])
            own = E[:, column : column + len(rows)]
            column += len(rows)
            if task.units is None:
                continue
            linear = rows < 3 if task.kind != kernel.POSTURE else np.zeros(len(rows), dtype=bool)
            norms = [
                np.linalg.norm(own[:, part], axis=1) if part.any() else np.full(len(E), np.nan)
                for part in (linear, ~linear)
            ]
            points = tuple(name for name, known in self._points.items() if any(_same(known, p) for p in task.points))
            found[task.name] = TaskErrors(np.array(norms).T, task.units, points)
        return found

    @property
    def sigma_min(self) -> dict[str, Floats]:
        """σ_min of J_m* of each task about points (N,)."""
        self._reduce()
        return {name: np.concatenate(parts)[: len(self)] for name, parts in self._singular.items()}

    @property
    def poses(self) -> dict[str, Floats]:
        """Pose of each of the tasks' points but the base: place and quaternion x, y, z, w, inertial axes (N, 7)."""
        self._reduce()
        return {name: np.concatenate(parts)[: len(self)] for name, parts in self._poses.items()}

    def _reduce(self) -> None:
        """Take singular values and poses of the cycles that wait for it."""
        if not self._waiting:
            return
        J, first = np.array([jacobian for jacobian, _ in self._waiting]), 0
        for task in self._about_points:
            rows = len(self._rows[task.name])
            smallest = np.zeros(len(J))
            if rows <= J.shape[2]:  # else the joints cannot move it in all its rows
                smallest[:] = np.linalg.svd(J[:, first : first + rows], compute_uv=False)[:, -1]
            self._singular[task.name].append(smallest)
            first += rows
        found = poses(self.robot.model, self._data, self._tracked, [q for _, q in self._waiting])
        for name, values in found.items():
            self._poses[name].append(values)
        self._waiting.clear()


def poses(
    model: pin.Model, data: pin.Data, points: Mapping[str, OperationalPoint], Q: Sequence[Floats]
) -> dict[str, Floats]:
    """Return the pose of each point (N, 7) at configurations `Q` (N, nq), by Pinocchio's forward kinematics."""
    found = {name: np.empty((len(Q), 7)) for name in points}
    if points:
        for k, q in enumerate(Q):
            pin.forwardKinematics(model, data, q)
            for name, point in points.items():
                found[name][k] = pin.SE3ToXYZQUAT(data.oMi[point.joint] * point.placement)
    return found


def _points(tasks: Sequence[Task]) -> dict[str, OperationalPoint]:
    """Return the points of tasks, each once, by names of their own."""
    found: dict[str, OperationalPoint] = {}
    for task in tasks:
        for point in task.points:
            if not any(_same(point, known) for known in found.values()):
                found[_name(point, task, found)] = point
    return found


def _name(point: OperationalPoint, task: Task, taken: Mapping[str, OperationalPoint]) -> str:
    """Return the frame's name, and the task's where another offset from the frame has it."""
    if point.joint == 1 and point.placement.isIdentity(0.0):
        return BASE
    name = point.frame
    while name in taken or name == BASE:
        name = f"{name} ({task.name})"
    return name


def _same(a: OperationalPoint, b: OperationalPoint) -> bool:
    return bool(a.joint == b.joint and a.placement == b.placement)

"""What a scenario says, in SI units, with every name known to be right."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from ospace.control import (
    Base,
    BaseAttitudeTask,
    CentreOfMassTask,
    Completion,
    DampingTask,
    JointLimits,
    LookAtTask,
    MomentumTask,
    OrientationTask,
    PoseTask,
    PositionTask,
    PostureTask,
    RelativePoseTask,
    Task,
)
from ospace.control.references import Reference
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.model.state import State

TASKS: dict[str, type[Task]] = {
    "pose": PoseTask,
    "position": PositionTask,
    "orientation": OrientationTask,
    "look_at": LookAtTask,
    "relative_pose": RelativePoseTask,
    "centre_of_mass": CentreOfMassTask,
    "base_attitude": BaseAttitudeTask,
    "momentum": MomentumTask,
    "posture": PostureTask,
    "damping": DampingTask,
}
"""By the `type` of a task."""


@dataclass(frozen=True)
class Hold:
    """Stay; with a duration, come to rest within it."""

    duration: float = 0.0


@dataclass(frozen=True, eq=False)
class ToPose:
    """A pose in the inertial frame; what is None stays as it is at the phase's start."""

    position: Floats | None
    rotation: Floats | None
    duration: float = 0.0


@dataclass(frozen=True, eq=False)
class Shift:
    """From where the point is at the phase's start, by so much; inertial axes."""

    shift: Floats
    turn: Floats
    duration: float = 0.0


@dataclass(frozen=True, eq=False)
class Follow:
    """A frame of the target, with an offset as seen from it."""

    frame: str
    offset: pin.SE3
    duration: float = 0.0


@dataclass(frozen=True, eq=False)
class ToMomentum:
    """Linear momentum, and angular about the centre of mass."""

    momentum: Floats
    duration: float = 0.0


Goal = Hold | ToPose | Shift | Follow | ToMomentum


@dataclass(frozen=True, eq=False)
class TaskPlan:
    """A task of a phase.

    Attributes
    ----------
    key : str
        Where it stands in the file.
    type, name : str
    options : mapping
        Arguments of the task's class: gains, weight or level, completion, axes.
    point, seen_from : str, optional
        Frames.
    offset : pin.SE3
        Of the point, as seen from its frame.
    goal : Goal, optional
        None for tasks that follow nothing: posture and damping.
    """

    key: str
    type: str
    name: str
    options: Mapping[str, Any]
    point: str | None = None
    seen_from: str | None = None
    offset: pin.SE3 = field(default_factory=pin.SE3.Identity)
    goal: Goal | None = None

    @property
    def completion(self) -> Completion | None:
        """When it counts as done."""
        completion: Completion | None = self.options.get("completion")
        return completion

    def task(self, robot: SpaceRobot, reference: Reference | None = None) -> Task:
        """Make the task for a robot."""
        options: dict[str, Any] = dict(self.options)
        if self.point is not None:
            options["point"] = robot.point(self.point, offset=self.offset)
        if self.seen_from is not None:
            options["seen_from"] = robot.point(self.seen_from)
        if self.type == "base_attitude":
            options["robot"] = robot
        if reference is not None:
            options["reference"] = reference
        return TASKS[self.type](name=self.name, **options)


@dataclass(frozen=True)
class GraspPlan:
    """The target's frame `fixture` is fixed to the chaser's frame `hand`, where they are near enough: m, rad."""

    hand: str
    fixture: str
    position: float
    angle: float


@dataclass(frozen=True)
class Release:
    """The target is let go."""


@dataclass(frozen=True, eq=False)
class PhasePlan:
    """A phase: it ends when all completion tests hold, its motions are done and `duration` is over; or at `timeout`.

    Attributes
    ----------
    key, name : str
    timeout, duration : float
        Longest and shortest time, s.
    tasks : tuple of TaskPlan
        Those of all phases included.
    action : GraspPlan or Release, optional
        At the end.
    """

    key: str
    name: str
    timeout: float
    duration: float
    tasks: tuple[TaskPlan, ...]
    action: GraspPlan | Release | None = None

    @property
    def earliest(self) -> float:
        """The shortest time that it takes: its motions are done, and tests have held from then on; s."""
        times = [self.duration]
        for task in self.tasks:
            times.append(self.motion(task) + (task.completion.hold if task.completion else 0.0))
        return max(times)

    def motion(self, task: TaskPlan) -> float:
        """Return how long the motion of one of its tasks takes, s; that of a task of all phases has begun before."""
        return task.goal.duration if task.goal is not None and task.key.startswith(self.key) else 0.0


@dataclass(frozen=True)
class ControlPlan:
    """How control and simulation go: s; names of solver and integrator."""

    period: float = 1e-3
    step: float = 1e-3
    solver: str = "daqp"
    integrator: str = "rk4"


@dataclass(frozen=True, eq=False)
class LimitsPlan:
    """Limits of the joints, taken from the model."""

    share: float = 1.0
    acceleration: Mapping[str, float] = field(default_factory=dict)

    def of(self, robot: SpaceRobot, actuated: SpaceRobot) -> JointLimits:
        """Return the limits of `robot`, of whose joints those of `actuated` have drives."""
        limits = JointLimits.of(robot, acceleration=self.acceleration, share=self.share)
        idle = np.array([name not in actuated.rate_names for name in robot.rate_names], dtype=bool)
        if not idle.any():
            return limits
        free = np.where(idle, np.inf, 0.0)
        return replace(
            limits,
            torque=np.where(idle, 0.0, limits.torque),
            lower=limits.lower - free,
            upper=limits.upper + free,
            velocity=limits.velocity + free,
            acceleration=limits.acceleration + free,
        )


@dataclass(frozen=True, eq=False)
class Scenario:
    """A scenario; read one with `ospace.scenario.load`.

    Attributes
    ----------
    path : Path
    source : str
        The text of the file.
    name : str
    start : State
        Of the chaser.
    target : State, optional
        At the start.
    base : Base
    limits : LimitsPlan
    control : ControlPlan
    phases : tuple of PhasePlan
    """

    path: Path
    source: str
    name: str
    start: State
    target: State | None
    base: Base
    limits: LimitsPlan
    control: ControlPlan
    phases: tuple[PhasePlan, ...]

    @property
    def robot(self) -> SpaceRobot:
        """The chaser."""
        return self.start.robot

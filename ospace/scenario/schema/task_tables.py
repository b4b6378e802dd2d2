"""Tables of tasks: one for each class of `ospace.control`, with the keys that the class has an argument for."""

from __future__ import annotations

from dataclasses import fields
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, ConfigDict, Field, WithJsonSchema, create_model

from ospace.control import (
    BaseAttitudeTask,
    CentreOfMassTask,
    Completion,
    DampingTask,
    LookAtTask,
    MomentumTask,
    OrientationTask,
    PoseTask,
    PositionTask,
    PostureTask,
    RelativePoseTask,
    Task,
    ZeroReactionTask,
)
from ospace.control.references import Reference
from ospace.control.tasks.pose import AXES_IN
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.points import Axes, OperationalPoint, parse_axes
from ospace.model.robot import SpaceRobot
from ospace.scenario import plugins
from ospace.scenario.schema.goal_tables import Goal, MomentumGoal, MotionGoal, goal_field
from ospace.scenario.schema.keys import (
    POSITIONS,
    MadeTable,
    PoseTable,
    Weight,
    default_table,
    is_a,
    unbounded_field,
    vector_field,
)
from ospace.scenario.schema.plugin_tables import SCHEMA, PluginTable, reader
from ospace.scenario.table import Either, Flag, Level, OneOf, Problem, Table, Text
from ospace.scenario.units import Quantity, Time, Vector

_DIRECTION = 1e-9


def _six(axes: list[bool]) -> Axes:
    try:
        return parse_axes(axes)
    except OspaceError as error:
        raise ValueError(str(error)) from None


def _direction(axis: Floats) -> Floats:
    if not np.linalg.norm(axis) > _DIRECTION:
        raise ValueError(f"gives no direction: not all three may be zero, or below {_DIRECTION:g}")
    return axis


AxesKey = Annotated[
    Axes,
    Either(
        is_a(list),
        {
            "is": Annotated[
                list[Flag],
                WithJsonSchema({"type": "array", "items": {"type": "boolean"}, "minItems": 6, "maxItems": 6}),
                AfterValidator(_six),
            ],
            "else": Annotated[str, OneOf(("all", "linear", "angular"))],
        },
    ),
]


class CompletionTable(MadeTable):
    """Completion of a task."""

    position: Annotated[float, Quantity("length", above=0.0, infinite=True)] = unbounded_field(
        "Largest norm of the linear error"
    )
    angle: Annotated[float, Quantity("angle", above=0.0, infinite=True)] = unbounded_field(
        "Largest norm of the angular error, or largest error of a joint"
    )
    hold: Time = Field(0.0, description="For how long, without a break")

    def make(self) -> Completion:
        """Make the completion test."""
        return Completion(self.position, self.angle, self.hold)


class MomentumCompletion(CompletionTable):
    """Completion of a momentum task."""

    position: Annotated[float, Quantity("momentum", above=0.0, infinite=True)] = unbounded_field(
        "Largest norm of the error of linear momentum"
    )
    angle: Annotated[float, Quantity("angular momentum", above=0.0, infinite=True)] = unbounded_field(
        "Largest norm of the error of angular momentum"
    )


class RateCompletion(CompletionTable):
    """Completion of a task of rates."""

    position: Annotated[float, Quantity("velocity", above=0.0, infinite=True)] = unbounded_field(
        "Largest norm of the linear velocity"
    )
    angle: Annotated[float, Quantity("angular velocity", above=0.0, infinite=True)] = unbounded_field(
        "Largest norm of the angular velocity"
    )


class TaskTable(Table):
    """A task; what it has beside these keys is that of its type."""

    type: str
    name: Text = Field(description="Its name; a phase's task of the same name replaces one of all phases")
    stiffness: Annotated[float, Quantity("stiffness", least=0.0)] = Field(25.0, description="Square of its frequency")
    damping_ratio: Annotated[float, Quantity("number", least=0.0, most=100.0)] = Field(1.0, description="1 is critical")
    weight: Weight = Field(1.0, description="Beside tasks of the same level")
    level: Level | None = Field(None, description="Strict level, smallest first; tasks without one come last")
    completion: CompletionTable | None = Field(None, description="When it counts as done")

    def _of(self, key: str) -> Any:
        """Return the value of a key that some types have; None for the others."""
        return getattr(self, key, None)

    @property
    def followed(self) -> Goal | None:
        """Its goal; None for tasks that follow nothing: posture, damping and zero reaction."""
        goal: Goal | None = self._of("goal")
        return goal

    @property
    def motion(self) -> float:
        """Time that its motion takes, s."""
        return self.followed.duration if self.followed is not None else 0.0

    @property
    def hold(self) -> float:
        """For how long its completion test must hold, s."""
        return self.completion.hold if self.completion is not None else 0.0

    @property
    def frames(self) -> dict[str, str]:
        """Names of frames of the robot by their keys, ``point`` and ``seen_from``."""
        given = {key: self._of(key) for key in ("point", "seen_from")}
        return {key: frame for key, frame in given.items() if frame}

    def point_of(self, robot: SpaceRobot) -> OperationalPoint | None:
        """Return the point that the task is about, where it is about one."""
        point = self.frames.get("point")
        return robot.point(point, offset=self._of("offset").pose) if point else None

    def postures(self, robot: SpaceRobot) -> tuple[dict[str, float], list[Problem]]:
        """Return the positions of the joints of ``posture``, SI units, and what is wrong with others."""
        return POSITIONS.read(self._of("posture") or {}, robot, self.path("posture"))

    def task(self, robot: SpaceRobot, reference: Reference | None = None) -> Task:
        """Make the task for a robot."""
        made: dict[str, Any] = {
            "point": self.point_of,
            "seen_from": lambda robot: robot.point(self.frames["seen_from"]),
            "completion": lambda robot: None if self.completion is None else self.completion.make(),
            "posture": lambda robot: self.postures(robot)[0],
            "axis": lambda robot: tuple(map(float, self._of("axis"))),
        }
        options = {key: getattr(self, key) for key in type(self).model_fields if key not in _NOT_OF_THE_CLASS}
        options = {
            key: made[key](robot) if key in made else value for key, value in options.items() if value is not None
        }
        if self.type == "base_attitude":
            options["robot"] = robot
        if reference is not None:
            options["reference"] = reference
        return TASKS[self.type](**options)


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
    "zero_reaction": ZeroReactionTask,
}
"""By the `type` of a task: a table has the keys that the class has an argument for."""
_NOT_OF_THE_CLASS = ("type", "goal", "offset")
_KEYS: dict[str, Any] = {
    "point": (Text, Field(description="A frame of the robot")),
    "offset": (PoseTable, default_table(PoseTable, "Of the point, as seen from the frame")),
    "seen_from": (Text, Field(description="The frame that the pose is seen from")),
    "axes": (AxesKey | None, Field(None, description="Which of six components; if left out, all that the type has")),
    "axes_in": (
        Annotated[Literal["inertial", "point"], OneOf(AXES_IN)],
        Field("inertial", description="Whose axes these are; what is not taken in those of the point is free to roll"),
    ),
    "axis": (
        Annotated[Floats, Vector("number"), AfterValidator(_direction)],
        vector_field("What looks, in the point's axes", 1.0),
    ),
    "posture": (
        Annotated[dict[str, Any] | None, POSITIONS],
        Field(None, description="Position by joint name; if left out, all joints stay where they are"),
    ),
    "goal": (MotionGoal, goal_field("hold")),
}
_WITHOUT_GOAL = (PostureTask, DampingTask, ZeroReactionTask)


def _table_of(name: str, task: type[Task]) -> type[TaskTable]:
    """Make the table of a type of tasks."""
    known = {one.name for one in fields(task)} | (set() if task in _WITHOUT_GOAL else {"goal"})
    known |= {"offset"} if "point" in known else set()
    keys = {key: kind for key, kind in _KEYS.items() if key in known}
    if task is MomentumTask:
        keys["goal"] = MomentumGoal, goal_field("zero")
        keys["completion"] = MomentumCompletion | None, Field(None, description="When it counts as done")
    if task is ZeroReactionTask:
        keys["completion"] = RateCompletion | None, Field(None, description="When it counts as done")
    keys["weight"] = Weight, Field(task.weight, description="Beside tasks of the same level")
    keys["type"] = Literal[name], Field(description=f"A task of the class {task.__name__}")
    return create_model(
        f"{task.__name__}Table", __base__=TaskTable, __doc__=f"A task of type {name}.", __module__=__name__, **keys
    )


TASK_TABLES = {name: _table_of(name, task) for name, task in TASKS.items()}
globals().update({table.__name__: table for table in TASK_TABLES.values()})  # where pickle looks for them


class PluginTask(PluginTable, TaskTable):
    """A task that a plugin brings; its other keys are the arguments of its class."""

    def postures(self, robot: SpaceRobot) -> tuple[dict[str, float], list[Problem]]:
        """Return none: what its class takes is its own."""
        return {}, []

    def task(self, robot: SpaceRobot, reference: Reference | None = None) -> Task:
        """Make the task for a robot."""
        made: Task = self.made(robot, completion=None if self.completion is None else self.completion.make())
        return made


class UnknownTask(TaskTable):
    """Says what is wrong with the type, and nothing of keys that it may have."""

    model_config = ConfigDict(extra="ignore")
    type: Annotated[str, OneOf(tuple(TASKS))]


def _task_type(value: Any) -> str:
    named = value.get("type") if isinstance(value, dict) else None
    if plugins.is_reference(named):
        return "plugin"
    return named if isinstance(named, str) and named in TASKS else "_unknown"


_REMEDY = "no dataclass that is a task, as a subclass of CustomTask"
_PLUGIN = Annotated[PluginTask, reader(PluginTask, (Task,), _REMEDY, UnknownTask), SCHEMA]
AnyTask = Annotated[TaskTable, Either(_task_type, {**TASK_TABLES, "plugin": _PLUGIN, "_unknown": UnknownTask})]

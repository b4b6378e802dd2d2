"""Keys of a scenario file: what each may hold, its unit, bounds, default and meaning; the JSON Schema follows.

Names of robots' joints and frames are checked where the robot is known, in `ospace.scenario.rehearsal`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
import pinocchio as pin
from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    WithJsonSchema,
    create_model,
    model_validator,
)

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
from ospace.control.base import MODES
from ospace.control.references import Reference
from ospace.control.solvers import solver_named
from ospace.exceptions import OspaceError, closest
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import unit_of
from ospace.model.points import Axes, OperationalPoint, parse_axes
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario.table import Array, Either, Flag, Level, OneOf, Problem, Table, Text
from ospace.scenario.units import Angles, AngularVelocities, Lengths, Quantity, Time, Vector, Velocities
from ospace.simulation.integrators import INTEGRATORS

_MOST_STEPS = 2_000_000
_UNIT_LENGTH = 1e-3
_DIRECTION = 1e-9
_WHOLE = 1e-9
_LEAST_MOMENT = 1e-9
"""Least principal moment of inertia of a target's body, kg m²."""
_TENSOR = ((0, 3, 4), (3, 1, 5), (4, 5, 2))
"""Where ixx, iyy, izz, ixy, ixz, iyz stand in the tensor."""


# -- types of keys -----------------------------------------------------------------------------------------------


def _is(kind: type) -> Callable[[Any], str]:
    return lambda value: "is" if isinstance(value, kind) else "else"


def _unit_quaternion(x: Floats) -> Floats:
    length = float(np.linalg.norm(x))
    if abs(length - 1.0) > _UNIT_LENGTH:
        raise ValueError(f"its length is {length:.6g}: give x, y, z, w of length 1")
    return np.asarray(x / length)


def _direction(axis: Floats) -> Floats:
    if not np.linalg.norm(axis) > _DIRECTION:
        raise ValueError(f"gives no direction: not all three may be zero, or below {_DIRECTION:g}")
    return axis


def _tensor(inertia: Floats) -> Floats:
    tensor = inertia if len(inertia) == 3 else np.array([[inertia[k] for k in row] for row in _TENSOR])
    if not np.abs(tensor if tensor.ndim == 1 else np.linalg.eigvalsh(tensor)).min() >= _LEAST_MOMENT:
        raise ValueError(f"principal moments must be at least {_LEAST_MOMENT:g} kg m^2")
    return tensor


def _six(axes: list[bool]) -> Axes:
    try:
        return parse_axes(axes)
    except OspaceError as error:
        raise ValueError(str(error)) from None


def _installed(solver: str) -> str:
    try:
        solver_named(solver)
    except OspaceError as error:
        raise ValueError(str(error)) from None
    return solver


def _true(value: object) -> object:
    if value is not True:
        raise ValueError("give true, or leave it out")
    return value


def _vector(description: str, first: float = 0.0) -> Any:
    """Return the field of a vector that is zero, or along x, if it is left out."""
    default: list[Any] = [first, 0.0, 0.0]
    return Field(
        default_factory=lambda: np.array(default), description=description, json_schema_extra={"default": default}
    )


def _empty(kind: type[Table], description: str) -> Any:
    """Return the field of a table that has its defaults if it is left out."""
    return Field(default_factory=lambda: kind.model_validate({}), description=description)


def _without_default(schema: dict[str, Any]) -> None:
    del schema["default"]


def _unbounded(description: str) -> Any:
    """Return the field of a bound that is infinite if it is left out; JSON has no number for that."""
    return Field(math.inf, description=description, json_schema_extra=_without_default)


Quaternion = Annotated[Floats, Vector("number", 4), AfterValidator(_unit_quaternion)]
Inertia = Annotated[
    Floats,
    Either(
        lambda value: "six" if isinstance(value, list) and len(value) == 6 else "three",
        {"three": Annotated[Floats, Vector("inertia")], "six": Annotated[Floats, Vector("inertia", 6)]},
    ),
    AfterValidator(_tensor),
]
AxesKey = Annotated[
    Axes,
    Either(
        _is(list),
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
Period = Annotated[float, Quantity("time", least=1e-6, most=10.0)]
Weight = Annotated[float, Quantity("number", least=0.0)]


def _limit(dimension: str) -> Either:
    """Return the type of one limit for all three axes, or of three."""
    largest = Annotated[float, Quantity(dimension, least=0.0, infinite=True)]
    return Either(_is(list), {"is": Annotated[Floats, Vector(dimension)], "else": largest})


@dataclass(frozen=True)
class ByJoint:
    """Type of a table from joint names to quantities, whose dimension is that of the joint."""

    linear: str
    angular: str
    above: float = -math.inf

    def of(self, joint: str, robot: SpaceRobot) -> Quantity:
        """Return the type of a joint's quantity; raises `ValueError` for a joint with several degrees of freedom."""
        model = robot.model.joints[robot.joint_number(joint)]
        if model.nv > 1:
            raise ValueError(f"joint '{joint}' has {model.nv} degrees of freedom: a scenario sets joints with one")
        return Quantity(self.linear if unit_of(model) == "m" else self.angular, above=self.above)

    def read(self, given: Mapping[str, Any], robot: SpaceRobot, key: str) -> tuple[dict[str, float], list[Problem]]:
        """Return the quantities in SI units, and what is wrong with others."""
        values, problems = {}, []
        for name, value in given.items():
            try:
                values[name] = self.of(name, robot).read(value)
            except (OspaceError, ValueError) as error:
                problems.append((f"{key}.{name}", str(error)))
        return values, problems

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        of = [
            Quantity(one, above=self.above).__get_pydantic_json_schema__(core, handler)
            for one in (self.linear, self.angular)
        ]
        return {"type": "object", "additionalProperties": {"anyOf": of}}


POSITIONS = ByJoint("length", "angle")
RATES = ByJoint("velocity", "angular velocity")
ACCELERATIONS = ByJoint("acceleration", "angular acceleration", above=0.0)


# -- robot and target --------------------------------------------------------------------------------------------


class MadeTable(Table):
    """A table that an object of ospace is made of, which says itself what it cannot be."""

    def make(self) -> Any:
        """Make the object."""
        raise NotImplementedError

    def mistakes(self) -> Iterable[Problem]:
        """Return what the object refuses."""
        if not self._noted:
            try:
                self.make()
            except OspaceError as error:
                yield self.key, str(error)


class PoseTable(Table):
    """A pose; what is left out is zero."""

    model_config = ConfigDict(json_schema_extra={"not": {"required": ["rpy", "quaternion"]}})
    position: Lengths | None = Field(None, description="Place")
    rpy: Angles | None = Field(None, description="Roll, pitch and yaw, as in URDF")
    quaternion: Quaternion | None = Field(None, description="x, y, z, w, of length 1; instead of rpy")

    @property
    def rotation(self) -> Floats | None:
        """The rotation (3, 3), where one is given."""
        if self.quaternion is not None:
            return np.asarray(pin.Quaternion(self.quaternion).toRotationMatrix())
        return None if self.rpy is None else np.asarray(pin.rpy.rpyToMatrix(self.rpy))

    @property
    def pose(self) -> pin.SE3:
        """The pose."""
        rotation = np.eye(3) if self.rotation is None else self.rotation
        return pin.SE3(rotation, np.zeros(3) if self.position is None else self.position)

    def mistakes(self) -> Iterable[Problem]:
        """Return whether two rotations are given."""
        if {"rpy", "quaternion"} <= self.model_fields_set:
            yield self.path("quaternion"), "give rpy or quaternion, not both"


def _amount(limit: float | Floats) -> float | tuple[float, float, float]:
    if isinstance(limit, float):
        return limit
    x, y, z = map(float, limit)
    return x, y, z


class BaseTable(MadeTable):
    """What acts on the base."""

    force: Annotated[float | Floats, _limit("force")] = Field(0.0, description="Largest along each base axis, or three")
    torque: Annotated[float | Floats, _limit("torque")] = Field(
        0.0, description="Largest about each base axis, or three"
    )
    wheels: Flag = Field(False, description="Torques come of reaction wheels")
    wheel_momentum: Annotated[float, Quantity("angular momentum", above=0.0, infinite=True)] = _unbounded(
        "Largest that wheels store about each base axis; no bound if it is left out"
    )

    def make(self) -> Base:
        """Make the base."""
        return Base(_amount(self.force), _amount(self.torque), self.wheels, self.wheel_momentum)


class RobotTable(PoseTable):
    """The chaser."""

    model: Text = Field(description="A URDF, relative to the scenario, or a robot that comes with ospace")
    base: Annotated[
        BaseTable | str,
        Either(
            lambda value: {dict: "table", str: "mode"}.get(type(value)),
            {"table": BaseTable, "mode": Annotated[str, OneOf(tuple(MODES))]},
            f"give the name of a mode, or a table{closest('', MODES)}",
        ),
    ] = Field("floating", description="What acts on the base: nothing, all, forces, or torques of wheels; or a table")
    velocity: Velocities = _vector("Of the base-link frame's origin, inertial axes")
    angular_velocity: AngularVelocities = _vector("Of the base, inertial axes")
    joints: Annotated[dict[str, Any], POSITIONS] = Field({}, description="Position by joint name: angle or length")
    joint_rates: Annotated[dict[str, Any], RATES] = Field({}, description="Rate by joint name")

    def make_base(self) -> Base:
        """Make what acts on the base."""
        return self.base.make() if isinstance(self.base, BaseTable) else MODES[self.base]


class BodyTable(Table):
    """A rigid body."""

    mass: Annotated[float, Quantity("mass", least=1e-6)] = Field(description="Mass")
    inertia: Inertia = Field(
        description="About the mass centre: three principal moments, or ixx, iyy, izz, ixy, ixz, iyz"
    )
    mass_centre: Lengths = _vector("Place of the mass centre, in axes of the body")
    name: Text = Field("target", description="Name")
    frames: dict[str, PoseTable] = Field({}, description="Pose by frame name")


class TargetTable(PoseTable):
    """What the chaser can grasp."""

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": ["model"]}, {"required": ["body"]}]})
    model: Text | None = Field(None, description="A URDF, relative to the scenario, or a model that comes with ospace")
    body: BodyTable | None = Field(None, description="The numbers of a rigid body, instead of model")
    spin: AngularVelocities = _vector("About its mass centre, inertial axes")
    velocity: Velocities = _vector("Of its mass centre, inertial axes")
    joints: Annotated[dict[str, Any], POSITIONS] = Field({}, description="Position by joint name; they have no drives")

    def mistakes(self) -> Iterable[Problem]:
        """Return whether there is not one of model and body."""
        yield from super().mistakes()
        if ("model" in self.model_fields_set) == ("body" in self.model_fields_set):
            yield self.key, "give either model, a URDF, or body, the numbers of a rigid body"


# -- limits and control ------------------------------------------------------------------------------------------


class LimitsTable(Table):
    """Limits of the joints, taken from the model."""

    share: Annotated[float, Quantity("number", above=0.0, most=1.0)] = Field(
        1.0, description="Of the model's torque and velocity limits"
    )
    acceleration: Annotated[
        float | dict[str, Any] | None,
        Either(
            _is(dict),
            {
                "is": Annotated[dict[str, Any], ACCELERATIONS],
                "else": Annotated[float, Quantity("angular acceleration", above=0.0, infinite=True)],
            },
        ),
    ] = Field(None, description="Of all joints, or by joint name; sliding joints take the same number in m/s^2")

    def accelerations(self, robot: SpaceRobot) -> tuple[dict[str, float], list[Problem]]:
        """Return the limits of acceleration by joint, SI units, and what is wrong with others."""
        if isinstance(self.acceleration, dict):
            return ACCELERATIONS.read(self.acceleration, robot, self.path("acceleration"))
        return {} if self.acceleration is None else dict.fromkeys(robot.joint_names, self.acceleration), []

    def of(self, robot: SpaceRobot, actuated: SpaceRobot) -> JointLimits:
        """Return the limits of `robot`, of whose joints those of `actuated` have drives."""
        limits = JointLimits.of(robot, acceleration=self.accelerations(actuated)[0], share=self.share)
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


class ControlTable(Table):
    """How control and simulation go."""

    period: Period = Field(1e-3, description="Of the control cycle, a whole number of steps")
    step: Period = Field(1e-3, description="Of the integrator; the period if that is shorter")
    solver: Annotated[Text, AfterValidator(_installed)] = Field(
        "daqp", description="daqp, proxqp, or a back-end of qpsolvers that is installed"
    )
    integrator: Annotated[str, OneOf(INTEGRATORS)] = Field("rk4", description="Scheme that integrates the motion")

    @model_validator(mode="after")
    def _short_step(self) -> ControlTable:
        if "step" not in self.model_fields_set:
            self.step = min(self.step, self.period)
        return self

    def mistakes(self) -> Iterable[Problem]:
        """Return whether the period is not a whole number of steps."""
        count = self.period / self.step
        if math.isfinite(count) and not (round(count) >= 1 and abs(count - round(count)) <= _WHOLE * max(1.0, count)):
            yield self.path("period"), f"{self.period:g} s is not a whole number of steps of {self.step:g} s"


# -- goals -------------------------------------------------------------------------------------------------------


class Hold(Table):
    """Stay; with a duration, come to rest within it."""

    hold: Annotated[Literal[True], BeforeValidator(_true)] = Field(description="true")
    duration: Time = Field(0.0, description="Of the motion")


class ToPose(PoseTable):
    """A pose in the inertial frame; what is None stays as it is at the phase's start."""

    duration: Time = Field(0.0, description="Of the motion")


class Shift(Table):
    """From where the point is at the phase's start, by so much; inertial axes."""

    shift: Lengths = _vector("Displacement, inertial axes")
    turn: Angles = _vector("Rotation vector, inertial axes")
    duration: Time = Field(0.0, description="Of the motion")


class Follow(Table):
    """A frame of the target, with an offset as seen from it."""

    follow: Text = Field(description="A frame of the target")
    offset: PoseTable = _empty(PoseTable, "Pose as seen from that frame")
    duration: Time = Field(0.0, description="Of the motion")


class ToMomentum(Table):
    """Linear momentum, and angular about the centre of mass."""

    linear: Annotated[Floats, Vector("momentum")] = _vector("Linear momentum, inertial axes")
    angular: Annotated[Floats, Vector("angular momentum")] = _vector(
        "Angular momentum about the centre of mass, inertial axes"
    )
    duration: ClassVar[float] = 0.0

    @property
    def momentum(self) -> Floats:
        """Linear and angular momentum (6,)."""
        return np.concatenate([self.linear, self.angular])


Goal = Hold | ToPose | Shift | Follow | ToMomentum
_GOALS = {
    "follow": {"follow"},
    "shift": {"shift", "turn"},
    "pose": {"position", "rpy", "quaternion"},
    "hold": {"hold"},
}
"""The keys of which a goal has one or more, and of the others none."""


def _goal_way(value: Any) -> str | None:
    if isinstance(value, str):
        return "text"
    ways = [way for way, keys in _GOALS.items() if isinstance(value, dict) and keys & value.keys()]
    return ways[0] if len(ways) == 1 else None


def _of_text(goal: Goal | str) -> Goal:
    if isinstance(goal, str):
        return ToMomentum() if goal == "zero" else Hold(hold=True, duration=0.0)
    return goal


MotionGoal = Annotated[
    Goal,
    Either(
        _goal_way,
        {
            "text": Annotated[str, OneOf(("hold",))],
            "hold": Hold,
            "pose": ToPose,
            "shift": Shift,
            "follow": Follow,
        },
        "give one of: follow; shift or turn; position, rpy or quaternion; hold",
    ),
    AfterValidator(_of_text),
]
MomentumGoal = Annotated[
    Goal,
    Either(
        lambda value: {str: "text", dict: "table"}.get(type(value)),
        {"text": Annotated[str, OneOf(("zero", "hold"))], "table": ToMomentum},
        "give 'zero', 'hold', or a table with linear, angular or both",
    ),
    AfterValidator(_of_text),
]


def _goal(default: str = "hold") -> Any:
    """Return the field of a goal."""
    what = "What to follow from the phase's start on"
    return Field(default_factory=lambda: _of_text(default), description=what, json_schema_extra={"default": default})


# -- tasks -------------------------------------------------------------------------------------------------------


class CompletionTable(MadeTable):
    """When a task counts as done."""

    position: Annotated[float, Quantity("length", above=0.0, infinite=True)] = _unbounded(
        "Largest norm of the linear error"
    )
    angle: Annotated[float, Quantity("angle", above=0.0, infinite=True)] = _unbounded(
        "Largest norm of the angular error, or largest error of a joint"
    )
    hold: Time = Field(0.0, description="For how long, without a break")

    def make(self) -> Completion:
        """Make the completion test."""
        return Completion(self.position, self.angle, self.hold)


class MomentumCompletion(CompletionTable):
    """When a momentum task counts as done."""

    position: Annotated[float, Quantity("momentum", above=0.0, infinite=True)] = _unbounded(
        "Largest norm of the error of linear momentum"
    )
    angle: Annotated[float, Quantity("angular momentum", above=0.0, infinite=True)] = _unbounded(
        "Largest norm of the error of angular momentum"
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
        """Its goal; None for tasks that follow nothing: posture and damping."""
        goal: Goal | None = self._of("goal")
        return goal

    @property
    def motion(self) -> float:
        """How long its motion takes, s."""
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
}
"""By the `type` of a task: a table has the keys that the class has an argument for."""
_NOT_OF_THE_CLASS = ("type", "goal", "offset")
_KEYS: dict[str, Any] = {
    "point": (Text, Field(description="A frame of the robot")),
    "offset": (
        PoseTable,
        _empty(PoseTable, "Of the point, as seen from the frame"),
    ),
    "seen_from": (Text, Field(description="The frame that the pose is seen from")),
    "axes": (AxesKey | None, Field(None, description="Which of six components; if left out, all that the type has")),
    "axis": (
        Annotated[Floats, Vector("number"), AfterValidator(_direction)],
        _vector("What looks, in the point's axes", 1.0),
    ),
    "posture": (
        Annotated[dict[str, Any] | None, POSITIONS],
        Field(None, description="Position by joint name; if left out, all joints stay where they are"),
    ),
    "goal": (MotionGoal, _goal("hold")),
}
_WITHOUT_GOAL = (PostureTask, DampingTask)


def _table_of(name: str, task: type[Task]) -> type[TaskTable]:
    """Make the table of a type of tasks."""
    known = {one.name for one in fields(task)} | (set() if task in _WITHOUT_GOAL else {"goal"})
    known |= {"offset"} if "point" in known else set()
    keys = {key: kind for key, kind in _KEYS.items() if key in known}
    if task is MomentumTask:
        keys["goal"] = MomentumGoal, _goal("zero")
        keys["completion"] = MomentumCompletion | None, Field(None, description="When it counts as done")
    keys["weight"] = Weight, Field(task.weight, description="Beside tasks of the same level")
    keys["type"] = Literal[name], Field(description=f"A task of the class {task.__name__}")
    return create_model(
        f"{task.__name__}Table", __base__=TaskTable, __doc__=f"A task of type {name}.", __module__=__name__, **keys
    )


TASK_TABLES = {name: _table_of(name, task) for name, task in TASKS.items()}
globals().update({table.__name__: table for table in TASK_TABLES.values()})  # where pickle looks for them


class _UnknownTask(TaskTable):
    """Says what is wrong with the type, and nothing of keys that it may have."""

    model_config = ConfigDict(extra="ignore")
    type: Annotated[str, OneOf(tuple(TASKS))]


def _task_type(value: Any) -> str:
    named = value.get("type") if isinstance(value, dict) else None
    return named if isinstance(named, str) and named in TASKS else "_unknown"


AnyTask = Annotated[TaskTable, Either(_task_type, {**TASK_TABLES, "_unknown": _UnknownTask})]


# -- phases ------------------------------------------------------------------------------------------------------


class GraspTable(Table):
    """The target's frame `fixture` is fixed to the chaser's frame `hand`, where they are near enough."""

    hand: Text = Field(description="A frame of the chaser")
    fixture: Text = Field(description="A frame of the target")
    position: Annotated[float, Quantity("length", above=0.0, infinite=True)] = Field(
        0.01, description="Largest distance of the two"
    )
    angle: Annotated[float, Quantity("angle", above=0.0, infinite=True)] = Field(
        math.radians(1.0), description="Largest angle between the two"
    )


class PhaseTable(Table):
    """A phase: it ends when all completion tests hold, its motions are done and `duration` is over; or at `timeout`."""

    name: Text = Field(description="A name of its own")
    timeout: Annotated[float, Quantity("time", above=0.0)] = Field(
        description="Longest time; the run then ends as failed"
    )
    duration: Time = Field(0.0, description="Shortest time; required where no task has a completion test")
    task: Annotated[list[AnyTask], Array] = Field([], description="Tasks of this phase")
    grasp: GraspTable | None = Field(None, description="At the end, the target is grasped")
    release: Flag = Field(False, description="At the end, the target is let go")
    _shared: list[TaskTable] = PrivateAttr(default_factory=list)

    @property
    def tasks(self) -> list[TaskTable]:
        """Its own tasks, and those of all phases that it does not replace."""
        names = [task.name for task in self.task]
        return [*self.task, *(task for task in self._shared if task.name not in names)]

    def owns(self, task: TaskTable) -> bool:
        """Return whether a task is of this phase alone, and none of all phases."""
        return task in self.task

    @property
    def changes_robot(self) -> bool:
        """Whether the phases after it have another robot: the target is grasped or let go."""
        return self.release or self.grasp is not None

    @property
    def earliest(self) -> float:
        """The shortest time that it takes: its motions are done, and tests have held from then on; s."""
        return max([self.duration, *(self.motion(task) + task.hold for task in self.tasks)])

    def motion(self, task: TaskTable) -> float:
        """Return how long the motion of one of its tasks takes, s; that of a task of all phases has begun before."""
        return task.motion if self.owns(task) else 0.0

    def mistakes(self) -> Iterator[Problem]:
        """Yield what does not fit together in a phase."""
        if self.duration > self.timeout:
            yield self.path("duration"), f"{self.duration:g} s is longer than the time-out, {self.timeout:g} s"
        yield from _same_names("task", self.task)
        tasks, given = self.tasks, {name for name, _ in self._noted}
        if not tasks and "task" not in given:
            what = "a phase needs at least one task, [[phase.task]], or one of all phases, [[task]]"
            yield self.path("task"), what
        for task in tasks:
            motion = self.motion(task)
            if motion + task.hold > self.timeout:
                what = (
                    f"{motion + task.hold:g} s of motion and hold are longer than the time-out of phase '{self.name}'"
                )
                part = "goal.duration" if motion > self.timeout else "completion.hold"
                yield task.path(part), f"{what}, {self.timeout:g} s"
        done = any("completion" in task.model_fields_set or isinstance(task, _UnknownTask) for task in tasks)
        if not (self.duration or done or "task" in given):
            yield self.key, "nothing ends the phase: give a duration, or a task with a completion test"
        if self.release and "grasp" in self.model_fields_set:
            yield self.path("release"), "a phase ends by a grasp or by a release, not by both"


class ScenarioTable(Table):
    """A scenario of ospace: a robot, perhaps a target, and phases with their tasks."""

    name: Text | None = Field(None, description="Title; the file's name if left out")
    robot: RobotTable = Field(description="The chaser")
    target: TargetTable | None = Field(None, description="What it can grasp")
    limits: LimitsTable = _empty(LimitsTable, "Limits of the joints")
    control: ControlTable = _empty(ControlTable, "How control and simulation go")
    task: Annotated[list[AnyTask], Array] = Field([], description="Tasks of all phases")
    phase: Annotated[list[PhaseTable], Array] = Field(
        description="Phases, in their order", json_schema_extra={"minItems": 1}
    )

    @model_validator(mode="after")
    def _share(self) -> ScenarioTable:
        for phase in self.phase:
            phase._shared = self.task
        return self

    def mistakes(self) -> Iterator[Problem]:
        """Yield what does not fit together in a scenario."""
        if not self.phase and "phase" not in dict(self._noted):
            yield "phase", "a scenario needs at least one phase, [[phase]]"
        longest = sum(phase.timeout for phase in self.phase)
        if longest > _MOST_STEPS * self.control.step:
            what = f"time-outs of {longest:g} s in all are more than {_MOST_STEPS} steps of {self.control.step:g} s"
            yield "phase", f"{what}: make them shorter, or control.step longer"
        yield from _same_names("phase", self.phase)


def _same_names(what: str, tables: Iterable[PhaseTable] | Iterable[TaskTable]) -> Iterator[Problem]:
    known: set[str] = set()
    for table in tables:
        if table.name in known:
            yield table.path("name"), f"two {what}s are called '{table.name}'"
        known |= {table.name} - {""}


@dataclass(frozen=True, eq=False)
class Scenario:
    """A scenario; read one with `ospace.scenario.load`.

    Attributes
    ----------
    path : Path
    source : str
        The text of the file.
    name : str
    robot : SpaceRobot
        The chaser.
    start : State
        Of the chaser.
    target_robot : SpaceRobot, optional
    target : State, optional
        Of the target at the start.
    base : Base
    limits : LimitsTable
    control : ControlTable
    phases : tuple of PhaseTable
    """

    path: Path
    source: str
    name: str
    robot: SpaceRobot
    start: State
    target_robot: SpaceRobot | None
    target: State | None
    base: Base
    limits: LimitsTable
    control: ControlTable
    phases: tuple[PhaseTable, ...]


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a scenario file, draft 2020-12: each key with its meaning, unit, bounds and default."""
    made = ScenarioTable.model_json_schema(mode="validation")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "ospace scenario"} | made

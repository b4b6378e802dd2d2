"""Operational-space control: tasks and limits to joint torques, by one quadratic program a cycle."""

from ospace.control.base import Base
from ospace.control.clearance import Clearance, Nearest, Obstacle
from ospace.control.command import Command
from ospace.control.controller import Controller
from ospace.control.inequalities import Inequality, RowsInequality
from ospace.control.instant import Instant
from ospace.control.limits import JointLimits
from ospace.control.realtime import realtime
from ospace.control.references import Constant, Function, MinimumJerk
from ospace.control.tasks import (
    BaseAttitudeTask,
    CentreOfMassTask,
    Completion,
    CustomTask,
    DampingTask,
    LookAtTask,
    MomentumTask,
    OrientationTask,
    PoseTask,
    PositionTask,
    PostureTask,
    RelativePoseTask,
    RowsTask,
    Task,
    ZeroReactionTask,
)

__all__ = [
    "Base",
    "BaseAttitudeTask",
    "CentreOfMassTask",
    "Clearance",
    "Command",
    "Completion",
    "Constant",
    "Controller",
    "CustomTask",
    "DampingTask",
    "Function",
    "Inequality",
    "Instant",
    "JointLimits",
    "LookAtTask",
    "MinimumJerk",
    "MomentumTask",
    "Nearest",
    "Obstacle",
    "OrientationTask",
    "PoseTask",
    "PositionTask",
    "PostureTask",
    "RelativePoseTask",
    "RowsInequality",
    "RowsTask",
    "Task",
    "ZeroReactionTask",
    "realtime",
]

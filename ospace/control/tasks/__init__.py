"""Tasks, one file each."""

from ospace.control.tasks.base_attitude import BaseAttitudeTask
from ospace.control.tasks.centre_of_mass import CentreOfMassTask
from ospace.control.tasks.custom import CustomTask, RowsTask
from ospace.control.tasks.damping import DampingTask
from ospace.control.tasks.look_at import LookAtTask
from ospace.control.tasks.momentum import MomentumTask
from ospace.control.tasks.orientation import OrientationTask
from ospace.control.tasks.pose import PoseTask
from ospace.control.tasks.position import PositionTask
from ospace.control.tasks.posture import PostureTask
from ospace.control.tasks.relative_pose import RelativePoseTask
from ospace.control.tasks.task import Completion, Task
from ospace.control.tasks.zero_reaction import ZeroReactionTask

__all__ = [
    "BaseAttitudeTask",
    "CentreOfMassTask",
    "Completion",
    "CustomTask",
    "DampingTask",
    "LookAtTask",
    "MomentumTask",
    "OrientationTask",
    "PoseTask",
    "PositionTask",
    "PostureTask",
    "RelativePoseTask",
    "RowsTask",
    "Task",
    "ZeroReactionTask",
]

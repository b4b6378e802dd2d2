"""Keys of a scenario file: what each may hold, its unit, bounds, default and meaning; the JSON Schema follows.

Names of robots' joints and frames are checked where the robot is known, in `ospace.scenario.rehearsal`.
"""

from ospace.scenario.schema.control_tables import LimitsTable
from ospace.scenario.schema.disturbance_table import ROBOT, TARGET, DisturbanceTable
from ospace.scenario.schema.goal_tables import Follow, Hold, Shift, ToMomentum, ToPose, Via
from ospace.scenario.schema.keys import POSITIONS, RATES
from ospace.scenario.schema.mass_error_table import MassErrorTable
from ospace.scenario.schema.noise_table import NoiseTable
from ospace.scenario.schema.phase_tables import GraspTable, PhaseTable
from ospace.scenario.schema.plugin_tables import InequalityTable, PluginTable
from ospace.scenario.schema.robot_tables import BodyTable, RobotTable, TargetTable
from ospace.scenario.schema.scenario import Scenario, ScenarioTable, Target, json_schema
from ospace.scenario.schema.task_tables import TASKS, TaskTable

__all__ = [
    "POSITIONS",
    "RATES",
    "ROBOT",
    "TARGET",
    "TASKS",
    "BodyTable",
    "DisturbanceTable",
    "Follow",
    "GraspTable",
    "Hold",
    "InequalityTable",
    "LimitsTable",
    "MassErrorTable",
    "NoiseTable",
    "PhaseTable",
    "PluginTable",
    "RobotTable",
    "Scenario",
    "ScenarioTable",
    "Shift",
    "Target",
    "TargetTable",
    "TaskTable",
    "ToMomentum",
    "ToPose",
    "Via",
    "json_schema",
]

"""Scenarios: a robot, a target and phases, from a TOML file to a run with its certificate."""

from ospace.scenario import log, series
from ospace.scenario.coarse_run import rehearse
from ospace.scenario.errors import ScenarioError
from ospace.scenario.load import load
from ospace.scenario.motion import Approach, FreeMotion
from ospace.scenario.result import Contact, PhaseResult, Run, Segment, TaskErrors
from ospace.scenario.runner import run
from ospace.scenario.schema import Scenario

__all__ = [
    "Approach",
    "Contact",
    "FreeMotion",
    "PhaseResult",
    "Run",
    "Scenario",
    "ScenarioError",
    "Segment",
    "TaskErrors",
    "load",
    "log",
    "rehearse",
    "run",
    "series",
]

"""Scenarios: a robot, a target and phases, from a TOML file to a run with its certificate."""

from ospace.exceptions import ScenarioError
from ospace.scenario import log, series
from ospace.scenario.description import Scenario
from ospace.scenario.motion import Approach, FreeMotion
from ospace.scenario.reading import load
from ospace.scenario.result import Contact, PhaseResult, Run, Segment, TaskErrors
from ospace.scenario.running import run

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
    "run",
    "series",
]

"""The whole file, and the scenario that it becomes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import Field, model_validator

from ospace.control import Base
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario.schema.control_tables import ControlTable, LimitsTable
from ospace.scenario.schema.disturbance_table import ROBOT, DisturbanceTable
from ospace.scenario.schema.keys import default_table, is_a
from ospace.scenario.schema.mass_error_table import MassErrorTable
from ospace.scenario.schema.noise_table import NoiseTable
from ospace.scenario.schema.phase_tables import PhaseTable, same_names
from ospace.scenario.schema.plugin_tables import AnyInequality
from ospace.scenario.schema.robot_tables import RobotTable, TargetTable
from ospace.scenario.schema.task_tables import AnyTask
from ospace.scenario.table import Array, Either, Problem, Table, Text

_MOST_STEPS = 2_000_000


class ScenarioTable(Table):
    """A scenario of ospace: a robot, perhaps a target, and phases with their tasks."""

    name: Text | None = Field(None, description="Title; the file's name if left out")
    robot: RobotTable = Field(description="The chaser")
    target: Annotated[
        TargetTable | list[TargetTable] | None,
        Either(is_a(list), {"is": Annotated[list[TargetTable], Array], "else": TargetTable}),
    ] = Field(None, description="What it can grasp: a table, or several, [[target]]")
    limits: LimitsTable = default_table(LimitsTable, "Limits of the joints")
    control: ControlTable = default_table(ControlTable, "How control and simulation go")
    noise: NoiseTable = default_table(NoiseTable, "Noise of the sensors")
    mass_error: Annotated[list[MassErrorTable], Array] = Field(
        [], description="Errors of the model that the controller has"
    )
    disturbance: Annotated[list[DisturbanceTable], Array] = Field([], description="Wrenches from outside")
    task: Annotated[list[AnyTask], Array] = Field([], description="Tasks of all phases")
    inequality: Annotated[list[AnyInequality], Array] = Field([], description="Inequalities of all phases")
    phase: Annotated[list[PhaseTable], Array] = Field(
        description="Phases, in their order", json_schema_extra={"minItems": 1}
    )

    @model_validator(mode="after")
    def _share(self) -> ScenarioTable:
        for phase in self.phase:
            phase._shared, phase._shared_inequalities = self.task, self.inequality
        return self

    @property
    def targets(self) -> list[TargetTable]:
        """All targets."""
        if isinstance(self.target, TargetTable):
            return [self.target]
        return self.target or []

    def mistakes(self) -> Iterator[Problem]:
        """Yield what does not fit together in a scenario."""
        if not self.phase and "phase" not in dict(self._noted):
            yield "phase", "a scenario needs at least one phase, [[phase]]"
        longest = sum(phase.timeout for phase in self.phase)
        if longest > _MOST_STEPS * self.control.step:
            what = f"time-outs of {longest:g} s in all are more than {_MOST_STEPS} steps of {self.control.step:g} s"
            yield "phase", f"{what}: make them shorter, or control.step longer"
        yield from same_names("phase", self.phase)
        targets = self.targets
        known: set[str | None] = {None}
        for one in targets:
            if one.name in known - {None}:
                yield one.path("name"), f"two targets are called '{one.name}'"
            known.add(one.name)
            if one.name is None and len(targets) > 1:
                yield one.path("name"), "missing: there are several targets"
            if one.name == ROBOT:
                yield one.path("name"), f"'{ROBOT}' is the chaser: give another name"
        yield from same_names("disturbance", self.disturbance)


class Target(NamedTuple):
    """A target: its robot, and its state at the start."""

    robot: SpaceRobot
    start: State


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
    targets : mapping of str to Target
        By name, in their order in the file.
    base : Base
    limits : LimitsTable
    control : ControlTable
    noise : NoiseTable
    disturbances : tuple of DisturbanceTable
    mass_errors : tuple of MassErrorTable
    phases : tuple of PhaseTable
    """

    path: Path
    source: str
    name: str
    robot: SpaceRobot
    start: State
    targets: Mapping[str, Target]
    base: Base
    limits: LimitsTable
    control: ControlTable
    noise: NoiseTable
    disturbances: tuple[DisturbanceTable, ...]
    mass_errors: tuple[MassErrorTable, ...]
    phases: tuple[PhaseTable, ...]

    def disturbances_of(self, of: str) -> list[DisturbanceTable]:
        """Return the disturbances of the robot, or of a target.

        Parameters
        ----------
        of : str
            "robot", or the name of the target.

        Returns
        -------
        list of DisturbanceTable
        """
        return [one for one in self.disturbances if one.of == of]

    def target_named(self, name: str | None) -> str:
        """Return the name of a target; of the only one where none is given.

        Parameters
        ----------
        name : str, optional

        Returns
        -------
        str
        """
        return name or next(iter(self.targets))


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a scenario file, draft 2020-12: each key with its meaning, unit, bounds and default."""
    made = ScenarioTable.model_json_schema(mode="validation")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "ospace scenario"} | made

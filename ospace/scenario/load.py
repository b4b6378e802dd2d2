"""From a TOML file to a `Scenario`: all problems are reported together, each by its key."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ospace import models
from ospace.exceptions import OspaceError
from ospace.files import open_regular
from ospace.model.joint_positions import Position
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario.errors import ScenarioError
from ospace.scenario.plugins import allowed
from ospace.scenario.rehearsal import rehearse
from ospace.scenario.schema import (
    POSITIONS,
    RATES,
    TARGET,
    BodyTable,
    RobotTable,
    Scenario,
    ScenarioTable,
    Target,
    TargetTable,
)
from ospace.scenario.table import Problem
from ospace.simulation import rigid_body, tumbling

_LARGEST_FILE = 1_000_000
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
_ENDLESS = {
    re.compile(rf"(?<![\w-]){_PART}(?:\s*+\.\s*+{_PART}){{32}}"): "a key of more than 32 parts",
    re.compile(r"(?<![\w-])[+-]?[\d_]{1000}"): "a number of 1000 digits or more",
}
"""What a reader of TOML takes minutes and gigabytes for, or gives up."""


def load(path: str | os.PathLike[str], plugins: Iterable[str] = ()) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    path : path-like
        A TOML file; its schema is in ``docs/scenario.md``.
    plugins : sequence of str
        Modules with code that the scenario may name, as ``my_module:MyTask``; they are imported.

    Returns
    -------
    Scenario

    Raises
    ------
    ScenarioError
        The file cannot be read, or the scenario cannot run, as one that names code of a module which is not among the
        `plugins`: carries all problems, by key.
    OspaceError
        A plugin cannot be imported.
    """
    file = models.find(path, scenarios=True)
    source = _text(file)
    for pattern, what in _ENDLESS.items():
        if found := pattern.search(source):
            line = source.count("\n", 0, found.start()) + 1
            raise ScenarioError(file, [("", f"is no scenario: {what} (at line {line})")])
    try:
        data = tomllib.loads(source)
    except tomllib.TOMLDecodeError as error:
        raise ScenarioError(file, [("", f"is not TOML: {error}")]) from None
    except RecursionError:
        raise ScenarioError(file, [("", "is not a scenario: values are nested too deep")]) from None
    with allowed(plugins):
        read = ScenarioTable.model_validate(data)
    tables = list(read.tables())
    problems = [problem for table in tables for problem in table.problems()]
    robots = _Robots(file.parent, problems)
    chaser = robots.chaser(read.robot) if isinstance(read.robot, RobotTable) else None
    named = {table.name or TARGET: robots.target(table) for table in read.targets}
    if chaser is None:
        raise ScenarioError(file, problems)
    made = Scenario(
        path=file,
        source=source,
        name=read.name or file.stem,
        robot=chaser[0],
        start=chaser[1],
        targets={name: Target(*one) for name, one in named.items() if one is not None},
        base=read.robot.make_base(),
        limits=read.limits,
        control=read.control,
        noise=read.noise,
        disturbances=tuple(read.disturbance),
        mass_errors=tuple(read.mass_error),
        phases=tuple(read.phase),
    )
    unread = "target" in read.model_fields_set and not named
    rehearse(made, problems, None if unread else named.keys())
    if problems:
        raise ScenarioError(file, problems)
    return made


def _text(file: Path) -> str:
    try:
        with open_regular(file) as opened:
            content = opened.read(_LARGEST_FILE + 1)
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise ScenarioError(file, [("", getattr(error, "strerror", None) or str(error))]) from None
    if len(content) > _LARGEST_FILE:
        raise ScenarioError(file, [("", f"is larger than {_LARGEST_FILE // 1_000_000} MB: no scenario is")])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(file, [("", f"is not UTF-8 text: {error.reason} at byte {error.start}")]) from None


class _Robots:
    """Makes the robots of a scenario in their states; what is wrong goes to `problems`, and None comes back."""

    def __init__(self, folder: Path, problems: list[Problem]) -> None:
        self.folder, self.problems = folder, problems

    def chaser(self, table: RobotTable) -> tuple[SpaceRobot, State] | None:
        """Return the chaser and its state at the start."""
        robot = self._model(table)
        if robot is None:
            return None
        positions, wrong = POSITIONS.read(table.joints, robot, table.path("joints"))
        rates, wrong_rates = RATES.read(table.joint_rates, robot, table.path("joint_rates"))
        self.problems += wrong + wrong_rates
        v, R = np.zeros(robot.nv), table.pose.rotation
        v[:3], v[3:6] = R.T @ table.velocity, R.T @ table.angular_velocity
        for name, rate in rates.items():
            v[6:][robot.rates_of(name)] = rate
        try:
            return robot, robot.state(robot.configuration(_all_joints(robot, positions), table.pose), v)
        except OspaceError as error:
            self.problems.append((table.key, str(error)))
            return None

    def target(self, table: TargetTable) -> tuple[SpaceRobot, State] | None:
        """Return the target and its state at the start."""
        robot = self._model(table) if table.model else self._body(table.body)
        if robot is None:
            return None
        if table.name:
            robot.name = robot.model.name = table.name
        positions, wrong = POSITIONS.read(table.joints, robot, table.path("joints"))
        self.problems += wrong
        try:
            return robot, tumbling(robot, table.pose, table.spin, table.velocity, _all_joints(robot, positions))
        except OspaceError as error:
            self.problems.append((table.key, str(error)))
            return None

    def _model(self, table: RobotTable | TargetTable) -> SpaceRobot | None:
        """Read a file beside the scenario, or a robot that comes with ospace."""
        given, key = table.model, table.path("model")
        if not given:
            return None
        file = self.folder / given
        try:
            if not os.path.lexists(file) and Path(given).name == given and not Path(given).suffix:
                file = models.path(given)
            return SpaceRobot.from_urdf(file, free_mimic=table.free_mimic)
        except OspaceError as error:
            self.problems.append((key, str(error)))
            return None

    def _body(self, table: BodyTable | None) -> SpaceRobot | None:
        if table is None or any(key.startswith(table.key) for key, _ in self.problems):
            return None
        frames = {name: frame.pose for name, frame in table.frames.items()}
        try:
            return rigid_body(table.mass, table.inertia, table.mass_centre, name=table.name, frames=frames)
        except OspaceError as error:
            self.problems.append((table.key, str(error)))
            return None


def _all_joints(robot: SpaceRobot, positions: Mapping[str, float]) -> dict[str, Position]:
    """Return positions of all joints: those given, and of the others one inside their limits."""
    others: dict[str, Any] = robot.joint_positions(robot.neutral())
    return others | dict(positions)

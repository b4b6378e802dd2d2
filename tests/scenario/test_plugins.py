"""Scenarios that name tasks, inequalities and a solver of a plugin: run where the user names it too, refused else."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ospace import scenario
from ospace.cli.main import main
from ospace.exceptions import OspaceError
from ospace.scenario.errors import ScenarioError

MODULE = """
from __future__ import annotations
from dataclasses import dataclass
from typing import Annotated
from ospace.control import CustomTask, Inequality, PositionTask
from ospace.control.solvers import solver_named
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.scenario.units import Quantity

@dataclass(frozen=True, kw_only=True, eq=False)
class Across(CustomTask):
    tip: OperationalPoint
    robot: SpaceRobot
    to: Annotated[float, Quantity("length")]
    weight: float = 10.0
    gain_of_it: float = 1.0
    words: tuple = ()
    def error(self, at): return self.gain_of_it * (at.position(self.tip)[1] - self.to)
    def jacobian(self, at): return self.gain_of_it * at.jacobian(self.tip)[1]

@dataclass(frozen=True, kw_only=True, eq=False)
class Wall(Inequality):
    tip: OperationalPoint
    wall: Annotated[float, Quantity("length")]
    def value(self, at): return self.wall - at.position(self.tip)[1]
    def jacobian(self, at): return -at.jacobian(self.tip)[1]

@dataclass(frozen=True, kw_only=True, eq=False)
class Planar(PositionTask):
    offered = (0, 1)

@dataclass(frozen=True, kw_only=True, eq=False)
class Fails(Wall):
    def value(self, at): return 1 / (at.time < 0.01)

class Bare: ...
calls = []
def solve(program):
    calls.append(1)
    return solver_named("daqp")(program)
number = 3
"""
SCENARIO = """
[robot]
model = "planar_2r"
joints = { joint_1 = "20 deg", joint_2 = "60 deg" }
[control]
solver = "plugged:solve"
period = "5 ms"
step = "5 ms"
[[inequality]]
type = "plugged:Wall"
name = "wall"
tip = "end_effector"
wall = "145 cm"
deceleration = 0.2
[[phase]]
name = "up"
timeout = "6 s"
duration = "4 s"
[[phase.task]]
type = "plugged:Across"
name = "across"
tip = "end_effector"
to = "150 cm"
completion = { position = "6 cm" }
[[phase]]
name = "rest"
timeout = "1 s"
duration = "0.1 s"
[[phase.task]]
type = "plugged:Planar"
name = "tip"
point = "end_effector"
[[phase.inequality]]
type = "plugged:Wall"
name = "wall"
tip = "end_effector"
wall = "2 m"
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "plugged.py").write_text(MODULE)
    (tmp_path / "plugged.toml").write_text(SCENARIO)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "plugged", raising=False)
    yield tmp_path
    sys.modules.pop("plugged", None)


def written(folder, *replacements):
    text = SCENARIO
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    file = folder / "changed.toml"
    file.write_text(text)
    return file


def refusals(file, plugins=("plugged",)):
    with pytest.raises(ScenarioError) as caught:
        scenario.load(file, plugins)
    return dict(caught.value.problems)


def test_a_plugin_runs_where_it_is_named(folder):
    loaded = scenario.load(folder / "plugged.toml", ["plugged"])
    (task,) = loaded.phases[0].tasks
    made = task.task(loaded.robot)
    assert (made.to, made.weight, made.stiffness, made.robot) == (1.5, 10.0, 25.0, loaded.robot)
    assert loaded.phases[0].inequalities[0].make(loaded.robot).deceleration == 0.2
    assert loaded.phases[1].inequalities[0].make(loaded.robot).wall == 2.0
    run = scenario.run(loaded)
    assert run.passed
    up = run.phases[0]
    assert up.errors["across"].units == ("m", "rad")
    assert abs(up.errors["across"].last[0] - 0.05) < 1e-3
    assert "wall, lower" in up.active_limits
    assert "wall, lower" not in run.phases[1].active_limits
    assert sys.modules["plugged"].calls


def test_without_its_name_no_code_runs(folder):
    with pytest.raises(ScenarioError) as caught:
        scenario.load(folder / "plugged.toml")
    assert "plugged" not in sys.modules
    problems = dict(caught.value.problems)
    assert set(problems) == {
        "control.solver",
        "inequality[0].type",
        "phase[0].task[0].type",
        "phase[1].task[0].type",
        "phase[1].inequality[0].type",
    }
    for problem in problems.values():
        assert "is code of the module 'plugged', which runs only where you name it: --plugin plugged" in problem


def test_a_second_scenario_is_refused_though_the_first_ran(folder):
    scenario.load(folder / "plugged.toml", ["plugged"])
    assert len(refusals(folder / "plugged.toml", ())) == 5


@pytest.mark.parametrize(
    ("replacement", "key", "message"),
    [
        (("plugged:Across", "plugged:Acros"), "phase[0].task[0].type", "module 'plugged' has no 'Acros'; did you mean"),
        (("plugged:Across", "plugged:Wall"), "phase[0].task[0].type", "is no dataclass that is a task"),
        (("plugged:Across", "plugged:Bare"), "phase[0].task[0].type", "is no dataclass that is a task"),
        (("plugged:Across", "plugged:"), "phase[0].task[0].type", "names no code: give module and name"),
        (("plugged:Across", "os.path:join"), "phase[0].task[0].type", "code of the module 'os.path'"),
        (("plugged:solve", "plugged:number"), "control.solver", "is no function"),
        (('to = "150 cm"', 'to = "150 s"'), "phase[0].task[0].to", "is not a length"),
        (('to = "150 cm"', ""), "phase[0].task[0].to", "missing"),
        (('to = "150 cm"', 'to = 1.5\ntwo = 2'), "phase[0].task[0].two", "unknown key"),
        (('to = "150 cm"', 'to = 1.5\ngoal = "hold"'), "phase[0].task[0].goal", "unknown key"),
        (('tip = "end_effector"\nto', 'tip = "end"\nto'), "phase[0].task[0].tip", "no frame 'end' in robot"),
        (('wall = "2 m"', 'wall = "2 m"\ndeceleration = -1.0'), "phase[1]", "deceleration is -1.0"),
        (('type = "plugged:Wall"\nname = "wall"\ntip = "end_effector"\nwall = "2 m"', 'name = "x"'),
         "phase[1].inequality[0].type", "missing: give module and class"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_by_its_key(folder, replacement, key, message):
    problems = refusals(written(folder, replacement))
    assert message in problems[key], problems


def test_a_plugin_that_cannot_be_imported_is_named(folder):
    (folder / "broken.py").write_text("1 / 0")
    for name, message in (
        ("broken", "plugin 'broken' cannot be imported: ZeroDivisionError"),
        ("not_there", "plugin 'not_there' cannot be imported: ModuleNotFoundError"),
        ("plugged.py", "cannot be imported"),
        ("a b", "is not the name of a module"),
    ):
        with pytest.raises(OspaceError, match=message):
            scenario.load(folder / "plugged.toml", [name])


def test_tables_of_a_plugin_cross_processes(folder):
    phases = scenario.load(folder / "plugged.toml", ["plugged"]).phases
    copied = pickle.loads(pickle.dumps(phases))
    assert copied[0].task[0].to == 1.5
    code = "import pickle, sys; print(pickle.load(sys.stdin.buffer)[0].task[0].to)"
    done = subprocess.run(
        [sys.executable, "-c", code],
        input=pickle.dumps(phases),
        capture_output=True,
        check=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(Path(scenario.__file__).parents[2])])},
    )
    assert float(done.stdout) == 1.5


def test_the_command_takes_plugins_that_lie_beside_the_scenario(folder, monkeypatch, capsys):
    monkeypatch.setattr(sys, "path", [one for one in sys.path if one != str(folder)])
    file = str(folder / "plugged.toml")
    for more in ([], ["--check"]):
        assert main(["run", file, "--headless", *more]) == 2
        assert "phase[0].task[0].type: 'plugged:Across' is code of the module" in capsys.readouterr().err
    assert main(["run", file, "--headless", "--plugin", "plugged"]) == 0
    assert "2 of 2 phases complete" in capsys.readouterr().out
    failing = written(folder, ("plugged:Wall", "plugged:Fails"))
    assert main(["run", str(failing), "--headless", "--plugin", "plugged"]) == 1
    assert "up: inequality 'wall': Fails.value failed: ZeroDivisionError" in capsys.readouterr().out


def test_a_scenario_of_built_in_tasks_takes_an_inequality_alone(folder):
    file = written(folder, ('type = "plugged:Planar"', 'type = "position"'))
    run = scenario.run(scenario.load(file, ["plugged"]))
    assert np.isfinite(run.phases[1].errors["tip"].norms[:, 0]).all()

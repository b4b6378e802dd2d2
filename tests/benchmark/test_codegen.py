"""Generated C as a peer: the same numbers as ours, or a message that says what is missing."""

import importlib.util
import shutil
from pathlib import Path

import numpy as np
import pytest

import ospace
from ospace.benchmark import codegen
from ospace.cli.main import main
from ospace.validation.sampling import random_state

GENERATED = all(importlib.util.find_spec(name) for name in ("casadi", "adam", "liecasadi")) and shutil.which("gcc")
needs_it = pytest.mark.skipif(not GENERATED, reason="pip install 'ospace[benchmarks]', and gcc")


@needs_it
def test_generated_code_computes_the_same():
    path = Path(ospace.models.path("chaser_7dof"))
    robot = ospace.SpaceRobot.from_urdf(path)
    rng = np.random.default_rng(3)
    states = [random_state(robot, rng) for _ in range(4)]
    comparison = codegen.inverse_inertia(robot, [robot.point(robot.leaf_links[0])], path)
    comparison.check([(state.q.copy(), state.v.copy()) for state in states])
    assert np.any(comparison.results(states[0].q, states[0].v)[0][1])


@needs_it
def test_a_file_that_adam_cannot_read(tmp_path):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    file = tmp_path / "other.urdf"
    file.write_text("<robot name='other'/>")
    with pytest.raises(ospace.OspaceError, match="adam cannot take"):
        codegen.inverse_inertia(robot, [robot.point(robot.leaf_links[0])], file)


@pytest.mark.parametrize("missing", ["casadi", "adam"])
def test_a_missing_package_is_named(capsys, monkeypatch, missing):
    found = importlib.util.find_spec
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None if name == missing else found("json"))
    assert main(["bench", "planar_2r", "--codegen"]) == 2
    message = capsys.readouterr().err
    assert missing in message
    assert "ospace[benchmarks]" in message


def test_a_missing_compiler_is_named(capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: object())
    monkeypatch.setattr("shutil.which", lambda name: None)
    assert main(["bench", "planar_2r", "--codegen"]) == 2
    assert "gcc" in capsys.readouterr().err

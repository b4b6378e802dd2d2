"""Examples that end in a picture: short, with labelled axes, and what they print is so."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("agg")
import matplotlib.pyplot as plt

EXAMPLES = Path(__file__).parents[1] / "examples"
PLOTTED = sorted(script for script in EXAMPLES.glob("*.py") if "plt.show()" in script.read_text())
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


@pytest.fixture
def run(capsys, monkeypatch):
    """Run an example; return the numbers of each line by what is printed before its first colon."""

    def numbers(name):
        monkeypatch.setattr(plt, "show", lambda: None)
        runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")
        lines = [line.split(":", 1) for line in capsys.readouterr().out.splitlines() if ":" in line]
        said: dict[str, list[float]] = {}
        for before, after in lines:
            said.setdefault(before, []).extend(float(number) for number in NUMBER.findall(after))
        return said

    yield numbers
    plt.close("all")


@pytest.mark.parametrize("script", PLOTTED, ids=lambda script: script.stem)
def test_a_picture_takes_less_than_forty_lines(script):
    text = script.read_text()
    assert sum(bool(line.strip()) for line in text.splitlines()) < 40
    title, rule = text.splitlines()[1:3]
    assert set(rule) == {"="}
    assert len(rule) == len(title)  # reStructuredText takes it for a heading only then


def assert_labelled():
    pictures = [axes for number in plt.get_fignums() for axes in plt.figure(number).axes]
    assert pictures
    for axes in pictures:
        assert axes.has_data() or axes.patches
        assert axes.get_ylabel()
    assert any(axes.get_xlabel() for axes in pictures)


def test_the_map_of_singularities_has_the_published_one(run):
    said = run("singularity_map")
    assert said["joint 1 at -65 deg"][-1] == pytest.approx(-11.41, abs=5e-3)
    assert_labelled()


def test_the_base_stands_still_while_joints_swing_in_its_null_space(run):
    said = run("reaction_null_space")
    assert said["as asked, base turns by"][0] > 1.0
    assert said["projected, base turns by"][0] < 1e-9  # deg
    assert said["projected, joints move by"][0] > 20.0
    assert_labelled()


def test_the_shells_of_the_workspace_are_the_published_ones(run):
    said = run("workspace_shells")
    assert said["PDW"] == pytest.approx([0.351064, 0.553677, 1.436170, 2.287234], abs=1e-4)
    assert said["reach"][0] == pytest.approx(said["PDW"][-1], abs=1e-4)
    assert_labelled()

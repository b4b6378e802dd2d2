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
    inner, middle, outer, reach = 0.351064, 0.553677, 1.436170, 2.287234
    assert said["PDW"] == [inner, middle, outer, reach]
    assert said["PIW"] == [0.0, inner, middle, outer]
    assert_labelled()


def test_a_bus_turns_the_less_the_heavier_it_is(run):
    said = run("bus_mass")
    buses = [float(name.split()[2]) for name in said]
    together, turns = zip(*said.values(), strict=True)
    assert [whole - bus for whole, bus in zip(together, buses, strict=True)] == [35.0] * len(
        buses
    )  # seven links of 5 kg
    assert list(turns) == sorted(turns, reverse=True)
    assert turns[0] > 3.0 * turns[-1]
    assert_labelled()


def test_a_floating_base_turns_while_the_hand_reaches_its_goal(run):
    said = run("free_floating_reach")
    assert said["hand moved by"][0] == pytest.approx((0.3**2 + 0.3**2 + 0.2**2) ** 0.5, abs=1e-4)
    assert said["hand off its goal by"][0] < 1e-3  # mm
    assert said["base turned by"][0] > 1.0  # deg
    assert_labelled()


def test_singular_values_over_the_workspace(run):
    said = run("singular_values")
    least, most = said["sigma_min"]
    assert (
        0.0 < least < 0.1 < most < said["farthest"][0]
    )  # m per rad: no longer than the way from the joint to the hand
    assert 0.0 < said["below 0.1 m per rad"][-1] < 5.0
    assert_labelled()


def test_wheels_store_half_and_give_a_quarter_within_twice_the_time(run):
    said = run("reaction_wheels")
    assert said["momentum within 20 s"][0] == pytest.approx(2.0 * said["momentum within 40 s"][0], rel=1e-3)
    assert said["torque within 20 s"][0] == pytest.approx(4.0 * said["torque within 40 s"][0], rel=1e-3)
    assert_labelled()


def test_an_impulse_has_a_direction_that_leaves_the_base_at_rest(run):
    said = run("impulse_map")
    for stand in ("stretched", "bent"):
        least, most = said[f"{stand}, base turns by"][:2]
        assert said[f"{stand}, of all directions at least"][0] < 1e-12 < least < 0.1 * most
    assert said["bent, base turns by"][1] > 2.0 * said["stretched, base turns by"][1]
    assert_labelled()


def test_a_target_tumbles_by_elliptic_functions(run):
    said = run("tumbling")
    assert said["period"][0] == 155.45425
    assert said["simulation off by"][0] < 1e-11
    assert said["after a period off by"][0] < 1e-11
    assert_labelled()


def test_the_loop_in_mujoco_moves_as_in_ospace(run):
    said = run("mujoco_loop")
    assert said["joints move by"][0] > 10.0  # deg
    assert said["joints apart by"][0] < 1e-9
    assert said["base apart by"][0] < 1e-10
    assert_labelled()

"""Links that overlap with all joints at zero are named, the deepest first, or it is said that none were sought."""

import numpy as np
import pytest
import solids
import trimesh

import ospace
from ospace.collision import pairs
from ospace.validation import overlaps
from ospace.validation.report import check


def balls(folder, *places):
    """Write balls of radius 0.1 m at these x, each on a joint of its own beside the others."""
    parts = [
        part
        for k, x in enumerate(places)
        for part in (solids.link(f"ball_{k}", solids.BALL), solids.joint("bus", f"ball_{k}", origin=f"{x} 0 0"))
    ]
    return solids.robot(folder, *parts)


def found_in(robot):
    return list(overlaps.of_shapes(robot))


def test_pairs_that_overlap_are_named_the_deepest_first(tmp_path):
    robot = balls(tmp_path, 0.5, 0.65, 0.75, 5.0)
    [finding] = found_in(robot)
    assert (finding.code, finding.severity, finding.subject) == ("overlap-at-zero", "info", "robot 'solids'")
    assert finding.message == (
        "2 pairs of links overlap with all joints at zero: 'ball_1' and 'ball_2' by 100 mm, "
        "'ball_0' and 'ball_1' by 50 mm"
    )
    assert finding.value == "2"


def test_one_pair_is_one_pair(tmp_path):
    [finding] = found_in(balls(tmp_path, 0.5, 0.65))
    assert finding.message.startswith("1 pair of links overlaps with all joints at zero: 'ball_0' and 'ball_1' by 50")


def test_five_pairs_are_named_and_the_others_counted(tmp_path):
    [finding] = found_in(balls(tmp_path, *(0.5 + 0.19 * k for k in range(8))))
    assert finding.message.startswith("7 pairs")
    assert finding.message.count(" by ") == 5
    assert finding.message.endswith(", and 2 more")


def test_a_depth_that_coal_cannot_tell_is_not_told(tmp_path, monkeypatch):
    monkeypatch.setattr(overlaps, "overlaps", lambda geometry: {("a", "b"): 0.01, ("c", "d"): np.inf})
    [finding] = found_in(balls(tmp_path, 0.5))
    assert finding.message.endswith("at zero: 'c' and 'd', 'a' and 'b' by 10 mm")


@pytest.mark.parametrize("model", ["chaser_24dof", "chaser_7dof", "ets_vii", "target"])
def test_nothing_is_said_of_robots_whose_links_stand_apart(model):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(model))
    assert found_in(robot) == []


def test_the_check_has_it_and_is_as_sound_as_before(tmp_path):
    robot = balls(tmp_path, 0.5, 0.65)
    report = check(robot, [robot.point("ball_0")], samples=1)
    assert [finding.subject for finding in report.findings if finding.code == "overlap-at-zero"] == ["robot 'solids'"]
    assert report.errors == 0


def test_a_robot_without_a_file_or_shapes_has_nothing_to_say(tmp_path):
    robot = solids.robot(tmp_path, solids.link("arm"), solids.joint("bus", "arm"))
    assert found_in(robot) == []
    assert found_in(ospace.SpaceRobot(robot.model)) == []


def meshed(folder, name="ball.stl"):
    drawn = f'<mesh filename="{name}"/>'
    return solids.robot(
        folder,
        solids.link("first", drawn),
        solids.joint("bus", "first", origin="0.5 0 0"),
        solids.link("second", drawn),
        solids.joint("bus", "second", origin="0.65 0 0"),
    )


def test_meshes_overlap_and_those_that_are_missing_or_broken_do_not(tmp_path):
    trimesh.creation.icosphere(radius=0.1).export(tmp_path / "ball.stl")
    [finding] = found_in(meshed(tmp_path))
    assert "'first' and 'second' by" in finding.message
    (tmp_path / "cut.stl").write_text("solid arm\n facet normal 0 0")
    assert found_in(meshed(tmp_path, "cut.stl")) == []
    assert found_in(meshed(tmp_path, "no_such.stl")) == []


def test_too_many_shapes_are_not_looked_at_and_that_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(overlaps, "_MOST_SOLIDS", 3)
    assert found_in(balls(tmp_path, 0.5, 1.0, 1.5)) == []

    def compute(geometry):
        raise AssertionError("too much to compute")

    monkeypatch.setattr(overlaps, "overlaps", compute)
    [finding] = found_in(balls(tmp_path, 0.5, 1.0, 1.5, 2.0))
    assert "was not looked at: there are more than 3 shapes" in finding.message
    assert "pairs.overlaps" in finding.remedy
    assert callable(pairs.overlaps)


def test_meshes_of_many_megabytes_are_not_read_and_that_is_said(tmp_path, monkeypatch):
    trimesh.creation.icosphere(radius=0.1).export(tmp_path / "ball.stl")
    size = (tmp_path / "ball.stl").stat().st_size
    monkeypatch.setattr(overlaps, "_MOST_BYTES", 2 * size)
    [finding] = found_in(meshed(tmp_path))
    assert finding.value == "1"
    monkeypatch.setattr(overlaps, "_MOST_BYTES", 2 * size - 1)
    [finding] = found_in(meshed(tmp_path))
    assert "was not looked at" in finding.message
    assert finding.value is None

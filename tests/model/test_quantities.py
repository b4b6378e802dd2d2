"""Quantities as people write them, in all places where a joint is put somewhere; and names of robots for files."""

import math

import numpy as np
import pytest

import ospace
from ospace import models, quantities
from ospace.cli.main import main


@pytest.fixture(scope="module")
def robot():
    return ospace.SpaceRobot.from_urdf("planar_2r")


def test_a_robot_that_comes_with_ospace_is_read_by_its_name(robot, tmp_path, monkeypatch):
    assert robot.source == models.path("planar_2r")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "planar_2r").write_bytes(models.path("target").read_bytes())
    assert ospace.SpaceRobot.from_urdf("planar_2r").n_joints == 0  # a file of that name comes first
    with pytest.raises(ospace.UrdfError, match="no_such_robot"):
        ospace.SpaceRobot.from_urdf("no_such_robot")
    with pytest.raises(ospace.UrdfError):
        ospace.SpaceRobot.from_urdf("sub/planar_2r")


def test_a_scenario_that_comes_with_ospace_is_loaded_by_its_name():
    assert ospace.scenario.load("grasp_flying").path == models.scenario("grasp_flying")


@pytest.mark.parametrize("text", ["20 deg", "20deg", "20°", "0.3490658503988659 rad", "349.0658503988659 mrad"])
def test_positions_take_text_with_a_unit(robot, text):
    angle = math.radians(20.0)
    assert robot.joint_positions(robot.configuration({"joint_2": text}))["joint_2"] == pytest.approx(angle, rel=1e-15)
    Q = robot.configurations({"joint_2": [text, 0.5], "joint_1": text})
    np.testing.assert_allclose(Q[:, 7:], [[angle, angle], [angle, 0.5]], rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "said"),
    [("20", "a text needs a unit"), ("1 m", "a unit of length"), ("fast", "not an angle"), ("inf deg", "not finite")],
)
def test_text_that_is_no_angle_is_refused_by_its_joint(robot, text, said):
    with pytest.raises(ospace.OspaceError, match=rf"joint 'joint_2'.*{said}|{said}.*'joint_2'|joint_2.*{said}"):
        robot.configuration({"joint_2": text})


@pytest.mark.parametrize("pose", ["joint_2=20deg", "joint_2=20 deg", "joint_2=0.3490658503988659"])
def test_poses_of_the_shell_take_units(tmp_path, monkeypatch, pose):
    seen = []
    monkeypatch.setattr("ospace.visual.scene.Scene.display", lambda self, q, v=None: seen.append(q))
    assert main(["view", "planar_2r", "--pose", pose, "--html", str(tmp_path / "a.html")]) == 0
    assert seen[0][8] == pytest.approx(math.radians(20.0), rel=1e-15)


def test_a_pose_of_another_kind_is_refused(capsys):
    assert main(["view", "planar_2r", "--pose", "joint_2=3 m", "--html", "/dev/null"]) == 2
    assert "--pose 'joint_2=3 m': position of joint 'joint_2': '3 m' is not an angle" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("at", "rpy"),
    [("0.6,0,-0.2", "0,1.5707963267948966,0"), ("60,0,-20cm", "0,90,0deg"), ("60cm,0m,-200 mm", "0,90 deg,0 rad")],
)
def test_places_of_parts_take_units(tmp_path, at, rpy):
    arguments = [f"--at={at}", f"--rpy={rpy}", "--prefix", "a_", "--out", str(tmp_path / "a.urdf")]
    assert main(["compose", "target", "planar_2r", *arguments]) == 0
    joint = ospace.SpaceRobot.from_urdf(tmp_path / "a.urdf").description.joints
    placed = next(one for one in joint if one.child == "a_base")
    np.testing.assert_allclose(placed.pose.xyz, [0.6, 0.0, -0.2], atol=1e-15)
    np.testing.assert_allclose(placed.pose.rpy, [0.0, math.pi / 2, 0.0], atol=1e-15)


def test_every_unit_is_read_in_every_spelling():
    for dimension, units in quantities.UNITS.items():
        for unit, size in units.items():
            read = {quantities.parse(text, dimension) for text in (f"2 {unit}", f" 2.0  {unit} ")}
            assert read == {2.0 * size}

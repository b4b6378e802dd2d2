"""Orientations written as quaternions place, weigh and draw as those written as rpy."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from urdf.corpus.parts import inertial, joint, link, robot

import ospace
from ospace.urdf import bodies
from ospace.urdf.description import Pose

TURNS = [
    (0.0, 0.0, 0.0, 1.0),
    (0.7071067811865476, 0.0, 0.0, 0.7071067811865476),
    (0.0, 0.7071067811865476, 0.0, 0.7071067811865476),
    (0.0, -0.7071067811865476, 0.0, 0.7071067811865476),
    (0.5, 0.5, 0.5, 0.5),
    (0.5, -0.5, 0.5, -0.5),
    (0.0, 0.0, 1.0, 0.0),
    (0.3, 0.6400000001, 0.2, 0.68),
    (3.0, -4.0, 12.0, 84.0),
    (1e-9, 0.7071067811865476, 1e-8, 0.7071067811865475),
]


@pytest.mark.parametrize("quaternion", TURNS, ids=str)
def test_roll_pitch_and_yaw_of_a_quaternion_are_its_turn(quaternion):
    """Where the pitch is 90 deg, roll and yaw have one axis, and must still add up."""
    matrix = pin.Quaternion(np.array(quaternion) / np.linalg.norm(quaternion)).matrix()
    ours, _ = bodies.placement(Pose(rpy=bodies.quaternion_to_rpy(quaternion)))
    np.testing.assert_allclose(ours, matrix, rtol=0.0, atol=1e-15)


def test_random_quaternions_and_all_next_to_a_pitch_of_90_deg():
    rng = np.random.default_rng(0)
    for k in range(500):
        turn = rng.normal(size=3) * 10.0 ** -rng.uniform(0, 16)
        matrix = pin.rpy.rpyToMatrix(rng.uniform(-3, 3), (-1) ** k * np.pi / 2, rng.uniform(-3, 3)) @ pin.exp3(turn)
        quaternion = pin.Quaternion(matrix).normalized()
        ours, _ = bodies.placement(Pose(rpy=bodies.quaternion_to_rpy(tuple(quaternion.coeffs()))))
        np.testing.assert_allclose(ours, quaternion.matrix(), rtol=0.0, atol=2e-15)


@pytest.mark.parametrize("place", ["joint", "fixed joint", "inertial"])
@pytest.mark.parametrize("quaternion", TURNS[1:5], ids=str)
def test_a_quaternion_turns_as_rpy_does(tmp_path, place, quaternion):
    """H of the same robot written in both ways, in each place that weighs or places a body."""
    rpy = pin.rpy.matrixToRpy(pin.Quaternion(np.array(quaternion)).matrix())
    written = {
        "rpy": 'rpy="{!r} {!r} {!r}"'.format(*map(float, rpy)),
        "quat": 'quat_xyzw="{!r} {!r} {!r} {!r}"'.format(*quaternion),
        "none": "",
    }
    H = {}
    for name, text in written.items():
        turned = {one: text if one == place else "" for one in ("joint", "fixed joint", "inertial")}
        content = (
            robot(
                link("base"),
                link("arm", inertial(moments=("0.02", "0.03", "0.04")).replace('0.05"', f'0.05" {turned["inertial"]}')),
                link("hand", inertial(mass="1", origin="0.3 0.1 0.2")),
                joint(origin=f'0.3 0 0" {turned["joint"]} xmlns:end="'),
                joint("weld", "fixed", "arm", "hand", "", origin=f'0.2 0 0" {turned["fixed joint"]} xmlns:end="'),
            )
            .replace(' xmlns:end=""', "")
            .replace("<robot", '<robot version="1.1"')
        )
        (tmp_path / "robot.urdf").write_text(content)
        made = ospace.SpaceRobot.from_urdf(tmp_path / "robot.urdf")
        assert made.findings == ()
        dynamics = ospace.joint_space_dynamics(made.state(made.configuration({"hinge": 0.7})))
        H[name] = np.block(
            [
                [dynamics.base_inertia, dynamics.coupling_inertia],
                [dynamics.coupling_inertia.T, dynamics.manipulator_inertia],
            ]
        )
    np.testing.assert_allclose(H["quat"], H["rpy"], rtol=0.0, atol=1e-14)
    assert np.abs(H["quat"] - H["none"]).max() > 1e-3


def test_a_shape_is_turned_by_its_quaternion(tmp_path):
    shape = '<visual><origin quat_xyzw="0 0 0.6 0.8"/><geometry><box size="1 2 3"/></geometry></visual>'
    (tmp_path / "robot.urdf").write_text(robot(link("base", more=shape)).replace("<robot", '<robot version="1.2"'))
    (drawn,) = ospace.SpaceRobot.from_urdf(tmp_path / "robot.urdf").description.links[0].shapes
    assert drawn.pose.rpy == pytest.approx((0.0, 0.0, 2.0 * np.arctan2(0.6, 0.8)))

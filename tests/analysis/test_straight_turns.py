"""Turns of the base along straight paths of the joints are those that `base_motion` finds."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import analysis
from ospace.analysis import straight_turns


def turns(arm, x):
    """Return attitudes (N, 3, 3) by `base_motion`."""
    paths = [np.array([arm.at[7:], q[7:]]) for q in arm.configurations(x)]
    return [pin.XYZQUATToSE3(analysis.base_motion(arm.robot, path)[-1]).rotation for path in paths]


@pytest.mark.parametrize("name", ["planar_2r", "chaser_7dof"])
def test_turns_of_a_robot(name):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    arm = analysis.Arm(robot, robot.point("end_effector"), at=robot.configuration({"joint_2": 0.4}))
    steps, change = straight_turns.steps_for(arm, arm.draw(np.random.default_rng(0), 32))
    assert 2 <= steps <= 64
    assert change < 1e-5
    x = arm.draw(np.random.default_rng(1), 4)
    np.testing.assert_allclose(straight_turns.turned(arm, x, steps).as_matrix(), turns(arm, x), atol=change)


def test_joints_that_slide_and_that_others_follow():
    robot = trees.coupled(3)
    arm = analysis.Arm(robot, robot.point(robot.leaf_links[-1]), ["joint_1", "joint_2"])
    x = arm.draw(np.random.default_rng(1), 3) / 4.0
    np.testing.assert_allclose(straight_turns.turned(arm, x, 64).as_matrix(), turns(arm, x), atol=1e-7)


def test_the_published_turn_while_one_joint_turns():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    arm = analysis.Arm(robot, robot.point("end_effector"))
    (turn,) = straight_turns.turned(arm, np.array([[np.pi / 2, 0.0]]), 64).as_rotvec()
    np.testing.assert_allclose(np.rad2deg(turn), [0.0, 0.0, -43.28500849], atol=1e-6)

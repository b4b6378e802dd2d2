"""The part of a robot that a map moves is the robot: its Jacobians, its mass, its units."""

from __future__ import annotations

import re

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import OspaceError, analysis
from ospace.model.joint_positions import unit_of

SINGLE = ("revolute", "prismatic along any axis", "continuous", "revolute about any axis", "spherical", "planar")


def robot_and_joints(seed):
    robot = trees.coupled(seed) if seed % 2 else trees.tree(seed, 7, SINGLE)
    single = [n for n in robot.joint_names if robot.model.joints[robot.joint_number(n)].nv == 1]
    return robot, single[: 2 + seed % 3]


@pytest.mark.parametrize("seed", range(6))
def test_jacobians_are_those_of_the_whole_robot_in_lengths_of_the_arm(seed):
    robot, joints = robot_and_joints(seed)
    hand = robot.point(robot.leaf_links[-1])
    arm = analysis.Arm(robot, hand, joints, at=trees.state(robot, seed).q)
    x = arm.draw(np.random.default_rng(seed), 5)
    found = arm.posture(x)
    per_unit = np.array([arm.length if unit == "m" else 1.0 for unit in arm.units])
    columns = [robot.rates_of(name).start for name in arm.joints]
    rows = np.r_[np.full(3, 1.0 / arm.length), np.ones(3)]
    for k, q in enumerate(arm.configurations(x)):
        state = robot.state(q)
        whole = ospace.generalized_jacobian(state, hand)
        placement = state.placement(hand).translation
        np.testing.assert_allclose(found.hand[k], placement, atol=1e-12)
        J_m_star, J_b_star = whole.generalized_jacobian, whole.base_generalized_jacobian
        np.testing.assert_allclose(found.J_m_star[k], rows[:, None] * J_m_star[:, columns] * per_unit, atol=1e-11)
        np.testing.assert_allclose(found.J_b_star[k], rows[:, None] * J_b_star[:, columns] * per_unit, atol=1e-11)


@pytest.mark.parametrize("seed", range(4))
def test_the_inertia_about_the_mass_centre_is_that_of_the_whole_robot(seed):
    robot, joints = robot_and_joints(seed)
    arm = analysis.Arm(robot, robot.point(robot.leaf_links[-1]), joints, at=trees.state(robot, seed).q)
    x = arm.draw(np.random.default_rng(seed), 2)
    model = (robot if robot.free is None else robot.free).model
    data = model.createData()
    for q, inertia in zip(arm.configurations(x), arm.inertia(x, arm.posture(x).centre), strict=True):
        pin.ccrba(model, data, q if robot.free is None else robot.free.configuration(q), np.zeros(model.nv))
        np.testing.assert_allclose(inertia, data.Ig.inertia, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_how_the_hand_moves_about_the_mass_centre_with_the_base_level(seed):
    robot, joints = robot_and_joints(seed)
    arm = analysis.Arm(robot, robot.point(robot.leaf_links[-1]), joints)
    x, step = arm.draw(np.random.default_rng(seed), 3), 1e-6
    J = arm.posture(x).level_jacobian(arm.length)
    for k in range(len(arm.joints)):
        way = step * arm.scale[k] * np.eye(len(arm.joints))[k]
        ahead, behind = (arm.posture(x + sign * way).from_centre for sign in (1.0, -1.0))
        np.testing.assert_allclose(J[:, :, k], (ahead - behind) / (2.0 * step * arm.length), atol=1e-8)


def test_ranges_are_limits_or_what_is_given():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    arm = analysis.Arm(robot, robot.point("end_effector", "linear"), ranges={"joint_2": (0.0, 9.0)})
    np.testing.assert_allclose(arm.lower, [-2.9671, 0.0])
    np.testing.assert_allclose(arm.upper, [2.9671, 9.0])
    np.testing.assert_allclose(arm.rates, robot.model.velocityLimit[6:])
    assert (arm.length, arm.units, arm.rows, arm.rank, arm.planar) == (
        2.0,
        ("rad", "rad"),
        (True, True, False, False, False, False),
        2,
        True,
    )


def test_joints_without_limits_turn_once():
    robot = trees.tree(1, 3, ("continuous", "revolute", "prismatic"), branching=0.0)
    arm = analysis.Arm(robot, robot.point("link_2"))
    np.testing.assert_allclose([arm.lower, arm.upper], [[-np.pi] * 3, [np.pi] * 3])
    assert [unit_of(robot.model.joints[robot.joint_number(name)]) for name in arm.joints] == list(arm.units)
    np.testing.assert_array_equal(arm.rates, 1.0)
    assert not arm.planar


def test_a_hand_in_space_has_all_its_rows():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("ets_vii"))
    arm = analysis.Arm(robot, robot.point("end_effector"))
    assert (arm.rows, arm.rank, arm.planar) == ((True,) * 6, 6, False)


@pytest.mark.parametrize(
    ("point", "options", "message"),
    [
        ("base", {}, "no joint stands between the base and 'base'"),
        ("end_effector", {"joints": ["joint_3"]}, "has no joint 'joint_3'"),
        ("end_effector", {"joints": []}, "joints is empty"),
        ("end_effector", {"ranges": {"joint_1": (1.0, 1.0)}}, "range of joint 'joint_1' is empty, 1 to 1"),
        ("end_effector", {"ranges": {"joint_1": (1.0, float("nan"))}}, "give a finite number"),
        ("end_effector", {"ranges": {"joint_1": 3.0}}, "give low and high"),
        ("end_effector", {"joints": ["joint_1"], "ranges": {"joint_2": (0.0, 1.0)}}, "which does not vary"),
        ("end_effector", {"at": [0.0]}, "at has shape (1,)"),
    ],
)
def test_an_arm_that_cannot_be_is_refused(point, options, message):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    with pytest.raises(OspaceError, match=re.escape(message)):
        analysis.Arm(robot, robot.point(point), **options)


def test_joints_of_several_degrees_of_freedom_are_refused():
    robot = trees.tree(0, 2, ("spherical", "revolute"), branching=0.0)
    with pytest.raises(OspaceError, match="joint 'joint_0' is of type Spherical: name joints that turn or slide"):
        analysis.Arm(robot, robot.point("link_1"))
    assert analysis.Arm(robot, robot.point("link_1"), ["joint_1"]).joints == ("joint_1",)


def test_postures_without_dynamics_are_told():
    robot = trees.tree(0, 2, ("prismatic",), branching=0.0)
    arm = analysis.Arm(robot, robot.point("link_1", "linear"), ranges={"joint_0": (1e200, 2e200)})
    with pytest.raises(OspaceError, match=r"has no dynamics at joint_0=.*e\+\d+, joint_1=.*are too large or too small"):
        analysis.map_arm(arm, random=9)


def test_the_hand_of_another_robot_is_refused():
    one, other = (trees.tree(seed, 2, ("revolute",)) for seed in (0, 1))
    with pytest.raises(OspaceError, match="another robot"):
        analysis.Arm(one, other.point("link_1"))

"""Friction of joints: the law, where its numbers come from, and that it only takes energy."""

import numpy as np
import pytest

import ospace
from ospace.dynamics.joint_friction import FRICTION_VELOCITY, JointFriction

URDF = """<robot name="rubbing"><link name="bus">{mass}</link><link name="a">{mass}</link><link name="b">{mass}</link>
<joint name="first" type="revolute"><parent link="bus"/><child link="a"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
<limit lower="-2" upper="2" effort="9" velocity="2"/><dynamics damping="3.5" friction="0.75"/></joint>
<joint name="second" type="prismatic"><parent link="a"/><child link="b"/><origin xyz="0 0 1"/><axis xyz="1 0 0"/>
<limit lower="-2" upper="2" effort="9" velocity="2"/></joint></robot>""".replace(
    "{mass}", '<inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory):
    path = tmp_path_factory.mktemp("friction") / "rubbing.urdf"
    path.write_text(URDF)
    return ospace.SpaceRobot.from_urdf(path)


def test_damping_and_friction_are_those_of_the_file(rubbing):
    friction = JointFriction.of(rubbing)
    np.testing.assert_array_equal(friction.damping, [3.5, 0.0])
    np.testing.assert_array_equal(friction.coulomb, [[0.75, 0.0], [0.75, 0.0]])
    assert friction.any
    assert not JointFriction.of(ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))).any


@pytest.mark.parametrize("rate", [-3.0, -1e-3, 0.0, 1e-4, 0.02, 5.0])
def test_the_law_of_friction_and_its_slope(rubbing, rate):
    friction = JointFriction.of(rubbing)
    rates = np.array([rate, rate])
    expected = -3.5 * rate - 0.75 * np.tanh(rate / FRICTION_VELOCITY)
    np.testing.assert_allclose(friction.torque(rates), [expected, 0.0], rtol=1e-14, atol=0.0)
    out = np.empty(2)
    assert friction.torque(rates, out) is out
    h = 1e-6
    difference = (friction.torque(rates - h) - friction.torque(rates + h)) / (2.0 * h)
    np.testing.assert_allclose(friction.slope(rates), difference, rtol=1e-6, atol=1e-8)


def test_friction_that_differs_by_sense(rubbing):
    robot = ospace.SpaceRobot.from_model(rubbing.model.copy())
    lower = robot.model.lowerDryFrictionLimit.copy()
    lower[6] = -2.0
    robot.model.lowerDryFrictionLimit = lower
    backward = JointFriction.of(robot).torque(np.array([-1.0, 0.0]))
    np.testing.assert_allclose(backward, [3.5 + 2.0, 0.0])


@pytest.mark.parametrize(("field", "value"), [("damping", -1.0), ("damping", np.inf), ("upperDryFrictionLimit", -0.1)])
def test_friction_that_would_drive_is_refused(rubbing, field, value):
    robot = ospace.SpaceRobot.from_model(rubbing.model.copy())
    values = getattr(robot.model, field).copy()
    values[7] = value
    setattr(robot.model, field, values)
    with pytest.raises(ospace.OspaceError, match="'second'"):
        JointFriction.of(robot)

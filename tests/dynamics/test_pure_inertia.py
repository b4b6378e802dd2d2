"""Wheels and gyros whose tensor alone is given: H is regular, and every way in computes with them as with any link."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from urdf.corpus.inertias import ALONE, DISC, SMALL, UP, gimballed, wheeled
from urdf.corpus.parts import AXIS

import ospace
from ospace.control import BaseAttitudeTask, Controller, PostureTask
from ospace.validation import report
from ospace.validation.sampling import random_state

ROBOTS = {
    "wheel": wheeled(UP, DISC),
    "wheel across its axis": wheeled(AXIS, DISC),
    "wheel of one moment": wheeled(UP, ALONE),
    "gyro": gimballed(SMALL, UP),
    "gyro in a ring of nothing": gimballed(None, UP),
    "gyro of one moment": gimballed(SMALL, UP, ALONE),
}


@pytest.fixture(params=ROBOTS)
def made(request, tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(ROBOTS[request.param])
    return ospace.SpaceRobot.from_urdf(file)


def inertia(robot, q):
    H = np.triu(pin.crba(robot.model, robot.model.createData(), q))
    return H + np.triu(H, 1).T


def test_joint_space_inertia_is_regular(made):
    H = inertia(made, random_state(made, np.random.default_rng(0)).q)
    scale = 1.0 / np.sqrt(np.diag(H))
    assert np.linalg.eigvalsh(H * np.outer(scale, scale))[0] > 1e-2


def test_all_ways_in_agree(made):
    checked = report.check(made, [made.point(made.leaf_links[-1])], samples=3)
    assert checked.verdict == "sound"


def test_state_evaluator_batch_and_controller_take_it(made):
    state, point = random_state(made, np.random.default_rng(1)), made.point(made.leaf_links[-1], axes="linear")
    expected = ospace.operational_space(state, [point]).inertia
    evaluator = ospace.OperationalSpaceEvaluator(made, [point])
    evaluator.update(state.q.copy(), state.v.copy())
    np.testing.assert_allclose(evaluator.inertia, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    batch = ospace.operational_space_batch(made, [point], state.q[None], state.v[None], ("inertia",))
    np.testing.assert_allclose(batch.inertia[0], expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    controller = Controller(made, [PostureTask(name="posture"), BaseAttitudeTask(name="base", robot=made)])
    command = controller.update(0.0, made.neutral(), np.zeros(made.nv))
    assert np.isfinite(command.torque).all()


def test_torque_on_a_wheel_turns_the_bus_the_other_way(tmp_path):
    """No outer torque: what the wheel gains, I (ω + φ̇), the bus loses."""
    file = tmp_path / "robot.urdf"
    file.write_text(wheeled(UP, DISC).replace('xyz="0.1 0 0.05"', 'xyz="0 0 0"'))
    robot = ospace.SpaceRobot.from_urdf(file)
    torque = np.r_[np.zeros(6), 0.3]
    acceleration = pin.aba(robot.model, robot.model.createData(), robot.neutral(), np.zeros(7), torque)
    np.testing.assert_allclose(0.04 * acceleration[5], -0.3, rtol=1e-12)
    np.testing.assert_allclose(0.02 * (acceleration[5] + acceleration[6]), 0.3, rtol=1e-12)
    H_m_star = ospace.generalized_dynamics(robot.state(robot.neutral())).generalized_inertia
    np.testing.assert_allclose(H_m_star[0, 0], 0.04 * 0.02 / 0.06, rtol=1e-12)


def bus_with(joint, inertia, armature=0.0):
    model = pin.Model()
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    model.appendBodyToJoint(base, pin.Inertia(100.0, np.zeros(3), np.diag([10.0, 12.0, 14.0])), pin.SE3.Identity())
    wheel = model.addJoint(base, joint, pin.SE3.Random(), "spin")
    model.appendBodyToJoint(wheel, inertia, pin.SE3.Identity())
    model.armature = np.r_[np.zeros(6), np.full(model.nv - 6, armature)]
    return model


NOTHING, WHEEL = pin.Inertia.Zero(), pin.Inertia(0.0, np.zeros(3), np.diag([0.01, 0.01, 0.02]))
FLAT = pin.Inertia(0.0, np.zeros(3), np.diag([0.0, 0.0, 0.02]))


@pytest.mark.parametrize(
    ("joint", "inertia", "armature", "regular"),
    [
        (pin.JointModelRZ(), WHEEL, 0.0, True),
        (pin.JointModelRUBZ(), FLAT, 0.0, True),
        (pin.JointModelRX(), FLAT, 0.0, False),
        (pin.JointModelPZ(), WHEEL, 0.0, False),
        (pin.JointModelPZ(), WHEEL, 0.1, True),
        (pin.JointModelRX(), NOTHING, 0.1, True),
        (pin.JointModelRX(), NOTHING, 0.0, False),
        (pin.JointModelSpherical(), WHEEL, 0.0, True),
        (pin.JointModelSpherical(), FLAT, 0.0, False),
        (pin.JointModelTranslation(), WHEEL, 0.0, False),
        (pin.JointModelUniversal(np.eye(3)[0], np.eye(3)[2]), WHEEL, 0.0, True),
        (pin.JointModelHZ(0.1), WHEEL, 0.0, True),
    ],
)
def test_models_from_code_are_judged_by_what_resists_each_joint(joint, inertia, armature, regular):
    model = bus_with(joint, inertia, armature)
    if not regular:
        with pytest.raises(ospace.UnsoundModelError, match="'spin'"):
            ospace.SpaceRobot.from_model(model)
        return
    robot = ospace.SpaceRobot.from_model(model)
    state = random_state(robot, np.random.default_rng(0))
    dynamics = ospace.joint_space_dynamics(state)
    assert np.linalg.eigvalsh(dynamics.manipulator_inertia)[0] > 1e-3
    assert np.isfinite(ospace.generalized_dynamics(state).generalized_inertia).all()

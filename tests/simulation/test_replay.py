"""Logged torques, replayed in MuJoCo, which shares no code with Pinocchio: they move the robot as the run did."""

import mujoco
import numpy as np
import pytest
from robots.mujoco_robot import FREE_JOINT, MujocoRobot

from ospace import models, scenario


@pytest.fixture(scope="module")
def before_contact():
    """The paper's demonstration up to the grasp, 14.7 s: the robot, and its trajectory."""
    grasp = scenario.run(scenario.load(models.scenario("grasp")))
    return grasp.segments[0].robot, grasp.segments[0].trajectory


def replayed(robot, run, scale=1.0):
    """Return MuJoCo's robot after the run's torques, each held for a step of 1 ms, from the run's start."""
    engine = MujocoRobot(models.path("chaser_24dof"))
    engine.model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    engine.model.opt.timestep = 1e-3
    engine.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    engine.take(robot.state(run.q[0], run.v[0]))
    driven = [engine.model.jnt_dofadr[engine.joint(name)] for name in robot.joint_names]
    for torque in run.torque[:-1]:
        engine.data.qfrc_applied[driven] = scale * torque
        mujoco.mj_step(engine.model, engine.data)
    return engine


def off(robot, run, engine):
    """Return how far joints (rad), base (m) and its attitude (rad, half angle) are from where the run ended."""
    ends = robot.joint_positions(run.q[-1])
    joints = [engine.data.qpos[engine.model.jnt_qposadr[engine.joint(name)]] - ends[name] for name in ends]
    base = engine.data.qpos[engine.model.jnt_qposadr[engine.joint(FREE_JOINT)] :][:7]
    x, y = base[[4, 5, 6, 3]], run.q[-1, 3:7]
    return np.abs(joints).max(), np.abs(base[:3] - run.q[-1, :3]).max(), np.abs(x - np.sign(x @ y) * y).max()


def test_logged_torques_move_mujoco_s_robot_as_the_run_moved(before_contact):
    robot, run = before_contact
    assert run.time[-1] == pytest.approx(14.7)
    assert np.ptp(run.q[:, 7:], axis=0).max() > 0.5  # rad: there is a motion to compare
    assert max(off(robot, run, replayed(robot, run))) < 1e-11


def test_torques_that_are_off_by_a_millionth_move_it_elsewhere(before_contact):
    robot, run = before_contact
    assert max(off(robot, run, replayed(robot, run, scale=1.0 + 1e-6))) > 1e-7

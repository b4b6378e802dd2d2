"""Controller and simulation of robots whose joints mimic others."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.control import Constant, Controller, DampingTask, JointLimits, PoseTask, PostureTask
from ospace.simulation import grasp, release, rigid_body
from ospace.simulation.plant import Plant


def accelerations(robot, q, v, torque):
    """φ̈ under joint torques, by Pinocchio of the free joints and G."""
    free = robot.free
    q_free, v_free = free.configuration(q), free.G @ v
    data = free.model.createData()
    upper = np.triu(pin.crba(free.model, data, q_free))
    H = free.G.T @ (upper + np.triu(upper, 1).T) @ free.G
    c = free.G.T @ pin.nonLinearEffects(free.model, data, q_free, v_free)
    return np.linalg.solve(H, np.r_[np.zeros(6), torque] - c)


@pytest.mark.parametrize("seed", [0, 1, 4])
def test_torques_of_the_controller_accelerate_a_coupled_robot_as_its_tasks_demand(seed):
    robot = trees.coupled(seed)
    state = trees.state(robot, seed)
    still = DampingTask(name="still", damping_ratio=1.0, stiffness=4.0, weight=1.0)
    command = Controller(robot, still, regularization=1e-12).update(0.0, state.q, state.v)
    moved = accelerations(robot, state.q, state.v, command.torque)[6:]
    np.testing.assert_allclose(moved, -4.0 * state.v[6:], atol=1e-6)


@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
def test_a_run_of_a_coupled_robot_keeps_momentum_and_energy(integrator):
    robot = trees.coupled(3, joints=5, followers=2)
    robot.model.armature = np.zeros(robot.nv)  # of which the symplectic integrator knows no planar joint
    robot = ospace.SpaceRobot.from_model(robot.model)
    start = trees.state(robot, 3)
    run = ospace.simulate(robot, start.q, start.v, duration=0.3, integrator=integrator)
    certificate = run.certificate()
    assert certificate.passed, str(certificate)


def test_the_plant_of_a_coupled_robot_by_its_equations():
    """Under torques, a base wrench and a force at a point."""
    robot = trees.coupled(2)
    state, rng = trees.state(robot, 2), np.random.default_rng(0)
    point, wrench = robot.point("link_5"), rng.normal(size=6)
    plant = Plant(robot, {point: wrench})
    plant.torque[:] = rng.normal(size=robot.n_joints)
    own = np.zeros(robot.nv)
    power = plant.accelerate(0.0, state.q, state.v, own)
    J = ospace.operational_space(state, point).jacobian
    T = np.eye(robot.nv)
    T[:3, :3] = T[3:6, 3:6] = state.T_WB.rotation
    force = plant.tau + T.T @ J.T @ wrench
    bias = accelerations(robot, state.q, state.v, np.zeros(robot.n_joints))
    np.testing.assert_allclose(plant.inertia(state.q) @ (own - bias), force, atol=1e-9)
    assert power == pytest.approx(float(force @ state.v), rel=1e-10)


def test_a_hand_reaches_its_goal_while_its_fingers_close_together():
    """Two fingers that slide against each other: one torque moves both."""
    robot = trees.coupled(6, joints=8, followers=1)
    q = robot.neutral()
    (follower,), (leader,) = robot.free.followers, {one.leader for one in robot.free.followers.values()}
    law = robot.free.followers[follower]
    task = PostureTask(name="posture", posture={leader: 0.1}, stiffness=25.0, weight=1.0)
    run = ospace.simulate(robot, q, np.zeros(robot.nv), Controller(robot, task), duration=3.0)
    assert robot.joint_positions(run.q[-1])[leader] == pytest.approx(0.1, abs=1e-3)
    free = robot.free.configuration(run.q[-1])
    j = robot.free.model.getJointId(follower)
    assert free[robot.free.model.idx_qs[j]] == pytest.approx(law.ratio * 0.1 + law.offset, abs=2e-3)
    assert run.certificate().passed


def test_a_coupled_robot_takes_hold_of_a_body_and_lets_go():
    robot = trees.coupled(1)
    hand = robot.point("link_3")
    start = trees.state(robot, 1)
    body = rigid_body(20.0, np.array([1.0, 2.0, 2.5]), name="satellite")
    there = body.state(body.configuration(T_WB=start.placement(hand)), 0.1 * np.ones(6))
    held = grasp(start, hand, there, body.point(body.frame_names[0]))
    assert held.state.robot.free.followers.keys() == robot.free.followers.keys()
    assert held.state.robot.nv == robot.nv
    run = ospace.simulate(held.state.robot, held.state.q, held.state.v, duration=0.1)
    assert run.certificate().passed
    chaser, _ = release(held, run.q[-1], run.v[-1])
    own = held.state.robot.state(run.q[-1], run.v[-1]).placement(held.state.robot.point("link_3"))
    np.testing.assert_allclose(chaser.placement(hand).homogeneous, own.homogeneous, atol=1e-12)


def test_limits_of_a_coupled_robot_are_those_of_its_leaders():
    robot = trees.coupled(1)
    limits = JointLimits.of(robot)
    assert limits.torque.shape == (robot.n_joints,)
    target = trees.state(robot, 1).placement(robot.point("link_8"))
    task = PoseTask(name="hand", point=robot.point("link_8"), reference=Constant(target))
    command = Controller(robot, [task], limits=limits).update(0.0, trees.state(robot, 1).q, np.zeros(robot.nv))
    assert command.torque.shape == (robot.n_joints,)

"""Joints that leave the base in peace: the velocity that they give it falls to zero, whatever momentum does."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trees
from commands import accelerations, state, unlimited

import ospace
from ospace import simulate
from ospace.analysis import base_displacement
from ospace.control import Constant, Controller, DampingTask, PositionTask, ZeroReactionTask
from ospace.dynamics.dense import Dense


def given_to_base(robot, q, v):
    """J_b* φ̇, by Pinocchio's dense forms."""
    return Dense(robot.state(q, v), []).J_b_star @ v[6:]


def rates_along(robot, q, v, command, h=1e-4):
    """J_b* φ̇ and its rate along the motion that a command makes."""
    a = accelerations(robot, q, v, command)
    before, after = (
        given_to_base(robot, pin.integrate(robot.model, q, t * v + 0.5 * t * t * a), v + t * a) for t in (-h, h)
    )
    return given_to_base(robot, q, v), (after - before) / (2.0 * h)


@pytest.mark.parametrize("axes", ["angular", "linear", (True, False, False, False, True, True)])
@pytest.mark.parametrize("base", ["floating", "flying", "wheels"])
def test_what_joints_give_the_base_falls(chaser, hand, axes, base):
    """With momentum, and under a wrench on the base that another task asks for."""
    q, v = state(chaser, 2)
    rows = np.array(ospace.model.points.parse_axes(axes))
    tasks = [
        ZeroReactionTask(name="peace", axes=axes, stiffness=4.0, damping_ratio=0.75, level=0),
        PositionTask(name="hand", point=hand, level=1),
    ]
    command = Controller(chaser, tasks, base=base, limits=unlimited(chaser), regularization=1e-10).update(0.0, q, v)
    x, rate = rates_along(chaser, q, v, command)
    np.testing.assert_allclose(rate[rows], -3.0 * x[rows], rtol=0, atol=1e-6 * np.abs(rate).max())
    np.testing.assert_allclose(command.errors["peace"], -x[rows], rtol=0, atol=1e-12)
    assert np.abs(rate[~rows]).max() > 1e-3


@pytest.mark.parametrize("robot", [trees.tree(2, 12), trees.coupled(3)], ids=["every joint type", "coupled"])
def test_zero_reaction_of_joints_of_all_types(robot):
    q, v = state(robot, 5, speed=0.5)
    task = ZeroReactionTask(name="peace", axes="all", stiffness=1.0, level=0)
    run = Controller(robot, [task, DampingTask(name="rest")], limits=unlimited(robot), regularization=1e-12)
    command = run.update(0.0, q, v)
    x = given_to_base(robot, q, v)
    np.testing.assert_allclose(command.errors["peace"], -x, rtol=0, atol=1e-12)
    np.testing.assert_allclose(command.residuals["peace"], 0.0, rtol=0, atol=1e-7)
    a, h = np.r_[np.zeros(6), command.joint_acceleration], 1e-4
    before, after = (
        given_to_base(robot, pin.integrate(robot.model, q, t * v + 0.5 * t * t * a), v + t * a) for t in (-h, h)
    )
    rate = (after - before) / (2.0 * h)
    np.testing.assert_allclose(rate, -2.0 * x, rtol=0, atol=1e-5 * max(1.0, np.abs(rate).max()))


def test_a_hand_moves_and_the_base_stays_in_peace(chaser, hand):
    q = chaser.configuration({"right_arm_2": -0.6, "right_arm_4": 1.2, "left_arm_4": 0.8})
    start = chaser.state(q).placement(hand)
    goal = Constant(pin.SE3(start.rotation, start.translation + [0.0, 0.05, 0.05]))
    reach = PositionTask(name="hand", point=hand, reference=goal, stiffness=16.0, level=1)
    rest = DampingTask(name="rest")
    moved = {}
    for name, above in (("peace", [ZeroReactionTask(name="peace", level=0)]), ("none", [])):
        controller = Controller(chaser, [*above, reach, rest], period=2e-3)
        run = simulate(chaser, q, np.zeros(chaser.nv), controller, duration=1.0, step=2e-3, period=2e-3)
        turns = base_displacement(run.q[:, :7])[:, 1]
        reached = chaser.state(run.q[-1]).placement(hand).translation
        assert np.linalg.norm(reached - goal.pose.translation) < 0.02
        moved[name] = np.degrees(turns.max())
    assert moved["peace"] < 1e-5
    assert moved["none"] > 1e-2


def test_zero_reaction_refuses_a_reference(chaser):
    with pytest.raises(ospace.OspaceError, match="no reference to follow"):
        ZeroReactionTask(name="peace", reference=Constant(pin.SE3.Identity()))
    with pytest.raises(ospace.OspaceError, match="follows no such reference"):
        Controller(chaser, [ZeroReactionTask(name="peace")]).follow("peace", Constant(pin.SE3.Identity()))
    with pytest.raises(ospace.OspaceError, match="axes takes no row"):
        Controller(chaser, [ZeroReactionTask(name="peace", axes=(False,) * 6)])

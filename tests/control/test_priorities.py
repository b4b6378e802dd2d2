"""Strict levels: each keeps its motion, none is dropped, and one without a solution is named."""

import itertools

import numpy as np
import pinocchio as pin
import pytest
from commands import KEPT, leveled_states, state, unlimited

import ospace
from ospace.control import (
    BaseAttitudeTask,
    Constant,
    Controller,
    JointLimits,
    OrientationTask,
    PoseTask,
    PostureTask,
)
from ospace.control.base import MODES
from ospace.validation.sampling import random_state


def test_a_level_that_repeats_another_takes_nothing_from_those_below(chaser, hand, head):
    q, v = state(chaser, 8)
    far = Constant(pin.SE3.Identity())
    below = [OrientationTask(name="head", point=head, reference=far), PostureTask(name="posture", weight=1.0)]
    first = PoseTask(name="hand", point=hand, reference=far, level=0)
    again = PoseTask(name="again", point=hand, reference=far, level=1)
    alone, repeated = (
        Controller(chaser, tasks, limits=unlimited(chaser)).update(0.0, q, v)
        for tasks in ([first, *below], [first, again, *below])
    )
    np.testing.assert_allclose(
        repeated.joint_acceleration, alone.joint_acceleration, atol=1e-6 * np.abs(alone.joint_acceleration).max()
    )


def test_a_strict_level_costs_those_above_nothing(chaser, hand, head):
    q, v = state(chaser, 8)
    first = {"name": "hand", "point": hand, "reference": Constant(chaser.state(q, v).placement(hand))}
    rest = [
        OrientationTask(name="head", point=head, level=1, reference=Constant(pin.SE3.Identity())),
        BaseAttitudeTask(name="base", robot=chaser, level=2, reference=Constant(pin.SE3.Identity())),
        PoseTask(name="left", point=chaser.point("left_hand"), reference=Constant(pin.SE3.Identity())),
    ]
    own = {"limits": unlimited(chaser), "trust_radius": 1e6}  # the turn that is asked of the head is a long one
    alone = Controller(chaser, [PoseTask(**first, level=0)], **own).update(0.0, q, v)
    together = Controller(chaser, [PoseTask(**first, level=0), *rest], **own).update(0.0, q, v)
    for command in (alone, together):
        assert np.abs(command.residuals["hand"]).max() < 1e-4
    difference = together.residuals["hand"] - alone.residuals["hand"]
    assert np.abs(difference).max() < 1e-8
    assert np.abs(together.residuals["head"]).max() < 1e-2
    tasks = [PoseTask(**first), *(type(task)(**{**vars(task), "level": None}) for task in rest)]
    weighted = Controller(chaser, tasks, **own).update(0.0, q, v)
    assert np.abs(weighted.residuals["hand"]).max() > 1e-2


def test_levels_keep_limits(chaser, hand, head):
    q, v = state(chaser, 9)
    limits = JointLimits.of(chaser, share=0.05, acceleration=5.0)
    tasks = [
        PoseTask(name="hand", point=hand, level=0, reference=Constant(pin.SE3.Identity())),
        OrientationTask(name="head", point=head, level=1, reference=Constant(pin.SE3.Identity())),
        PostureTask(name="posture", weight=1.0),
    ]
    command = Controller(chaser, tasks, limits=limits).update(0.0, q, 0.1 * v)
    assert command.status in KEPT
    assert (np.abs(command.torque) <= limits.torque * (1 + 1e-8)).all()
    assert (np.abs(command.joint_acceleration) <= 5.0 + 1e-4).all()


@pytest.mark.parametrize("name", ["planar_2r", "ets_vii", "chaser_7dof", "chaser_24dof"])
@pytest.mark.parametrize("solver", ["daqp", "proxqp"])
def test_no_level_is_dropped_and_levels_are_those_of_quadprog(name, solver):
    """In states of which many need softened limits, and in which solvers alone fail."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    point, rng = robot.point(robot.leaf_links[-1]), np.random.default_rng(5)
    for seed in range(40):
        drawn = random_state(robot, np.random.default_rng(seed))
        limits = JointLimits.of(robot, share=rng.choice([1.0, 0.05]), acceleration=rng.choice([np.inf, 5.0]))
        goal = Constant(pin.SE3(pin.exp3(rng.normal(size=3)), drawn.q[:3] + rng.normal(scale=3.0, size=3)))
        tasks = [PoseTask(name="hand", point=point, reference=goal, level=0)]
        tasks += [BaseAttitudeTask(name="base", robot=robot, level=1), PostureTask(name="posture")]
        v = rng.choice([0.0, 0.1, 1.0]) * drawn.v
        one, other = (
            Controller(robot, tasks, limits=limits, base=sorted(MODES)[seed % 4], solver=kind).update(0.0, drawn.q, v)
            for kind in (solver, "quadprog")
        )
        assert one.status == other.status != "degraded"
        if one.status in KEPT:
            atol = 1e-3 * (1.0 + np.abs(other.torque).max())
            np.testing.assert_allclose(one.torque, other.torque, rtol=0, atol=atol)


@pytest.mark.parametrize("level", [1, None])
def test_a_level_without_a_solution_is_named(chaser, hand, level):
    tasks, q, v = next(leveled_states(chaser, hand, 1))
    run = Controller(chaser, tasks, limits=JointLimits.of(chaser, share=0.3))
    whole = run.update(0.0, q, v)
    solve, calls, failing = run._solve, itertools.count(), 1 if level == 1 else 2
    run._solve = lambda program: None if next(calls) == failing else solve(program)
    command = run.update(0.0, q, v)
    name = "base" if level == 1 else "rest"
    assert command.status == "degraded"
    assert command.dropped == {level: (name,)}
    assert ("level 1" if level == 1 else "without a level") in command.explanation
    assert f"'{name}'" in command.explanation
    np.testing.assert_allclose(command.residuals["hand"], whole.residuals["hand"], rtol=0, atol=1e-4)
    assert (np.abs(command.torque) <= run.limits.torque).all()

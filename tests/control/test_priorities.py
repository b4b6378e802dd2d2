"""Strict levels: each keeps its motion, none is dropped, and one without a solution is named."""

import itertools

import arms
import numpy as np
import pinocchio as pin
import pytest
from commands import KEPT, leveled_states, state, unlimited

import ospace
from ospace.control import (
    BaseAttitudeTask,
    Constant,
    Controller,
    DampingTask,
    JointLimits,
    OrientationTask,
    PoseTask,
    PostureTask,
)
from ospace.control.base import MODES
from ospace.control.priorities import Level, relaxed, solve_by_levels
from ospace.control.solvers import solver_of
from ospace.kernels.qp.tables import UNLIMITED, Program
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


def test_weights_balance_tasks_of_one_level():
    """As they do without levels: two poses that contradict each other, nine to one."""
    robot = arms.arm()
    q = robot.configuration({"joint_1": 0.4, "joint_2": 1.2, "joint_4": 0.7})
    pose = robot.state(q).placement(robot.point("tool"))
    found = []
    for level in (0, None):
        tasks = [
            PoseTask(
                name=f"by {weight}",
                point=robot.point("tool"),
                weight=weight,
                level=level,
                reference=Constant(pin.SE3(pose.rotation, pose.translation + np.array([by, 0.0, 0.0]))),
            )
            for weight, by in ((9.0, 0.01), (1.0, -0.01))
        ]
        run = Controller(robot, tasks, limits=unlimited(robot), trust_radius=1e6)
        found.append(run.update(0.0, q, np.zeros(robot.nv)))
    leveled, weighted = (one.joint_acceleration for one in found)
    np.testing.assert_allclose(leveled, weighted, rtol=0, atol=1e-6 * np.abs(weighted).max())
    np.testing.assert_allclose(found[0].residuals["by 9.0"][0], -25.0 * 0.1 * 0.02, rtol=1e-3)


def bare_program(size, lower, upper):
    """Nothing to minimize: z and, without a weight, as many torques, between bounds."""
    bounds = np.concatenate([lower, np.full(size, -UNLIMITED)]), np.concatenate([upper, np.full(size, UNLIMITED)])
    return Program(np.zeros((size, size)), np.zeros(size), np.eye(size), *bounds, np.zeros((2, size), dtype=np.int64))


def test_what_damps_a_level_damps_those_below():
    """Else these would swing for it: a level damped by 1 of one row, and one without a damping that asks for 1."""
    program = bare_program(3, np.full(3, -UNLIMITED), np.full(3, UNLIMITED))
    rows, none = np.eye(3), np.zeros(3)
    levels = [
        Level(rows[:1], np.array([1.0]), np.ones(3), np.array([0.0, -0.25, 0.0])),
        Level(rows[1:2], np.array([1.0]), none, none),
    ]
    z = solve_by_levels(program, levels, solver_of("daqp"), 1e-9).z
    np.testing.assert_allclose(z, [0.5, 0.5 * (1.0 + 0.25), 0.0], atol=1e-5)


def test_bounds_that_contradict_each_other_give_way_by_the_least_squares():
    """φ̈ from 10 on, and an inequality that ends it at 4: both by 3."""
    n, inf = 1, UNLIMITED
    program = Program(
        np.ones((1, 1)), np.zeros(1), np.ones((2, 1)), np.array([10.0, -inf, -inf]), np.array([inf, inf, 4.0]),
        np.zeros((2, 1), dtype=np.int64),
    )  # fmt: skip
    moved, z = relaxed(program, n, solver_of("daqp"))
    np.testing.assert_allclose(z, 7.0, atol=1e-3)
    np.testing.assert_allclose([moved.lower[0], moved.upper[2]], 7.0, atol=1e-3)


def test_where_nothing_can_be_solved_joints_are_braked_within_a_tenth_of_a_second():
    robot = arms.arm()
    run = Controller(robot, [DampingTask(name="rest")])
    run._solve = lambda program: None
    v = np.zeros(robot.nv)
    v[6:] = 1e-3 * np.array([0.0, 3.0, 0.0, 0.0, 0.0, 0.0])
    command = run.update(0.0, robot.configuration(), v)
    assert command.status == "stopped"
    np.testing.assert_allclose(command.joint_acceleration, -v[6:] / 0.1, rtol=0, atol=1e-4)

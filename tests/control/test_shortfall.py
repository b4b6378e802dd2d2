"""A command tells which task falls short, by how much, along what, and why."""

import arms
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.control import (
    BaseAttitudeTask,
    Completion,
    Constant,
    Controller,
    DampingTask,
    Function,
    JointLimits,
    OrientationTask,
    PoseTask,
    PositionTask,
    PostureTask,
)

BENT = np.radians([0.0, 20.0, 80.0, -50.0, 10.0, 40.0])


def bent(robot, joints=BENT):
    q = robot.configuration()
    q[7:] = joints
    return q


def moved(robot, q, by):
    pose = robot.state(q).placement(robot.point("tool"))
    return Constant(pin.SE3(pose.rotation, pose.translation + np.asarray(by)))


def hand(robot, q, by, kind=PoseTask, **settings):
    own = {"stiffness": 100.0, "weight": 10.0, "reference": moved(robot, q, by), **settings}
    return kind(name="hand", point=robot.point("tool"), **own)


def told(robot, q, tasks, v=None, **settings):
    run = Controller(robot, [*tasks, DampingTask(name="rest", stiffness=1.0)], **settings)
    return run.update(0.0, q, np.zeros(robot.nv) if v is None else v)


def test_a_reference_that_is_followed_is_nominal():
    robot = arms.arm()
    q = bent(robot)
    command = told(robot, q, [hand(robot, q, [2e-3, 0.0, 0.0])])
    assert command.status == "nominal"
    assert command.shortfalls == ()
    assert command.explanation == "nominal: all limits are kept, all references followed"


def test_a_target_beyond_a_stretched_arm_is_out_of_reach():
    robot = arms.arm()
    q = bent(robot, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    outward = np.array([np.sin(0.5), 0.0, np.cos(0.5)])
    command = told(robot, q, [hand(robot, q, 0.56 * outward, PositionTask)])
    (short,) = command.shortfalls
    assert command.status == "falling short"
    assert (short.task, short.reason) == ("hand", "out of reach")
    assert short.distance == pytest.approx(0.56, rel=1e-2)
    np.testing.assert_allclose(short.direction, outward, atol=0.02)
    assert "out of reach: hand, 0.56 m short along (0.5, 0, 0.87)" in command.explanation
    assert command.near_singularity == ()


def test_near_a_singularity_is_told_apart_from_out_of_reach():
    """Where nothing is asked for along the direction that is lost, there is no shortfall."""
    robot = arms.arm()
    q = bent(robot, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0])
    command = told(robot, q, [hand(robot, q, [0.0, 0.0, 0.0], PositionTask)], singular=1e-2)
    assert command.status == "nominal"
    assert command.near_singularity == ("hand",)
    assert "near a dynamic singularity: hand, along (" in command.explanation
    direction, turning = command.lost_direction("hand")
    assert not turning
    assert abs(direction @ [np.sin(0.5), 0.0, np.cos(0.5)]) == pytest.approx(1.0, abs=1e-3)
    assert "out of reach" not in command.explanation


def test_what_a_singularity_costs_without_an_error_is_its_own_reason():
    robot = arms.arm()
    q, v = bent(robot, [0.0, 0.5, 0.0, 0.0, 0.0, 0.0]), np.zeros(12)
    v[6:] = 0.0, 1.0, -1.5, 1.0, 0.0, 0.5  # the drift along the arm, that no joint can make up for
    pose = moved(robot, q, [0.0, 0.0, 0.0]).pose
    velocity = ospace.operational_space(robot.state(q, v), robot.point("tool")).jacobian @ v
    along = Function(lambda time: (pose, velocity, np.zeros(6)))
    own = {"stiffness": 9.0, "reference": along}
    (short,) = told(robot, q, [hand(robot, q, [0.0, 0.0, 0.0], PositionTask, **own)], v).shortfalls
    assert short.reason == "near a dynamic singularity"


@pytest.mark.parametrize("kind", ["torque", "position", "velocity"])
def test_what_limits_hold_back_names_them(kind):
    robot = arms.arm()
    q, v, limits = bent(robot), np.zeros(12), JointLimits.of(robot)
    changed = {name: getattr(limits, name).copy() for name in ("torque", "lower", "upper", "velocity", "acceleration")}
    if kind == "torque":
        changed["torque"][1] = 1.0
    elif kind == "position":
        changed["upper"][1] = q[8]
    else:
        changed["velocity"][1] = 1e-4
    command = told(robot, q, [hand(robot, q, [0.1, 0.0, -0.1], PositionTask)], v, limits=JointLimits(**changed))
    (short,) = command.shortfalls
    assert short.reason == "held back by limits"
    assert short.cause == f"held back by limits of joint_1 ({kind}): hand"
    assert set(short.limits) <= set(command.active_limits)
    assert short.cause in command.explanation


def test_what_other_tasks_hold_back_is_told():
    robot = arms.arm()
    q = bent(robot)
    strong = PostureTask(name="stay", weight=1e4)
    (short,) = told(robot, q, [hand(robot, q, [0.05, 0.0, 0.0]), strong]).shortfalls
    assert short.reason == "held back by other tasks"
    assert short.distance == pytest.approx(0.05, rel=0.05)


def test_a_long_way_is_told_as_one():
    robot = arms.arm()
    q = bent(robot)
    (short,) = told(robot, q, [hand(robot, q, [-0.5, 0.4, -0.3])]).shortfalls
    assert short.reason == "on its way"


def test_a_reference_that_runs_ahead_is_on_its_way_too():
    """What it asks of the error's rate counts as the error that a spring would need for it, 2 · 2 m/s / 10."""
    robot = arms.arm()
    q = bent(robot)
    pose, velocity = moved(robot, q, [0.0, 0.0, 0.0]).pose, np.r_[2.0, np.zeros(5)]
    ahead = Function(lambda time: (pose, velocity, np.zeros(6)))
    (short,) = told(robot, q, [hand(robot, q, [0.0, 0.0, 0.0], reference=ahead)]).shortfalls
    assert short.reason == "on its way"


def test_turns_are_in_degrees_about_an_axis():
    robot = arms.arm()
    q = bent(robot)
    pose = robot.state(q).placement(robot.point("tool"))
    goal = Constant(pin.SE3(pin.exp3(np.array([0.0, 0.0, 0.1])) @ pose.rotation, pose.translation))
    turn = OrientationTask(name="turn", point=robot.point("tool"), reference=goal)
    (short,) = told(robot, q, [turn, PostureTask(name="stay", weight=1e4)]).shortfalls
    assert short.turning
    assert short.size == "5.7 deg short about (0, 0, 1)"
    assert short.distance == 0.0


def test_the_bounds_of_completion_say_what_is_short():
    robot = arms.arm()
    q = bent(robot)
    stay = PostureTask(name="stay", weight=1e4)
    for bound, short in ((None, False), (1e-3, True), (0.1, False)):
        completion = None if bound is None else Completion(position=bound)
        command = told(robot, q, [hand(robot, q, [5e-3, 0.0, 0.0], completion=completion), stay])
        assert bool(command.shortfalls) == short
        assert command.status == ("falling short" if short else "nominal")


def test_postures_are_regularization_and_do_not_fall_short():
    robot = arms.arm()
    q = bent(robot)
    posture = PostureTask(name="far", posture={"joint_0": 2.0}, weight=1e-6)
    command = told(robot, q, [BaseAttitudeTask(name="base", robot=robot), posture])
    assert command.status == "nominal"

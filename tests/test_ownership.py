"""Points, states, motions and controllers of another robot are refused, wherever they are given."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.control import BaseAttitudeTask, Controller, LookAtTask, PoseTask, RelativePoseTask
from ospace.dynamics.dense import Dense
from ospace.simulation import grasp, rigid_body
from ospace.validation import report
from ospace.validation.sample import Sample
from ospace.visual.scene import Scene


@pytest.fixture(scope="module")
def robot():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))


OTHERS = {
    "of other size": lambda robot: ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof")),
    "smaller": lambda robot: rigid_body(5.0, (1.0, 1.0, 1.0), name="base"),
    "read again": lambda robot: ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r")),
    "pickled": lambda robot: pickle.loads(pickle.dumps(robot)),
    "deep-copied": copy.deepcopy,
}


@pytest.fixture(scope="module", params=OTHERS.values(), ids=OTHERS)
def foreign(robot, request):
    """Return a point of another robot: the farthest link's, whose number is the largest."""
    other = request.param(robot)
    return other.point(other.leaf_links[-1])


def controller_of(robot, task):
    return Controller(robot, [task])


def begun(robot):
    controller = Controller(robot, [PoseTask(name="hand", point=robot.point("end_effector"))])
    controller.update(0.0, robot.configuration(), np.zeros(robot.nv))
    return controller


def at_rest(robot):
    return robot.state(robot.configuration())


def a_second(robot):
    return robot.point("end_effector")


TAKERS = {
    "placement": lambda robot, point: at_rest(robot).placement(point),
    "placement_about_base": lambda robot, point: at_rest(robot).placement_about_base(point),
    "operational_space": lambda robot, point: ospace.operational_space(at_rest(robot), [a_second(robot), point]),
    "inverted": lambda robot, point: ospace.operational_space(at_rest(robot), point, "inverted"),
    "dense": lambda robot, point: ospace.operational_space(at_rest(robot), point, "dense"),
    "oracle": lambda robot, point: Dense(at_rest(robot), [point]),
    "generalized_jacobian": lambda robot, point: ospace.generalized_jacobian(at_rest(robot), point),
    "free_floating": lambda robot, point: ospace.free_floating(at_rest(robot), point),
    "evaluator": lambda robot, point: ospace.OperationalSpaceEvaluator(robot, [a_second(robot), point]),
    "batch": lambda robot, point: ospace.operational_space_batch(robot, point, robot.configuration()[None]),
    "pose task": lambda robot, point: controller_of(robot, PoseTask(name="t", point=point)),
    "look-at task": lambda robot, point: controller_of(robot, LookAtTask(name="t", point=point)),
    "relative pose": lambda robot, point: controller_of(
        robot, RelativePoseTask(name="t", point=a_second(robot), seen_from=point)
    ),
    "base attitude": lambda robot, point: controller_of(robot, BaseAttitudeTask(name="t", robot=point.robot)),
    "controller's pose": lambda robot, point: begun(robot).pose(point),
    "wrenches": lambda robot, point: ospace.simulate(
        robot, robot.configuration(), np.zeros(robot.nv), duration=0.01, wrenches={point: np.ones(6)}
    ),
    "hand": lambda robot, point: grasp(at_rest(robot), point, at_rest(robot), a_second(robot)),
    "fixture": lambda robot, point: grasp(at_rest(robot), a_second(robot), at_rest(robot), point),
    "check": lambda robot, point: report.check(robot, [point], samples=1),
    "sample": lambda robot, point: Sample(robot, at_rest(robot), [point], np.random.default_rng(0)),
    "scene": lambda robot, point: Scene(robot, [point]),
}


@pytest.mark.parametrize("take", TAKERS.values(), ids=TAKERS)
def test_a_point_of_another_robot_is_refused(robot, foreign, take):
    take(robot, a_second(robot))  # its own is taken
    with pytest.raises(ospace.OspaceError, match="belongs to another robot"):
        take(robot, foreign)


@pytest.mark.parametrize("take", [TAKERS[name] for name in TAKERS if name != "base attitude"])
@pytest.mark.parametrize("given", ["end_effector", 3, None], ids=repr)
def test_what_is_not_a_point_is_refused(robot, take, given):
    with pytest.raises(ospace.OspaceError, match=r"robot\.point"):
        take(robot, given)


@pytest.mark.parametrize("wrenches", [[1.0], "hand", 3.0])
def test_wrenches_that_are_no_mapping_are_refused(robot, wrenches):
    with pytest.raises(ospace.OspaceError, match="wrenches"):
        ospace.simulate(robot, robot.configuration(), np.zeros(robot.nv), duration=0.01, wrenches=wrenches)


def test_the_message_says_that_a_copy_is_another_robot(robot):
    point = copy.deepcopy(robot).point("end_effector")
    with pytest.raises(ospace.OspaceError, match=r"bears the name 'planar_2r' as well.*in one go with its points"):
        at_rest(robot).placement(point)


def test_points_and_states_copied_in_one_go_stay_together(robot):
    given = robot, at_rest(robot), a_second(robot)
    for one, state, point in (copy.deepcopy(given), pickle.loads(pickle.dumps(given))):
        assert state.robot is point.robot is one
        np.testing.assert_array_equal(
            state.placement(point).homogeneous, at_rest(robot).placement(a_second(robot)).homogeneous
        )


# -- motions and controllers -------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def namesake(robot):
    """Return a robot of the same sizes, with another name and other joints."""
    model = pin.Model(robot.model)
    model.name, model.names[2] = "another", "shoulder"
    return ospace.SpaceRobot.from_model(model)


def run_of(robot):
    return ospace.simulate(robot, robot.configuration(), np.zeros(robot.nv), duration=0.01)


def test_a_trajectory_of_another_robot_of_the_same_sizes_is_refused(robot, namesake):
    run = run_of(robot)
    run.at(robot, 0.005)
    with pytest.raises(ospace.OspaceError, match=r"of 'planar_2r'"):
        run.at(namesake, 0.005)
    with pytest.raises(ospace.OspaceError, match=r"of robot 'planar_2r'"):
        Scene(namesake).animate(run)


def test_a_controller_of_another_robot_s_joints_is_refused(robot, namesake):
    controller = Controller(robot, [PoseTask(name="hand", point=robot.point("end_effector"))])
    q = namesake.configuration()
    with pytest.raises(ospace.OspaceError, match="the controller is of robot 'planar_2r'"):
        ospace.simulate(namesake, q, np.zeros(namesake.nv), controller, duration=0.01)


def test_a_controller_may_know_its_robot_by_a_model_of_its_own(robot):
    controller = begun(copy.deepcopy(robot))
    run = ospace.simulate(robot, robot.configuration(), np.zeros(robot.nv), controller, duration=0.01)
    assert len(run) > 1


@pytest.mark.parametrize("given", [None, 5, "state", "robot", "q"])
def test_what_is_not_a_state_or_a_robot_is_refused(robot, given):
    state = robot.state(robot.neutral())
    point = robot.point("end_effector")
    wrong = {"robot": robot, "q": state.q}.get(given, given)
    for function in (ospace.momentum, ospace.joint_space_dynamics, ospace.generalized_dynamics):
        with pytest.raises(ospace.OspaceError, match=r"is not a State: make it with robot\.state\(q, v\)"):
            function(wrong)
    for function in (ospace.generalized_jacobian, ospace.operational_space, ospace.free_floating):
        with pytest.raises(ospace.OspaceError, match="is not a State"):
            function(wrong, [point])
    with pytest.raises(ospace.OspaceError, match="is not a State"):
        grasp(wrong, point, state, point)
    if wrong is robot:
        wrong = state
    for call in (
        lambda: ospace.OperationalSpaceEvaluator(wrong, [point]),
        lambda: ospace.operational_space_batch(wrong, [point], state.q[None]),
        lambda: ospace.simulate(wrong, state.q, state.v, duration=0.1),
        lambda: Controller(wrong, [PoseTask(name="tip", point=point)]),
    ):
        with pytest.raises(ospace.OspaceError, match="is not a SpaceRobot: read it with"):
            call()

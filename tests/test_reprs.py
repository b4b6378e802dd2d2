"""What is printed of robots, points, evaluators, controllers and results: a line that says what it is."""

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import analysis
from ospace.control import DampingTask, PoseTask


@pytest.fixture(scope="module")
def robot():
    return ospace.SpaceRobot.from_urdf("chaser_7dof")


def test_points_tell_rows_and_offset(robot):
    shift = pin.SE3(pin.rpy.rpyToMatrix(0.0, 0.0, np.deg2rad(30.0)), np.array([0.0, 0.0, 0.1]))
    assert repr(robot.point("end_effector")) == "OperationalPoint('end_effector', 'all')"
    assert repr(robot.point("end_effector", "linear")) == "OperationalPoint('end_effector', 'linear')"
    assert repr(robot.point("end_effector", [1, 0, 0, 0, 0, 1])) == "OperationalPoint('end_effector', x, rz)"
    offset = "offset=(0, 0, 0.1) m, rpy (0, 0, 30) deg"
    assert repr(robot.point("end_effector", offset=shift)) == f"OperationalPoint('end_effector', 'all', {offset})"


def test_what_works_in_loops_tells_what_it_is_of(robot):
    hand = robot.point("end_effector")
    evaluator = ospace.OperationalSpaceEvaluator(robot, hand, ("inertia_inverse",))
    assert repr(evaluator) == f"OperationalSpaceEvaluator('chaser_7dof', [{hand!r}], quantities=('inertia_inverse',))"
    tasks = [PoseTask(name="hand", point=hand), DampingTask(name="rest")]
    made = repr(ospace.Controller(robot, tasks, base="flying", period=2e-3))
    assert (
        made
        == "Controller('chaser_7dof', [PoseTask 'hand', DampingTask 'rest'], base=flying, period=0.002 s, solver=daqp)"
    )


def test_results_tell_their_shapes_and_no_numbers(robot):
    state, hand = robot.state(robot.neutral()), robot.point("end_effector")
    space = ospace.operational_space(state, hand)
    assert repr(space).startswith("OperationalSpace(inertia=array(6, 6), inertia_inverse=array(6, 6), ")
    assert repr(space).endswith("rank=6)")
    assert space.as_dict()["inertia"] is space.inertia
    results = [
        ospace.joint_space_dynamics(state),
        ospace.generalized_dynamics(state),
        ospace.generalized_jacobian(state, hand),
        ospace.free_floating(state, hand),
        ospace.operational_space_batch(robot, hand, np.tile(robot.neutral(), (3, 1))),
        analysis.reaction_null_space(state),
        ospace.Controller(robot, DampingTask(name="rest")).update(0.0, robot.neutral(), np.zeros(robot.nv)),
        ospace.simulate(robot, robot.neutral(), np.zeros(robot.nv), duration=0.01),
    ]
    for one in results:
        assert repr(one).startswith(f"{type(one).__name__}(")
        assert len(repr(one)) < 600
        assert "\n" not in repr(one)
    assert repr(results[-1]) == "Trajectory('chaser_7dof', 0 to 0.01 s in 11 records, rk4)"

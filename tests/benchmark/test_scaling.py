"""Robots of growing size: their degrees of freedom, and results right on them."""

import numpy as np
import pytest
import trees

import ospace
from ospace.benchmark import scaling


@pytest.mark.parametrize("shape", scaling.SHAPES)
@pytest.mark.parametrize("nv", [7, 12, 61])
def test_robots_of_any_size_have_it_and_right_results(shape, nv):
    robot = scaling.robot_of(shape, nv)
    assert robot.nv == nv
    state = trees.state(robot, 0)
    point = robot.point(robot.leaf_links[-1])
    reference = ospace.operational_space(state, point, "dense").inertia_inverse
    found = ospace.OperationalSpaceEvaluator(robot, point).update(state.q, state.v).inertia_inverse
    np.testing.assert_allclose(found, reference, rtol=0.0, atol=1e-10 * np.abs(reference).max())
    assert shape == "chain" or nv < 12 or len(robot.leaf_links) > 1

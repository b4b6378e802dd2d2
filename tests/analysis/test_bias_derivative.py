"""Derivatives of the bias force by configuration and velocity, against differences of eighth order of the oracle."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import analysis
from ospace.dynamics.dense import Dense

WEIGHTS = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))
STEP, DIGITS = 1e-3, 1e-10


def difference(state, points, direction):
    robot = state.robot
    of_q, of_v = np.split(direction, 2)

    def at(h):
        dense = Dense(ospace.State(robot, pin.integrate(robot.model, state.q, h * of_q), state.v + h * of_v), points)
        return dense.Gamma_e @ dense.mu

    return sum(weight * (at(k * STEP) - at(-k * STEP)) for k, weight in WEIGHTS) / STEP


def close(value, reference):
    np.testing.assert_allclose(value, reference, rtol=0, atol=DIGITS * max(1.0, np.abs(reference).max()))


@pytest.mark.parametrize("kind", [*trees.JOINT_TYPES, None])
def test_the_derivative_of_the_bias_force_for_every_joint_type(kind):
    robot = trees.tree(1, 3, (kind,)) if kind else trees.tree(4, 14)
    state, points = trees.state(robot, 1), [robot.point("link_2" if kind is None else "link_1", axes="linear")]
    direction = np.random.default_rng(1).normal(size=2 * robot.nv)
    close(analysis.bias_force_derivative(state, points, direction), difference(state, points, direction))


@pytest.mark.parametrize("seed", range(4))
def test_the_derivative_of_the_bias_force_of_a_coupled_robot(seed):
    robot = trees.coupled(seed)
    state, point = trees.state(robot, seed), robot.point("link_8")
    direction = np.random.default_rng(seed).normal(size=2 * robot.nv)
    close(analysis.bias_force_derivative(state, point, direction), difference(state, [point], direction))


def test_derivatives_of_the_bias_force_along_coordinates_add_up():
    robot = trees.tree(2, 7)
    state, points = trees.state(robot, 2), [robot.point("link_6", axes="linear"), robot.point("link_3")]
    whole = analysis.bias_force_derivative(state, points)
    assert whole.shape == (9, 2 * robot.nv)
    direction = np.random.default_rng(2).normal(size=2 * robot.nv)
    close(whole @ direction, analysis.bias_force_derivative(state, points, direction))
    close(whole @ direction, difference(state, points, direction))


def test_the_bias_force_does_not_change_where_base_and_frame_move_alike():
    """Neither the base's place nor its velocity counts; turning the robot turns the force."""
    robot = trees.tree(3, 6)
    state, point = trees.state(robot, 3), robot.point("link_5")
    whole, R = analysis.bias_force_derivative(state, point), state.T_WB.rotation
    mu_e = ospace.operational_space(state, point).bias_force
    assert not whole[:, :3].any()
    assert not whole[:, robot.nv : robot.nv + 3].any()
    for axis in range(3):
        turned = np.r_[np.cross(R[:, axis], mu_e[:3]), np.cross(R[:, axis], mu_e[3:])]
        close(whole[:, 3 + axis], turned)


def test_the_bias_force_is_of_second_degree_in_the_velocity():
    robot = trees.tree(4, 8)
    state, point = trees.state(robot, 4), robot.point("link_7")
    along = analysis.bias_force_derivative(state, point, np.r_[np.zeros(robot.nv), state.v])
    close(along, 2.0 * ospace.operational_space(state, point).bias_force)


def test_dependent_rows_have_no_derivative_of_the_bias_force():
    robot = trees.tree(0, 4)
    state = trees.state(robot, 0)
    points = [robot.point("link_3"), robot.point("link_3")]
    with pytest.raises(ospace.OspaceError, match="12 rows have rank 6"):
        analysis.bias_force_derivative(state, points)
    with pytest.raises(ospace.OspaceError, match="direction has shape"):
        analysis.bias_force_derivative(state, points[0], np.ones(robot.nv))

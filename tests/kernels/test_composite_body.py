"""Composite bodies against Pinocchio's crba, rnea and Jacobians, one sweep at a time."""

import numpy as np
import pinocchio as pin
import pytest
from kernel_tables import Laid, close, full

from ospace.kernels import composite_body, points


@pytest.fixture(params=range(4))
def laid(request):
    laid = Laid(request.param)
    points.place_points(laid.nodes, laid.w)
    composite_body.compose(laid.joints, laid.w)
    composite_body.base_generalized_jacobian(laid.w)
    composite_body.momentum(laid.joints, laid.w)
    return laid


def test_the_joint_space_inertia_is_the_dense_one(laid):
    composite_body.manipulator_inertia(laid.joints, laid.w)
    close(full(laid.w.IC[0]), laid.dense.H[:6, :6])
    close(laid.w.H_bm[1:].T, laid.dense.H[:6, 6:])
    close(laid.w.manipulator_inertia, laid.dense.H[6:, 6:])
    close(laid.w.inertia_diagonal[:, 0], np.diag(laid.dense.H))


def test_the_centre_of_mass_is_pinocchio_s(laid):
    robot = laid.state.robot
    centre = pin.centerOfMass(robot.model, robot.model.createData(), laid.state.q) - laid.state.q[:3]
    close(laid.w.mass_centre[0], centre, 1e-12)


def test_the_base_follows_the_joints_and_the_momentum(laid):
    close(full(laid.w.base_inverse[0]), np.linalg.inv(laid.dense.H[:6, :6]))
    close(laid.w.J_b_star[1:].T, laid.dense.J_b_star)
    close(laid.w.momentum[0], laid.dense.M_0)
    close(laid.w.base_momentum_velocity[0], np.linalg.solve(laid.dense.H[:6, :6], laid.dense.M_0))


def test_the_points_follow_the_joints_and_the_momentum(laid):
    laid.w.J_m_star[:] = np.nan  # all of it is written
    composite_body.generalized_jacobian(laid.robot, laid.w)
    close(laid.w.generalized_jacobian, laid.dense.J_m_star)
    rest = laid.dense.J_e[:, :6] @ np.linalg.solve(laid.dense.H[:6, :6], laid.dense.M_0)
    close(laid.w.momentum_velocity.ravel(), rest)


def test_the_base_eliminated_leaves_the_generalized_inertia(laid):
    composite_body.generalized_inertia(laid.joints, laid.w)
    close(laid.w.generalized_inertia, laid.dense.H_m_star)
    composite_body.bias(laid.joints, laid.w)
    close(laid.w.base_force[0], laid.dense.c[:6])
    close(laid.w.joint_force[:, 0], laid.dense.c[6:])
    composite_body.generalized_bias(laid.nodes, laid.w)
    close(laid.w.generalized_bias[:, 0], laid.dense.c_m_star)
    base = -np.linalg.solve(laid.dense.H[:6, :6], laid.dense.c[:6])
    close(laid.w.base_drift[0], base)
    close(laid.w.drift.ravel(), laid.dense.J_e[:, :6] @ base + laid.dense.drift)


def test_forces_of_a_motion_are_those_of_inverse_dynamics(laid):
    acceleration = np.random.default_rng(1).normal(size=laid.state.robot.nv)
    laid.w.given[:, 0] = acceleration
    composite_body.inverse_dynamics(laid.joints, laid.w)
    forces = np.concatenate([laid.w.base_force[0], laid.w.joint_force[:, 0]])
    close(forces, laid.dense.H @ acceleration + laid.dense.c)

"""Responses to forces at the points, and what a free-floating robot makes of them, against dense forms."""

import numpy as np
import pytest
from kernel_tables import Laid, close

from ospace.kernels import composite_body, points, pv_osimr, response


@pytest.fixture(params=range(4))
def laid(request):
    laid = Laid(request.param)
    w = laid.w
    w.IA[:] = w.I
    points.place_points(laid.nodes, w)
    pv_osimr.begin(laid.nodes, w)
    pv_osimr.sweep_inward(laid.joints, laid.nodes, w, False)
    pv_osimr.invert_base(w)
    composite_body.compose(laid.joints, w)
    composite_body.base_generalized_jacobian(w)
    composite_body.momentum(laid.joints, w)
    composite_body.generalized_jacobian(laid.robot, w)
    composite_body.bias(laid.joints, w)
    composite_body.generalized_bias(laid.nodes, w)
    w.response[:] = w.f[:] = w.base_mobility[:] = np.nan  # all of it is written
    response.respond(laid.robot, w)
    return laid


def test_the_response_to_forces_is_the_dense_one(laid):
    close(laid.w.response, laid.dense.response)


def test_pivots_are_those_of_the_articulated_inertia(laid):
    for i in range(1, len(laid.joints.parent)):
        beta = laid.w.S[i] @ laid.w.U[i] + laid.joints.armature[i, 0]
        assert laid.w.beta_inv[i, 0] == pytest.approx(1.0 / beta, rel=1e-13)


def test_free_floating_inertia_and_bias_are_the_dense_ones(laid):
    response.free_floating(laid.robot, laid.w)
    close(laid.w.floating_inertia_inverse, laid.dense.Lambda_inv)
    close(laid.w.floating_bias[:, 0], laid.dense.mu)


def test_the_locked_robot(laid):
    response.base_inertia_inverse(laid.robot, laid.w)
    close(laid.w.base_inertia_inverse, laid.dense.Lambda_b_inv)

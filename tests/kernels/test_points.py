"""Places, Jacobians and accelerations of points against Pinocchio's."""

import numpy as np
import pytest
from kernel_tables import Laid, close

from ospace.kernels import points
from ospace.kernels.tree import path_to


@pytest.fixture(params=range(4))
def laid(request):
    laid = Laid(request.param)
    points.place_points(laid.nodes, laid.w)
    return laid


def test_places_about_the_base_and_about_the_link(laid):
    for n in range(1, len(laid.nodes.parent)):
        if laid.nodes.point[n] >= 0:
            about_base = laid.state.placement_about_base(laid.points[laid.nodes.point[n]]).translation
            np.testing.assert_allclose(laid.w.place[n], about_base, rtol=0, atol=1e-14)
            np.testing.assert_allclose(laid.w.arm[n], about_base - laid.w.r[laid.nodes.link[n]], rtol=0, atol=1e-14)


def test_jacobians_of_points_are_pinocchio_s(laid):
    laid.w.columns[:] = np.nan  # all of it is written
    points.point_jacobians(laid.robot, laid.w)
    close(laid.w.jacobian, laid.dense.J_e, 1e-13)


def test_a_column_is_the_motion_per_rate(laid):
    tip = laid.points[0]
    p = laid.state.placement_about_base(tip).translation
    way = path_to(laid.state.robot.links.parent, int(laid.state.robot.link_of_joint[tip.joint]))
    for k in way:
        close(points.joint_column(laid.w, tuple(p), k), laid.dense.J_e[:6, k + 5], 1e-12)


def test_accelerations_without_those_of_the_joints_are_the_drift(laid):
    drift = np.empty((3, 6))
    for n in range(1, len(laid.nodes.parent)):
        if laid.nodes.point[n] >= 0:
            drift[laid.nodes.point[n]] = points.acceleration_at(laid.nodes, laid.w, n, (0.0,) * 6)
    close(drift.ravel(), laid.dense.drift)

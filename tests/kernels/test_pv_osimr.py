"""PV-OSIMr, sweep by sweep, on trees of all joint types whose points meet in junctions."""

import numpy as np
import pytest
from kernel_tables import Laid, close, full

from ospace.kernels import points, pv_osimr


@pytest.fixture(params=range(6))
def laid(request):
    laid = Laid(request.param)
    w = laid.w
    w.IA[:] = w.I
    points.place_points(laid.nodes, w)
    for table in (w.K, w.L, w.y, w.G, w.p):
        table[:] = np.nan  # all that is read is written before
    pv_osimr.begin(laid.nodes, w)
    pv_osimr.initial_bias_forces(w, w.I)
    pv_osimr.sweep_inward(laid.joints, laid.nodes, w, True)
    laid.base_pivot = pv_osimr.invert_base(w)
    return laid


def test_what_the_base_feels_is_the_rest_with_its_joints_free(laid):
    H, c = laid.dense.H, laid.dense.c
    free = np.linalg.solve(H[6:, 6:], np.column_stack([H[6:, :6], c[6:]]))
    close(full(laid.w.IA[0]), H[:6, :6] - H[:6, 6:] @ free[:, :6])
    close(laid.w.p[0], c[:6] - H[:6, 6:] @ free[:, 6])


def test_pivots_are_those_of_the_joints_with_all_further_out_free(laid):
    """The last column of a Cholesky factor from the outermost joint inward: what is left when others are free."""
    H, last = laid.dense.H[6:, 6:], len(laid.dense.H) - 6
    S, I = laid.w.S[last], full(laid.w.I[last])
    terms = S[:3] @ S[:3] * np.trace(I[:3, :3]) + S[3:] @ S[3:] * np.trace(I[3:, 3:])
    assert laid.w.relative_pivot[last, 0] == pytest.approx(H[-1, -1] / terms, rel=1e-10)


def test_mobility_of_the_base_and_its_pivot(laid):
    I = full(laid.w.IA[0])
    close(laid.w.G[0].reshape(6, 6), np.linalg.inv(I))
    assert laid.base_pivot == pytest.approx(1.0 / (np.diag(I) * np.diag(np.linalg.inv(I))).max(), rel=1e-9)


def test_the_inverse_operational_inertia_is_the_dense_one(laid):
    pv_osimr.sweep_outward(laid.nodes, laid.w)
    Gamma_inv = np.full_like(laid.w.all_rows, np.nan)
    pv_osimr.collect(laid.nodes, laid.w, Gamma_inv)
    close(Gamma_inv, laid.dense.Gamma_e_inv)


def test_the_bias_is_the_acceleration_when_no_force_acts(laid):
    pv_osimr.spread_bias(laid.nodes, laid.w)
    close(laid.w.acceleration.ravel(), -laid.dense.mu)


def test_without_bias_the_same_inertia_and_no_bias_touched():
    one, other = Laid(2), Laid(2)
    for laid, biased in ((one, True), (other, False)):
        laid.w.IA[:] = laid.w.I
        points.place_points(laid.nodes, laid.w)
        pv_osimr.begin(laid.nodes, laid.w)
        laid.w.p[:] = 1.0
        pv_osimr.sweep_inward(laid.joints, laid.nodes, laid.w, biased)
    for name in ("IA", "K", "L"):
        np.testing.assert_array_equal(getattr(one.w, name), getattr(other.w, name))
    assert (other.w.p == 1.0).all()
    assert (other.w.y == 0.0).all()


def test_blocks_of_a_triangle_stand_one_after_the_other():
    assert [pv_osimr.block(n, b) for n in range(4) for b in range(n + 1)] == list(range(10))

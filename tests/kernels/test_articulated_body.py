"""The articulated-body step against the matrices that it stands for."""

import numpy as np
import pytest
from kernel_tables import close, full

from ospace.kernels.articulated_body import force_across, inertia_across, pivot_terms, relative_pivot

LOWER = np.tril_indices(6)


@pytest.fixture
def case():
    rng = np.random.default_rng(4)
    A = rng.normal(size=(6, 6))
    I, S, p = A @ A.T + 6 * np.eye(6), rng.normal(size=6), rng.normal(size=6)
    return I, S, p, I @ S, S @ I @ S


def test_beyond_its_joint_a_body_resists_no_motion_along_it(case):
    I, S, _, U, beta = case
    across = full(inertia_across(tuple(I[LOWER]), tuple(U), 1.0 / beta))
    close(across, I - np.outer(U, U) / beta)
    assert np.abs(across @ S).max() < 1e-13 * np.abs(U).max()


def test_beyond_its_joint_no_force_acts_along_it(case):
    _, S, p, U, beta = case
    across = np.array(force_across(tuple(p), tuple(U), S @ p, 1.0 / beta))
    close(across, p - U * (S @ p) / beta)
    assert abs(across @ S) < 1e-13


def test_relative_pivot_is_over_the_traces_of_the_inertia(case):
    I, S, _, _, beta = case
    terms = S[:3] @ S[:3] * np.trace(I[:3, :3]) + S[3:] @ S[3:] * np.trace(I[3:, 3:])
    assert pivot_terms(tuple(I[LOWER]), tuple(S)) == pytest.approx(terms, rel=1e-14)
    assert relative_pivot(beta, terms) == pytest.approx(beta / terms, rel=1e-14)
    assert relative_pivot(1.0, 0.0) > 0.0  # a drive's inertia alone
    assert relative_pivot(0.0, 0.0) == 0.0

"""Inverse of a symmetric positive definite matrix by sweeping."""

import numpy as np
import pytest

from ospace.kernels.jit.load_store import table
from ospace.kernels.spd_inverse import Rows, inverse


def rows_for(r, lanes):
    """Working memory as the evaluator lays it out: whole rows in numbers of `lanes` doubles, or in plain ones."""
    m = r + r % 2
    columns = -(-m // lanes)
    memory, units = np.full((m + 2) * columns * lanes, np.nan), np.zeros(m * columns * lanes)
    units.reshape(m, -1)[range(m), range(m)] = 1.0
    memory.reshape(m + 2, -1)[:, m:] = 0.0
    number = np.zeros(lanes) if lanes > 1 else 0.0
    wide, unit = table(memory, 0, m + 2, columns, number), table(units, 0, m, columns, number)
    return Rows(memory.reshape(m + 2, -1), wide, unit, np.full((r, 1), np.nan))


def positive(rng, r, spread=0.0):
    """A matrix of eigenvalues in [1, 10], its units spread over that many powers of ten."""
    Q, _ = np.linalg.qr(rng.normal(size=(r, r)))
    A = Q * rng.uniform(1.0, 10.0, r) @ Q.T
    units = 10.0 ** rng.uniform(-spread, spread, r)
    return 0.5 * (A + A.T) * np.outer(units, units)


def swept(A, lanes=1):
    X = np.full_like(A, np.nan)
    pivot = inverse(A, rows_for(len(A), lanes), X)
    return X, pivot


@pytest.mark.parametrize("lanes", [1, 2, 8])
@pytest.mark.parametrize("r", [1, 2, 3, 4, 5, 6, 9, 12, 18])
def test_the_inverse_undoes_the_matrix_and_is_symmetric(r, lanes):
    A = positive(np.random.default_rng(r), r)
    X, _ = swept(A, lanes)
    np.testing.assert_allclose(X @ A, np.eye(r), rtol=0, atol=1e-13)
    np.testing.assert_array_equal(X, X.T)


@pytest.mark.parametrize("r", [1, 5, 6])
def test_units_of_the_rows_do_not_matter(r):
    A = positive(np.random.default_rng(r), r, spread=6.0)
    X, pivot = swept(A)
    size = np.sqrt(np.diag(A))
    np.testing.assert_allclose(X * np.outer(size, size) @ (A / np.outer(size, size)), np.eye(r), rtol=0, atol=1e-12)
    assert pivot == pytest.approx(swept(A / np.outer(size, size))[1], rel=1e-12)


@pytest.mark.parametrize("r", [1, 2, 5, 6, 9])
def test_the_smallest_pivot_is_that_of_cholesky_at_unit_diagonal(r):
    for seed in range(8):
        A = positive(np.random.default_rng(seed), r, spread=2.0)
        size = np.sqrt(np.diag(A))
        expected = np.square(np.diag(np.linalg.cholesky(A / np.outer(size, size)))).min()
        assert swept(A)[1] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("last", [3, 4])
def test_the_pivot_of_dependent_rows_falls_to_rounding(last):
    rng = np.random.default_rng(2)
    J = rng.normal(size=(last + 1, 8))
    J[last] = J[:last].sum(axis=0)
    assert abs(swept(J @ J.T)[1]) < 1e-13

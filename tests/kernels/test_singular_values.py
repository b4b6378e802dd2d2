"""Singular values in the lanes, against LAPACK: of all shapes, ranks and spreads."""

import numpy as np
import pytest

from ospace.kernels import singular_values as kernel
from ospace.kernels.jit import simd

SHAPES = ((1, 1), (1, 4), (4, 1), (3, 7), (6, 6), (6, 7), (7, 6), (12, 18))


def values_of(A, width):
    out = np.full((len(A), min(A.shape[1:])), np.nan)
    kernel.BY_WIDTH[width](A, np.full(kernel.memory_length(*A.shape[1:], width), np.nan), out)
    return out


def off(A, width=None):
    """The largest difference to LAPACK, in the largest singular value of each matrix."""
    A = np.ascontiguousarray(A)
    reference = np.linalg.svd(A, compute_uv=False)
    difference = np.abs(values_of(A, width or simd.widest()) - reference).max(axis=1)
    return (difference / np.maximum(reference[:, 0], 1e-300)).max()


def matrices(shape, values, count=11):
    U, _, V = np.linalg.svd(np.random.default_rng(sum(shape)).normal(size=(count, *shape)), full_matrices=False)
    return (U * values) @ V


@pytest.mark.parametrize("shape", SHAPES)
def test_singular_values_of_random_matrices_are_those_of_lapack(shape):
    assert off(np.random.default_rng(1).normal(size=(50, *shape))) < 1e-13


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("kind", ["spread", "one lost", "one left", "alike", "two alike", "nothing"])
def test_singular_values_of_lost_and_equal_directions(shape, kind):
    m = min(shape)
    values = {
        "spread": 10.0 ** (-3.0 * np.arange(m)),
        "one lost": np.r_[np.ones(m - 1), 1e-20],
        "one left": np.r_[1.0, np.zeros(m - 1)],
        "alike": np.ones(m),
        "two alike": np.r_[1.0, 1.0 + 1e-9, 1e-6 * np.ones(m)][:m],
        "nothing": np.zeros(m),
    }[kind]
    assert off(matrices(shape, values)) < 1e-13


@pytest.mark.parametrize("factor", [1e-60, 1e60])
def test_units_of_singular_values_do_not_matter(factor):
    assert off(factor * np.random.default_rng(2).normal(size=(9, 6, 7))) < 1e-13


def test_rows_of_zeros_and_whole_numbers_have_their_singular_values():
    A = np.round(np.random.default_rng(3).normal(size=(40, 6, 7)))
    A[:20, 2] = 0.0
    A[5:30, :, 3] = 0.0
    assert off(A) < 1e-13


@pytest.mark.parametrize("width", sorted(simd.WIDTHS))
@pytest.mark.parametrize("count", [1, 7, 8])
def test_singular_values_do_not_depend_on_the_width_of_a_vector(width, count):
    assert off(np.random.default_rng(4).normal(size=(count, 6, 9)), width) < 1e-13


def test_each_lane_has_singular_values_of_its_own():
    A = np.random.default_rng(5).normal(size=(8, 6, 7)) * 10.0 ** np.arange(-20.0, 20.0, 5.0)[:, None, None]
    assert off(A) < 1e-13


def test_singular_values_of_a_matrix_do_not_depend_on_its_neighbours():
    rng, width = np.random.default_rng(6), simd.widest()
    A, B = rng.normal(size=(2, width, 6, 7))
    B[1:] = matrices((6, 7), np.ones(6), width - 1)
    B[0] = A[0]
    np.testing.assert_array_equal(values_of(A, width)[0], values_of(B, width)[0])

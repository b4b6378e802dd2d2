"""Sine and cosine without a branch, against 50 digits, up to where they promise to hold."""

import mpmath as mp
import numpy as np
import pytest

from ospace.kernels.jit.compile import entry
from ospace.kernels.kinematics import sine_cosine, sines_cosines

LIMIT = 1e5
EPS = np.finfo(float).eps


@entry
def compiled(q, sine, cosine):
    sines_cosines(q, sine, cosine)


def exactly(x):
    with mp.workdps(50):
        return float(mp.sin(mp.mpf(x))), float(mp.cos(mp.mpf(x)))


def close(x):
    """To within a unit of the last digit of one."""
    for value, expected in zip(sine_cosine(x), exactly(x), strict=True):
        assert abs(value - expected) <= EPS, f"at {x!r}: {value!r} for {expected!r}"


def near(x):
    return [x, np.nextafter(x, np.inf), np.nextafter(x, -np.inf)]


@pytest.mark.parametrize("turn", [0, 1, 2, 3, 4, 5, 7, 10, 63661])
def test_sine_and_cosine_at_quarter_turns_and_where_the_reduction_changes(turn):
    for x in (turn * np.pi / 2.0, (turn + 0.5) * np.pi / 2.0):
        for angle in [*near(x), *near(-x)]:
            if abs(angle) <= LIMIT:
                close(float(angle))


def test_sine_and_cosine_of_small_angles_keep_all_their_digits():
    for x in (0.0, 5e-324, 1e-300, 1e-17, 1e-8, 1e-3):
        for angle in (x, -x):
            s, c = sine_cosine(angle)
            expected = exactly(angle)
            assert s == pytest.approx(expected[0], rel=4e-16, abs=0.0)
            assert c == pytest.approx(expected[1], rel=2e-16)


@pytest.mark.parametrize("largest", [1.0, 4.0, 100.0, LIMIT])
def test_sine_and_cosine_of_random_angles(largest):
    for x in np.random.default_rng(6).uniform(-largest, largest, 500):
        close(float(x))


def test_sine_and_cosine_at_the_largest_angle():
    for x in (LIMIT, -LIMIT, np.nextafter(LIMIT, 0.0)):
        close(float(x))


@pytest.mark.parametrize("way", [compiled, sines_cosines], ids=["compiled", "interpreted"])
def test_sines_and_cosines_of_a_whole_table(way):
    """Sums that the compiler may reorder elsewhere stay in order in the reduction."""
    x = np.r_[np.random.default_rng(7).uniform(-LIMIT, LIMIT, 300), np.arange(-8, 9) * np.pi / 4.0, LIMIT, -LIMIT]
    sine, cosine = np.full((2, len(x), 1), np.nan)
    way(x[:, None], sine, cosine)
    expected = np.array([exactly(one) for one in x])
    np.testing.assert_allclose(np.hstack([sine, cosine]), expected, rtol=0, atol=EPS)


def test_sines_and_cosines_of_several_lanes():
    x = np.linspace(-7.0, 7.0, 32)
    s, c = sine_cosine(x)
    np.testing.assert_array_equal(np.column_stack([s, c]), [sine_cosine(one) for one in x])

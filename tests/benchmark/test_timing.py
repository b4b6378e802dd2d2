"""Timing: windows take turns, and a ratio is one of medians."""

import numpy as np
import pytest

from ospace.benchmark.timing import WINDOWS, Ratio, window_times


def test_windows_take_turns():
    calls = []
    ways = [lambda q, v, k=k: calls.append(k) for k in range(2)]
    times = window_times(ways, [(np.zeros(1), np.zeros(1))], seconds=1e-9, tick=lambda: calls.append("tick"))
    assert times.shape == (WINDOWS, 2)
    assert calls == [0, 0, 1, 1] + [0, 1, "tick"] * WINDOWS


def test_ratio_is_of_medians_over_windows():
    times = np.array([[1e-6, 2e-6], [1e-6, 4e-6], [2e-6, 6e-6]])
    assert Ratio.of(times) == Ratio(*(pytest.approx(x) for x in (1.0, 4.0, 3.0, 2.5, 3.5)))

"""Timing of several ways against each other: turn by turn, so that what else the machine does meets all."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ospace.kernels.tree import Floats

Way = Callable[[Floats, Floats], Any]
"""Function that is timed: called with q and v."""
States = Sequence[tuple[Floats, Floats]]
Tick = Callable[[], None]
"""Called after every turn: progress, and the place to stop at."""
WINDOWS = 15


@dataclass(frozen=True)
class Ratio:
    """Times of one call, and how much longer the other way takes.

    Attributes
    ----------
    ours, theirs : float
        Median over the windows, µs.
    ratio : float
        Median over the windows of theirs over ours.
    low, high : float
        Quartiles of the ratio.
    """

    ours: float
    theirs: float
    ratio: float
    low: float
    high: float

    @classmethod
    def of(cls, times: Floats) -> Ratio:
        """Sum up (windows, 2) times of ours and theirs, s."""
        low, middle, high = np.percentile(times[:, 1] / times[:, 0], (25, 50, 75))
        ours, theirs = np.median(times, axis=0) * 1e6
        return cls(float(ours), float(theirs), float(middle), float(low), float(high))


def window_times(ways: Sequence[Way], states: States, *, seconds: float, tick: Tick) -> Floats:
    """Return (windows, ways) times of one call, s: each window runs each way over all `states`, again and again.

    `seconds` is for all windows of all ways. Each way is warmed up before.
    """
    rounds = [_rounds(way, states, seconds / (WINDOWS * len(ways))) for way in ways]
    times = np.empty((WINDOWS, len(ways)))
    for window in times:
        for k, way in enumerate(ways):
            window[k] = _run(way, states, rounds[k]) / (rounds[k] * len(states))
        tick()
    return times


def _run(way: Way, states: States, rounds: int) -> float:
    start = time.perf_counter()
    for _ in range(rounds):
        for q, v in states:
            way(q, v)
    return time.perf_counter() - start


def _rounds(way: Way, states: States, seconds: float) -> int:
    """Return how many rounds over all states fill a window; a first one warms up and does not count."""
    _run(way, states, 1)
    return max(1, int(seconds / max(_run(way, states, 1), 1e-9)))

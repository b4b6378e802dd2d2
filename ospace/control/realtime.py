"""A control loop with deadlines: without garbage collection, with nothing left to load, and its cycles timed."""

from __future__ import annotations

import gc
import math
import time as clock
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ospace.control.command import Command
from ospace.control.controller import Controller
from ospace.exceptions import OspaceError

_SHORTEST, _LONGEST = 1e-6, 100.0  # s
_FINENESS = 100.0
"""Bins of the record in a factor of e: percentiles are good to 1 %."""
_KEPT = 1000
"""Overruns that are kept, the last ones."""


class Overrun(NamedTuple):
    """A cycle that took longer than the period."""

    time: float
    """Of the cycle, s."""
    duration: float
    """s."""
    processor: float = math.nan
    """For how much of it the thread had a processor, s; the rest went to other programs. NaN where it is not known."""


class Loop:
    """A controller whose cycles are timed; made by `realtime`.

    Attributes
    ----------
    period : float
        A cycle that takes longer is an overrun, s.
    cycles : int
    overruns : int
        How many there were.
    last_overruns : deque of Overrun
        The last 1000 of them.
    largest : Overrun
        The longest of all cycles, an overrun or not.
    garbage : int
        Objects that the loop left in reference cycles, which Python's collector would have freed in between; known
        when the loop is over. The controller leaves none.
    """

    def __init__(self, controller: Controller, period: float) -> None:
        self.controller, self.period = controller, period
        self.cycles = self.overruns = self.garbage = 0
        self.last_overruns: deque[Overrun] = deque(maxlen=_KEPT)
        self.largest = Overrun(math.nan, 0.0)
        self._counts = np.zeros(_bin(_LONGEST) + 1, dtype=np.int64)

    def update(self, time: float, q: npt.ArrayLike, v: npt.ArrayLike) -> Command:
        """Return what `Controller.update` does, and note how long it took."""
        worked, start = clock.thread_time(), clock.perf_counter()
        command = self.controller.update(time, q, v)
        duration = clock.perf_counter() - start
        self.note(time, duration, clock.thread_time() - worked)
        return command

    def note(self, time: float, duration: float, processor: float = math.nan) -> None:
        """Note that the cycle at `time` took so long, s: for loops that do more in a cycle than `update`."""
        self.cycles += 1
        self._counts[_bin(duration)] += 1
        if duration > self.largest.duration:
            self.largest = Overrun(time, duration, processor)
        if duration > self.period:
            self.overruns += 1
            self.last_overruns.append(Overrun(time, duration, processor))

    def percentile(self, share: float) -> float:
        """Return within which time `share` percent of the cycles were done, s, to 1 %; NaN before the first."""
        if not self.cycles:
            return math.nan
        last = int(np.searchsorted(np.cumsum(self._counts), math.ceil(share / 100.0 * self.cycles)))
        return min(_SHORTEST * math.exp((last + 1) / _FINENESS), self.largest.duration)

    def __str__(self) -> str:
        if not self.cycles:
            return "no cycle"
        middle, p99, p999 = (1e6 * self.percentile(share) for share in (50.0, 99.0, 99.9))
        text = (
            f"{self.cycles} cycles: median {middle:.3g} µs, 99 % within {p99:.3g}, 99.9 % within {p999:.3g}, "
            f"largest {self.largest.duration * 1e6:.4g} µs at {self.largest.time:.6g} s"
        )
        if not math.isnan(self.largest.processor):
            text += f", {self.largest.processor * 1e6:.4g} of it on a processor"
        late = f"{self.overruns} overruns of {self.period * 1e3:g} ms" if self.overruns else "no overrun"
        left = f"; {self.garbage} objects left in reference cycles" if self.garbage else ""
        return f"{text}; {late}{left}"


@contextmanager
def realtime(controller: Controller, period: float | None = None) -> Iterator[Loop]:
    """Run a loop without Python's garbage collector, and time its cycles.

    Beforehand the controller is warmed up, and what there is by then is collected once and taken out of the
    collector's sight (`gc.freeze`). Memory is freed all the same where nothing refers to it any more; only objects that
    refer to each other in a circle stay until the loop is over. Then the collector is as it was.

    Parameters
    ----------
    controller : Controller
    period : float, optional
        A cycle that takes longer is an overrun, s; the controller's period without it.

    Returns
    -------
    context manager of Loop
        Call its `update` in place of the controller's.

    Raises
    ------
    OspaceError
        The period makes no sense.
    """
    period = controller.period if period is None else period
    if not 0.0 < period < math.inf:
        raise OspaceError(f"period is {period!r}: give a finite number above 0, s")
    loop = Loop(controller, period)
    enabled, frozen = gc.isenabled(), gc.get_freeze_count()
    gc.collect()
    gc.disable()
    controller.warm_up()  # last of all: the collector leaves the processor's caches cold
    gc.freeze()
    try:
        yield loop
    finally:
        loop.garbage = gc.collect()
        if not frozen:  # else it was frozen by whoever is around, and stays so
            gc.unfreeze()
        if enabled:
            gc.enable()


def _bin(duration: float) -> int:
    return int(_FINENESS * math.log(min(max(duration, _SHORTEST), _LONGEST) / _SHORTEST))

"""Completion of tasks: errors within their bounds for some time without a break."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ospace.control.references import MinimumJerk, Reference
from ospace.control.tasks import Task
from ospace.kernels.tree import Floats, Ints


class CompletionWatch:
    """Since when each task with a completion test is within its bounds."""

    def __init__(self, tasks: Sequence[Task], first: Ints, rows: Ints) -> None:
        self._parts = [
            (t, task, rows[first[t] : first[t + 1]], slice(int(first[t]), int(first[t + 1])))
            for t, task in enumerate(tasks)
            if task.completion is not None
        ]
        self._inside_since = np.full(len(tasks), np.nan)

    def observe(self, time: float, error: Floats, references: Sequence[Reference | None]) -> None:
        """Take the errors (m,) of all rows in a cycle; a `MinimumJerk` is not complete before it rests."""
        for t, task, rows, own in self._parts:
            reference = references[t]
            moves = isinstance(reference, MinimumJerk) and time < reference.start + reference.duration
            if moves or task.completion is None or not task.is_within(task.completion, rows, error[own]):
                self._inside_since[t] = np.nan
            elif np.isnan(self._inside_since[t]):
                self._inside_since[t] = time

    def restart(self, t: int) -> None:
        """Begin anew with task `t`."""
        self._inside_since[t] = np.nan

    def held(self, t: int, time: float) -> float:
        """Return how long task `t` has been within its bounds, s; NaN where it is not."""
        return float(time - self._inside_since[t])

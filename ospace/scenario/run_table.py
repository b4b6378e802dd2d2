"""A run as one tidy table: a row for each record, over all segments, with its phase and the errors of its tasks."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from ospace.files import replacing
from ospace.simulation.columns import columns


class RunLike(Protocol):
    """The part of a `Run` that makes the table."""

    @property
    def phases(self) -> Sequence[Any]: ...  # noqa: D102
    @property
    def segments(self) -> Sequence[Any]: ...  # noqa: D102


_WHAT = ("position error", "angle error")


def run_columns(run: RunLike) -> dict[str, Any]:
    """Return the columns of the table.

    Parameters
    ----------
    run : Run

    Returns
    -------
    dict of str to (N,) array
        By heading, with its unit. NaN where a segment has no such joint, a phase no such task, or no control cycle was
        at the record.
    """
    parts = [_segment(run, k, segment) for k, segment in enumerate(run.segments)]
    headings = dict.fromkeys(heading for part in parts for heading in part)
    return {
        heading: np.concatenate([part[heading] if heading in part else _nothing(part) for part in parts])
        for heading in headings
    }


def write(run: RunLike, file: Path) -> Path:
    """Write the table as CSV: numbers with all digits, NaN as nothing.

    Parameters
    ----------
    run : Run
    file : Path

    Returns
    -------
    Path
        The file.
    """
    table = run_columns(run)
    with replacing(file) as part, part.open("w", encoding="utf-8", newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow(table)
        rows.writerows([_cell(value) for value in row] for row in zip(*table.values(), strict=True))
    return file


def _cell(value: Any) -> object:
    if not isinstance(value, float):
        return value
    return "" if math.isnan(value) else f"{value:.17g}"


def _nothing(part: dict[str, Any]) -> Any:
    return np.full(len(part["time [s]"]), math.nan)


def _segment(run: RunLike, k: int, segment: Any) -> dict[str, Any]:
    table = columns(segment.trajectory, segment.robot)
    time = table.pop("time [s]")
    phases = np.full(len(time), "", dtype=object)
    errors: dict[str, Any] = {}
    for phase in (one for one in run.phases if one.segment == k):
        within = (time >= phase.start - 1e-9) & (time <= phase.end + 1e-9)
        phases[within] = phase.name
        _add_errors(errors, phase, time)
    return {"time [s]": time, "phase": phases, "segment": np.full(len(time), k), **table, **errors}


def _add_errors(errors: dict[str, Any], phase: Any, time: Any) -> None:
    """Put the errors of a phase's cycles into the records that they belong to."""
    if not len(phase.time):
        return
    records = np.clip(np.searchsorted(time, phase.time - 1e-9), 0, len(time) - 1)
    there = np.abs(time[records] - phase.time) < 1e-9
    for task, of_task in phase.errors.items():
        for c, unit in enumerate(of_task.units):
            values = of_task.norms[:, c]
            if unit and not np.isnan(values).all():
                column = errors.setdefault(f"{task} {_WHAT[c]} [{unit}]", np.full(len(time), math.nan))
                column[records[there]] = values[there]

"""Files that hold a run: one ``.npz``, or a folder of CSV files."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from ospace.exceptions import OspaceError
from ospace.kernels.tables import Floats
from ospace.scenario.result import Run
from ospace.simulation import Trajectory

_TARGET = ("time", "q", "v")


@dataclass(frozen=True, eq=False)
class Log:
    """What `load` reads.

    Attributes
    ----------
    scenario : str
        The text of the scenario.
    trajectories : tuple of Trajectory
        Of the chaser, segment by segment: before and after each grasp or release.
    targets : tuple of (time, q, v) or None
        Of the target while it moves by itself, segment by segment.
    phases : dict of str to array
        ``name``, ``outcome``, ``start``, ``end`` and ``segment`` of each phase.
    errors : tuple of dict
        Of each phase: ``time`` (N,), and each task's norms (N, 2) by its name under ``tasks``.
    """

    scenario: str
    trajectories: tuple[Trajectory, ...]
    targets: tuple[tuple[Floats, Floats, Floats] | None, ...]
    phases: dict[str, Any]
    errors: tuple[dict[str, Any], ...]


def save(run: Run, path: str | os.PathLike[str]) -> Path:
    """Write a run to ``path``, compressed; the suffix is ``.npz``. The file appears when it is whole."""
    file = Path(path).with_suffix(".npz")
    content: dict[str, Any] = {"scenario": run.scenario.source}
    for k, segment in enumerate(run.segments):
        for one in fields(Trajectory):
            content[f"segment{k}/{one.name}"] = getattr(segment.trajectory, one.name)
        if segment.target is not None:
            values = (segment.target_time, segment.target_q, segment.target_v)
            content |= {f"segment{k}/target/{name}": value for name, value in zip(_TARGET, values, strict=True)}
    for name in ("name", "outcome", "start", "end", "segment"):
        content[f"phases/{name}"] = np.array([getattr(phase, name) for phase in run.phases])
    for k, phase in enumerate(run.phases):
        content[f"phase{k}/time"] = phase.time
        for task, errors in phase.errors.items():
            content[f"phase{k}/errors/{task.replace('/', '_')}"] = errors.norms
    part = file.with_name(f".{file.name}.part.npz")
    try:
        np.savez_compressed(part, **content)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)
    return file


def load(path: str | os.PathLike[str]) -> Log:
    """Read what `save` wrote; raises `OspaceError` if the file cannot be read or holds something else."""
    try:
        with np.load(path, allow_pickle=False) as file:
            stored: dict[str, Any] = {name: file[name] for name in file.files}
        trajectories, targets = [], []
        for k in _count(stored, "segment"):
            values = {one.name: stored[f"segment{k}/{one.name}"] for one in fields(Trajectory)}
            trajectories.append(
                Trajectory(**{name: value.item() if value.ndim == 0 else value for name, value in values.items()})
            )
            target = tuple(stored.get(f"segment{k}/target/{name}") for name in _TARGET)
            targets.append(None if target[0] is None else target)
        phases = {name[7:]: value for name, value in stored.items() if name.startswith("phases/")}
        errors = []
        for k in range(len(phases["name"])):
            tasks = {name.split("/", 2)[2]: stored[name] for name in stored if name.startswith(f"phase{k}/errors/")}
            errors.append({"time": stored[f"phase{k}/time"], "tasks": tasks})
        return Log(str(stored["scenario"]), tuple(trajectories), tuple(targets), phases, tuple(errors))  # type: ignore[arg-type]
    except KeyError as error:
        raise OspaceError(f"{path}: holds no run of a scenario: {error} is missing") from None
    except (OSError, ValueError, AttributeError) as error:
        raise OspaceError(f"{path}: no run can be read from it ({error})") from None


def to_csv(run: Run, folder: str | os.PathLike[str]) -> list[Path]:
    """Write a run to a folder: ``phases.csv``, ``errors_<k>_<phase>.csv``, and a folder for each segment.

    Returns the paths of the files.
    """
    to = Path(folder)
    to.mkdir(parents=True, exist_ok=True)
    lines = ["phase,outcome,segment,start [s],end [s]"]
    lines += [f"{_quoted(p.name)},{p.outcome},{p.segment},{p.start!r},{p.end!r}" for p in run.phases]
    written = [to / "phases.csv"]
    written[0].write_text("\n".join(lines) + "\n", encoding="utf-8")
    for k, phase in enumerate(run.phases):
        heading, columns = ["time [s]"], [phase.time]
        for task, errors in phase.errors.items():
            for c, unit in enumerate(errors.units):
                if not np.isnan(errors.norms[:, c]).any():
                    heading.append(_quoted(f"{task} [{unit}]"))
                    columns.append(errors.norms[:, c])
        written.append(_table(to / f"errors_{k}_{_safe(phase.name)}.csv", heading, np.column_stack(columns)))
    for k, segment in enumerate(run.segments):
        own = to / f"segment_{k}"
        written += segment.trajectory.to_csv(own)
        if segment.target is not None:
            values = np.c_[segment.target_time, segment.target_q, segment.target_v]
            heading = ["time [s]", *(f"q[{i}]" for i in range(segment.target_q.shape[1]))]
            heading += [f"v[{i}]" for i in range(segment.target_v.shape[1])]
            written.append(_table(own / "target.csv", heading, values))
    return written


def _table(file: Path, heading: list[str], values: Floats) -> Path:
    np.savetxt(file, values, fmt="%.17g", delimiter=",", header=",".join(heading), comments="", encoding="utf-8")
    return file


def _count(stored: dict[str, Any], what: str) -> Iterator[int]:
    k = 0
    while f"{what}{k}/time" in stored:
        yield k
        k += 1


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if set(text) & set(',"\n') else text


def _safe(text: str) -> str:
    """Return a name as files may have it."""
    return "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in text)

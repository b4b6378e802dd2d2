"""The curves of a run: what can be plotted of a log, in units for people."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ospace.kernels.tree import Floats
from ospace.results import Result
from ospace.scenario.log import Log
from ospace.scenario.result import BASE, PhaseResult, TaskErrors
from ospace.simulation.certificate import balances

_MM, _DEG, _PERCENT, _MICRO = 1e3, 180.0 / math.pi, 100.0, 1e6
_Part = tuple[Floats, Mapping[str, Floats]]
"""Times (N,) and, by label, values (N,) of a part of a run."""


@dataclass(frozen=True, eq=False)
class Series(Result):
    """Curves over time that belong together.

    Attributes
    ----------
    name : str
        One of `TITLES`.
    title, unit : str
    time : (N,)
        s, over all segments of the run.
    values : (N, k)
        In `unit`; NaN where there is nothing to tell, as of a task that a phase does not have.
    labels : tuple of k str
    limits : tuple of float
        What the values should not pass.
    logarithmic : bool
        True where the values are shown by their decades.
    """

    name: str
    title: str
    unit: str
    time: Floats
    values: Floats
    labels: tuple[str, ...]
    limits: tuple[float, ...] = ()
    logarithmic: bool = False


def of(log: Log) -> dict[str, Series]:
    """Return the series that a log has, by name, in the order of `TITLES`."""
    found = {}
    for name, one in _SERIES.items():
        with np.errstate(invalid="ignore", over="ignore"):  # what cannot be computed of a wild run is left out
            time, values = _joined(list(one.parts(log)))
        if values and len(time):
            columns = np.column_stack(list(values.values()))
            labels = tuple(values)
            found[name] = Series(name, one.title, one.unit, time, columns, labels, one.limits(log), one.logarithmic)
    return found


def _joined(parts: Sequence[_Part]) -> _Part:
    """Put parts one after the other; NaN where one lacks a label that another has."""
    labels = dict.fromkeys(label for _, values in parts for label in values)
    time = np.concatenate([np.zeros(0), *(time for time, _ in parts)])
    # a segment may begin a rounding error before the one before it ends
    return np.maximum.accumulate(time), {
        label: np.concatenate([values.get(label, np.full(len(time), np.nan)) for time, values in parts])
        for label in labels
    }


# -- by control cycles -------------------------------------------------------------------------------------------


def _errors(of_task: Callable[[TaskErrors], Floats | None]) -> Callable[[Log], Iterator[_Part]]:
    """Return what tells of errors of some kind; `of_task` gives those of a task, if it has any."""

    def parts(log: Log) -> Iterator[_Part]:
        for phase in log.phases:
            of_tasks = ((task, of_task(errors)) for task, errors in phase.errors.items())
            yield phase.time, {task: values for task, values in of_tasks if values is not None}

    return parts


def _places(errors: TaskErrors) -> Floats | None:
    return errors.norms[:, 0] * _MM if errors.units[0] == "m" and _has(errors, 0) else None


def _angles(errors: TaskErrors) -> Floats | None:
    return errors.norms[:, 1] * _DEG if errors.points and _has(errors, 1) else None


def _joints(errors: TaskErrors) -> Floats | None:
    return errors.norms[:, 1] if errors.units[1] == "rad" and not errors.points and _has(errors, 1) else None


def _momenta(errors: TaskErrors) -> Floats | None:
    return errors.norms[:, 0] if errors.units[0] == "N s" and _has(errors, 0) else None


def _angular_momenta(errors: TaskErrors) -> Floats | None:
    return errors.norms[:, 1] if errors.units[1] == "N m s" and _has(errors, 1) else None


def _has(errors: TaskErrors, column: int) -> bool:
    """Return whether the task has linear rows (0), or angular ones or joints (1)."""
    return not np.isnan(errors.norms[:, column]).all()


def _orientation(log: Log) -> Iterator[_Part]:
    """Tell how far the base, and points that a task turns and does not move, are from where they were."""
    start: dict[str, Floats] = {}
    for phase in log.phases:
        if not len(phase.time):
            continue
        poses = _poses(phase, log)
        turned = [name for errors in phase.errors.values() if not _has(errors, 0) for name in errors.points]
        for name in (BASE, *turned):
            start.setdefault(name, poses[name][0, 3:])
        yield phase.time, {name: _turn(start[name], poses[name][:, 3:]) * _DEG for name in (BASE, *turned)}


def _path(log: Log) -> Iterator[_Part]:
    """Tell of points that a task moves."""
    for phase in log.phases:
        poses = _poses(phase, log)
        moved = [name for errors in phase.errors.values() if _has(errors, 0) for name in errors.points]
        yield phase.time, {f"{name} {axis}": poses[name][:, k] for name in moved for k, axis in enumerate("xyz")}


def _poses(phase: PhaseResult, log: Log) -> dict[str, Floats]:
    """Return the poses of the phase's points and of the base at its cycles (N, 7)."""
    run = log.segments[phase.segment].trajectory
    records = np.searchsorted(run.time, phase.time - 1e-9 * np.maximum(1.0, phase.time))
    return {BASE: run.q[np.minimum(records, len(run) - 1), :7], **phase.poses}


def _turn(start: Floats, now: Floats) -> Floats:
    """Return the angle between orientations, rad; quaternions x, y, z, w (4,), (N, 4)."""
    w = now @ start
    v = start[3] * now[:, :3] - now[:, 3:] * start[:3] - np.cross(start[:3], now[:, :3])
    angle: Floats = 2.0 * np.arctan2(np.linalg.norm(v, axis=1), np.abs(w))
    return angle


def _sigma_min(log: Log) -> Iterator[_Part]:
    return ((phase.time, phase.sigma_min) for phase in log.phases)


def _cycle_time(log: Log) -> Iterator[_Part]:
    return ((phase.time, {"cycle": phase.cycle_time * _MICRO}) for phase in log.phases)


def _clearance(log: Log) -> Iterator[_Part]:
    """Tell the smallest distance of links that keep a clearance."""
    for phase in log.phases:
        kept = phase.separation
        yield phase.time, {} if kept is None else {"nearest links": kept.distance * _MM}


def _kept(log: Log) -> tuple[float, ...]:
    return tuple({one.separation.clearance * _MM for one in log.phases if one.separation is not None})


# -- by records of the simulation --------------------------------------------------------------------------------


def _torque(log: Log) -> Iterator[_Part]:
    """Tell of joints that have a limit: percent of it."""
    for segment in log.segments:
        limits, torque = segment.torque_limits, segment.trajectory.torque
        limited = [j for j in range(len(limits)) if 0.0 < limits[j] < math.inf]
        yield segment.trajectory.time, {segment.joints[j]: torque[:, j] / limits[j] * _PERCENT for j in limited}


def _unlimited_torque(log: Log) -> Iterator[_Part]:
    for segment in log.segments:
        unlimited = [j for j, limit in enumerate(segment.torque_limits) if math.isinf(limit)]
        torque = segment.trajectory.torque
        yield segment.trajectory.time, {segment.joints[j]: torque[:, j] for j in unlimited}


def _balances(*names: str) -> Callable[[Log], Iterator[_Part]]:
    """Return what tells of quantities of the certificate."""

    def parts(log: Log) -> Iterator[_Part]:
        for segment in log.segments:
            run = segment.trajectory
            yield run.time, {one.name: one.error for one in balances(run) if one.name in names}

    return parts


def _limits(name: str) -> Callable[[Log], tuple[float, ...]]:
    """Return what tells the limit of a quantity of the certificate."""
    return lambda log: (log.certificate[name].limit,)


def _none(log: Log) -> tuple[float, ...]:
    return ()


# -- all of them -------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Kind:
    """Recipe of a series."""

    title: str
    unit: str
    parts: Callable[[Log], Iterator[_Part]]
    limits: Callable[[Log], tuple[float, ...]] = _none
    logarithmic: bool = False


_MOMENTUM, _ENERGY = ("linear momentum", "angular momentum"), "work and energy"
_SERIES = {
    "position-error": _Kind("Position errors of tasks", "mm", _errors(_places)),
    "angle-error": _Kind("Angle errors of tasks", "deg", _errors(_angles)),
    "joint-error": _Kind("Joint errors of postures", "rad", _errors(_joints)),
    "momentum-error": _Kind("Linear momentum errors of tasks", "N s", _errors(_momenta)),
    "angular-momentum-error": _Kind("Angular momentum errors of tasks", "N m s", _errors(_angular_momenta)),
    "orientation": _Kind("Orientation, turn since the start", "deg", _orientation),
    "path": _Kind("Position of points that tasks move", "m", _path),
    "torque": _Kind("Torque of joints, share of its limit", "%", _torque, lambda log: (-_PERCENT, _PERCENT)),
    "unlimited-torque": _Kind("Torque of joints that have no limit", "N m or N", _unlimited_torque),
    "momentum": _Kind(
        "Momentum not accounted for, over its scale", "", _balances(*_MOMENTUM), _limits(_MOMENTUM[0]), True
    ),
    "energy": _Kind("Energy not accounted for by work, over its scale", "", _balances(_ENERGY), _limits(_ENERGY), True),
    "sigma-min": _Kind("σ_min of each task's generalized Jacobian", "", _sigma_min),
    "clearance": _Kind("Smallest distance of links that keep a clearance", "mm", _clearance, _kept),
    "cycle-time": _Kind("Time that each control cycle took", "µs", _cycle_time, logarithmic=True),
}
TITLES = {name: one.title for name, one in _SERIES.items()}
"""By the names of all series, in their order."""

"""Files that hold a run: one ``.npz``, or a folder of CSV files.

The ``.npz`` holds each array of a `Log` under its own name, and under ``about`` a JSON text with all the rest of it,
where ``{"array": name}`` stands for an array.
"""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import ospace
from ospace.exceptions import OspaceError, printable
from ospace.files import replacing, write_text
from ospace.kernels.tree import Floats
from ospace.results import Result
from ospace.scenario import run_table
from ospace.scenario.result import BASE, PhaseResult, Run, Segment, Verdict, outcomes
from ospace.scenario.schema import TARGET
from ospace.simulation import Certificate, Excess, Trajectory
from ospace.simulation.certificate import LIMITS
from ospace.simulation.columns import Names, quoted
from ospace.stored import WRONG_KIND, arrays, fit, fit_times, made


@dataclass(frozen=True, eq=False)
class TargetMotion(Result):
    """A target that moves by itself.

    Attributes
    ----------
    name : str
        In the scenario.
    robot_name : str
    time : (M,)
        s.
    q, v : (M, nq), (M, nv)
        As of `SpaceRobot.state`.
    """

    name: str
    robot_name: str
    time: Floats
    q: Floats
    v: Floats


@dataclass(frozen=True, eq=False)
class LoggedSegment(Result):
    """Part of a run with one and the same robot.

    Attributes
    ----------
    joints : tuple of str
        Names of the joints, in the order of the torques.
    torque_limits : (n,)
        To either side, N m, or N for prismatic joints; infinity where the model has none, 0 for a joint without drive.
    trajectory : Trajectory
        Of the chaser, or of chaser and target combined; the base's pose is the first seven numbers of its q.
    targets : tuple of TargetMotion
        Those that move by themselves.
    """

    joints: tuple[str, ...]
    torque_limits: Floats
    trajectory: Trajectory
    targets: tuple[TargetMotion, ...]


@dataclass(frozen=True, eq=False)
class Log(Verdict):
    """All that a run leaves behind, without the robot and the controller that made it.

    Logs are equal if all that they hold is.

    Attributes
    ----------
    scenario : str
        The text of the scenario.
    name : str
        Its title.
    versions : mapping of str to str
        Of ospace, pin, numpy and python.
    segments : tuple of LoggedSegment
        From a grasp or release to the next.
    phases : tuple of PhaseResult
        Those that began.
    not_begun : tuple of str
        Names of the others.
    certificate : Certificate
        The worst of all segments, of the target by itself, and of grasps.
    exceeded : mapping of str to Excess
        As of `Run`.
    seconds : float
        Wall time.
    interrupted : bool
        Ctrl-C ended the run.
    """

    scenario: str
    name: str
    versions: Mapping[str, str]
    segments: tuple[LoggedSegment, ...]
    phases: tuple[PhaseResult, ...]
    not_begun: tuple[str, ...]
    certificate: Certificate
    exceeded: Mapping[str, Excess]
    seconds: float
    interrupted: bool

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Log):
            return NotImplemented
        ours, theirs = _content(self), _content(other)
        return ours.keys() == theirs.keys() and all(
            np.array_equal(ours[name], theirs[name], equal_nan=name != _ABOUT) for name in ours
        )

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"Log('{self.name}', {outcomes(self)})"


def of(run: Run) -> Log:
    """Return the log of a run.

    Parameters
    ----------
    run : Run

    Returns
    -------
    Log
    """
    return Log(
        scenario=run.scenario.source,
        name=run.scenario.name,
        versions={
            "ospace": ospace.__version__,
            "pin": pin.__version__,
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
        segments=tuple(_logged(segment, run) for segment in run.segments),
        phases=run.phases,
        not_begun=run.not_begun,
        certificate=run.certificate,
        exceeded=run.exceeded,
        seconds=run.seconds,
        interrupted=run.interrupted,
    )


def _logged(segment: Segment, run: Run) -> LoggedSegment:
    robot, actuated = segment.robot, run.scenario.robot
    limits = run.scenario.limits.of(robot, actuated).torque
    driven = [name in actuated.rate_names for name in robot.rate_names]
    targets = tuple(TargetMotion(one.name, one.robot.name, one.time, one.q, one.v) for one in segment.targets)
    return LoggedSegment(tuple(robot.rate_names), np.where(driven, limits, 0.0), segment.trajectory, targets)


# -- one file ----------------------------------------------------------------------------------------------------

_ABOUT = "about"
_LONGEST_NAME = 50
"""Letters; of four bytes each they still make a name that file systems take."""
_FORMAT = "ospace run 3"


def save(run: Run | Log, path: str | os.PathLike[str]) -> Path:
    """Write a run to a file, compressed, which appears when it is whole.

    Parameters
    ----------
    run : Run or Log
    path : path-like
        Its suffix is replaced with ``.npz``.

    Returns
    -------
    Path
        Of the file.
    """
    file = Path(path).with_suffix(".npz")
    with replacing(file) as part:
        np.savez_compressed(part, **_content(run if isinstance(run, Log) else of(run)))
    return file


def load(path: str | os.PathLike[str]) -> Log:
    """Read what `save` wrote.

    Parameters
    ----------
    path : path-like

    Returns
    -------
    Log

    Raises
    ------
    OspaceError
        The file cannot be read, or holds something else; an array that fits nothing is named.
    """
    stored = arrays(path, "run")
    try:
        about = json.loads(str(stored.pop(_ABOUT)))
        if about.pop("format") != _FORMAT:
            raise KeyError
        return _log(_unpacked(about, stored))
    except OspaceError as error:
        why = f": {error}"
    except (*WRONG_KIND, RecursionError):
        why = ""
    raise OspaceError(
        f"{printable(os.fspath(path))}{why}: holds no run of a scenario as ospace {ospace.__version__} writes it: "
        f"run the scenario again, with --log"
    )


def _content(log: Log) -> dict[str, Any]:
    """Return all that a log holds, by names in the file."""
    arrays: dict[str, Any] = {}
    about = {"format": _FORMAT} | _packed(log, "", arrays)
    return {_ABOUT: json.dumps(about, ensure_ascii=False)} | arrays


def _packed(value: Any, name: str, arrays: dict[str, Any]) -> Any:
    """Return what JSON can hold of `value`; put its arrays into `arrays`."""
    if isinstance(value, np.ndarray):
        while name in arrays:  # two names may differ in letters that a file's may not have
            name += "_"
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value):
        value = {one.name: getattr(value, one.name) for one in fields(value)}
    if isinstance(value, Mapping):
        return {key: _packed(one, f"{name}/{_safe(key)}".lstrip("/"), arrays) for key, one in value.items()}
    if isinstance(value, tuple):
        return [_packed(one, f"{name}/{k}", arrays) for k, one in enumerate(value)]
    return value


def _unpacked(value: Any, arrays: Mapping[str, Any]) -> Any:
    """Return dictionaries and tuples with their arrays."""
    if isinstance(value, list):
        return tuple(_unpacked(one, arrays) for one in value)
    if not isinstance(value, dict):
        return value
    if value.keys() == {"array"} and isinstance(value["array"], str):
        array = arrays[value["array"]]
        if array.dtype != np.float64:
            raise TypeError
        return array
    return {key: _unpacked(one, arrays) for key, one in value.items()}


def _log(known: dict[str, Any]) -> Log:
    """Make a log of what was read; raises where something is missing, unknown, or of a shape that fits nothing."""
    log: Log = made(Log, known)
    for k, segment in enumerate(log.segments):
        _fit_segment(f"segments/{k}", segment)
    for k, phase in enumerate(log.phases):
        _fit_phase(f"phases/{k}", phase)
        known_points = {BASE, *phase.poses}
        if not 0 <= phase.segment < len(log.segments) or not all(
            known_points >= {*errors.points} for errors in phase.errors.values()
        ):
            raise ValueError
    _sizes(*(log.certificate[name].limit for name in LIMITS if log.segments))
    _sizes(*(number for one in log.exceeded.values() for number in (one.amount, one.time)))
    return log


def _fit_segment(name: str, segment: LoggedSegment) -> None:
    run, joints = segment.trajectory, len(segment.joints)
    run.check_arrays(f"{name}/trajectory/")
    fit(f"{name}/trajectory/torque", run.torque, len(run), joints)
    fit(f"{name}/torque_limits", segment.torque_limits, joints)
    _sizes(*(number for one in run.outside_limits.values() for number in (one.amount, one.time)))
    for k, target in enumerate(segment.targets):
        length = fit_times(f"{name}/targets/{k}/time", target.time)
        fit(f"{name}/targets/{k}/q", target.q, length, None, least=7)
        fit(f"{name}/targets/{k}/v", target.v, length, None, least=6)


def _fit_phase(name: str, phase: PhaseResult) -> None:
    _sizes(phase.start, phase.end)
    cycles = fit_times(f"{name}/time", phase.time)
    fit(f"{name}/cycle_time", phase.cycle_time, cycles)
    fit(f"{name}/base_motion", phase.base_motion, cycles, 2)
    for task, errors in phase.errors.items():
        fit(f"{name}/errors/{task}/norms", errors.norms, cycles, 2)
    for task, values in phase.sigma_min.items():
        fit(f"{name}/sigma_min/{task}", values, cycles)
    for point, poses in phase.poses.items():
        fit(f"{name}/poses/{point}", poses, cycles, 7)
    if phase.separation is not None:
        fit(f"{name}/separation/distance", phase.separation.distance, cycles)
        _sizes(phase.separation.clearance, *map(abs, phase.separation.closest.values()))
    if phase.grasp is not None:
        fit(f"{name}/grasp/impulse", phase.grasp.impulse, 6)
        fit(f"{name}/grasp/velocity_error", phase.grasp.velocity_error, 6)


def _sizes(*values: float) -> None:
    """Raise where one is not finite, or negative."""
    if not all(0.0 <= value < math.inf for value in values):
        raise ValueError


# -- a folder ----------------------------------------------------------------------------------------------------


def to_csv(run: Run, folder: str | os.PathLike[str]) -> list[Path]:
    """Write a run to a folder: all in ``run.csv``; and by parts.

    These are ``phases.csv``, ``errors_<k>_<phase>.csv``, and a folder for each segment. Headings name joints and units.

    Parameters
    ----------
    run : Run
    folder : path-like
        Made where it is not there.

    Returns
    -------
    list of Path
        Of the files.
    """
    to = Path(folder)
    to.mkdir(parents=True, exist_ok=True)
    written = [run_table.write(run, to / "run.csv"), to / "phases.csv"]
    lines = ["phase,outcome,segment,start [s],end [s]"]
    lines += [f"{quoted(p.name)},{p.outcome},{p.segment},{p.start!r},{p.end!r}" for p in run.phases]
    write_text(written[1], "\n".join(lines) + "\n")
    for k, phase in enumerate(run.phases):
        heading, columns = ["time [s]"], [phase.time]
        for task, errors in phase.errors.items():
            for c, unit in enumerate(errors.units):
                if not np.isnan(errors.norms[:, c]).any():
                    heading.append(quoted(f"{task} [{unit}]"))
                    columns.append(errors.norms[:, c])
        heading += ["base shift [m]", "base turn [rad]"]
        columns += [*phase.base_motion.T]
        written.append(_table(to / f"errors_{k}_{_safe(phase.name)}.csv", heading, np.column_stack(columns)))
    for k, segment in enumerate(run.segments):
        own = to / f"segment_{k}"
        written += segment.trajectory.to_csv(own, segment.robot)
        for target in segment.targets:
            names = Names.of(target.robot)
            heading = ["time [s]", *map(quoted, [*names.q, *names.v])]
            file = own / ("target.csv" if target.name == TARGET else f"target_{_safe(target.name)}.csv")
            written.append(_table(file, heading, np.c_[target.time, target.q, target.v]))
    return written


def _table(file: Path, heading: list[str], values: Floats) -> Path:
    with replacing(file) as part:
        np.savetxt(part, values, fmt="%.17g", delimiter=",", header=",".join(heading), comments="", encoding="utf-8")
    return file


def _safe(text: str) -> str:
    """Return a name as files may have it, of which the first letters are enough."""
    return "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in text[:_LONGEST_NAME])

"""The report of a run: animation, curves on the same clock, verdict, scenario and versions, in one file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from ospace.kernels.tables import Floats
from ospace.robot import SpaceRobot
from ospace.scenario import log, series
from ospace.scenario.result import PhaseResult, Run
from ospace.visual import page, plots
from ospace.visual.scene import Scene

_SAME = 1e-9  # s: times that differ by rounding


@dataclass(frozen=True)
class WholeMotion:
    """A robot's motion over all segments of a run, by itself and grasped; attributes as of `Trajectory`."""

    time: Floats
    q: Floats
    v: Floats


def save(run: Run, path: str | PathLike[str]) -> Path:
    """Write the report of a run to one HTML file, which asks for nothing; return its path."""
    file = Path(path)
    file.write_text(render(run), encoding="utf-8")
    return file


def render(run: Run) -> str:
    """Return the report as a page.

    Raises
    ------
    OspaceError
        Matplotlib or meshcat is not installed; the run has not moved.
    """
    kept = log.of(run)
    scene = scene_of(run)
    content = scene.content()
    curves = series.of(kept)
    dark = content.background == "space"
    return page.render(
        page.Content(
            content.stage,
            kept.name,
            f"{content.heading}; {run.duration:g} s simulated in {run.seconds:.1f} s",
            content.background,
            content.layers,
            content.labels,
            content.notes,
        ),
        template="run.html",
        report_style=page.own_text("report.css"),
        report_script=page.own_text("report.js"),
        passed=run.passed,
        verdict="passed" if run.passed else "interrupted" if run.interrupted else "failed",
        summary=_summary(run),
        phases=[_phase(phase) for phase in run.phases],
        remarks=[*_remarks(run)],
        certificate=run.certificate.quantities,
        panels=[plots.svg(one, run.phases, dark=dark) for one in curves.values()],
        scenario_name=kept.name,
        scenario=kept.scenario,
        versions=kept.versions,
    )


def scene_of(run: Run) -> Scene:
    """Return the animated scene of a run: the robot, and the target if there is one, before and after a grasp."""
    robot, target = run.scenario.robot, run.scenario.target
    names = dict.fromkeys(name for phase in run.phases for errors in phase.errors.values() for name in errors.points)
    points = [robot.point(name) for name in names if name in robot.frame_names]
    scene = Scene(robot, points or None)
    motions = [motion_of(run, robot)]
    if target is not None:
        scene.add(target.robot)
        motions.append(motion_of(run, target.robot))
    scene.animate(*motions)
    return scene


def motion_of(run: Run, robot: SpaceRobot) -> WholeMotion:
    """Return the motion of the chaser or the target of a run over all its segments.

    Parameters
    ----------
    run : Run
    robot : SpaceRobot
        That of the scenario, or that of its target.
    """
    parts: list[tuple[Floats, Floats, Floats]] = []
    for segment in run.segments:
        trajectory = segment.trajectory
        if segment.held is not None:
            mine = int(robot is not run.scenario.robot)
            states = [segment.held.release(q, v)[mine] for q, v in zip(trajectory.q, trajectory.v, strict=True)]
            parts.append((trajectory.time, np.array([one.q for one in states]), np.array([one.v for one in states])))
        elif robot is run.scenario.robot:
            parts.append((trajectory.time, trajectory.q, trajectory.v))
        else:
            parts.append((segment.target_time, segment.target_q, segment.target_v))
    time = np.concatenate([one[0] for one in parts])
    later = np.r_[True, np.diff(np.maximum.accumulate(time)) > _SAME]  # a segment begins where the one before it ends
    q, v = (np.concatenate([one[k] for one in parts])[later] for k in (1, 2))
    return WholeMotion(time[later], q, v)


# -- what stands beside it ---------------------------------------------------------------------------------------


def _summary(run: Run) -> str:
    done = sum(phase.outcome == "complete" for phase in run.phases)
    kept = "passed" if run.certificate.passed else "failed"
    return f"{done} of {len(run.phases) + len(run.not_begun)} phases complete, certificate {kept}"


def _phase(phase: PhaseResult) -> dict[str, Any]:
    tasks = [
        {"name": name, "worst": errors.in_words(errors.worst), "last": errors.in_words(errors.last)}
        for name, errors in phase.errors.items()
    ]
    return {
        "name": phase.name,
        "start": phase.start,
        "end": phase.end,
        "outcome": phase.outcome,
        "tasks": tasks or [{"name": "-", "worst": "-", "last": "-"}],
        "cycles": ", ".join(f"{count} {status}" for status, count in phase.statuses.items()) or "none",
    }


def _remarks(run: Run) -> Iterator[str]:
    for phase in run.phases:
        yield from (f"{phase.name}: {line}" for line in phase.remarks())
    if run.not_begun:
        yield f"not begun: {', '.join(run.not_begun)}"
    exceeded = ", ".join(f"{limit} by {excess:.2g}" for limit, excess in run.exceeded.items())
    yield f"limits of joints exceeded: {exceeded or 'none'}"

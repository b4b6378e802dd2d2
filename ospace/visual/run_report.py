"""The report of a run: animation, curves on the same clock, verdict, scenario and versions, in one file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.files import replacing
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.scenario import Run, Scenario, log, series, summary_text
from ospace.visual import page, plots
from ospace.visual.scene import Records, Scene

_SAME = 1e-9  # s: times that differ by rounding


def save(run: Run, path: str | PathLike[str]) -> Path:
    """Write the report of a run to one HTML file, which needs no network; return its path."""
    text = render(run)
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")
    return Path(path)


def render(run: Run) -> str:
    """Return the report as a page.

    Raises
    ------
    OspaceError
        Matplotlib or meshcat is not installed; the run has not moved.
    """
    kept = log.of(run)
    scene = scene_of(run.scenario)
    animate(scene, run)
    content = scene.content()
    curves = series.of(kept)
    dark = content.background == "space"
    took = f"{run.duration:g} s simulated in {run.seconds:.1f} s"
    return page.render(
        replace(content, title=kept.name, heading=f"{content.heading}; {took}"),
        template="run.html",
        report_style=page.own_text("report.css"),
        report_script=page.own_text("report.js"),
        summary_text=summary_text,
        run=run,
        remarks=list(_remarks(run)),
        panels=[plots.svg(one, run.phases, dark=dark) for one in curves.values()],
        log=kept,
        versions=kept.versions,
    )


def scene_of(scenario: Scenario) -> Scene:
    """Return the scene of a scenario at its start: the robot with the points of its tasks, and the target."""
    robot, target = scenario.robot, scenario.target_robot
    tasks = [task for phase in scenario.phases for task in phase.tasks]
    points: list[OperationalPoint] = []
    for task in tasks:
        if task.frames.get("point") in robot.frame_names:
            point = task.point_of(robot)
            if point is not None and not any(
                point.frame == one.frame and point.placement == one.placement for one in points
            ):
                points.append(point)
    scene = Scene(robot, points or None)
    if target is not None:
        scene.add(target)
    scene.display(scenario.start.q, scenario.start.v, [] if scenario.target is None else [scenario.target.q])
    return scene


def animate(scene: Scene, run: Run) -> None:
    """Show a run in the scene of its scenario; quantities are those of each segment's robot."""
    segments = [(segment.robot, segment.trajectory) for segment in run.segments]
    scene.animate(*motions_of(run), segments=segments)


def motions_of(run: Run) -> tuple[Records, ...]:
    """Return the motion of the chaser, and of the target if there is one, each over all segments of a run.

    A target that has one record, of a run that ended within its first control cycle, goes on as it moved then.

    Raises
    ------
    OspaceError
        Nothing has moved: the run ended before its first step.
    """
    parts: list[list[tuple[Floats, Floats, Floats]]] = [[], []]
    for segment in run.segments:
        trajectory = segment.trajectory
        if segment.held is not None:
            states = [segment.held.release(q, v) for q, v in zip(trajectory.q, trajectory.v, strict=True)]
            for one, mine in zip(parts, zip(*states, strict=True), strict=True):
                one.append((trajectory.time, np.array([own.q for own in mine]), np.array([own.v for own in mine])))
            continue
        parts[0].append((trajectory.time, trajectory.q, trajectory.v))
        if segment.target is not None:
            parts[1].append((segment.target_time, segment.target_q, segment.target_v))
    motions = [_joined(one) for one in parts if one]
    if not motions or len(motions[0].time) < 2:
        raise OspaceError("the run ended before its first step: nothing has moved")
    scenario, time = run.scenario, motions[0].time
    robots = [scenario.robot] if scenario.target_robot is None else [scenario.robot, scenario.target_robot]
    return tuple(_going_on(one, robot, time) for one, robot in zip(motions, robots, strict=True))


def _going_on(motion: Records, robot: SpaceRobot, time: Floats) -> Records:
    if len(motion.time) > 1:
        return motion
    (q,), (v,) = motion.q, motion.v
    later = np.asarray(pin.integrate(robot.model, q, (time[-1] - time[0]) * v))
    return Records(time[[0, -1]], np.array([q, later]), np.array([v, v]))


def _joined(parts: Sequence[tuple[Floats, Floats, Floats]]) -> Records:
    time, q, v = (np.concatenate([one[k] for one in parts]) for k in range(3))
    later = np.r_[True, np.diff(np.maximum.accumulate(time)) > _SAME]  # a segment begins where the one before it ends
    return Records(time[later], q[later], v[later])


# -- what stands beside it ---------------------------------------------------------------------------------------


def _remarks(run: Run) -> Iterator[str]:
    yield from summary_text.conditions(run.scenario)
    for phase in run.phases:
        if phase.reason:
            yield f"{phase.name}: {phase.reason}"
        yield from summary_text.remarks(phase)
    if run.not_begun:
        yield f"not begun: {', '.join(run.not_begun)}"
    yield f"limits of joints exceeded: {summary_text.exceeded(run.exceeded)}"

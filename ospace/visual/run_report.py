"""The report of a run: animation, curves on the same clock, verdict, scenario and versions, in one file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError, printable
from ospace.files import write_text
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario import Run, Scenario, log, series, summary_text
from ospace.scenario.holds import parts
from ospace.visual import joint_limits, page, plots
from ospace.visual.environment import Background
from ospace.visual.provenance import Provenance
from ospace.visual.scene import Records, Scene

_SAME = 1e-9  # s: times that differ by rounding


def save(run: Run, path: str | PathLike[str], about: Provenance | None = None) -> Path:
    """Write the report of a run to one HTML file, which needs no network; return its path."""
    text = render(run, about)
    return write_text(path, text)


def render(run: Run, about: Provenance | None = None, background: Background = "space") -> str:
    """Return the report as a page; for paper with `background` "paper".

    Raises
    ------
    OspaceError
        Matplotlib or meshcat is not installed; the run has not moved.
    """
    kept = log.of(run)
    scene = scene_of(run.scenario, background)
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
        about=about,
        printable=printable,
        limits=joint_limits.of_run(run),
        summary_text=summary_text,
        run=run,
        remarks=list(_remarks(run)),
        panels=[plots.svg(one, run.phases, dark=dark) for one in curves.values()],
        log=kept,
        versions=kept.versions,
    )


def scene_of(scenario: Scenario, background: Background = "space") -> Scene:
    """Return the scene of a scenario at its start: the robot with the points of its tasks, and the targets."""
    robot = scenario.robot
    tasks = [task for phase in scenario.phases for task in phase.tasks]
    points: list[OperationalPoint] = []
    for task in tasks:
        if task.frames.get("point") in robot.frame_names:
            point = task.point_of(robot)
            if point is not None and not any(
                point.frame == one.frame and point.placement == one.placement for one in points
            ):
                points.append(point)
    scene = Scene(robot, points or None, background=background)
    for target in scenario.targets.values():
        scene.add(target.robot)
    scene.display(scenario.start.q, scenario.start.v, [target.start.q for target in scenario.targets.values()])
    return scene


def animate(scene: Scene, run: Run) -> None:
    """Show a run in the scene of its scenario; quantities are those of each segment's robot."""
    segments = [(segment.robot, segment.trajectory) for segment in run.segments]
    scene.animate(*motions_of(run), segments=segments)


def motions_of(run: Run) -> tuple[Records, ...]:
    """Return the motion of the chaser, and of each target, over all segments of a run.

    A target that has one record, of a run that ended within its first control cycle, goes on as it moved then.

    Raises
    ------
    OspaceError
        Nothing has moved: the run ended before its first step.
    """
    scenario = run.scenario
    chaser: list[tuple[Floats, Floats, Floats]] = []
    targets: dict[str, list[tuple[Floats, Floats, Floats]]] = {name: [] for name in scenario.targets}
    for segment in run.segments:
        trajectory = segment.trajectory
        if segment.holds:
            states = [parts(segment.holds, q, v) for q, v in zip(trajectory.q, trajectory.v, strict=True)]
            chaser.append(_records(trajectory.time, [own for own, _ in states]))
            for hold in segment.holds:
                targets[hold.target].append(_records(trajectory.time, [held[hold.target] for _, held in states]))
        else:
            chaser.append((trajectory.time, trajectory.q, trajectory.v))
        for target in segment.targets:
            targets[target.name].append((target.time, target.q, target.v))
    motions = [_joined(one) for one in (chaser, *targets.values()) if one]
    if not motions or len(motions[0].time) < 2:
        raise OspaceError("the run ended before its first step: nothing has moved")
    time = motions[0].time
    robots = [scenario.robot, *(target.robot for target in scenario.targets.values())]
    return tuple(_going_on(one, robot, time) for one, robot in zip(motions, robots, strict=True))


def _records(time: Floats, states: Sequence[State]) -> tuple[Floats, Floats, Floats]:
    return time, np.array([state.q for state in states]), np.array([state.v for state in states])


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

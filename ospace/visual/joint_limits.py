"""Joints and their limits, as a table of a report: what the model allows, and how near a run came."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ospace.model.joint_positions import BoundedCoordinates, unit_of
from ospace.model.robot import SpaceRobot
from ospace.scenario import Run
from ospace.urdf.description import Description

_UNITS = {"rad": ("rad", "rad/s", "N m"), "m": ("m", "m/s", "N")}


class Row(NamedTuple):
    """A limit of a joint; texts, empty where there is no such thing.

    Attributes
    ----------
    joint, kind, unit : str
    lower, upper : str
        Limits.
    least, most : str
        Extremes of a run.
    margin : str
        What is left to the nearer limit, in percent of the range; negative beyond it.
    """

    joint: str
    kind: str
    unit: str
    lower: str
    upper: str
    least: str = ""
    most: str = ""
    margin: str = ""


def of_description(robot: Description) -> list[Row]:
    """Return the limits of all joints that move, as their file has them."""
    rows = []
    for joint in robot.joints:
        if joint.kind in ("fixed", "floating", "planar"):
            continue
        limit = joint.limit
        position, rate, force = _UNITS["m" if joint.kind == "prismatic" else "rad"]
        lower, upper = (-math.inf, math.inf) if limit is None else (limit.lower, limit.upper)
        velocity, effort = (math.inf, math.inf) if limit is None else (limit.velocity, limit.effort)
        rows += [
            Row(joint.name, "position", position, _number(lower), _number(upper)),
            Row(joint.name, "velocity", rate, _number(-velocity), _number(velocity)),
            Row(joint.name, "torque" if position == "rad" else "force", force, _number(-effort), _number(effort)),
        ]
    return rows


def of_run(run: Run) -> list[Row]:
    """Return the limits of the chaser's joints as the model has them, beside the extremes of a run."""
    robot = run.scenario.robot
    rows: list[Row] = []
    for name in robot.joint_names:
        j = robot.joint_number(name)
        if robot.model.nvs[j] == 1:
            rows += _rows(run, robot, name, j)
    return rows


def _rows(run: Run, robot: SpaceRobot, name: str, j: int) -> list[Row]:
    model, k = robot.model, int(robot.model.idx_vs[j])
    position, rate, force = _UNITS[unit_of(model.joints[j])]
    bounded = BoundedCoordinates.of(model)
    lower, upper = -math.inf, math.inf
    places = np.flatnonzero(bounded.joint == j)
    if len(places):
        lower, upper = (float(side[places[0]]) for side in bounded.limits(model))
    positions, rates, torques = [], [], []
    for segment in run.segments:  # a combined robot has the chaser's joints by the same names
        own = segment.robot.joint_number(name)
        first = int(segment.robot.model.idx_vs[own]) - 6
        if model.nqs[j] == 1:
            positions.append(segment.trajectory.q[:, int(segment.robot.model.idx_qs[own])])
        rates.append(segment.trajectory.v[:, 6 + first])
        torques.append(segment.trajectory.torque[:, first])
    velocity, effort = float(model.velocityLimit[k]), float(model.effortLimit[k])
    kind = "torque" if position == "rad" else "force"
    return [
        _row(name, "position", position, lower, upper, positions),
        _row(name, "velocity", rate, -velocity, velocity, rates),
        _row(name, kind, force, -effort, effort, torques),
    ]


def _row(name: str, kind: str, unit: str, lower: float, upper: float, parts: list[np.ndarray]) -> Row:
    values = np.concatenate(parts) if parts else np.zeros(0)
    if not len(values):
        return Row(name, kind, unit, _number(lower), _number(upper))
    least, most = float(values.min()), float(values.max())
    span = upper - lower
    margin = 100.0 * min(least - lower, upper - most) / span if math.isfinite(span) and span > 0.0 else math.nan
    shown = "" if math.isnan(margin) else f"{margin:.1f} %"
    return Row(name, kind, unit, _number(lower), _number(upper), f"{least:.4g}", f"{most:.4g}", shown)


def _number(value: float) -> str:
    return "none" if not math.isfinite(value) or abs(value) >= 1e9 else f"{value:.4g}"

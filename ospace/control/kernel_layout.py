"""Tasks, actuation and limits of a controller as the kernels take them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ospace.control.base import Base
from ospace.control.limits import JointLimits, bounded
from ospace.control.tasks import Task
from ospace.exceptions import OspaceError
from ospace.kernels.qp import tables as qp
from ospace.kernels.tasks.tables import (
    CENTRE_OF_MASS,
    CUSTOM,
    DAMPING,
    LOOK_AT,
    MOMENTUM,
    MOTION,
    POSTURE,
    REFERENCE,
    RELATIVE,
    ZERO_REACTION,
    BaseActuation,
    TaskRows,
    Tasks,
)
from ospace.kernels.tree import UNKNOWN, Floats, Nodes
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot

_POINTS = {MOTION: 1, RELATIVE: 2, LOOK_AT: 1, CUSTOM: None} | dict.fromkeys(
    (CENTRE_OF_MASS, MOMENTUM, POSTURE, DAMPING, ZERO_REACTION), 0
)
"""How many points the kernel of each kind of task takes; None for any number."""


def task_tables(robot: SpaceRobot, tasks: Sequence[Task], points: Sequence[OperationalPoint], nodes: Nodes) -> Tasks:
    """Lay out tasks; references and postures come with the first cycle.

    Parameters
    ----------
    points : sequence of OperationalPoint
        The base, then those of each task in turn.
    nodes : Nodes
        The same as the evaluator lays them out.

    Raises
    ------
    OspaceError
        The kernels cannot place a joint of the robot.
    """
    if not robot.own_kinematics:
        unknown = robot.joint_of_link(int(np.flatnonzero(robot.links.kind == UNKNOWN)[0]))
        raise OspaceError(f"joint '{unknown}' is of a type that the controller does not know how to place")
    rows = [checked_rows(robot, task) for task in tasks]
    point, at = np.full((len(tasks), 2), -1, dtype=np.int64), 1
    for t, task in enumerate(tasks):
        count = len(task.points)
        if task.kind != CUSTOM:
            point[t, :count] = range(at, at + count)
        at += count
    turn = [(robot.link_axes[one.joint].T @ one.placement.rotation).ravel(order="F") for one in points]
    return Tasks(
        np.array([task.kind for task in tasks]),
        np.array([task.geometric for task in tasks], dtype=np.int64),
        point,
        np.concatenate([[0], np.cumsum([len(own) for own in rows])]),
        np.concatenate(rows).astype(np.int64),
        np.array([task.own_axes for task in tasks], dtype=np.int64),
        np.array([task.gain * 2 for task in tasks], dtype=np.float64),
        np.array([task.direction for task in tasks], dtype=np.float64),
        np.zeros((len(tasks), REFERENCE)),
        np.zeros((len(tasks), robot.nq)),
        np.array([int(np.flatnonzero(nodes.point == e)[0]) for e in range(len(points))]),
        np.array(turn),
    )


def checked_rows(robot: SpaceRobot, task: Task) -> list[int]:
    """Return which components or joint rates the rows of a task are; raise where its kernel has none of these."""
    kind, made = getattr(task, "kind", None), f"task '{task.name}' of class {type(task).__name__}"
    if kind not in _POINTS:
        raise OspaceError(
            f"{made} is of kind {kind!r}, which no kernel writes the rows of: a task in Python is a subclass of "
            f"CustomTask, with error and jacobian, or of RowsTask"
        )
    rows, joints = task.rows(robot), kind in (POSTURE, DAMPING)
    count = robot.n_joints if joints else 6
    if not all(isinstance(row, int) and 0 <= row < count for row in rows):
        raise OspaceError(f"{made} has rows {rows}: give {'joint rates' if joints else 'components'} 0 to {count - 1}")
    if _POINTS[kind] not in (None, len(task.points)):
        raise OspaceError(f"{made} is about {len(task.points)} points: its kernel takes {_POINTS[kind]}")
    return rows


def base_actuation(robot: SpaceRobot, base: Base) -> BaseActuation:
    """Lay out the actuated components of the wrench, scaled to accelerations of the base: of mass and mean inertia."""
    component = np.flatnonzero(base.limits > 0.0)
    moment = np.trace(robot.model.inertias[1].inertia) / 3.0
    scale = np.where(component < 3, robot.total_mass, moment)
    return BaseActuation(component, scale, np.zeros((len(component), 6)))


def limit_tables(
    limits: JointLimits, largest: Floats, period: float, horizon: float, braking: float
) -> qp.ProgramLimits:
    """Lay out limits of joints, and of the scaled base wrench: `largest` (k,) to either side."""
    return qp.ProgramLimits(
        bounded(np.array([0.0 - limits.torque, limits.torque])),
        bounded(np.array([limits.lower, limits.upper])),
        bounded(limits.velocity),
        bounded(limits.acceleration),
        bounded(np.array([-largest, largest])),
        period,
        horizon,
        braking,
    )


def empty_program(n: int, k: int, rows: int, g: int, allowed: Floats) -> tuple[TaskRows, qp.Program, qp.Answer]:
    """Return tables: `rows` of tasks, the program of n joints, k base components and g inequalities, the answer.

    `allowed` (T, 2) is by how much tasks may be short of their references.
    """
    size = n + k
    bounds = np.zeros((2, size + n + g))
    bounds[0, size + n :], bounds[1, size + n :] = -qp.UNLIMITED, qp.UNLIMITED
    b, error, equivalent_error = np.zeros((3, rows))
    task_rows = TaskRows(np.zeros((rows, size)), b, error, equivalent_error, np.zeros((size, 6)))
    cause = np.zeros((2, n), dtype=np.int64)
    program = qp.Program(np.zeros((size, size)), np.zeros(size), np.zeros((n + g, size)), bounds[0], bounds[1], cause)
    answer = qp.Answer(np.zeros(n), np.zeros((1, 6)), np.zeros(rows), np.zeros_like(allowed), allowed)
    return task_rows, program, answer

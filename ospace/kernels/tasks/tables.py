"""The tables of all tasks of a controller."""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.tree import Floats, Ints

MOTION, RELATIVE, LOOK_AT, CENTRE_OF_MASS, MOMENTUM, POSTURE, DAMPING, CUSTOM, ZERO_REACTION = range(9)
"""Kinds of tasks: which kernel writes their rows; those of `CUSTOM` ones are there before."""

# Columns of a reference: start and duration of a minimum-jerk motion, position, displacement, rotation by columns, its
# rotation vector, and velocity and acceleration on top.
START, DURATION, POSITION, DISPLACEMENT, ROTATION, ROTATION_VECTOR, VELOCITY, ACCELERATION, REFERENCE = (
    0, 1, 2, 5, 8, 17, 20, 26, 32
)  # fmt: skip


class Tasks(NamedTuple):
    """The tasks."""

    kind: Ints
    geometric: Ints
    """(T,) 1 for tasks about the motion of points, whose rows are those of a Jacobian."""
    point: Ints
    """(T, 2) points, of those of the evaluation."""
    first: Ints
    """(T + 1,) where the rows of each task begin."""
    rows: Ints
    """(m,) which of the six components, or which joint, each row is."""
    own_axes: Ints
    """(T,) 1 for tasks that move a point along and about its own axes."""
    gain: Floats
    """(T, 4) stiffness and damping, linear, then angular."""
    axis: Floats
    """(T, 3) in the point's axes."""
    reference: Floats
    """(T, REFERENCE)."""
    posture: Floats
    """(T, nq) positions of the joints as in q."""
    node: Ints
    """(p,) node of each point."""
    turn: Floats
    """(p, 9) rotation of each point in its link's axes, by columns."""


class BaseActuation(NamedTuple):
    """Actuated components of the base wrench."""

    component: Ints
    """(k,) components of the wrench, base axes, at the base."""
    scale: Floats
    """(k,) N or N m per unit of û."""
    response: Floats
    """(k, 6) work: ẍ_b per unit of û."""


class TaskRows(NamedTuple):
    """Demands of the tasks, row by row: A z = b."""

    A: Floats
    b: Floats
    error: Floats
    equivalent_error: Floats
    """(m,) e + ė d/k of tasks about points: the error that a spring alone would answer as spring and damper do."""
    block: Floats
    """(n + k, 6) work: columns of one task."""

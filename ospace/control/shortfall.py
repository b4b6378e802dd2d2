"""Reasons for a task that falls short of its reference: out of reach, held back by limits or other tasks, on its way.

With r = A z − b the residual of a task's rows, −Aᵀ r is how it pulls at joints and base, and ā |r| about as much as it
can, ā² = |A|² / rows. What stands against the pull tells why the task falls short:

    |Aᵀ r| < 0.1 ā |r|                   no motion of the joints, nor of the base's actuation, would help: out of reach
                                         where its error is as large, else at a dynamic singularity
    −Aᵀ r = Gᵀ λ but for half of it      the limits that bind hold it, G their rows
    |ê| > δ ā / 3                        its joints are damped, since it asks for more motion than the trust radius
    else                                 other tasks
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from ospace.kernels.tree import Floats, Ints

Reason = Literal[
    "out of reach", "near a dynamic singularity", "held back by limits", "on its way", "held back by other tasks"
]
_NO_PULL, _AWAY, _HELD, _BLAMED = 0.1, 0.5, 0.5, 0.2
_DAMPED = 1.0 / 3.0
_CLEAR = 1e-9


@dataclass(frozen=True)
class Shortfall:
    """By how much a task falls short of its reference, and why.

    Attributes
    ----------
    task : str
    reason : Reason
        "out of reach", "near a dynamic singularity", "held back by limits", "on its way" or "held back by other tasks".
    distance, angle : float
        By how much position and orientation would rest short of the reference, m and rad; zero without such rows.
    direction : (3,)
        Unit vector, in inertial axes or, with `own_axes`, in those of the task's point: along which the position is
        short, or about which the orientation is if it is the shorter of the two, relative to what is allowed; zero
        for a task in Python.
    limits : tuple of str
        What holds it back, as in `Command.active_limits`, the strongest first.
    turning : bool
        Whether `direction` is an axis to turn about.
    unit : str
        Of `distance`: m, or that of a task in Python.
    own_axes : bool
        Whether the task's rows are along the axes of its point.
    """

    task: str
    reason: Reason
    distance: float
    angle: float
    direction: Floats
    limits: tuple[str, ...] = ()
    turning: bool = False
    unit: str = "m"
    own_axes: bool = False

    @property
    def cause(self) -> str:
        """The reason, the strongest limit and the task, as ``'held back by limits of j_upper (torque): hand'``."""
        held = f" of {_named(self.limits[0])}" if self.limits else ""
        return f"{self.reason}{held}: {self.task}"

    @property
    def size(self) -> str:
        """By how much it is short, as ``'0.56 m short along (0.93, 0, 0.37)'``."""
        short = f"{math.degrees(self.angle):.2g} deg" if self.turning else f"{self.distance:.2g} {self.unit}"
        if not self.direction.any():
            return f"{short} short"
        axes = " of its own axes" if self.own_axes else ""
        return f"{short} short {'about' if self.turning else 'along'} {shown(self.direction)}{axes}"

    def __str__(self) -> str:
        return f"{self.cause}, {self.size}"


def shown(direction: Floats) -> str:
    """Return a unit vector to two digits."""
    return "(" + ", ".join(f"{round(float(x), 2) + 0.0:g}" for x in direction) + ")"


def _named(limit: str) -> str:
    """Return ``'j_upper (torque)'`` for ``'j_upper: torque, upper'``."""
    what, _, kind = limit.rpartition(", ")[0].partition(": ")
    return f"{what} ({kind})" if kind else what


class TaskResidual(NamedTuple):
    """The rows of one task and what is left of them."""

    A: Floats
    """(r, n + k)."""
    error: Floats
    """(r,)."""
    equivalent_error: Floats
    """(r,) ê, as in `ospace.kernels.qp.program`."""
    residual: Floats
    """(r,) A z − b."""
    components: Ints
    """(r,) which of six each row is."""


def shortfall(
    task: str,
    rows: TaskResidual,
    short: Floats,
    allowed: Floats,
    binding: tuple[Floats, tuple[str, ...]],
    trust_radius: float,
    unit: str = "",
) -> Shortfall:
    """Return why a task falls short.

    Parameters
    ----------
    short, allowed : (2,)
        By how much its position and orientation are short, and may be; m, rad.
    binding : (b, n + k) and b names
        Rows of the limits that bind.
    trust_radius : float
        As of the controller.
    unit : str
        Of a task in Python, whose rows are along no axes; empty for others.
    """
    A, error, equivalent, residual, components = rows
    mean, size = float(np.linalg.norm(A)) / math.sqrt(len(A)), float(np.linalg.norm(residual))
    turning = bool(short[1] / allowed[1] > short[0] / allowed[0])
    missing = np.zeros(3)
    for row, component in enumerate(components.tolist()):
        if (component >= 3) == turning:
            missing[component % 3] = -residual[row]
    direction, away = missing / max(float(np.linalg.norm(missing)), 1e-300), 0.0
    for row, component in enumerate(components.tolist()):
        if (component >= 3) == turning:
            away += error[row] * direction[component % 3]
    if unit:
        direction, away = np.zeros(3), float(np.linalg.norm(error))
    own = (float(short[0]), float(short[1]), direction)
    pull = -A.T @ residual
    if np.linalg.norm(pull) < _NO_PULL * mean * size:
        lost = away > _AWAY * short[int(turning)]
        return Shortfall(
            task, "out of reach" if lost else "near a dynamic singularity", *own, turning=turning, unit=unit or "m"
        )
    G, names = binding
    if len(names):
        force = np.linalg.lstsq(G.T, pull, rcond=None)[0][:, None] * G
        if np.linalg.norm(pull - force.sum(axis=0)) < _HELD * np.linalg.norm(pull):
            strength = np.linalg.norm(force, axis=1)
            order = [k for k in np.argsort(-strength) if strength[k] > _BLAMED * strength.max() + _CLEAR]
            held = tuple(dict.fromkeys(names[k] for k in order))
            return Shortfall(task, "held back by limits", *own, held, turning, unit or "m")
    damped = float(np.linalg.norm(equivalent)) > _DAMPED * trust_radius * mean
    return Shortfall(
        task, "on its way" if damped else "held back by other tasks", *own, turning=turning, unit=unit or "m"
    )

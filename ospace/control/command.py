"""Command of a controller, and the reasons for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np

from ospace.control.clearance import Nearest
from ospace.control.shortfall import Shortfall, TaskResidual, shortfall, shown
from ospace.kernels.tree import Floats, Ints
from ospace.model.joint_positions import with_units
from ospace.results import Result

Status = Literal["nominal", "falling short", "softened", "outside limits", "degraded", "stopped"]
_CAUSES = ("position", "velocity", "acceleration")
_ON = 1e-6  # how near a bound, relative to its size and at least to 1, counts as on it


@dataclass(frozen=True)
class CommandLayout:
    """Names behind the numbers of a command; the same for all commands of a controller."""

    joints: Sequence[str]
    units: Mapping[str, str]
    """Of positions and of the values of inequalities, by name: rad, m, or what these have."""
    components: Sequence[str]
    """Of the wrench on the base that are actuated."""
    inequalities: Sequence[str]
    """Names of their rows."""
    largest: Floats
    """Limits of these, as the program has them; wheels near their momentum are bounded more narrowly."""
    tasks: Sequence[str]
    first: Sequence[int]
    """(T + 1,) where the rows of each task begin."""
    geometric: Ints
    """Rows of tasks about points: those of the generalized Jacobian."""
    singular: float
    trust_radius: float
    components_of_rows: Ints
    """(m,) which of six components, or which joint, each row is."""
    task_units: Sequence[str]
    """Of the errors of tasks in Python; empty for others."""
    own_axes: Sequence[bool]
    """Of each task, whether its rows are along the axes of its point."""
    allowed: Floats
    """(T, 2) by how much the linear and angular rows of a task may be short."""


@dataclass(frozen=True)
class Timing:
    """Times of the parts of a cycle, s."""

    dynamics: float
    assembly: float
    solution: float
    total: float


@dataclass(frozen=True)
class Command(Result):
    """Command of a control cycle.

    Attributes
    ----------
    time : float
        s.
    torque : (n,)
        Of the joints; N m, or N.
    base_wrench : (6,)
        Of thrusters on the base, inertial axes, at the base-link frame's origin; N, N m.
    wheel_torque : (3,)
        Of reaction wheels on the base, inertial axes, for their own turning with it included; N m.
    joint_acceleration : (n,)
        rad/s², m/s².
    base_acceleration : (6,)
        ẍ_b, inertial axes, at the base-link frame's origin; m/s², rad/s².
    status : "nominal", "falling short", "softened", "outside limits", "degraded" or "stopped"
        The last of these that holds: all limits are kept, and every task about points or axes follows its reference
        within the bounds of its completion test, or 1 cm and 1 deg; a task does not, as `shortfalls` tells; motion
        limits and inequalities had to give way to torque limits; a joint is outside its position limits, or the value
        of an inequality below 0; no solution was found for tasks of a level; nothing could be solved and the joints are
        braked.
    softened : dict of name to float
        By how much a joint's acceleration passes the bounds that its motion limits set, rad/s² or m/s²; or a row of an
        inequality its bound.
    dropped : dict of level to tuple of str
        Levels without a solution, None for the tasks without a level, and the names of their tasks, which are undone.
    outside : dict of name to float
        By how much a joint is outside its position limits, rad or m; or the value of an inequality below 0.
    timing : Timing
    nearest : Nearest, optional
        The smallest distance of links that a `Clearance` keeps apart, and which they are.
    """

    time: float
    torque: Floats
    base_wrench: Floats
    wheel_torque: Floats
    joint_acceleration: Floats
    base_acceleration: Floats
    status: Status
    softened: dict[str, float]
    dropped: dict[int | None, tuple[str, ...]]
    outside: dict[str, float]
    timing: Timing
    _layout: CommandLayout = field(repr=False)
    _bounds: tuple[Floats, Floats, Floats, Ints] = field(repr=False)
    """Lower, upper, what they bound, and causes."""
    _rows: tuple[Floats, Floats, Floats, Floats, Floats] = field(repr=False)
    """A, errors, residuals, independence, equivalent errors."""
    _short: tuple[Floats, Floats] | None = field(repr=False, default=None)
    """By how much tasks are short (T, 2), and C, where one is by more than it may."""
    nearest: Nearest | None = None

    @cached_property
    def active_limits(self) -> tuple[str, ...]:
        """Limits that bind, as ``'right_arm_4: torque, upper'`` or ``'base force x, lower'``.

        Wheels that hold all they can are ``'base torque z: wheel momentum, upper'``.
        """
        return tuple(dict.fromkeys(name for _, name in self._binding))

    @cached_property
    def _binding(self) -> list[tuple[int, str]]:
        """Limits that bind: which of [z; C z] each bounds, and its name."""
        lower, upper, value, cause = self._bounds
        joints, components = self._layout.joints, self._layout.components
        n, m = len(joints), len(components)
        found = []
        for side, bound, sign in (("lower", lower, -1.0), ("upper", upper, 1.0)):
            on = sign * (value - bound) > -_ON * np.maximum(1.0, np.abs(bound))
            for i in map(int, np.flatnonzero(on)):
                if n + m <= i < n + m + n and lower[i] == upper[i]:
                    continue  # a joint without a drive
                if i >= n + m + n:
                    what = self._layout.inequalities[i - n - m - n]
                elif i < n:
                    what = f"{joints[i]}: {_CAUSES[cause[0 if side == 'lower' else 1, i]]}"
                elif i >= n + m:
                    what = f"{joints[i - n - m]}: torque"
                else:
                    narrow = abs(bound[i]) < (1.0 - _ON) * self._layout.largest[i - n]
                    what = f"base {components[i - n]}" + (": wheel momentum" if narrow else "")
                found.append((i, f"{what}, {side}"))
        return found

    @cached_property
    def shortfalls(self) -> tuple[Shortfall, ...]:
        """Tasks about points or axes that fall short of their references, by how much, and why.

        A residual A z − b that lasts is an error that rests at ``|A z − b| / stiffness``, so short is the task.
        """
        if self._short is None:
            return ()
        (short, C), layout = self._short, self._layout
        A, error, residual, _, equivalent = self._rows
        over = np.flatnonzero((short > layout.allowed).any(axis=1))
        rows = np.vstack([np.eye(C.shape[1]), C])
        binding = (rows[[i for i, _ in self._binding]], tuple(name for _, name in self._binding))
        found = []
        for t in map(int, over):
            own = slice(layout.first[t], layout.first[t + 1])
            rows_of_task = TaskResidual(
                A[own], error[own], equivalent[own], residual[own], layout.components_of_rows[own]
            )
            why = shortfall(
                layout.tasks[t],
                rows_of_task,
                short[t],
                layout.allowed[t],
                binding,
                layout.trust_radius,
                layout.task_units[t],
            )
            found.append(replace(why, own_axes=layout.own_axes[t]))
        return tuple(found)

    @cached_property
    def errors(self) -> dict[str, Floats]:
        """Error of each task's rows: m, rad; of a momentum task N s, N m s."""
        return self._by_task(self._rows[1])

    @cached_property
    def residuals(self) -> dict[str, Floats]:
        """By how much each task's accelerations miss what the task asked for: m/s², rad/s²."""
        return self._by_task(self._rows[2])

    @cached_property
    def _singular_values(self) -> Floats:
        J = self._rows[0][self._layout.geometric]
        return np.asarray(np.linalg.svd(J, compute_uv=False) if J.size else np.zeros(0), dtype=np.float64)

    @property
    def generalized_jacobian(self) -> Floats:
        """J_m* of all tasks about points (r, n), rows as they measure their errors, task after task."""
        J: Floats = self._rows[0].take(self._layout.geometric, axis=0)[:, : len(self._layout.joints)]
        return J

    @property
    def rank(self) -> int:
        """Rank of the generalized Jacobian, with the base's actuation, of all tasks about points; cut at 1e-9 of σ_max.

        Columns of the actuation are those of forces over the robot's mass and of torques over the base's mean inertia.
        """
        values = self._singular_values
        return int((values > 1e-9 * values.max(initial=0.0)).sum())

    @property
    def smallest_singular_value(self) -> float:
        """σ_min of the same; zero where the robot can move in fewer ways than the tasks have rows."""
        rows = len(self._layout.geometric)
        return float(self._singular_values.min()) if rows and len(self._singular_values) == rows else 0.0

    @cached_property
    def near_singularity(self) -> tuple[str, ...]:
        """Tasks near a dynamic singularity, whose motion is damped there; without those that are out of reach."""
        beyond = {one.task for one in self.shortfalls if one.reason == "out of reach"}
        return tuple(
            task
            for task, pivot in zip(self._layout.tasks, self._rows[3], strict=True)
            if pivot < self._layout.singular and task not in beyond
        )

    def lost_direction(self, task: str) -> tuple[Floats, bool]:
        """Return the direction in which a task's point moves least, and whether it is one to turn about.

        Parameters
        ----------
        task : str
            Of a task about points or axes.

        Returns
        -------
        direction : (3,)
            Unit vector, inertial axes, or those of the point where the task is in its axes: the larger part of the left
            singular vector of the task's rows at σ_min; zero for a task in Python, whose rows are along no axes.
        turning : bool
        """
        t = list(self._layout.tasks).index(task)
        if self._layout.task_units[t]:
            return np.zeros(3), False
        own = slice(self._layout.first[t], self._layout.first[t + 1])
        u, six = np.linalg.svd(self._rows[0][own])[0][:, -1], np.zeros(6)
        six[self._layout.components_of_rows[own]] = u
        turning = bool(np.linalg.norm(six[3:]) > np.linalg.norm(six[:3]))
        part = six[3:] if turning else six[:3]
        return part / np.linalg.norm(part), turning

    @property
    def explanation(self) -> str:
        """The status in words, and all that holds beside it."""
        if self.status == "stopped":
            reasons = ["the program could not be solved; the joints are braked within their torque limits"]
        else:
            reasons = [
                f"no solution was found for {_level(number)}, which {'are' if number is None else 'is'} left undone: "
                + (", ".join(map(repr, tasks)) or "no task")
                for number, tasks in self.dropped.items()
            ]
        if self.outside:
            reasons.append(f"outside position limits: {with_units(self.outside, self._layout.units)}")
        if self.softened:
            worst = ", ".join(f"'{joint}' by {excess:.3g}" for joint, excess in self.softened.items())
            reasons.append(f"torque limits leave no way to keep the motion limits; accelerations pass theirs: {worst}")
        reasons += map(str, self.shortfalls)
        for task in self.near_singularity:
            direction, turning = self.lost_direction(task)
            where = f", {'about' if turning else 'along'} {shown(direction)}" if direction.any() else ""
            reasons.append(f"near a dynamic singularity: {task}{where}")
        if not reasons:
            rounding = "the limits leave next to no room; all are kept but for rounding"
            kept = "all limits are kept, all references followed"
            reasons = [kept if self.status == "nominal" else rounding]
        return f"{self.status}: {'; '.join(reasons)}"

    def _by_task(self, values: Floats) -> dict[str, Floats]:
        first = self._layout.first
        return {task: values[first[t] : first[t + 1]] for t, task in enumerate(self._layout.tasks)}


def _level(number: int | None) -> str:
    return "the tasks without a level" if number is None else f"level {number}"

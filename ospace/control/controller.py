"""The operational-space controller: tasks and limits to joint torques, one quadratic program a cycle."""

from __future__ import annotations

import copy
import math
import time as clock
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import check_kind, checked_number, checked_vector
from ospace.control.base import MODES, Base, parse_base
from ospace.control.clearance import Clearance
from ospace.control.clearance_rows import ClearanceRows
from ospace.control.command import Command, CommandLayout, Status, Timing
from ospace.control.completion import CompletionWatch
from ospace.control.custom_rows import CustomRows, Written
from ospace.control.inequalities import Inequality, RowsInequality
from ospace.control.kernel_layout import base_actuation, empty_program, limit_tables, task_tables
from ospace.control.limits import JointLimits
from ospace.control.priorities import Level, Solution, kernel_calls, relaxed, solve_by_levels
from ospace.control.references import Constant, Function, Reference
from ospace.control.solvers import Solver, solver_of
from ospace.control.tasks import Completion, CustomTask, RowsTask, Task
from ospace.control.tasks.base_attitude import base_point
from ospace.control.wheels import Wheels
from ospace.dynamics.evaluator import OperationalSpaceEvaluator
from ospace.dynamics.joint_friction import JointFriction
from ospace.exceptions import OspaceError, closest
from ospace.kernels.evaluation import compose
from ospace.kernels.jit.together import compile_together
from ospace.kernels.qp import tables as kernel
from ospace.kernels.qp.program import assemble, recover_solution
from ospace.kernels.tasks.tables import REFERENCE
from ospace.kernels.tree import Floats, Ints
from ospace.model.joint_positions import joint_units
from ospace.model.points import OperationalPoint, check_owner
from ospace.model.robot import SpaceRobot

_COMPONENTS = ("force x", "force y", "force z", "torque x", "torque y", "torque z")
_ROUNDING = 1e-5
"""Excess over a bound, relative to it and at least to 1, that is a solver's tolerance, summed over levels."""
_EXCESS = 1e-5
"""Excess over motion limits that counts as one, rad/s²."""
_OUTSIDE = 1e-6
"""Excess over position limits that counts as one, rad or m; control stays within less at a limit."""
_SHORT = 0.01
"""By how much a task without a completion test may be short of its reference, m."""
DEFAULT_HORIZON = 0.04
"""How far ahead motion limits are seen, s."""
_BRAKING_TIME = 0.1
"""Within which joints are braked where nothing can be solved, s."""
_LOOKED_UP = ("_solve", "_custom", "_clearance", "_R", "_place", "_q", "_v")


Limiting = Inequality | RowsInequality | Clearance
"""What bounds z beside the limits of joints."""


class _Outcome(NamedTuple):
    """Result of a cycle's program."""

    z: Floats
    status: Status
    softened: dict[str, float]
    dropped: dict[int | None, tuple[str, ...]]


class Controller:
    """Joint torques, and a wrench on the base where it has actuators, that make a robot do its tasks.

    Parameters
    ----------
    robot : SpaceRobot
        With joints of any type, one row and one torque for each of their rates.
    tasks : sequence of Task
        Of different names.
    base : "floating", "flying", "thrusters", "wheels" or Base
        What acts upon the base. Nothing does on a floating one: it moves as the joints make it (7), (12).
    limits : JointLimits, optional
        Those of the robot's model without it.
    inequalities : sequence of Inequality, RowsInequality or Clearance
        Of different names, which no task has; one clearance at most.
    period : float
        Of the control cycle, s.
    solver : str or function
        "daqp", "proxqp", or a back-end of qpsolvers; or a function from a `Program` to z (n + k,), or None where it
        finds no solution.
    braking : float
        Share of what a joint's torque limit could decelerate that the approach to its position limits counts on.
    limit_horizon : float, optional
        How far ahead motion limits are seen, s; one period at least. 40 ms without it, or two periods if that is
        longer: joints rest at their limits though commands are late by 5 ms. Give eight times the delay where it is
        longer, or more where sensors are noisy.
    regularization : float
        Weight of squared accelerations, so that the program has one solution.
    singular : float
        Tasks whose rows are less independent than this (smallest pivot of J Jᵀ at unit diagonal, 1 for orthogonal
        rows) count as near a dynamic singularity, and their joints are damped.
    damping : float
        Weight of that damping at the singularity, relative to the mean diagonal of J Jᵀ.
    trust_radius : float
        Joint motion that an error may ask for, its size over the root mean square of its rows, rad or m. The nearer it
        comes to this, the more the joints of the task are damped, so that they come to rest where a target is out of
        reach; smaller errors are followed as if it were not there.
    wheel_momentum : (3,)
        What reaction wheels store at the first cycle, inertial axes; N m s.

    Attributes
    ----------
    wheel_momentum : (3,)
        What they store now, by the torques commanded so far, each for one `period`; set it where it is measured.

    Raises
    ------
    OspaceError
        Two tasks of one name, or none; a task of an unknown kind; an unknown mode or solver; a task of
        another robot's point; a limit or number that makes no sense.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        tasks: Task | Sequence[Task],
        *,
        base: Base | str = "floating",
        limits: JointLimits | None = None,
        inequalities: Limiting | Sequence[Limiting] = (),
        period: float = 1e-3,
        solver: str | Solver = "daqp",
        braking: float = 0.5,
        limit_horizon: float | None = None,
        regularization: float = 1e-6,
        singular: float = 1e-5,
        damping: float = 1e-5,
        trust_radius: float = 1.0,
        wheel_momentum: npt.ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        self.tasks = (tasks,) if isinstance(tasks, Task) else tuple(tasks)
        check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
        self.robot, self.period = robot, _above_zero("period", period)
        self.base, self.limits = parse_base(base), JointLimits.of(robot) if limits is None else limits
        check_kind(self.limits, JointLimits, "make it of the robot's model, JointLimits.of(robot), or by its arrays")
        if isinstance(inequalities, Limiting):
            inequalities = (inequalities,)
        self.inequalities = tuple(inequalities)
        self._solver = solver
        self._refuse_unknown_kinds()
        self._refuse_repeated_names()
        for task in self.tasks:
            task.check(robot, self.base)
        if len(self.limits.torque) != robot.n_joints:
            raise OspaceError(f"limits are of {len(self.limits.torque)} joints; '{robot.name}' has {robot.n_joints}")
        self._points = [base_point(robot), *(point for task in self.tasks for point in task.points)]
        self._run = OperationalSpaceEvaluator(robot, self._points, ("generalized_inertia", "generalized_bias"))
        self._tasks = task_tables(robot, self.tasks, self._points, self._run.layout.nodes)
        self._link = self._run.layout.nodes.link[self._tasks.node]
        n, m = robot.n_joints, len(self._tasks.rows)
        self._base = base_actuation(robot, self.base)
        component, scale = self._base.component, self._base.scale
        allowed = np.array([_allowed(task) for task in self.tasks])
        g = sum(one.size for one in self.inequalities)
        self._rows, self._program, self._answer = empty_program(n, len(component), m, g, allowed)
        self._weights = kernel.Weights(
            np.array([task.weight if task.level is None else 0.0 for task in self.tasks]),
            _above_zero("regularization", regularization),
            _above_zero("singular", singular),
            _above_zero("damping", damping),
            _above_zero("trust_radius", trust_radius),
            np.ones(len(self.tasks)),
            np.zeros_like(self._rows.A),
            *np.zeros((2, len(self.tasks), n)),
        )
        largest = self.base.limits[component] / scale
        horizon = max(DEFAULT_HORIZON, 2.0 * self.period) if limit_horizon is None else limit_horizon
        times = (self.period, _above_zero("limit_horizon", horizon))
        self._limits = limit_tables(self.limits, largest, *times, _above_zero("braking", braking))
        friction = JointFriction.of(robot)
        self._resistance = kernel.Resistance(friction.damping, friction.coulomb, np.zeros(n))
        self._undriven = np.flatnonzero(self.limits.torque == 0.0)
        self._beyond = np.zeros(n)
        wheel_rows = (component >= 3) & self.base.wheels
        self._wheels = Wheels(wheel_rows, component - 3, self.base.wheel_momentum, largest, scale)
        self.wheel_momentum = checked_vector(wheel_momentum, 3, "wheel_momentum", robot.name)
        first = self._tasks.first
        geometric = [np.arange(first[t], first[t + 1]) for t, task in enumerate(self.tasks) if task.geometric]
        self._layout = CommandLayout(
            robot.rate_names,
            {**joint_units(robot.model), **{one.name: one.unit for one in self.inequalities}},
            [_COMPONENTS[c] for c in self._base.component],
            [one.name for one in self.inequalities for _ in range(one.size)],
            largest,
            [task.name for task in self.tasks],
            [int(row) for row in first],
            np.concatenate([np.zeros(0, dtype=np.int64), *geometric]),
            singular,
            self._weights.trust_radius,
            self._tasks.rows,
            [task.unit if isinstance(task, CustomTask) else "" for task in self.tasks],
            [task.own_axes for task in self.tasks],
            allowed,
        )
        self._levels = sorted({task.level for task in self.tasks if task.level is not None})
        self._rows_of_levels = [self._level(number) for number in self._levels]
        self._moving: list[tuple[int, Function]] = []
        self._begun, self._time, self._falls_short = False, 0.0, False
        self._references: list[Reference | None] = [None] * len(self.tasks)
        for t, task in enumerate(self.tasks):
            if task.reference is not None:
                self._set_reference(t, task.reference)
        self._completion = CompletionWatch(self.tasks, first, self._tasks.rows)
        self._connect()

    def __repr__(self) -> str:
        named = [name for name, mode in MODES.items() if mode == self.base]
        tasks = ", ".join(f"{type(task).__name__} '{task.name}'" for task in self.tasks)
        solver = self._solver if isinstance(self._solver, str) else getattr(self._solver, "__name__", "of your own")
        base = named[0] if named else repr(self.base)
        return f"Controller('{self.robot.name}', [{tasks}], base={base}, period={self.period:g} s, solver={solver})"

    def warm_up(self) -> None:
        """Load all that the first `update` would load: compiled kernels, or compile them, and the solver.

        After it the first cycle takes no longer than others. A copy of the controller runs the cycle, at zero joint
        positions and without references, so that nothing of this one changes, before its first cycle or later.
        """
        compile_together(
            [
                (assemble, self._assembly(0.0)),
                (recover_solution, self._recovery(self._program.f, self._program)),
                (compose, (self._run.memory, self._run.memory, self._run.memory)),
                *self._custom.calls(),
                *(() if self._clearance is None else self._clearance.calls()),
                *kernel_calls(self._program),
            ]
        )
        shared = {id(one): one for one in (self.robot, self.tasks, self.inequalities)}
        unset = {id(self._references): [None] * len(self.tasks), id(self._moving): []}
        twin = copy.deepcopy(self, {**shared, **unset})
        twin._begun = False
        with suppress(OspaceError):  # what is singular there need not be elsewhere
            twin.update(0.0, self.robot.configuration(), np.zeros(self.robot.nv))

    # -- one cycle -------------------------------------------------------------------------------------------

    def update(self, time: float, q: npt.ArrayLike, v: npt.ArrayLike) -> Command:
        """Return the command of a control cycle.

        Parameters
        ----------
        time : float
            s.
        q : (nq,)
            Configuration, as `SpaceRobot.state` takes it; m, rad.
        v : (nv,)
            Velocity, base twist in base axes, linear first, then joint rates; m/s, rad/s.

        Returns
        -------
        Command

        Raises
        ------
        OspaceError
            The state makes no sense, a reference is not finite, or a joint moves nothing. Tasks and limits that
            contradict each other are no error: `Command.status` tells.
        """
        start = clock.perf_counter()
        if type(time) is not float or not math.isfinite(time):
            time = checked_number(time, "time")
        self._run.update(q, v)
        if not self._begun:
            self._begin()
        self._time = time
        evaluated = clock.perf_counter()
        for t, reference in self._moving:
            reference.write(self._tasks.reference[t], time)
        if self._wheels.any:
            self._wheels.limit(self._rotation().T @ self.wheel_momentum, self.period, self._limits.wrench)
        if self._custom.any:
            self._custom.write(time, self._q, self._v)
        if self._clearance is not None and self._clearance.write(time, self._q, self._v):
            self._name_rows(self._clearance)
        farthest = assemble(*self._assembly(time))
        assembled = clock.perf_counter()
        outcome = self._solution()
        solved = clock.perf_counter()
        self._completion.observe(time, self._rows.error, self._references)
        if self._clearance is not None:
            farthest = max(farthest, self._clearance.below)
        outside = self._outside() if max(farthest, -self._custom.smallest) > _OUTSIDE else {}
        return self._command(outcome, outside, (start, evaluated, assembled, solved))

    def completed(self, name: str) -> bool:
        """Return whether the task's completion test has held for its time in the last cycle.

        It does not before a `MinimumJerk` has come to rest; a `Function` is compared with where it is.

        Parameters
        ----------
        name : str
            Of the task.

        Returns
        -------
        bool

        Raises
        ------
        OspaceError
            The task is unknown, or has no completion test.
        """
        t = self._index(name)
        completion = self.tasks[t].completion
        if completion is None:
            raise OspaceError(f"task '{name}' has no completion test")
        return self._completion.held(t, self._time) >= completion.hold - 1e-12

    def follow(self, name: str, reference: Reference | Mapping[str, float]) -> None:
        """Give a task another reference, or a posture task another posture, from the next cycle on.

        Parameters
        ----------
        name : str
            Of the task.
        reference : Constant, MinimumJerk, Function, or mapping of joint name to position
            The last is a posture; rad, or m.

        Raises
        ------
        OspaceError
            The task is unknown, or cannot follow the reference.
        """
        t = self._index(name)
        task = self.tasks[t].redirected(reference)
        task.write(self.robot, self._tasks.posture[t])
        if task.reference is not None:
            self._set_reference(t, task.reference)
        self._completion.restart(t)

    def pose(self, point: OperationalPoint) -> pin.SE3:
        """Return the pose of a point of one of the tasks in the state of the last cycle.

        Parameters
        ----------
        point : OperationalPoint
            Of the controller's robot.

        Returns
        -------
        pin.SE3
            Inertial axes; m.

        Raises
        ------
        OspaceError
            The point is another robot's or of no task, or there was no cycle yet.
        """
        check_owner(self.robot, point)
        if not self._begun:
            raise OspaceError("there is no cycle yet: call update(time, q, v) first")
        for e, known in enumerate(self._points):
            if known.joint == point.joint and known.placement == point.placement:
                return self._pose(e)
        raise OspaceError(f"point '{point.frame}' belongs to no task")

    def _solution(self) -> _Outcome:
        """Solve; else let motion limits give way; else brake."""
        found = self._attempt(self._program)
        if found is not None and self._finish(found.z, self._program) <= _ROUNDING:
            softened = self._undriven_excess(found.z) if len(self._undriven) else {}
            return _Outcome(found.z, "softened" if softened else "nominal", softened, self._dropped(found))
        least = relaxed(self._program, self.robot.n_joints, self._solve)
        if least is not None:
            program, start = least
            for found in (self._attempt(program), self._attempt(program, start)):
                if found is not None and self._finish(found.z, program) <= _ROUNDING:
                    softened = {**self._excess(found.z), **self._undriven_excess(found.z)}
                    return _Outcome(found.z, "softened", softened, self._dropped(found))
        z = self._braking()
        self._finish(z, self._program)
        return _Outcome(z, "stopped", {}, {})

    def _attempt(self, program: kernel.Program, start: Floats | None = None) -> Solution | None:
        """Solve `program`, by levels if there are any, from `start` if there is one."""
        if not self._levels and start is None:
            z = self._solve(program)
            return None if z is None else Solution(z)
        levels = []
        for taken, weight, rows, scale in self._rows_of_levels:
            damped, slowed = weight @ self._weights.damped[taken], weight @ self._weights.slowed[taken]
            levels.append(Level(scale[:, None] * self._rows.A[rows], scale * self._rows.b[rows], damped, slowed))
        return solve_by_levels(program, levels, self._solve, self._weights.regularization, start)

    def _dropped(self, found: Solution) -> dict[int | None, tuple[str, ...]]:
        """Return the levels that found no solution, None for tasks without a level, and the names of their tasks."""
        if not found.dropped:
            return {}
        numbers = [*self._levels, None]
        return {numbers[k]: tuple(task.name for task in self.tasks if task.level == numbers[k]) for k in found.dropped}

    def _finish(self, z: Floats, program: kernel.Program) -> float:
        """Compute what comes of `z`; return by how much it passes the bounds of `program`, relative to them."""
        excess, self._falls_short = recover_solution(*self._recovery(z, program))
        return float(excess)

    def _assembly(self, time: float) -> tuple[Any, ...]:
        """Return what `assemble` takes."""
        own = self._base, self._tasks, self._limits, self._resistance, self._weights, self._rows, self._program
        return time, self._run.memory, *own, self._beyond

    def _recovery(self, z: Floats, program: kernel.Program) -> tuple[Any, ...]:
        """Return what `recover_solution` takes."""
        own = self._resistance, self._tasks, self._rows, program, self._answer
        return z, self._run.memory, self._base, self.period, *own

    def _excess(self, z: Floats) -> dict[str, float]:
        """By how much accelerations pass the bounds of joints' motion limits and of inequalities."""
        n, program, size = self.robot.n_joints, self._program, len(z)
        soft = [*range(n), *range(size + n, len(program.lower))]
        value = np.concatenate([z[:n], program.C[n:] @ z])
        excess = np.maximum(value - program.upper[soft], program.lower[soft] - value)
        found: dict[str, float] = {}
        for name, by in zip([*self._layout.joints, *self._layout.inequalities], excess.tolist(), strict=True):
            if by > _EXCESS:
                found[name] = max(by, found.get(name, 0.0))
        return found

    def _undriven_excess(self, z: Floats) -> dict[str, float]:
        """By how much joints without a drive pass what keeps them within their velocity and acceleration limits."""
        own, limits = self._undriven, self.limits
        acceleration = z[own]
        rate = self._v[6:][own] + self.period * acceleration
        excess = np.maximum(
            (np.abs(rate) - limits.velocity[own]) / self.period, np.abs(acceleration) - limits.acceleration[own]
        )
        return {self._layout.joints[j]: float(by) for j, by in zip(own.tolist(), excess, strict=True) if by > _EXCESS}

    def _outside(self) -> dict[str, float]:
        """By how much joints are outside their position limits, and values of inequalities below 0."""
        found = {
            self._layout.joints[j]: float(self._beyond[j]) for j in np.flatnonzero(self._beyond > _OUTSIDE).tolist()
        }
        if self._custom.any:
            found |= self._custom.below(-_OUTSIDE)
        if self._clearance is not None:
            found |= self._clearance.outside(_OUTSIDE)
        return found

    def _braking(self) -> Floats:
        """Return accelerations by torques that take energy from every joint, within their limits."""
        n, program = self.robot.n_joints, self._program
        H, c, rate = program.C[:n, :n], self._resistance.bias, self._v[6:]
        torque = np.clip(c - H @ rate / _BRAKING_TIME, *self._limits.torque)
        torque[torque * rate > 0.0] = 0.0
        z = np.zeros(len(program.f))
        z[:n] = np.linalg.solve(H, torque - c)
        return z

    def _command(self, outcome: _Outcome, outside: dict[str, float], marks: tuple[float, ...]) -> Command:
        n, program, answer = self.robot.n_joints, self._program, self._answer
        z, status, softened, dropped = outcome
        if status != "stopped" and (dropped or outside):
            status = "degraded" if dropped else "outside limits"
        elif status == "nominal" and self._falls_short:
            status = "falling short"
        torque = np.clip(answer.torque, *self._limits.torque)
        wrench = np.zeros(6)
        if len(z) > n:
            wrench[self._base.component] = z[n:] * self._base.scale
            R = self._rotation()
            wrench = np.concatenate([R @ wrench[:3], R @ wrench[3:]])
        wheel_torque = np.zeros(3)
        if self._wheels.any:
            wheel_torque, wrench[3:] = wrench[3:].copy(), 0.0
            self.wheel_momentum = self.wheel_momentum - wheel_torque * self.period
        value = np.concatenate([z, answer.torque, program.C[n:] @ z] if self.inequalities else [z, answer.torque])
        lower, upper = program.lower.copy(), program.upper.copy()
        torque_rows = slice(len(z), len(z) + n)
        lower[torque_rows], upper[torque_rows] = self._limits.torque
        own = (self._rows.A, self._rows.error, answer.residual, self._weights.independence, self._rows.equivalent_error)
        A, error, residual, independence, equivalent = (one.copy() for one in own)
        now = clock.perf_counter()
        start, evaluated, assembled, solved = marks
        timing = Timing(evaluated - start, assembled - evaluated, solved - assembled, now - start)
        return Command(
            self._time,
            torque,
            wrench,
            wheel_torque,
            z[:n],
            answer.base_acceleration[0].copy(),
            status,
            softened,
            dropped,
            outside,
            timing,
            self._layout,
            (lower, upper, value, program.cause.copy()),
            (A, error, residual, independence, equivalent),
            (answer.short.copy(), program.C.copy()) if self._falls_short else None,
            None if self._clearance is None else self._clearance.nearest,
        )

    # -- the state of the last cycle -------------------------------------------------------------------------

    def _rotation(self) -> Floats:
        """Of the base."""
        R: Floats = self._R[0].reshape(3, 3).T
        return R

    def _pose(self, e: int) -> pin.SE3:
        R = self._R[self._link[e]].reshape(3, 3).T @ self._tasks.turn[e].reshape(3, 3).T
        return pin.SE3(R, self._place[self._tasks.node[e]] + self._q[:3])

    # -- setting up ------------------------------------------------------------------------------------------

    def _connect(self) -> None:
        """Look up what a copy cannot take over: the solver, and where the evaluator keeps the state."""
        self._solve = solver_of(self._solver)
        first, at = self._tasks.first, self.robot.n_joints
        written: list[tuple[Written, int]] = [
            (task, int(first[t])) for t, task in enumerate(self.tasks) if isinstance(task, CustomTask | RowsTask)
        ]
        times = self.period, self._limits.horizon
        self._clearance: ClearanceRows | None = None
        for one in self.inequalities:
            if isinstance(one, Clearance):
                self._clearance = ClearanceRows(one, at, self._base, self._program, self._run.memory, *times)
            else:
                written.append((one, at))
            at += one.size
        self._custom = CustomRows(self.robot, written, self._base, self._rows, self._program, self._run.memory, *times)
        if self._clearance is not None:
            self._layout = replace(self._layout, units={**self._layout.units, **self._clearance.units})
            self._name_rows(self._clearance)
        self._R, self._place = self._run.table("R"), self._run.table("place")
        self._q, self._v = self._run.table("q")[: self.robot.nq, 0], self._run.table("velocity")[:, 0]

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what `_connect` looks up; all else goes along, so that a copy goes on as this one would."""
        return {name: value for name, value in vars(self).items() if name not in _LOOKED_UP}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._connect()

    def _refuse_unknown_kinds(self) -> None:
        for task in self.tasks:
            check_kind(task, Task, "tasks are those of ospace.control, and subclasses of CustomTask and RowsTask")
        for one in self.inequalities:
            if not isinstance(one, Limiting):
                raise OspaceError(
                    f"{one!r:.60} is no inequality: write a subclass of Inequality or RowsInequality, "
                    f"or give a Clearance"
                )
        clearances = [one for one in self.inequalities if isinstance(one, Clearance)]
        if len(clearances) > 1:
            raise OspaceError("two clearances are given: give one, with all of its pairs and obstacles")
        if clearances and clearances[0].robot is not self.robot:
            raise OspaceError(
                f"the clearance is of robot '{clearances[0].robot.name}', another one than the controller's: "
                f"make it of that robot"
            )

    def _refuse_repeated_names(self) -> None:
        names = [one.name for one in (*self.tasks, *self.inequalities)]
        for name in names:
            if names.count(name) > 1:
                what = "tasks or inequalities" if self.inequalities else "tasks"
                raise OspaceError(f"two {what} are called '{name}': give each a name of its own")
        if not self.tasks:
            raise OspaceError("no task given: a controller needs at least one")

    def _name_rows(self, clearance: ClearanceRows) -> None:
        """Call the rows of the clearance by the pairs that they are of."""
        names: list[str] = []
        for one in self.inequalities:
            names += clearance.names if isinstance(one, Clearance) else [one.name] * one.size
        self._layout = replace(self._layout, inequalities=names)

    def _level(self, number: int) -> tuple[list[int], Floats, Ints, Floats]:
        """Tasks of a strict level and their weights, and their rows and the roots of these rows' weights."""
        first = self._tasks.first
        taken = [t for t, task in enumerate(self.tasks) if task.level == number]
        weight = np.array([self.tasks[t].weight for t in taken])
        rows = np.concatenate([np.arange(first[t], first[t + 1]) for t in taken])
        return taken, weight, rows, np.sqrt(np.repeat(weight, np.diff(first)[taken]))

    def _index(self, name: str) -> int:
        names = [task.name for task in self.tasks]
        if name not in names:
            raise OspaceError(f"no task '{name}'{closest(str(name), names)}")
        return names.index(name)

    def _begin(self) -> None:
        """Take what is there at the first cycle as the reference of every task that was given none."""
        self._begun = True
        centre = self._run.table("mass_centre")[0] + self._q[:3]
        for t, task in enumerate(self.tasks):
            self._tasks.posture[t] = self._q
            task.write(self.robot, self._tasks.posture[t])
            poses = [self._pose(e) for e in self._tasks.point[t] if e >= 0]
            if self._references[t] is None:
                self._set_reference(t, Constant(task.initial(poses, centre)))

    def _set_reference(self, t: int, reference: Reference) -> None:
        row = np.zeros(REFERENCE)
        if not isinstance(reference, Function):
            reference.write(row, 0.0)
            if not np.isfinite(row).all():
                raise OspaceError(f"the reference of task '{self.tasks[t].name}' is not finite")
        self._references[t] = reference
        self._tasks.reference[t] = row
        self._moving = [(k, one) for k, one in self._moving if k != t]
        if isinstance(reference, Function):
            self._moving.append((t, reference))


def _allowed(task: Task) -> tuple[float, float]:
    """By how much a task may be short of its reference: the bounds of its completion test, else 1 cm and 1 deg."""
    if isinstance(task, CustomTask) and task.completion is None and task.unit not in ("m", "rad"):
        return math.inf, math.inf
    bounds = task.completion or Completion(_SHORT, math.radians(1.0))
    return (
        bounds.position if math.isfinite(bounds.position) else _SHORT,
        bounds.angle if math.isfinite(bounds.angle) else math.radians(1.0),
    )


def _above_zero(name: str, value: float) -> float:
    if not (isinstance(value, Real) and 0.0 < value < np.inf):
        raise OspaceError(f"{name} is {value!r}: give a finite number above 0")
    return float(value)

"""Rows of a cycle's program that users write in Python: called, checked, and handed to the kernel."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np

from ospace.checks import real_numbers
from ospace.control.inequalities import Inequality, RowsInequality
from ospace.control.instant import Instant
from ospace.control.limits import bounded
from ospace.control.state_function import Custom, StateFunction
from ospace.control.tasks.custom import CustomTask, RowsTask
from ospace.exceptions import OspaceError
from ospace.kernels.observation import observe
from ospace.kernels.qp import custom_rows as kernel
from ospace.kernels.qp.custom_rows import write_custom_rows
from ospace.kernels.qp.tables import Program
from ospace.kernels.tasks.tables import BaseActuation, TaskRows
from ospace.kernels.tree import Floats
from ospace.model.points import check_owner
from ospace.model.robot import SpaceRobot

Written = CustomTask | RowsTask | Inequality | RowsInequality


class CustomRows:
    """Writes the rows of tasks and inequalities in Python to the tables of a controller.

    Parameters
    ----------
    robot : SpaceRobot
    written : sequence of (Written, int)
        With the row where each begins: of the tasks' rows, or of `Program.C`; tasks before inequalities.
    base, rows, program : the controller's tables
    memory : Floats
        Of its evaluator.
    period, horizon : float
        Of control, and how far ahead limits are seen; s.

    Attributes
    ----------
    any : bool
        Whether there is one.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        written: Sequence[tuple[Written, int]],
        base: BaseActuation,
        rows: TaskRows,
        program: Program,
        memory: Floats,
        period: float,
        horizon: float,
    ) -> None:
        self.any = bool(written)
        if not self.any:
            return
        points = {point: None for one, _ in written for point in one.points}
        for point in points:
            check_owner(robot, point)
        self._at, self._size = Instant(robot, list(points)), len(program.f)
        self._rows, self._program = rows, program
        smooth = [(one, first) for one, first in written if isinstance(one, CustomTask | Inequality)]
        self._direct = [(one, first) for one, first in written if isinstance(one, RowsTask | RowsInequality)]
        ends = np.concatenate([[0], np.cumsum([one.size for one, _ in smooth])]).astype(np.int64)
        m = int(ends[-1])
        self._tables = kernel.CustomRows(
            first=ends,
            row=np.array([first for _, first in smooth], dtype=np.int64),
            tasks=sum(isinstance(one, CustomTask) for one, _ in smooth),
            gain=np.array([_gain(one) for one, _ in smooth]).reshape(-1, 2),
            given=np.array([_overridden(one) for one, _ in smooth], dtype=np.int64).reshape(-1, 2),
            value=np.zeros(m),
            jacobian=np.zeros((m, robot.nv)),
            rate=np.zeros(m),
            drift=np.zeros(m),
            later_jacobian=np.zeros((m, robot.nv)),
            later_rate=np.zeros(m),
            smallest=np.full(1, np.inf),
        )
        self._functions = [_Function(one, self._tables, c) for c, (one, _) in enumerate(smooth)]
        self._steps = not self._tables.given[:, 1].all()
        self._of_controller = memory, base, period, horizon

    def write(self, time: float, q: Floats, v: Floats) -> None:
        """Write all rows for the state that the controller's evaluator has evaluated last.

        Raises
        ------
        OspaceError
            What a user's class raises or returns cannot be used; names class and method.
        """
        at = self._at
        at.observe(time, q, v)
        later, step = at.later() if self._steps else (at, 1.0)
        for one in self._functions:
            one.evaluate(at, later)
        wrong = write_custom_rows(*self._arguments(step))
        if wrong >= 0:
            self._functions[wrong].refuse_nonfinite()
        for direct, first in self._direct:
            self._write(direct, first, at)

    def calls(self) -> list[tuple[Any, tuple[Any, ...]]]:
        """Return the kernels, with the arguments that they are called with."""
        return [(observe, self._at.arguments), (write_custom_rows, self._arguments(1.0))] if self.any else []

    def _arguments(self, step: float) -> tuple[Any, ...]:
        return *self._of_controller, step, self._tables, self._rows, self._program

    @property
    def smallest(self) -> float:
        """The smallest of all values of inequalities."""
        return float(self._tables.smallest[0]) if self.any else np.inf

    def below(self, least: float) -> dict[str, float]:
        """Return by how much values of inequalities are below 0, by name, where they are below `least`."""
        values = {one.name: float(one.value.min()) for one in self._functions if not one.is_task}
        return {name: -value for name, value in values.items() if value < least}

    def _write(self, one: RowsTask | RowsInequality, first: int, at: Instant) -> None:
        task = isinstance(one, RowsTask)
        method = one.equations if isinstance(one, RowsTask) else one.bounds
        try:
            returned = method(at)
        except Exception as error:
            raise _failed(one, method, error) from error
        if not (isinstance(returned, tuple) and len(returned) == 2):
            raise OspaceError(f"{_named(one, method)} returned {returned!r:.60}: give a matrix and a vector, A, b")
        A = _numbers(one, method, returned[0], (one.size, self._size), "matrix")
        b = _numbers(one, method, returned[1], (one.size,), "vector")
        if not np.isfinite(A).all() or not (np.isfinite(b) if task else b > -np.inf).all():
            raise OspaceError(f"{_named(one, method)} returned numbers that are not finite: {A!r:.60}, {b!r:.60}")
        rows = slice(first, first + one.size)
        if task:
            self._rows.A[rows], self._rows.b[rows], self._rows.error[rows] = A, b, b
        else:
            self._program.C[rows] = A
            self._program.upper[self._size :][rows] = bounded(b)


class _Function:
    """A function of the state, and where its derivatives go."""

    def __init__(self, one: CustomTask | Inequality, tables: kernel.CustomRows, c: int) -> None:
        self.name, self.is_task, self._one = one.name, isinstance(one, CustomTask), one
        own = slice(int(tables.first[c]), int(tables.first[c + 1]))
        self.value = tables.value[own]
        rate_given, drift_given = (bool(given) for given in tables.given[c])
        value_of = one.error if isinstance(one, CustomTask) else one.value
        self._now: list[tuple[Callable[[Instant], Any], Floats]] = [
            (value_of, self.value),
            (one.jacobian, tables.jacobian[own]),
        ]
        self._later: list[tuple[Callable[[Instant], Any], Floats]] = []
        if rate_given:
            self._now.append((one.rate, tables.rate[own]))
        if drift_given:
            self._now.append((one.drift, tables.drift[own]))
        elif rate_given:
            self._later.append((one.rate, tables.later_rate[own]))
        else:
            self._later.append((one.jacobian, tables.later_jacobian[own]))

    def evaluate(self, at: Instant, later: Instant) -> None:
        """Call the methods, and write what they return."""
        for calls, instant in ((self._now, at), (self._later, later)):
            for method, to in calls:
                try:
                    returned = method(instant)
                except Exception as error:
                    raise _failed(self._one, method, error) from error
                if type(returned) is np.ndarray and returned.shape == to.shape and returned.dtype == np.float64:
                    to[:] = returned
                else:
                    to[:] = _numbers(self._one, method, returned, to.shape)

    def refuse_nonfinite(self) -> NoReturn:
        """Raise the `OspaceError` that names the method whose numbers are not finite."""
        for method, numbers in (*self._now, *self._later):
            wrong = np.argwhere(~np.isfinite(numbers))
            if wrong.size:
                value, where = numbers[tuple(wrong[0])], ", ".join(map(str, wrong[0]))
                raise OspaceError(f"{_named(self._one, method)}: element [{where}] is {value}: give finite numbers")
        raise OspaceError(f"{_named(self._one, self._now[0][0])}: its numbers are too large to compute with")


def _overridden(one: StateFunction) -> tuple[bool, bool]:
    return type(one).rate is not StateFunction.rate, type(one).drift is not StateFunction.drift


def _gain(one: CustomTask | Inequality) -> tuple[float, float]:
    return one.gain if isinstance(one, CustomTask) else (float(one.deceleration), 0.0)


def _named(one: Custom, method: Callable[..., Any]) -> str:
    what = "task" if isinstance(one, CustomTask | RowsTask) else "inequality"
    return f"{what} '{one.name}': {type(one).__name__}.{method.__name__}"  # type: ignore[attr-defined]


def _failed(one: Custom, method: Callable[..., Any], error: Exception) -> OspaceError:
    return OspaceError(f"{_named(one, method)} failed: {type(error).__name__}: {error}")


def _numbers(
    one: Custom, method: Callable[..., Any], returned: Any, shape: tuple[int, ...], what: str = "array"
) -> Floats:
    """Return what a user's method returned as an array of that shape; one row may lack the first dimension."""
    try:
        numbers = real_numbers(returned)
    except (TypeError, ValueError):
        raise OspaceError(f"{_named(one, method)} returned {returned!r:.60}: give an array of real numbers") from None
    if numbers.shape == shape:
        return numbers
    if shape[0] == 1 and numbers.shape == shape[1:]:
        return numbers.reshape(shape)
    raise OspaceError(
        f"{_named(one, method)} returned a{'n' if what[0] == 'a' else ''} {what} of shape {numbers.shape}: "
        f"it takes {shape}, with size = {one.size} rows"
    )

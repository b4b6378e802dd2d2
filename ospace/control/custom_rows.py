"""Rows of a cycle's program that users write in Python: called, checked, and handed to the kernel."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NoReturn

import numpy as np
import numpy.typing as npt

from ospace.checks import real_numbers
from ospace.control.inequalities import Inequality, RowsInequality
from ospace.control.instant import Instant
from ospace.control.limits import bounded
from ospace.control.state_function import Custom, StateFunction
from ospace.control.tasks.custom import CustomTask, RowsTask
from ospace.exceptions import OspaceError
from ospace.kernels.qp import custom_rows as kernel
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
    period : float
        s.

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
        sizes = [one.size for one, _ in smooth]
        ends, m = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), sum(sizes)
        self._tables = kernel.CustomRows(
            ends,
            np.array([first for _, first in smooth], dtype=np.int64),
            sum(isinstance(one, CustomTask) for one, _ in smooth),
            np.array([_gain(one) for one, _ in smooth]).reshape(-1, 2),
            *(np.zeros(m) for _ in range(3)),
            np.zeros((m, robot.nv)),
        )
        self._smooth = [
            _Written(one, self._tables, slice(int(first), int(last)))
            for (one, _), first, last in zip(smooth, ends, ends[1:], strict=False)
        ]
        self.arguments = memory, base, period, self._tables, rows, program
        self._inequalities = [
            (one.one.name, one.own) for one in self._smooth if isinstance(one.one, Inequality)
        ]

    def write(self, time: float, q: Floats, v: Floats) -> None:
        """Write all rows for the state that the controller's evaluator has evaluated last.

        Raises
        ------
        OspaceError
            What a user's class raises or returns cannot be used; names class and method.
        """
        at = self._at
        at.observe(time, q, v)
        for one in self._smooth:
            one.differentiate(at)
        wrong = kernel.write_custom_rows(*self.arguments)
        if wrong >= 0:
            self._smooth[wrong].refuse_nonfinite()
        for one, first in self._direct:
            self._write(one, first, at)

    def margins(self) -> dict[str, Floats]:
        """Return the values of all inequalities that have one, by their names."""
        return {name: self._tables.value[own].copy() for name, own in self._inequalities}

    def _write(self, one: RowsTask | RowsInequality, first: int, at: Instant) -> None:
        task = isinstance(one, RowsTask)
        method = one.equations if isinstance(one, RowsTask) else one.bounds
        returned = _called(one, method, at)
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


class _Written:
    """A function of the state, and where its derivatives go."""

    def __init__(self, one: CustomTask | Inequality, tables: kernel.CustomRows, own: slice) -> None:
        self.one, self.own = one, own
        self._value_of: Callable[[Instant], npt.ArrayLike] = one.error if isinstance(one, CustomTask) else one.value
        self._rate_given = type(one).rate is not StateFunction.rate
        self._drift_given = type(one).drift is not StateFunction.drift
        self._value, self._rate, self._drift = tables.value[own], tables.rate[own], tables.drift[own]
        self._jacobian = tables.jacobian[own]

    def differentiate(self, at: Instant) -> None:
        """Compute y, J, ẏ and ÿ at v̇ = 0."""
        one, vector, matrix = self.one, self._value.shape, self._jacobian.shape
        self._value[:] = _numbers(one, self._value_of, _called(one, self._value_of, at), vector)
        self._jacobian[:] = _numbers(one, one.jacobian, _called(one, one.jacobian, at), matrix)
        if self._rate_given:
            self._rate[:] = _numbers(one, one.rate, _called(one, one.rate, at), vector)
        else:
            np.dot(self._jacobian, at.v, out=self._rate)
        if self._drift_given:
            self._drift[:] = _numbers(one, one.drift, _called(one, one.drift, at), vector)
            return
        later, step = at.later()
        if self._rate_given:
            rate = _numbers(one, one.rate, _called(one, one.rate, later), vector)
        else:
            rate = _numbers(one, one.jacobian, _called(one, one.jacobian, later), matrix) @ at.v
        np.subtract(rate, self._rate, out=self._drift)
        self._drift /= step

    def refuse_nonfinite(self) -> NoReturn:
        """Raise the `OspaceError` that names the method whose numbers are not finite."""
        results = (
            (self._value_of, self._value),
            (self.one.jacobian, self._jacobian),
            (self.one.rate, self._rate),
            (self.one.drift, self._drift),
        )
        for method, numbers in results:
            wrong = np.argwhere(~np.isfinite(numbers))
            if wrong.size:
                where = ", ".join(map(str, wrong[0]))
                value = numbers[tuple(wrong[0])]
                raise OspaceError(f"{_named(self.one, method)}[{where}] is {value}: all numbers must be finite")
        raise OspaceError(f"{_named(self.one, self._value_of)}: numbers are too large to compute with")


def _gain(one: CustomTask | Inequality) -> tuple[float, float]:
    return one.gain if isinstance(one, CustomTask) else (float(one.deceleration), 0.0)


def _named(one: Custom, method: Callable[..., Any]) -> str:
    what = "task" if isinstance(one, CustomTask | RowsTask) else "inequality"
    return f"{what} '{one.name}': {type(one).__name__}.{method.__name__}"  # type: ignore[attr-defined]


def _called(one: Custom, method: Callable[[Instant], Any], at: Instant) -> Any:
    """Call a user's method; raise `OspaceError` that names it, whatever it raises."""
    try:
        return method(at)
    except Exception as error:
        raise OspaceError(f"{_named(one, method)} failed: {type(error).__name__}: {error}") from error


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

"""Tasks that users write in Python."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy.typing as npt

from ospace.control.instant import Instant
from ospace.control.references import Reference
from ospace.control.state_function import Custom, StateFunction
from ospace.control.tasks.task import Task
from ospace.exceptions import OspaceError
from ospace.kernels.tasks import tables as kernel
from ospace.model.robot import SpaceRobot


@dataclass(frozen=True, kw_only=True, eq=False)
class _WrittenInPython(Custom, Task):
    """A task whose rows Python writes."""

    kind: ClassVar[int] = kernel.CUSTOM

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.reference is not None:
            raise OspaceError(
                f"task '{self.name}': {type(self).__name__} says itself what to follow, give no reference"
            )

    def redirected(self, reference: Reference | Mapping[str, Any]) -> Task:
        """Raise `OspaceError`: its class says what it follows."""
        raise OspaceError(f"task '{self.name}': {type(self).__name__} says itself what to follow")

    def rows(self, robot: SpaceRobot) -> list[int]:
        """Linear rows, or angular ones where the unit is rad."""
        return [3 if self.unit == "rad" else 0] * self.size

    def row_names(self, robot: SpaceRobot) -> list[str]:
        """Names of the rows."""
        return [f"{self.name}.{row}" for row in range(self.size)]


@dataclass(frozen=True, kw_only=True, eq=False)
class CustomTask(_WrittenInPython, StateFunction):
    """An error e(q, t) to bring to zero: ë = −d ė − k e, with the stiffness k and the damping d = 2 ζ √k.

    Write `error` and `jacobian`; `rate` where the error depends on time by itself, `drift` where it is known.

    Attributes
    ----------
    size, unit : int, str
        Of the error. A completion test takes `angle` for rad, else `position`, in that unit.
    """

    geometric: ClassVar[bool] = True

    @property
    def units(self) -> tuple[str, str]:
        """The unit of the error; rad is that of angular rows."""
        return self.unit, "rad"

    @abstractmethod
    def error(self, at: Instant) -> npt.ArrayLike:
        """Return e.

        Parameters
        ----------
        at : Instant

        Returns
        -------
        (m,) array
        """


@dataclass(frozen=True, kw_only=True, eq=False)
class RowsTask(_WrittenInPython):
    """Accelerations that a task demands: A z = b, with z = [φ̈; û] as `RowsInequality` has it.

    `Command.errors` has b for it. Stiffness and damping have no meaning.

    Parameters
    ----------
    name, weight, level
        As of every `Task`.

    Raises
    ------
    OspaceError
        A completion test is given, or the task makes no sense.
    """

    unit: ClassVar[str] = "m/s^2"

    @property
    def units(self) -> None:
        """No error, but accelerations."""
        return None

    @abstractmethod
    def equations(self, at: Instant) -> tuple[npt.ArrayLike, npt.ArrayLike]:
        """Return A and b of the accelerations that are demanded.

        Parameters
        ----------
        at : Instant

        Returns
        -------
        A, b : (m, n + k), (m,) arrays
        """

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.completion is not None:
            raise OspaceError(f"task '{self.name}': rows have no error that could be small: leave out the completion")

"""Tables of phases: tasks, time-out, and what ends them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import Annotated, Protocol

from pydantic import Field, PrivateAttr

from ospace.scenario.schema.keys import is_a
from ospace.scenario.schema.plugin_tables import AnyInequality, InequalityTable
from ospace.scenario.schema.task_tables import AnyTask, TaskTable, UnknownTask
from ospace.scenario.table import Array, Either, Flag, Problem, Table, Text
from ospace.scenario.units import Quantity, Time


class GraspTable(Table):
    """The target's frame `fixture` is fixed to the chaser's frame `hand`, where they are near enough."""

    hand: Text = Field(description="A frame of the chaser")
    fixture: Text = Field(description="A frame of the target")
    target: Text | None = Field(None, description="Name of the target; needed where there are several")
    position: Annotated[float, Quantity("length", above=0.0, infinite=True)] = Field(
        0.01, description="Largest distance of the two"
    )
    angle: Annotated[float, Quantity("angle", above=0.0, infinite=True)] = Field(
        math.radians(1.0), description="Largest angle between the two"
    )


class Named(Protocol):
    """A table with a name."""

    name: str

    def path(self, name: str) -> str: ...  # noqa: D102


class PhaseTable(Table):
    """A phase: it ends when all completion tests hold, its motions are done and `duration` is over; or at `timeout`.

    Without a task it coasts: nothing acts.
    """

    name: Text = Field(description="A name of its own")
    timeout: Annotated[float, Quantity("time", above=0.0)] = Field(
        description="Longest time; the run then ends as failed"
    )
    duration: Time = Field(0.0, description="Shortest time; required where no task has a completion test")
    task: Annotated[list[AnyTask], Array] = Field(
        [], description="Tasks of this phase; an empty list takes none of all phases either, and it coasts"
    )
    inequality: Annotated[list[AnyInequality], Array] = Field([], description="Inequalities of this phase")
    grasp: GraspTable | None = Field(None, description="At the end, the target is grasped")
    release: Annotated[bool | str, Either(is_a(str), {"is": Text, "else": Flag})] = Field(
        False, description="At the end, the target that was grasped last is let go; true, or its name"
    )
    _shared: list[TaskTable] = PrivateAttr(default_factory=list)
    _shared_inequalities: list[InequalityTable] = PrivateAttr(default_factory=list)

    @property
    def tasks(self) -> list[TaskTable]:
        """Its own tasks, and those of all phases that it does not replace; none where its list of tasks is empty."""
        if "task" in self.model_fields_set and not self.task:
            return []
        names = [task.name for task in self.task]
        return [*self.task, *(task for task in self._shared if task.name not in names)]

    @property
    def inequalities(self) -> list[InequalityTable]:
        """Its own inequalities, and those of all phases that it does not replace."""
        names = [one.name for one in self.inequality]
        return [*self.inequality, *(one for one in self._shared_inequalities if one.name not in names)]

    def owns(self, task: TaskTable) -> bool:
        """Return whether a task is of this phase alone, and none of all phases."""
        return task in self.task

    @property
    def changes_robot(self) -> bool:
        """True where the phases after it have another robot: the target is grasped or let go."""
        return bool(self.release) or self.grasp is not None

    @property
    def earliest(self) -> float:
        """The shortest time that it takes: its motions are done, and tests have held from then on; s."""
        return max([self.duration, *(self.motion(task) + task.hold for task in self.tasks)])

    def motion(self, task: TaskTable) -> float:
        """Return how long the motion of one of its tasks takes, s; that of a task of all phases has begun before."""
        return task.motion if self.owns(task) else 0.0

    def mistakes(self) -> Iterator[Problem]:
        """Yield what does not fit together in a phase."""
        if self.duration > self.timeout:
            yield self.path("duration"), f"{self.duration:g} s is longer than the time-out, {self.timeout:g} s"
        yield from same_names("task", self.task)
        yield from same_names("inequality", self.inequality)
        tasks, given = self.tasks, {name for name, _ in self._noted}
        if not tasks and "task" not in given:
            for one in self.inequalities:
                yield one.key, f"phase '{self.name}' has no task: it coasts, and nothing keeps '{one.name}'"
        for task in tasks:
            motion = self.motion(task)
            if motion + task.hold > self.timeout:
                what = (
                    f"{motion + task.hold:g} s of motion and hold are longer than the time-out of phase '{self.name}'"
                )
                part = "goal.duration" if motion > self.timeout else "completion.hold"
                yield task.path(part), f"{what}, {self.timeout:g} s"
        done = any("completion" in task.model_fields_set or isinstance(task, UnknownTask) for task in tasks)
        if not (self.duration or done or "task" in given):
            yield self.key, "nothing ends the phase: give a duration, or a task with a completion test"
        if self.release and "grasp" in self.model_fields_set:
            yield self.path("release"), "a phase ends by a grasp or by a release, not by both"


def same_names(what: str, tables: Iterable[Named]) -> Iterator[Problem]:
    """Yield the tables that bear the name of one before them."""
    known: set[str] = set()
    for table in tables:
        if table.name in known:
            several = f"{what[:-1]}ies" if what.endswith("y") else f"{what}s"
            yield table.path("name"), f"two {several} are called '{table.name}'"
        known |= {table.name} - {""}

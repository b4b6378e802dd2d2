"""Tables of tasks and inequalities that a plugin brings: their keys are the arguments of its class."""

from __future__ import annotations

from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from typing import Annotated, Any, ClassVar, get_args, get_origin, get_type_hints

from pydantic import ConfigDict, Field, PlainValidator, WithJsonSchema, create_model

from ospace.control import Inequality, RowsInequality
from ospace.exceptions import OspaceError
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.scenario import plugins
from ospace.scenario.table import Flag, Table, Text
from ospace.scenario.units import Quantity

_PLAIN = {str: Text, bool: Flag, float: Annotated[float, Quantity("number")]}
SCHEMA = WithJsonSchema(
    {
        "type": "object",
        "properties": {
            "type": {"type": "string", "pattern": f"^{plugins.REFERENCE}$", "description": "Module and class"},
            "name": {"type": "string", "pattern": r"\S", "description": "A name of its own"},
        },
        "required": ["type", "name"],
        "description": "What a plugin brings; its other keys are the arguments of its class",
    }
)
"""Of a plugin's table: an editor knows no more of it."""


class PluginTable(Table):
    """A table of an object whose class a plugin brings."""

    type: str
    name: Text = Field(description="A name of its own")
    points_of: ClassVar[tuple[str, ...]] = ()
    """Keys that are points: frames of the robot."""

    @property
    def frames(self) -> dict[str, str]:
        """Names of frames of the robot by their keys."""
        return {key: getattr(self, key) for key in self.points_of if getattr(self, key)}

    def made(self, robot: SpaceRobot, **more: Any) -> Any:
        """Make the object for a robot, with `more` arguments; raise `OspaceError`, whatever its class raises."""
        made_of = plugins.found(self.type)
        given = {key: getattr(self, key) for key in self.model_fields_set - {"type"}}  # the class has the defaults
        given |= {key: robot.point(frame) for key, frame in self.frames.items()}
        given |= {key: robot for key, kind in _hints(made_of).items() if kind is SpaceRobot}
        try:
            return made_of(**given | more)
        except OspaceError:
            raise
        except Exception as error:
            raise OspaceError(f"{self.type} cannot be made: {type(error).__name__}: {error}") from error

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by the name of the class, whose table is made anew where the copy is."""
        return _restored, (type(self).__base__, self.type), self.__getstate__()


def reader(base: type[PluginTable], kinds: tuple[type, ...], remedy: str, refused: type[Table]) -> PlainValidator:
    """Return what reads the table of a plugin's class, one of `kinds`; `refused` stands for others."""

    def read(value: Any) -> Table:
        named = value.get("type") if isinstance(value, dict) else None
        try:
            if not isinstance(named, str):
                raise ValueError("missing: give module and class of a plugin, as my_module:MyClass")
            made_of = plugins.checked(named)
            if not (isinstance(made_of, type) and issubclass(made_of, kinds) and is_dataclass(made_of)):
                raise ValueError(f"'{named}' is {remedy}")
        except ValueError as error:
            stands = refused.model_validate(value)
            stands.note_instead("type", str(error))
            return stands
        return table_of(base, named).model_validate(value)

    return PlainValidator(read)


@cache
def table_of(base: type[PluginTable], reference: str) -> type[PluginTable]:
    """Return the table whose keys are those of `base`, and the arguments of the class that `reference` names."""
    made_of = plugins.found(reference)
    hints = _hints(made_of)
    keys: dict[str, Any] = {}
    for one in fields(made_of):
        kind = hints.get(one.name, Any)
        if one.name in (*base.model_fields, "reference") or kind is SpaceRobot or not one.init:
            continue
        if kind is OperationalPoint:
            kind = Text
        elif not _reads_itself(kind):
            kind = _PLAIN.get(kind, Any)
        default: dict[str, Any] = {} if one.default is MISSING else {"default": one.default}
        if one.default_factory is not MISSING:
            default = {"default_factory": one.default_factory}
        keys[one.name] = kind, Field(description=f"An argument of {made_of.__name__}", **default)
    made: Any = create_model(f"{made_of.__name__}Table", __base__=base, __module__=made_of.__module__, **keys)
    made.points_of = tuple(key for key, kind in hints.items() if kind is OperationalPoint)
    table: type[PluginTable] = made
    return table


def _reads_itself(kind: Any) -> bool:
    """Return whether a type says itself how it is read, as ``Annotated[float, Quantity("length")]``."""
    own = get_args(kind)[1:] if get_origin(kind) is Annotated else ()
    return any(hasattr(one, "__get_pydantic_core_schema__") for one in own)


def _hints(made_of: Any) -> dict[str, Any]:
    return get_type_hints(made_of, include_extras=True)


def _restored(base: type[PluginTable], reference: str) -> PluginTable:
    made = table_of(base, reference)
    return made.__new__(made)


class InequalityTable(PluginTable):
    """An inequality; its other keys are the arguments of its class."""

    def make(self, robot: SpaceRobot) -> Inequality | RowsInequality:
        """Make the inequality for a robot."""
        made: Inequality | RowsInequality = self.made(robot)
        return made


class UnknownInequality(InequalityTable):
    """Says what is wrong with the type, and nothing of keys that it may have."""

    model_config = ConfigDict(extra="ignore")


_REMEDY = "no dataclass that is a subclass of Inequality or RowsInequality"
AnyInequality = Annotated[
    InequalityTable, reader(InequalityTable, (Inequality, RowsInequality), _REMEDY, UnknownInequality), SCHEMA
]

"""Tables of a scenario on pydantic: whatever is wrong in one is noted by its key, and reading goes on."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Self, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ModelWrapValidatorHandler,
    PrivateAttr,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    field_validator,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, ErrorDetails, core_schema

from ospace.exceptions import closest
from ospace.quantities import shown

Problem = tuple[str, str]
"""A key, as ``phase[1].task[0].stiffness``, and what is wrong with it."""
_MISSING = object()
_NAMED = 20
"""Unknown keys of one table; to look for what was meant takes time."""
_MOST_TABLES, _LONGEST = 1000, 1000
"""Tables of an array; letters of a text."""
_TAG = "\0"
"""Begins what pydantic puts into a key to say which of several types it took."""


@dataclass
class _Wrong:
    """Stands for a value that could not be read, until its table notes why."""

    errors: list[ErrorDetails]


class Table(BaseModel):
    """A table: unknown, missing and wrong keys become `problems`, never an exception.

    A value that could not be read is NaN for a number, so that no comparison holds of it, and empty for a text; else it
    is as if it were left out, or None.
    """

    model_config = ConfigDict(extra="forbid", arbitrary_types_allowed=True, defer_build=True)
    _key: str = PrivateAttr("")
    _noted: list[Problem] = PrivateAttr(default_factory=list)

    @property
    def key(self) -> str:
        """Key of the table in the file."""
        return self._key

    def __eq__(self, other: object) -> bool:
        return self is other

    def __hash__(self) -> int:
        return id(self)

    @model_validator(mode="wrap")
    @classmethod
    def _read(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        if not isinstance(data, dict):
            raise ValueError(f"{shown(data)}: give a table, with keys and values")
        fields = cls.model_fields
        unknown = [name for name in data if name not in fields] if cls.model_config["extra"] == "forbid" else []
        required = {name: _MISSING for name, field in fields.items() if field.is_required()}
        table = handler(required | {name: value for name, value in data.items() if name in fields})
        for name, field in fields.items():
            value = getattr(table, name)
            if isinstance(value, _Wrong):
                setattr(table, name, _stand_in(field))
                table._noted += [(_joined((name, *error["loc"])), _what(error)) for error in value.errors]
            elif value is _MISSING:
                setattr(table, name, _stand_in(field))
                near = closest(name, unknown)
                table._noted.append((name, "missing" + (near if "did you mean" in near else "")))
        table._noted += [(_joined((name,)), f"unknown key{closest(name, fields)}") for name in unknown[:_NAMED]]
        if len(unknown) > _NAMED:
            table._noted.append(("", f"{len(unknown) - _NAMED} more unknown keys"))
        return table

    @field_validator("*", mode="wrap")
    @classmethod
    def _go_on(cls, value: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        try:
            return value if value is _MISSING else handler(value)
        except ValidationError as error:
            return _Wrong(error.errors(include_url=False, include_input=False))

    def tables(self, key: str = "") -> Iterator[Table]:
        """Give this table and those within it their keys, and yield them in order."""
        self._key = key
        yield self
        for name in type(self).model_fields:
            value = getattr(self, name)
            inner: dict[tuple[str | int, ...], Any] = {(name,): value}
            if isinstance(value, list):
                inner = {(name, k): one for k, one in enumerate(value)}
            elif isinstance(value, Mapping):
                inner = {(name, one): table for one, table in value.items()}
            for parts, table in inner.items():
                if isinstance(table, Table):
                    yield from table.tables(_joined(parts, key))

    def path(self, name: str) -> str:
        """Return the path of a key of this table; of the table with the empty name."""
        return f"{self._key}.{name}" if self._key and name else self._key or name

    def problems(self) -> Iterator[Problem]:
        """Yield all that is wrong in this table, without those within it."""
        yield from ((self.path(name), what) for name, what in self._noted)
        yield from self.mistakes()

    def note_instead(self, name: str, what: str) -> None:
        """Note what is wrong with a key, in place of what was noted of it."""
        self._noted = [problem for problem in self._noted if problem[0] != name] + [(name, what)]

    def mistakes(self) -> Iterable[Problem]:
        """Return what is wrong with keys together, by their paths."""
        return ()


def _stand_in(field: FieldInfo) -> Any:
    """Return what stands for a value that could not be read."""
    if field.annotation is float:
        return math.nan
    if field.annotation is str:
        return ""
    if get_origin(field.annotation) is list:
        return []
    return None if field.is_required() else field.get_default(call_default_factory=True)


def _joined(parts: Iterable[str | int], key: str = "") -> str:
    """Return a key's path, as ``task[0].point``."""
    for part in parts:
        if isinstance(part, int):
            key += f"[{part}]"
        elif not part.startswith(_TAG):
            key += f".{part}" if key else part
    return key


def _what(error: ErrorDetails) -> str:
    """Return what is wrong, without pydantic's prefix."""
    return str(error.get("ctx", {}).get("error", error["msg"]))


# -- types of keys -----------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Either:
    """Type of a key that can be written in several ways.

    Attributes
    ----------
    choose : function
        Returns the way that a value is written in, by its name in `ways`; None for none of them.
    ways : mapping of str to type
        Those that begin with ``_`` stand in no JSON Schema.
    remedy : str
        What to write instead of a value that is written in none of the ways.
    """

    choose: Callable[[Any], str | None]
    ways: Mapping[str, Any]
    remedy: str = ""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.tagged_union_schema(
            {_TAG + name: handler.generate_schema(kind) for name, kind in self.ways.items()},
            discriminator=lambda value: _TAG + (self.choose(value) or ""),
            custom_error_type="written",
            custom_error_message=self.remedy,
        )

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        union: Any = core
        while "choices" not in union:  # the validator of all fields stands around it
            union = union["schema"]
        offered = {name: way for name, way in union["choices"].items() if not name.startswith(_TAG + "_")}
        return handler({**union, "choices": offered})


@dataclass(frozen=True)
class OneOf:
    """Type of a key whose value is one of some texts."""

    choices: tuple[str, ...]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def _read(self, value: object) -> str:
        if _text(value) not in self.choices:
            raise ValueError(f"{shown(value)} is unknown{closest(str(value), self.choices)}")
        return str(value)

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"enum": list(self.choices)}


def _text(value: object) -> object:
    if not isinstance(value, str) or not value.strip():
        raise ValueError(f"{shown(value)} is not a text: put it in quotes")
    if len(value) > _LONGEST:
        raise ValueError(f"{shown(value)} has {len(value)} letters: give at most {_LONGEST}")
    if control := next((letter for letter in value if unicodedata.category(letter) == "Cc"), ""):
        raise ValueError(f"{shown(value)} has the control character U+{ord(control):04X}: leave it out")
    return value


def _flag(value: object) -> object:
    if not isinstance(value, bool):
        raise ValueError(f"{shown(value)}: give true or false")
    return value


@dataclass(frozen=True)
class WholeNumber:
    """Type of a key whose value is a whole number from 0 to `most`."""

    most: int

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def _read(self, value: object) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not 0 <= value <= self.most:
            raise ValueError(f"{shown(value)}: give a whole number from 0 to {self.most}")
        return value

    def __get_pydantic_json_schema__(self, core: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return {"type": "integer", "minimum": 0, "maximum": self.most}


def _array(value: object) -> object:
    if not isinstance(value, list) or not all(isinstance(one, dict) for one in value):
        raise ValueError("give an array of tables, with a head in double brackets for each")
    if len(value) > _MOST_TABLES:
        raise ValueError(f"{len(value)} tables: give at most {_MOST_TABLES}")
    return value


Text = Annotated[str, WithJsonSchema({"type": "string", "pattern": r"\S"}), BeforeValidator(_text)]
Flag = Annotated[bool, BeforeValidator(_flag)]
Level = Annotated[int, WholeNumber(1000)]
Seed = Annotated[int, WholeNumber(2**53)]
Array = BeforeValidator(_array)

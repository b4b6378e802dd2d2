"""Results as people and other programs take them: short when they are printed, and as a dictionary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

_LONGEST = 60  # characters of one value


class Result:
    """Base of dataclasses that hold arrays."""

    def __init_subclass__(cls, **given: Any) -> None:
        super().__init_subclass__(**given)
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = Result.__repr__  # type: ignore[method-assign]  # dataclasses keep one that is there

    def __repr__(self) -> str:
        shown = (f"{name}={_short(value)}" for name, value in self.as_dict().items())
        return f"{type(self).__name__}({', '.join(shown)})"

    def as_dict(self) -> dict[str, Any]:
        """Return what it holds, by name; arrays are shared, not copied.

        Returns
        -------
        dict of str to object
        """
        shown = (one.name for one in fields(self) if one.repr)  # type: ignore[arg-type]  # a dataclass, as said above
        return {name: getattr(self, name) for name in shown}


def _short(value: object) -> str:
    """Return an array by its shape, and others in few letters."""
    if isinstance(value, np.ndarray):
        return f"array{value.shape}" if value.ndim else f"{value}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, Mapping) and len(repr(value)) > _LONGEST:
        return f"{{{len(value)}: {', '.join(map(str, value))[:_LONGEST]}}}"
    if isinstance(value, Sequence) and not isinstance(value, str) and len(repr(value)) > _LONGEST:
        return f"[{len(value)} {type(value[0]).__name__}]"
    text = repr(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"

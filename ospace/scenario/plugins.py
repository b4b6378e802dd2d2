"""Code that a scenario names, as ``my_module:Height``: it runs only where the user names the module as well."""

from __future__ import annotations

import importlib
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from ospace.exceptions import OspaceError, closest, printable

REFERENCE = r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*"
"""Module and name."""
_allowed: ContextVar[frozenset[str]] = ContextVar("allowed", default=frozenset())


def is_reference(text: object) -> bool:
    """Return whether a text names code."""
    return isinstance(text, str) and ":" in text


@contextmanager
def allowed(modules: Iterable[str]) -> Iterator[None]:
    """Import modules, and let scenarios that are read meanwhile name what is in them.

    Raises
    ------
    OspaceError
        One cannot be imported; names it, and what it raised.
    """
    if isinstance(modules, str):
        modules = (modules,)
    names = frozenset(modules)
    for name in sorted(names):
        _imported(name)
    before = _allowed.set(names)
    try:
        yield
    finally:
        _allowed.reset(before)


def checked(reference: str) -> Any:
    """Return what a scenario that is read names; raise `ValueError` where it may not, or there is no such thing."""
    if not re.fullmatch(REFERENCE, reference):
        raise ValueError(f"'{printable(reference)}' names no code: give module and name, as my_module:MyTask")
    module = reference.partition(":")[0]
    if module not in _allowed.get():
        raise ValueError(
            f"'{reference}' is code of the module '{module}', which runs only where you name it: "
            f"--plugin {module}, or load(…, plugins=['{module}'])"
        )
    try:
        return found(reference)
    except OspaceError as error:
        raise ValueError(str(error)) from None


def found(reference: str) -> Any:
    """Return what a scenario that has been read names.

    Raises
    ------
    OspaceError
        The module cannot be imported, or has no such name.
    """
    name, _, what = reference.partition(":")
    module = _imported(name)
    if not hasattr(module, what):
        raise OspaceError(
            f"module '{name}' has no '{what}'{closest(what, [one for one in vars(module) if one[0] != '_'])}"
        )
    return getattr(module, what)


def _imported(name: str) -> Any:
    if not re.fullmatch(REFERENCE.partition(":")[0], name):
        raise OspaceError(f"plugin {name!r} is not the name of a module: give my_module for a file my_module.py")
    try:
        return importlib.import_module(name)
    except Exception as error:
        raise OspaceError(f"plugin '{name}' cannot be imported: {type(error).__name__}: {error}") from error

"""The progress bar of all verbs: on a terminal, on standard error; with ``NO_COLOR`` there is none."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ospace.cli import output

_COMPILING = "compiling kernels, once for this machine (seconds each)"


@contextmanager
def bar(given: argparse.Namespace, what: str, total: int) -> Iterator[Callable[[int], None]]:
    """Yield what takes how much of `total` is done, and raises if the user has interrupted.

    Says when kernels are being compiled, in a pipe too.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from ospace.cli.console import no_colour
    from ospace.kernels.jit import cache

    console = Console(stderr=True)
    drawn = console.is_terminal and not no_colour()  # a bar is made of escapes
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not drawn) as shown:
        task = shown.add_task(what, total=total)
        said = False

        def compiling(number: int, of: int) -> None:
            nonlocal said
            which = f"compiling {number} of {of} kernels, once for this machine" if of > 1 else _COMPILING
            shown.update(task, description=which if of else what, refresh=True)
            if of and not said and not drawn:
                output.tell(_COMPILING)
                said = True

        def advance(done: int) -> None:
            given.refuse_if_interrupted()
            shown.update(task, completed=done)

        cache.listeners.append(compiling)
        try:
            yield advance
        finally:
            cache.listeners.remove(compiling)

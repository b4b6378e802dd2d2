"""The progress bar of all verbs: on a terminal, on standard error."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def bar(given: argparse.Namespace, what: str, total: int) -> Iterator[Callable[[int], None]]:
    """Yield what takes how much of `total` is done, and raises if the user has interrupted.

    Says once for a machine that kernels are being compiled, in a pipe too.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    from ospace.kernels import cache

    fresh = cache.is_empty()
    at_first = "compiling kernels, once for this machine (about 20 s)" if fresh else what
    console = Console(stderr=True)
    if fresh and not console.is_terminal:
        print(f"ospace: {at_first}", file=sys.stderr)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as shown:
        task = shown.add_task(at_first, total=total)

        def advance(done: int) -> None:
            given.refuse_if_interrupted()
            shown.update(task, completed=done, description=what)

        yield advance

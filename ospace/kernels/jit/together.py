"""Several entries compiled at once, in as many processes as there are cores.

What a child process compiles, the cache hands over; what it leaves undone, whatever became of it, is compiled here.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, nullcontext
from importlib import import_module
from pathlib import Path
from typing import Any

from ospace.kernels.jit import cache
from ospace.kernels.jit.compile import kinds_of

_CHILD = "import sys; sys.path.insert(0, sys.argv[1]); from ospace.kernels.jit import together; together.serve()"
_ROOT = Path(__file__).parents[3]

Job = tuple[Any, tuple[Any, ...]]
"""An entry, and the types of its arguments."""


def compile_together(calls: Iterable[tuple[Any, Iterable[Any]]]) -> None:
    """Compile entries for arguments of the types given with them, or load them where they are kept.

    Put first what takes longest.
    """
    jobs = [(entry, kinds_of(arguments)) for entry, arguments in calls if hasattr(entry, "compile")]
    missing = [job for job in jobs if not _is_there(*job)]
    left = deque(missing)

    def take() -> Job | None:
        try:
            job = left.popleft()
        except IndexError:
            return None
        cache.report(len(missing) - len(left), len(missing))
        return job

    with cache.reported_together() if missing else nullcontext(), ExitStack() as running:
        children = min(_cores(), len(missing)) - 1 if cache.directory() else 0
        feeders = [running.enter_context(_child(take)) for _ in range(children)]
        while job := take():
            job[0].compile(job[1])
        for feeder in feeders:
            feeder.join()
    for entry, kinds in jobs:
        entry.compile(kinds)


def _is_there(entry: Any, kinds: tuple[Any, ...]) -> bool:
    return kinds in entry.overloads or cache.is_kept(entry)


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _child(take: Callable[[], Job | None]) -> Iterator[threading.Thread]:
    """Run a child process, and yield the thread that hands it one job after the other."""
    try:
        process = subprocess.Popen(
            [sys.executable, "-c", _CHILD, str(_ROOT)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
    except (OSError, TypeError, ValueError):  # no such program, or none known: this process does all
        idle = threading.Thread(target=lambda: None)
        idle.start()
        yield idle
        return
    feeder = threading.Thread(target=_feed, args=(process, take), daemon=True)
    feeder.start()
    try:
        yield feeder
    finally:
        process.kill()
        feeder.join()
        process.communicate()


def _feed(process: subprocess.Popen[bytes], take: Callable[[], Job | None]) -> None:
    """Hand over jobs while the child does them."""
    requests, results = process.stdin, process.stdout
    if requests is None or results is None:
        return
    try:
        while results.readline() and (job := take()):
            entry, kinds = job
            pickle.dump((entry.__module__, entry.__name__, kinds), requests)
            requests.flush()
    except OSError:
        pass  # it is gone


def serve() -> None:
    """Compile what is asked for on standard input; one line on standard output asks for the next."""
    while True:
        sys.stdout.write("\n")
        sys.stdout.flush()
        try:
            module, name, kinds = pickle.load(sys.stdin.buffer)  # from the parent process alone
        except EOFError:
            return
        getattr(import_module(module), name).compile(kinds)

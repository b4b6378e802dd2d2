"""The `ospace` command: one verb a file, each imported only when it is called."""

from __future__ import annotations

import argparse
import importlib
import io
import os
import re
import signal
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import ospace
from ospace.cli import output

EXIT_FINDINGS, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130
_VERBS = ("check", "compose", "view", "run", "plot", "bench", "list")
XACRO_VALUE = re.compile(r"([A-Za-z_]\w*):=(.*)", re.DOTALL)
# The matrices here are small: threads of the linear algebra would wait for each other longer than they work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def parser() -> argparse.ArgumentParser:
    """Build the parser of all verbs; each sets ``run``, which returns the exit status and the text to print."""
    top = argparse.ArgumentParser(
        prog="ospace", description="Operational-space dynamics of space robots, from URDF, checked against Pinocchio."
    )
    top.add_argument("--version", action="version", version=f"ospace {ospace.__version__}")
    verbs = top.add_subparsers(dest="verb", metavar="VERB", required=True)
    for verb in _VERBS:
        importlib.import_module(f"ospace.cli.{verb}").add_to(verbs)
    return top


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb.

    Returns
    -------
    int
        0 sound, 1 findings of level error, 2 unreadable input, wrong usage or unwritable output, 130 interrupted.
    """
    from ospace.exceptions import OspaceError

    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal that lacks a letter shows another
    try:
        with _interrupts() as (refuse_if_interrupted, clear_interrupt), warnings.catch_warnings():
            warnings.showwarning = lambda message, *where, **more: print(f"ospace: {message}", file=sys.stderr)
            given = _parsed(list(sys.argv[1:] if arguments is None else arguments))
            given.refuse_if_interrupted, given.clear_interrupt = refuse_if_interrupted, clear_interrupt
            status, text = given.run(given)
            refuse_if_interrupted()
        return int(status) if output.printed(text) else EXIT_USAGE
    except OspaceError as error:
        print(f"ospace: error: {error}", file=sys.stderr)
        return EXIT_USAGE
    except KeyboardInterrupt:
        print("ospace: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except OSError as error:
        print(f"ospace: error: {error}", file=sys.stderr)
        return EXIT_USAGE


def _parsed(arguments: list[str]) -> argparse.Namespace:
    """Parse; arguments of a xacro, NAME:=VALUE, may stand anywhere, as for xacro itself."""
    values = {match[1]: match[2] for match in map(XACRO_VALUE.fullmatch, arguments) if match}
    top = parser()
    if arguments[:1] == ["compose"]:  # where they belong to the part before them
        return top.parse_args(arguments)
    given = top.parse_args([argument for argument in arguments if not XACRO_VALUE.fullmatch(argument)])
    if values and "xacro_args" not in given:
        name, value = next(iter(values.items()))
        top.error(f"{name}:={value} is an argument of a xacro, which ospace {given.verb} does not read")
    given.xacro_args = values
    return given


def takes_robot(verb: argparse.ArgumentParser) -> None:
    """Let the verb read a robot: arguments and folders of packages of a xacro, and which link is the base."""
    verb.set_defaults(xacro_args={})
    verb.add_argument(
        "--package-dir",
        metavar="DIR",
        action="append",
        default=[],
        help="where package:// names of meshes and $(find PACKAGE) of a xacro are looked up; repeatable",
    )
    verb.add_argument(
        "--root", metavar="LINK", help="link that becomes the base, with what hangs from it (default: the only root)"
    )


def find(text: str, *, scenario: bool = False) -> Path:
    """Return the file, or the robot or scenario of that name that comes with ospace."""
    from ospace import models

    if os.path.lexists(text) or Path(text).name != text or Path(text).suffix:
        return Path(text)
    return models.scenario(text) if scenario else models.path(text)


def package_dirs(given: argparse.Namespace) -> list[Path]:
    """Return the folders given with --package-dir; raise `OspaceError` where one is not there."""
    from ospace.exceptions import OspaceError

    folders = [Path(folder) for folder in given.package_dir]
    for folder in folders:
        if not folder.is_dir():
            raise OspaceError(f"--package-dir {folder}: no such folder")
    return folders


@contextmanager
def _interrupts() -> Iterator[tuple[Callable[[], None], Callable[[], None]]]:
    """Remember Ctrl-C: imports and finalizers swallow the exception, and the latter print it.

    Yields what raises it again, and what forgets it, for a verb that is meant to end so.
    """
    seen: list[int] = []

    def remember(number: int, frame: object) -> None:
        seen.append(number)
        raise KeyboardInterrupt

    def refuse() -> None:
        if seen:
            raise KeyboardInterrupt

    def report(ignored: sys.UnraisableHookArgs) -> None:
        if not issubclass(ignored.exc_type, KeyboardInterrupt):
            sys.__unraisablehook__(ignored)

    try:
        before = signal.signal(signal.SIGINT, remember)
    except ValueError:  # not the main thread, which alone is interrupted
        yield refuse, seen.clear
        return
    sys.unraisablehook, previous = report, sys.unraisablehook
    try:
        yield refuse, seen.clear
    finally:
        sys.unraisablehook = previous
        signal.signal(signal.SIGINT, before)

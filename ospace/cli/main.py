"""The `ospace` command: one verb a file, each imported only when it is called."""

from __future__ import annotations

import argparse
import importlib
import io
import os
import re
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import ospace
from ospace.cli import output
from ospace.cli.interrupts import Interrupts

EXIT_FINDINGS, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130
_VERBS = ("check", "compose", "view", "map", "run", "plot", "bench", "list")
XACRO_VALUE = re.compile(r"([A-Za-z_]\w*):=(.*)", re.DOTALL)
# The matrices here are small: threads of the linear algebra would wait for each other longer than they work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["MPLBACKEND"] = "agg"  # figures go into files, whatever windows the user has set, or misspelt
_NO_MEMORY_TO_LOAD = ("failed to map segment", "cannot allocate memory")


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
    interrupts = Interrupts(main.__code__)
    try:
        with interrupts, warnings.catch_warnings():
            warnings.showwarning = lambda message, *where, **more: output.tell(str(message))
            given = _parsed(list(sys.argv[1:] if arguments is None else arguments))
            given.refuse_if_interrupted, given.clear_interrupt = interrupts.refuse, interrupts.clear
            status, text = given.run(given)
            interrupts.refuse()
        return int(status) if output.printed(text) else EXIT_USAGE
    except OspaceError as error:
        output.tell(f"error: {error}")
        return EXIT_USAGE
    except KeyboardInterrupt:
        output.tell("interrupted")
        return EXIT_INTERRUPTED
    except Exception as error:
        if interrupts.seen:  # a library made another error of it
            output.tell("interrupted")
            return EXIT_INTERRUPTED
        if _lacks_memory(error):
            output.tell("error: not enough memory")
        elif isinstance(error, OSError):
            output.tell(f"error: {error}")
        else:
            raise
        return EXIT_USAGE


def _lacks_memory(error: BaseException | None) -> bool:
    """Return whether memory was asked for in vain, by a library too, which may make another error of it."""
    while error is not None:
        if isinstance(error, MemoryError) or any(text in str(error).lower() for text in _NO_MEMORY_TO_LOAD):
            return True
        error = error.__cause__ or error.__context__
    return False


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

"""The `ospace` command: one verb a file, each imported only when it is called."""

from __future__ import annotations

import argparse
import importlib
import io
import os
import re
import shlex
import sys
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NoReturn

import ospace
from ospace.cli import os_errors, output, streams
from ospace.cli.interrupts import Interrupts

EXIT_FINDINGS, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130
_VERBS = ("check", "compose", "view", "map", "run", "plot", "bench", "list", "completion")
XACRO_VALUE = re.compile(r"([A-Za-z_]\w*):=(.*)", re.DOTALL)
# The matrices here are small: threads of the linear algebra would wait for each other longer than they work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["MPLBACKEND"] = "agg"  # figures go into files, whatever windows the user has set, or misspelt
_SPARE = 8_000_000
"""Bytes that are kept for what is told where memory has run out."""
_NO_MEMORY_TO_LOAD = ("failed to map segment", "cannot allocate memory")


class Help(argparse.HelpFormatter):
    """Keeps paragraphs of a description apart, and lines that are indented as they are."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        return "\n\n".join(
            part if "\n  " in part else super(Help, self)._fill_text(part, width, indent) for part in text.split("\n\n")
        )


class Parser(argparse.ArgumentParser):
    """A parser that takes no abbreviations, and whose help has paragraphs."""

    def __init__(self, **given: Any) -> None:
        super().__init__(allow_abbrev=False, formatter_class=Help, **given)

    def error(self, message: str) -> NoReturn:
        """End with the usage, and a message of which a terminal obeys nothing."""
        from ospace.exceptions import printable_lines

        super().error(printable_lines(message))


def parser() -> Parser:
    """Build the parser of all verbs; each sets ``run``, which returns the exit status and the text to print.

    The help of a verb ends with the `EXAMPLES` of its module, and the address of its `PAGE`.
    """
    top = Parser(
        prog="ospace",
        description="Operational-space dynamics of space robots, from URDF, checked against Pinocchio.",
        epilog=_epilog(("ospace check chaser_24dof", "ospace list"), "index"),
    )
    top.add_argument("-V", "--version", action="version", version=f"ospace {ospace.__version__}")
    verbs = top.add_subparsers(dest="verb", metavar="VERB", required=True)
    for verb in _VERBS:
        module = importlib.import_module(f"ospace.cli.{verb}")
        module.add_to(verbs)
        verbs.choices[verb].epilog = _epilog(module.EXAMPLES, module.PAGE)
    return top


def _epilog(examples: Sequence[str], page: str) -> str:
    lines = "".join(f"\n  {one}" for one in examples)
    return f"examples:{lines}\n\nMore: {ospace.DOCUMENTATION}{page}.html"


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
    interrupts, spare = Interrupts(main.__code__), bytearray(_SPARE)
    try:
        with interrupts, warnings.catch_warnings():
            warnings.showwarning = lambda message, *where, **more: output.tell(str(message))
            streams.current = streams.Streams()
            given = _parsed(list(sys.argv[1:] if arguments is None else arguments))
            given.command = shlex.join(["ospace", *(sys.argv[1:] if arguments is None else arguments)])
            given.refuse_if_interrupted, given.clear_interrupt = interrupts.refuse, interrupts.clear
            status, text = given.run(given)
            interrupts.refuse()
        return int(status) if output.printed(text) and output.delivered() else EXIT_USAGE
    except OspaceError as error:
        output.tell(f"error: {error}")
        return EXIT_USAGE
    except KeyboardInterrupt:
        output.tell("interrupted")
        return EXIT_INTERRUPTED
    except Exception as error:
        del spare
        if interrupts.seen:  # a library made another error of it
            output.tell("interrupted")
            return EXIT_INTERRUPTED
        if _lacks_memory(error):
            output.tell("error: not enough memory")
        elif isinstance(error, OSError):
            output.tell(f"error: {os_errors.text(error)}")
        else:
            raise
        return EXIT_USAGE
    finally:
        streams.current.close()


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
    if not arguments:
        top.print_help()
        top.exit()
    _check_verb(top, arguments[0])
    if arguments[:1] == ["compose"]:  # where they belong to the part before them
        return top.parse_args(arguments)
    given, unknown = top.parse_known_args([one for one in arguments if not XACRO_VALUE.fullmatch(one)])
    if unknown:
        _refuse_unknown(verbs_of(top)[given.verb], unknown)
    if values and "xacro_args" not in given:
        name, value = next(iter(values.items()))
        top.error(f"{name}:={value} is an argument of a xacro, which ospace {given.verb} does not read")
    given.xacro_args = values
    return given


def verbs_of(top: Parser) -> Mapping[str, argparse.ArgumentParser]:
    """Return the parsers of the verbs by their names."""
    (verbs,) = (action for action in top._actions if isinstance(action, argparse._SubParsersAction))
    return verbs.choices


def _check_verb(top: Parser, verb: str) -> None:
    from ospace.exceptions import closest, printable

    if not verb.startswith("-") and verb not in _VERBS:
        top.error(f"no verb '{printable(verb)}'{closest(verb, _VERBS)}")


def _refuse_unknown(verb: argparse.ArgumentParser, unknown: Sequence[str]) -> None:
    from ospace.exceptions import closest, printable

    first = unknown[0].partition("=")[0]
    near = closest(first, verb._option_string_actions) if first.startswith("--") else ""
    verb.error(f"unrecognized arguments: {printable(' '.join(unknown))}{near.partition('; known')[0]}")


def takes_report(verb: argparse.ArgumentParser) -> None:
    """Let the verb print its report to PDF, and say whose it is."""
    verb.add_argument("--pdf", metavar="FILE", type=output.pdf, help="print the report to PDF, by Chromium")
    verb.add_argument("--project", metavar="TEXT", default="", help="project that the report is for")
    verb.add_argument("--author", metavar="TEXT", default="", help="author of the report")


def check_report_options(given: argparse.Namespace) -> None:
    """Refuse what a report cannot be made with, or a word for one that is not made, before any work is done."""
    for option in ("project", "author"):
        if getattr(given, option) and not (given.html or given.pdf):
            given.refuse_usage(f"--{option} is for a report: give it with --html or --pdf")
    if given.pdf:
        from ospace.visual import browser

        browser.find()


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

    if text == "-":
        return streams.current.standard_input(".toml" if scenario else ".urdf")
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

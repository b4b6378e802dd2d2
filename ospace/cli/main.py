"""The `ospace` command: one verb a file, each imported only when it is called."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

import ospace

EXIT_FINDINGS, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130
_VERBS = ("check",)
# The matrices here are small: threads of the linear algebra would wait for each other longer than they work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def parser() -> argparse.ArgumentParser:
    """Build the parser of all verbs."""
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
        0 sound, 1 findings of level error, 2 unreadable input or wrong usage, 130 interrupted.
    """
    from ospace.exceptions import OspaceError

    try:
        given = parser().parse_args(arguments)
        status: int = given.run(given)
        sys.stdout.flush()
        return status
    except OspaceError as error:
        print(f"ospace: error: {error}", file=sys.stderr)
        return EXIT_USAGE
    except KeyboardInterrupt:
        print("ospace: interrupted", file=sys.stderr)
        return EXIT_INTERRUPTED
    except BrokenPipeError:  # the reader of a pipe has gone; nothing may be written at exit either
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_USAGE

"""Output of a verb, printed and written: nothing over what it reads, and the result before a report that may fail."""

from __future__ import annotations

import argparse
import os
import stat
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

from ospace.cli import streams
from ospace.cli.dialect import shell

FIGURES = (".svg", ".png", ".pdf")
_STANDARD_OUTPUT = 1


def figure(text: str) -> Path:
    """Return the path of a figure, for argparse."""
    if text == "-":
        return file(text, FIGURES[0])
    if Path(text).suffix not in FIGURES:
        raise argparse.ArgumentTypeError(f"'{text}' ends neither in {' nor '.join(FIGURES)}")
    return file(text)


def pdf(text: str) -> Path:
    """Return the path of a PDF, for argparse."""
    if text != "-" and Path(text).suffix.lower() != ".pdf":
        raise argparse.ArgumentTypeError(f"'{text}' does not end in .pdf")
    return file(text, ".pdf")


def file(text: str, suffix: str = "") -> Path:
    """Return the path of a file in a folder that is there, for argparse; ``-`` is standard output, as `suffix` says."""
    if text == "-":
        return streams.current.standard_output(suffix)
    path = Path(text)
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}': no such folder '{path.parent}'")
    if path.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}' is a folder")
    return path


# -- before the work ---------------------------------------------------------------------------------------------


def distinct(inputs: Iterable[Path], outputs: Iterable[Path | None]) -> None:
    """Raise `OspaceError` where an output is an input, another output, or standard output; None stands for no file."""
    from ospace.exceptions import OspaceError, printable

    inputs, before = tuple(inputs), list[Path]()
    for out in filter(None, outputs):
        if _is_standard_output(out):
            raise OspaceError(printable(f"{out}: is standard output, where the result is printed; give another file"))
        for one in inputs:
            if _same(out, one):
                raise OspaceError(printable(f"{out}: is what is read, {one}; give another file"))
        for one in before:
            if _same(out, one):
                raise OspaceError(printable(f"{out}: is to be written twice, as {one} too; give another file"))
        before.append(out)


def _same(one: Path, other: Path) -> bool:
    """Return whether two paths lead to one file, which need not be there yet; a device may be both read and written."""
    if one.exists() and other.exists():
        return one.is_file() and one.samefile(other)
    return os.path.realpath(one) == os.path.realpath(other)


def _is_standard_output(path: Path) -> bool:
    """Return whether what is printed goes to the same file or pipe; a terminal or ``/dev/null`` can take both."""
    try:
        printed = os.fstat(_STANDARD_OUTPUT)
        return os.path.samestat(os.stat(path), printed) and not stat.S_ISCHR(printed.st_mode)
    except OSError:  # closed, or not there yet
        return False


def writable(*paths: Path | None) -> None:
    """Raise `OSError` where one of `paths` cannot be written; what is there stays as it is, and nothing else comes."""
    from ospace.files import check_writable

    for path in filter(None, paths):
        check_writable(path)


# -- beside the work and after it --------------------------------------------------------------------------------


def tell(text: str) -> None:
    """Print a remark on standard error, of which a terminal obeys nothing; it is lost where that is closed or full."""
    from ospace.exceptions import printable_lines

    if sys.stderr is None:  # print would take standard output
        return
    with suppress(OSError):
        print(printable_lines(f"ospace: {shell(streams.current.named(text))}"), file=sys.stderr, flush=True)


def printed(text: str) -> bool:
    """Print; report on standard error where the text cannot be written, and return whether it was."""
    if not text:
        return True
    if sys.stdout is None:  # closed by the caller: print would drop the text
        tell("error: cannot write the result: standard output is closed")
        return False
    try:
        if streams.current.pending is None:
            print(text, end="", flush=True)
        else:  # which standard output is for
            print(streams.current.named(text), end="", file=sys.stderr)
    except OSError as error:
        return _not_written(error)
    return True


def delivered() -> bool:
    """Write what ``-`` is to take to standard output; report where that fails, and return whether it was written."""
    try:
        streams.current.deliver()
    except OSError as error:
        return _not_written(error)
    return True


def _not_written(error: OSError) -> bool:
    if not isinstance(error, BrokenPipeError):  # where the reader of a pipe has gone, nobody is left to read it
        tell(f"error: cannot write the result: {error.strerror}")
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # nothing may be written at exit either
    return False


def written(path: Path, what: str, write: Callable[[], object]) -> bool:
    """Write; report on standard error why that failed, so that the rest goes on, and return whether it succeeded.

    Parameters
    ----------
    path : Path
    what : str
        It holds, as ``"report"``.
    write : function
    """
    from ospace.exceptions import OspaceError

    try:
        write()
    except (OSError, OspaceError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        tell(f"error: {path}: no {what}: {reason}")
        return False
    return True

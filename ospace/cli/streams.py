"""``-``: standard input in the place of a file that is read, standard output in that of one that is written.

What is read is kept in a file of its own, since readers go through a file more than once. What is written goes to one
first, and to standard output when all is done; messages about it go to standard error then.
"""

from __future__ import annotations

import re
import shutil
import sys
import tempfile
from pathlib import Path

_MOST = 1_000_000_000
"""Bytes that are read."""
_CHUNK = 1 << 20
_XACRO = b"http://www.ros.org/wiki/xacro"


class Streams:
    """Files of one command that are given as ``-``."""

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._read = False
        self.pending: Path | None = None

    def close(self) -> None:
        """Remove the files."""
        if self._folder is not None:
            self._folder.cleanup()

    def standard_input(self, suffix: str) -> Path:
        """Return a file that holds standard input; ``.xacro`` comes behind its suffix ``.urdf`` where it is one.

        Raises
        ------
        OspaceError
            It is a terminal, closed, too long, or was read before.
        """
        from ospace.exceptions import OspaceError

        if self._read:
            raise OspaceError("standard input, '-', is given twice: it can be read once")
        if sys.stdin is None or sys.stdin.isatty():
            raise OspaceError("standard input, '-', is a terminal: pipe a file into it, as in 'ospace check - < FILE'")
        self._read = True
        file = self._in_folder(f"standard_input{suffix}")
        with file.open("wb") as out:
            left = _MOST
            while chunk := sys.stdin.buffer.read(_CHUNK):
                left -= len(chunk)
                if left < 0:
                    raise OspaceError(f"standard input, '-', is longer than {_MOST} bytes: give a file")
                out.write(chunk)
        with file.open("rb") as beginning:
            if suffix == ".urdf" and _XACRO in beginning.read(_CHUNK):
                return file.rename(file.with_name(f"{file.name}.xacro"))
        return file

    def standard_output(self, suffix: str) -> Path:
        """Return a file whose content `deliver` writes to standard output; raise `OspaceError` for a second one."""
        from ospace.exceptions import OspaceError

        if self.pending is not None:
            raise OspaceError("standard output, '-', is given twice: it can take one file")
        self.pending = self._in_folder(f"standard_output{suffix}")
        return self.pending

    def deliver(self) -> None:
        """Write what was written for standard output to it."""
        if self.pending is not None and self.pending.is_file():
            with self.pending.open("rb") as file:
                shutil.copyfileobj(file, sys.stdout.buffer)
            sys.stdout.flush()

    def named(self, text: str) -> str:
        """Return a text that calls the files by what they stand for."""
        if self._folder is None:
            return text
        return re.sub(rf"{re.escape(self._folder.name)}/standard_(input|output)[.\w]*", r"standard \1", text)

    def _in_folder(self, name: str) -> Path:
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="ospace-")
        return Path(self._folder.name) / name


current = Streams()
"""Those of the command that runs, as `ospace.cli.main` sets them."""


def title(text: str) -> str:
    """Return the name by which people know the file that they gave."""
    return "standard input" if text == "-" else text

"""Files that appear when they are whole, and are read so."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from ospace.exceptions import OspaceError

_PART, _LONGEST_SUFFIX = ".ospace-", 16


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to, beside `path` and of its suffix; it takes the place of `path` once all is written.

    It is a new file of a random name, so that several may write to one `path`: the last one stays. Where writing
    fails, `path` stays as it was, and the error names it. A link stays one, and the file that it leads to is replaced.
    Devices, pipes, and files in folders that take no other are written themselves.

    Examples
    --------
    >>> with replacing("robot.html") as part:
    ...     part.write_text(page, encoding="utf-8")
    """
    file, given = Path(os.path.realpath(path)), Path(path)
    with _named(path):
        if given.exists() and not (given.is_file() and os.access(file.parent, os.W_OK)):
            yield given
            return
        part = _new_part(file, given.suffix)
        try:
            yield part
            if file.exists():
                shutil.copymode(file, part)
            os.replace(part, file)
        finally:
            part.unlink(missing_ok=True)


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write a text in UTF-8, as `replacing` does; return the path."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")
    return Path(path)


def check_writable(path: str | os.PathLike[str]) -> None:
    """Raise `OSError` where `replacing` could not write `path`; what is there stays, and nothing else comes."""
    file, given = Path(os.path.realpath(path)), Path(path)
    with _named(path):
        if not given.exists():
            _new_part(file, given.suffix).unlink()
        elif given.is_file() or given.is_dir():  # opening a device or pipe has side effects
            given.open("ab").close()


def _new_part(file: Path, suffix: str) -> Path:
    """Make an empty file beside `file`, of a name that nobody can have planted anything under, and not too long."""
    part = file.with_name(f"{_PART}{secrets.token_hex(8)}{suffix if len(suffix) <= _LONGEST_SUFFIX else ''}")
    os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0), 0o666))
    return part


@contextmanager
def _named(path: str | os.PathLike[str]) -> Iterator[None]:
    """Let an `OSError` name `path`: a write names nothing, and to open the part, or rename it, what nobody knows of.

    Libraries that cannot write, as to a full disk, and then fail to close their file, make other errors of it.
    """
    try:
        yield
    except OspaceError:
        raise
    except Exception as error:
        first: BaseException | None = error
        while first is not None and not isinstance(first, OSError):
            first = first.__context__
        if first is None or first.errno is None or _is_named(first):
            raise
        raise OSError(first.errno, first.strerror, os.fspath(path)) from error


def _is_named(error: OSError) -> bool:
    """Return whether the error names a file that the user knows of."""
    return error.filename is not None and not Path(os.fsdecode(error.filename)).name.startswith(_PART)


def open_regular(path: str | os.PathLike[str]) -> BinaryIO:
    """Open a file to be read; a pipe or device, which might never end or never begin, is refused by an `OSError`."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0))
    mode = os.fstat(descriptor).st_mode
    if stat.S_ISREG(mode):
        return os.fdopen(descriptor, "rb")
    os.close(descriptor)
    number, what = (errno.EISDIR, "is a folder") if stat.S_ISDIR(mode) else (errno.EINVAL, "is not a regular file")
    raise OSError(number, what, os.fspath(path))

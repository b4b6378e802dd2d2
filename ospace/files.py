"""Files that appear when they are whole, and are read so."""

from __future__ import annotations

import os
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ospace.exceptions import OspaceError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield a path to write to, beside `path` and of its suffix; it takes the place of `path` once all is written.

    Where that fails, `path` stays as it was. A link stays one, and the file that it leads to is replaced. Devices,
    pipes, and files in folders that take no other are written themselves.

    Examples
    --------
    >>> with replacing("robot.html") as part:
    ...     part.write_text(page, encoding="utf-8")
    """
    file, given = Path(os.path.realpath(path)), Path(path)
    if given.exists() and not (given.is_file() and os.access(file.parent, os.W_OK)):
        yield given
        return
    part = file.with_name(f".{file.name}.part{given.suffix}")
    try:
        yield part
        if file.exists():
            shutil.copymode(file, part)
        os.replace(part, file)
    finally:
        part.unlink(missing_ok=True)


def arrays(path: str | os.PathLike[str], what: str) -> dict[str, Any]:
    """Return the arrays of an ``.npz`` file by their names.

    Raises
    ------
    OspaceError
        The file, which should hold `what`, cannot be read, is cut off, or is another.
    """
    try:
        with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}
    except OSError as error:
        reason = error.strerror or str(error)
    except (ValueError, TypeError, AttributeError, EOFError, zipfile.BadZipFile, zlib.error):
        reason = "it is no whole .npz file of numbers"
    raise OspaceError(f"{path}: no {what} can be read from it ({reason})")

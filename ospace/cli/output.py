"""Files that a verb writes: told to be unwritable before any work is done."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FIGURES = (".svg", ".png", ".pdf")


def figure(text: str) -> Path:
    """Return the path of a figure, for argparse."""
    if Path(text).suffix not in FIGURES:
        raise argparse.ArgumentTypeError(f"'{text}' ends neither in {' nor '.join(FIGURES)}")
    return file(text)


def file(text: str) -> Path:
    """Return the path of a file in a folder that is there, for argparse."""
    path = Path(text)
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}': no such folder '{path.parent}'")
    if path.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}' is a folder")
    return path


@contextmanager
def writable(path: Path) -> Iterator[None]:
    """Raise `OSError` where `path` cannot be written; leave no empty file behind if the work in it fails."""
    existed = os.path.lexists(path)
    path.open("ab").close()
    try:
        yield
    except BaseException:
        if not existed:
            path.unlink(missing_ok=True)
        raise

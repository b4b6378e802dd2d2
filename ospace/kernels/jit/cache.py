"""Where compiled kernels are kept between processes.

Numba looks at the file of the entry alone when it decides whether a cached kernel is still good; an edit in a
file that the entry inlines would go unnoticed and old results come back. So every state of the sources has a
folder of its own, named by a hash over all kernel files and the versions of what compiles them.
"""

from __future__ import annotations

import hashlib
import os
import platform
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy


def _root() -> Path:
    if chosen := os.environ.get("OSPACE_CACHE_DIR"):
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "ospace"


@cache
def directory() -> Path | None:
    """Return the folder of the compiled kernels, or None, with a warning, where no such folder can be written.

    It lies in ``$OSPACE_CACHE_DIR``, else ``$XDG_CACHE_HOME/ospace``, else ``~/.cache/ospace``.
    """
    versions = (platform.python_version(), numba.__version__, llvmlite.__version__, numpy.__version__)
    key = hashlib.sha256(" ".join(versions).encode())
    kernels = Path(__file__).parents[1]
    for source in sorted(kernels.rglob("*.py")):
        key.update(source.relative_to(kernels).as_posix().encode())
        key.update(source.read_bytes())
    try:
        folder = _root() / f"kernels-{key.hexdigest()[:16]}"
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except (OSError, RuntimeError) as error:  # RuntimeError: no home folder
        warn(error)
        return None
    return folder


def warn(error: Exception) -> None:
    """Tell that compiled kernels cannot be kept, or what was kept cannot be read."""
    message = f"kernels are compiled anew by each process, which takes seconds: no folder can keep them ({error}); "
    warnings.warn(message + "set OSPACE_CACHE_DIR to one that can be written", RuntimeWarning, stacklevel=2)


told: list[Callable[[bool], None]] = []
"""Called with True when a kernel that is not kept begins to be compiled, and with False when it is done."""


@contextmanager
def announced(entry: Any) -> Iterator[None]:
    """Call what is in `told` around the compilation of `entry`, unless it is kept on disk already."""
    kept = getattr(getattr(entry._cache, "_cache_file", None), "_index_path", None)
    listeners = [] if kept and Path(kept).exists() else list(told)
    for listener in listeners:
        listener(True)
    try:
        yield
    finally:
        for listener in listeners:
            listener(False)


@contextmanager
def keyed_on_sources() -> Iterator[bool]:
    """Make numba keep what is decorated inside in `directory`; yield whether it can be kept at all."""
    folder = directory()
    if folder is None:
        yield False
        return
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = str(folder)
    try:
        yield True
    finally:
        numba.config.CACHE_DIR = before

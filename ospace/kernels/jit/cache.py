"""Cache of compiled kernels between processes.

Numba looks at the file of the entry alone when it decides whether a cached kernel is still good; an edit in a
file that the entry inlines would go unnoticed and old results come back. So every state of the sources has a
folder of its own, named by a hash over all kernel files and the versions of what compiles them. Nor would it notice
damage to machine code, which then does anything: each file ends with a hash of what it holds.
"""

from __future__ import annotations

import hashlib
import io
import os
import platform
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy
from numba.core.caching import IndexDataCacheFile


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
    """Tell that compiled kernels cannot be kept."""
    message = f"kernels are compiled anew by each process, which takes seconds: no folder can keep them ({error}); "
    warnings.warn(message + "set OSPACE_CACHE_DIR to one that can be written", RuntimeWarning, stacklevel=2)


listeners: list[Callable[[int, int], None]] = []
"""Called with k and n when the k-th of n kernels to compile begins, and with 0, 0 when all are done."""


def report(number: int, of: int) -> None:
    """Report that kernel `number` of so many begins to be compiled; 0 of 0 that all are done."""
    for listener in list(listeners):
        listener(number, of)


def is_kept(entry: Any) -> bool:
    """Return whether `entry` is on disk, for some types of arguments at least."""
    index = getattr(getattr(entry._cache, "_cache_file", None), "_index_path", None)
    return index is not None and _is_whole(index)


def check_files(entry: Any) -> None:
    """Let the files of a compiled `entry` end with their hashes, and what is damaged be compiled and written anew."""
    if hasattr(entry._cache, "_cache_file"):
        entry._cache._cache_file.__class__ = _CheckedFiles


class _CheckedFiles(IndexDataCacheFile):
    """Numba's index and data files of one kernel, each with a hash at the end: one that is damaged is not there."""

    @contextmanager
    def _open_for_write(self, path: str) -> Iterator[io.BytesIO]:
        content = io.BytesIO()
        yield content
        with super()._open_for_write(path) as file:
            file.write(content.getvalue() + _hash(content.getvalue()))

    def _load_index(self) -> Any:
        return super()._load_index() if _is_whole(self._index_path) else {}

    def _load_data(self, name: str) -> Any:
        return super()._load_data(name) if _is_whole(self._data_path(name)) else None


def _is_whole(path: str) -> bool:
    try:
        content = Path(path).read_bytes()
    except OSError:
        return False
    return content[-_HASH:] == _hash(content[:-_HASH])


def _hash(content: bytes) -> bytes:
    return hashlib.sha256(content).digest()


_HASH = len(_hash(b""))


_TOGETHER = ContextVar("ospace_compiles_together", default=False)


@contextmanager
def reported_together() -> Iterator[None]:
    """Report nothing of single kernels: whoever compiles several at once reports them."""
    before = _TOGETHER.set(True)
    try:
        yield
    finally:
        _TOGETHER.reset(before)
        report(0, 0)


@contextmanager
def announced(entry: Any) -> Iterator[None]:
    """Report the compilation of `entry`, unless it is kept on disk already or one of several that are reported."""
    if is_kept(entry) or _TOGETHER.get():
        yield
        return
    report(1, 1)
    try:
        yield
    finally:
        report(0, 0)


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

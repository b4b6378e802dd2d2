"""Reading of ``.npz`` files from anywhere: nothing is taken into memory before its size is known and its kind is right.

`arrays` looks at the headers of a file alone, then reads; `made` puts what was read into dataclasses by the types of
their fields; `fit` and `fit_times` hold arrays to the shapes that belong together.
"""

from __future__ import annotations

import io
import math
import os
import struct
import types
import warnings
import zipfile
from collections.abc import Mapping
from dataclasses import is_dataclass
from typing import Any, BinaryIO, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from ospace.exceptions import OspaceError, printable
from ospace.files import open_regular
from ospace.kernels.tree import Floats

_SMALL, _PACKED = 250_000_000, 50
"""Bytes that any file may unpack to; beyond, that many times its own size. A run unpacks to less than twice that."""
_DIRECTORY = 4_000_000
"""Bytes of the table of what is in a file, of which each array takes a hundred."""
_TEXT = 20_000_000
"""Bytes of a text; a letter takes four."""
LARGEST = 1e100
"""Of finite numbers: what is computed of larger ones has no end."""
WRONG_KIND = (KeyError, TypeError, ValueError, OverflowError, AttributeError)
"""What `made` raises, and those who take texts apart for it."""
_END = struct.Struct("<4s4H2LH")
_NO_NPZ = "it is no whole .npz file of numbers"


def arrays(path: str | os.PathLike[str], what: str) -> dict[str, Any]:
    """Return the arrays of an ``.npz`` file by their names: numbers, and short texts.

    Raises
    ------
    OspaceError
        The file, which should hold `what`, cannot be read, is cut off, is another, or would take too much memory.
    """
    try:
        # NumPy warns of headers that it repairs
        with open_regular(path) as stream, warnings.catch_warnings(action="error"):
            return _arrays(stream)
    except OspaceError as error:
        reason = str(error)
    except OSError as error:
        reason = error.strerror or str(error)
    except Exception:  # of zipfile, zlib and NumPy: readers of bytes from anywhere raise what they meet
        reason = _NO_NPZ
    raise OspaceError(printable(f"{os.fspath(path)}: no {what} can be read from it ({reason})"))


def _arrays(stream: BinaryIO) -> dict[str, Any]:
    size = stream.seek(0, io.SEEK_END)
    stream.seek(max(0, size - 42))
    end = stream.read()
    mark, _, _, _, _, directory, _, _ = _END.unpack(end[-_END.size :])
    if mark != b"PK\5\6":  # another file, or a remark follows, which NumPy does not write and which hides the sizes
        raise ValueError
    if end.startswith(b"PK\6\7") or directory > _DIRECTORY:  # the former leads to another end, of 2⁶⁴ entries
        raise OspaceError("it holds more arrays than any run")
    with zipfile.ZipFile(stream) as file:
        members = file.infolist()
        most, unpacked = max(_SMALL, _PACKED * size), sum(one.file_size for one in members)
        if unpacked > most:
            raise OspaceError(f"it would unpack to {unpacked / 1e6:.0f} MB; at most {most / 1e6:.0f} MB are read")
        for one in members:
            if one.flag_bits & 1 or one.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise OspaceError("it is encrypted, or compressed in a way that NumPy does not write")
            _check_header(file, one)
        return {one.filename.removesuffix(".npy"): _array(file, one) for one in members}


def _check_header(file: zipfile.ZipFile, member: zipfile.ZipInfo) -> None:
    """Raise where an array is not as large as its shape says, or holds no numbers."""
    with file.open(member) as stream:
        version = np.lib.format.read_magic(stream)
        read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, kind = read(stream)
        size = math.prod(shape) * kind.itemsize
        if stream.tell() + size != member.file_size or min(shape, default=0) < 0:
            raise ValueError
    if not (kind.kind in "biuf" or (kind.kind == "U" and size <= _TEXT)):
        raise ValueError


def _array(file: zipfile.ZipFile, member: zipfile.ZipInfo) -> Any:
    with file.open(member) as stream:
        array = np.lib.format.read_array(stream, allow_pickle=False)
        if stream.read(1):  # which also checks the sum of all bytes
            raise ValueError
    return array


def made(kind: Any, value: Any) -> Any:
    """Return what a file holds as a `kind`: a dataclass, a tuple, a mapping, an array, a number or a text.

    Raises
    ------
    TypeError
        It is of another kind, or a field is missing or unknown.
    OverflowError
        A whole number is none that a float holds.
    """
    origin, arguments = get_origin(kind), get_args(kind)
    if kind == Floats:
        _require(isinstance(value, np.ndarray) and value.dtype == np.float64)
        return value
    if is_dataclass(kind) and isinstance(kind, type):
        hints = get_type_hints(kind)
        _require(isinstance(value, Mapping) and value.keys() == hints.keys())
        return kind(**{name: made(hint, value[name]) for name, hint in hints.items()})
    if origin in (Union, types.UnionType):
        (other,) = (one for one in arguments if one is not types.NoneType)
        return None if value is None else made(other, value)
    if origin is Literal:
        _require(isinstance(value, str) and value in arguments)
        return value
    if origin is tuple:
        _require(isinstance(value, tuple))
        kinds = arguments[:1] * len(value) if arguments[-1] is Ellipsis else arguments
        return tuple(made(one, part) for one, part in zip(kinds, value, strict=True))
    if origin is not None:  # a mapping from texts
        _require(isinstance(value, Mapping))
        return {name: made(arguments[1], one) for name, one in value.items()}
    _require(isinstance(value, (int, float) if kind is float else kind) and isinstance(value, bool) == (kind is bool))
    if kind in (int, float):
        number = float(value)
        _require(not LARGEST < abs(number) < math.inf)
    return value


def _require(right: bool) -> None:
    if not right:
        raise TypeError


def fit(name: str, array: Floats, *shape: int | None, least: int = 0) -> None:
    """Raise `OspaceError` where an array has another shape, or holds numbers beyond all sense.

    Parameters
    ----------
    name : str
        In the file.
    array : array
    *shape : int or None
        None is any number from `least` on.
    least : int
    """
    found = array.shape
    fits = (size >= least if wanted is None else size == wanted for size, wanted in zip(found, shape, strict=False))
    if len(found) != len(shape) or not all(fits):
        wanted = " × ".join(f"{least} or more" if size is None else str(size) for size in shape)
        raise OspaceError(printable(f"array '{name}' is {' × '.join(map(str, found))}, not {wanted}"))
    sizes = np.abs(array)
    if ((sizes > LARGEST) & np.isfinite(sizes)).any():
        raise OspaceError(printable(f"array '{name}' holds numbers beyond {LARGEST:g}"))


def fit_times(name: str, time: Floats) -> int:
    """Return the number of times; raise `OspaceError` where they are no list, not finite, or decrease."""
    fit(name, time, None)
    if not np.isfinite(time).all() or (np.diff(time) < 0.0).any():
        raise OspaceError(printable(f"array '{name}' holds times that are not finite, or decrease"))
    return len(time)

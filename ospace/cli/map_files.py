"""Postures of a map, kept on disk while it grows, and written as a table or as arrays when it ends."""

from __future__ import annotations

import csv
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Self

import numpy as np

from ospace.files import replacing
from ospace.kernels.tree import Floats

_AT_ONCE = 65_536
"""Rows in memory."""


class Rows:
    """Rows of numbers in a file without a name; a row that was begun when Ctrl-C came is left out.

    Parameters
    ----------
    columns : sequence of str
        Names.
    beside : Path
        Of a file that will be written: the rows are kept on its disk where that can be.
    """

    def __init__(self, columns: Sequence[str], beside: Path) -> None:
        self.columns, self.count = tuple(columns), 0
        ordinary = not beside.exists() or beside.is_file()
        self._file = tempfile.TemporaryFile(dir=beside.parent if ordinary else None)  # noqa: SIM115

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self._file.close()

    def add(self, *parts: Floats) -> None:
        """Keep N rows, given as parts (N, k) that stand beside each other."""
        rows = np.hstack(parts).astype("<f8")
        self._file.seek(self.count * self._size)
        self._file.write(rows.tobytes())
        self.count += len(rows)

    def chunks(self) -> Iterator[Floats]:
        """Yield the rows, some at a time."""
        self._file.seek(0)
        for first in range(0, self.count, _AT_ONCE):
            some = self._file.read(min(_AT_ONCE, self.count - first) * self._size)
            yield np.frombuffer(some, dtype="<f8").reshape(-1, len(self.columns))

    @property
    def _size(self) -> int:
        return 8 * len(self.columns)


def to_csv(rows: Rows, path: Path) -> None:
    """Write rows below the names of their columns."""
    with replacing(path) as part, part.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerow(rows.columns)
        for some in rows.chunks():
            np.savetxt(file, some, fmt="%.12g", delimiter=",")


def to_npz(rows: Rows, path: Path, others: Mapping[str, Floats]) -> None:
    """Write rows as the array `rows`, the names of their columns as `columns`, and other arrays as they are named."""
    with replacing(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED, allowZip64=True) as archive:
        for name, array in {"columns": np.array(rows.columns), **others}.items():
            with archive.open(f"{name}.npy", "w") as member:
                np.lib.format.write_array(member, np.asarray(array), allow_pickle=False)
        header = {"descr": "<f8", "fortran_order": False, "shape": (rows.count, len(rows.columns))}
        with archive.open("rows.npy", "w", force_zip64=True) as member:
            np.lib.format.write_array_header_1_0(member, header)
            for some in rows.chunks():
                member.write(some.tobytes())

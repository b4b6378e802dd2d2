"""Postures of a map as files that are written while it grows: rows that were begun when it ends are left out."""

from __future__ import annotations

import csv
import io
import shutil
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Protocol, Self

import numpy as np

from ospace.files import replacing
from ospace.kernels.tree import Floats


class Rows(Protocol):
    """A file that takes postures."""

    def add(self, x: Floats, values: Floats) -> None:
        """Write N postures (N, n), and their quantities (N, m)."""


class CsvRows:
    """Rows of numbers, comma-separated, below their names."""

    def __init__(self, file: IO[bytes], names: Sequence[str]) -> None:
        self._file, self._begun, self._whole = file, 0, 0
        heading = io.StringIO(newline="")
        csv.writer(heading, lineterminator="\n").writerow(names)
        self._write(heading.getvalue().encode())

    def add(self, x: Floats, values: Floats) -> None:
        text = io.BytesIO()
        np.savetxt(text, np.hstack([x, values]), fmt="%.12g", delimiter=",")
        self._write(text.getvalue())

    def end(self) -> None:
        """Cut off what is not whole."""
        if self._begun != self._whole:
            self._file.truncate(self._whole)

    def _write(self, text: bytes) -> None:
        self._begun += len(text)
        self._file.write(text)
        self._whole = self._begun


class NpzRows:
    """Arrays `postures` and `values` of an ``.npz`` file, gathered beside it until their length is known."""

    def __init__(self, folder: Path) -> None:
        self._files = {name: (folder / name).open("wb") for name in ("postures", "values")}
        self._columns: dict[str, int] = {}
        self._count = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        for file in self._files.values():
            file.close()

    def add(self, x: Floats, values: Floats) -> None:
        for name, part in (("postures", x), ("values", values)):
            self._files[name].seek(self._count * part.shape[1] * 8)
            self._files[name].write(np.ascontiguousarray(part, dtype="<f8").tobytes())
            self._columns[name] = part.shape[1]
        self._count += len(x)

    def end(self, path: Path, others: Mapping[str, Floats]) -> None:
        """Write the file, with other arrays as well."""
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, allowZip64=True) as archive:
            for name, array in others.items():
                with archive.open(f"{name}.npy", "w") as member:
                    np.lib.format.write_array(member, np.asarray(array), allow_pickle=False)
            for name, file in self._files.items():
                file.close()
                shape = (self._count, self._columns.get(name, 0))
                header = {"descr": "<f8", "fortran_order": False, "shape": shape}
                with archive.open(f"{name}.npy", "w", force_zip64=True) as member, open(file.name, "rb") as rows:
                    np.lib.format.write_array_header_1_0(member, header)
                    shutil.copyfileobj(_Part(rows, shape[0] * shape[1] * 8), member)


class _Part:
    """The first bytes of a file."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file, self._left = file, size

    def read(self, size: int = -1) -> bytes:
        text = self._file.read(min(size if size >= 0 else self._left, self._left))
        self._left -= len(text)
        return text


@contextmanager
def csv_rows(path: Path, names: Sequence[str]) -> Iterator[CsvRows]:
    """Yield what writes postures to a CSV file, which appears when the block ends."""
    with replacing(path) as part, open(part, "wb") as file:
        rows = CsvRows(file, names)
        yield rows
        rows.end()


@contextmanager
def npz_rows(path: Path) -> Iterator[NpzRows]:
    """Yield what gathers postures for an ``.npz`` file, in a folder beside it while the block lasts."""
    with tempfile.TemporaryDirectory(prefix=".ospace-map-", dir=path.parent) as folder, NpzRows(Path(folder)) as rows:
        yield rows

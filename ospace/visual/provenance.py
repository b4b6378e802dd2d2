"""Provenance of a report: whose it is, and what it was made of."""

from __future__ import annotations

import hashlib
import os
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

_CHUNK = 1 << 20


@dataclass(frozen=True)
class Provenance:
    """Origin of a report, which a review board asks for before it reads it.

    Attributes
    ----------
    file : str
        Name of what was checked or run, as the user wrote it.
    sha256 : str
        Of its content; of the file alone, not of what it names, as meshes.
    command : str
        The line by which the report was made.
    date : str
        When, UTC; that of ``SOURCE_DATE_EPOCH`` where it is set, for reports that are to be the same again.
    project, author : str
        Empty where nobody gave them.
    """

    file: str
    sha256: str
    command: str = ""
    date: str = ""
    project: str = ""
    author: str = ""

    @classmethod
    def of(cls, path: Path, *, name: str, command: str = "", project: str = "", author: str = "") -> Provenance:
        """Take the hash of a file, and the time.

        Parameters
        ----------
        path : Path
        name, command, project, author : str
            As of the attributes.

        Returns
        -------
        Provenance
        """
        digest = hashlib.sha256()
        with path.open("rb") as file:
            while chunk := file.read(_CHUNK):
                digest.update(chunk)
        stamp = os.environ.get("SOURCE_DATE_EPOCH", "")
        now = datetime.fromtimestamp(int(stamp), UTC) if stamp.isdecimal() else datetime.now(UTC)
        return cls(name, digest.hexdigest(), command, now.strftime("%Y-%m-%d %H:%M UTC"), project, author)

    def rows(self) -> list[tuple[str, str]]:
        """Return titles and texts, without those that are empty.

        Returns
        -------
        list of (str, str)
        """
        titles = {
            "project": self.project,
            "author": self.author,
            "date": self.date,
            "file": self.file,
            "SHA-256 of the file": self.sha256,
            "command": self.command,
        }
        return [(title, text) for title, text in titles.items() if text]

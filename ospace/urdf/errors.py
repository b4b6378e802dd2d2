"""Raised for files that are refused, and for models without sound dynamics."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ospace.exceptions import OspaceError, printable
from ospace.urdf.description import Description
from ospace.urdf.lint.findings import Finding


class UrdfError(OspaceError):
    """The file could not be read as a URDF.

    Attributes
    ----------
    path : Path
        The file.
    code : str
        Stable name of the reason; ``ospace check --explain CODE`` explains it.
    line : int or None
        Line of the file, counted from 1.
    """

    def __init__(self, path: Path, reason: str, code: str, line: int | None = None) -> None:
        where = "" if line is None else f"line {line}: "
        super().__init__(printable(f"{path}: {where}{reason} [{code}]"))
        self.path, self.reason, self.code, self.line = path, reason, code, line


class UnsoundModelError(OspaceError):
    """The model was read, and its dynamics make no physical sense.

    Attributes
    ----------
    findings : tuple of Finding
        What is wrong, each with link or joint and remedy.
    description : Description or None
        Links, joints and shapes as the file has them; None where the model was not read from a file.
    """

    def __init__(self, name: str, findings: Iterable[Finding], description: Description | None = None) -> None:
        self.findings, self.description = tuple(findings), description
        lines = "".join(f"\n  {finding}" for finding in self.findings if finding.severity == "error")
        super().__init__(f"robot '{printable(name)}' has no sound dynamics:{lines}")

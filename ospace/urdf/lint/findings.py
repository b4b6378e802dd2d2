"""A finding: one thing to know about a model, by link or joint and line."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any

from ospace.exceptions import printable
from ospace.urdf.lint.rules import RULES, Severity

_SEVERITIES = ("error", "warning", "info")


@dataclass(frozen=True)
class Finding:
    """One thing to know about a model.

    Attributes
    ----------
    code : str
        Stable name of the kind of finding.
    severity : "error", "warning" or "info"
        With an error the model has no sound dynamics.
    subject : str
        The link or joint.
    message : str
        What was found, with its value.
    remedy : str
    line : int or None
        Line of the file, counted from 1.
    value : str or None
        The value at fault, as the file has it.
    file : str or None
        Name of the file that the line is of, where a xacro includes it; None for the file itself.
    pose : str or None
        Joint positions of the state that it is about, as ``ospace view --pose`` takes them; rad, m.
    """

    code: str
    severity: Severity
    subject: str
    message: str
    remedy: str
    line: int | None = None
    value: str | None = None
    file: str | None = None
    pose: str | None = None

    def __str__(self) -> str:
        end = "" if self.message.endswith("?") else "."
        return f"{self.severity} {self.code}: {self.place}: {self.message}{end} {self.remedy}"

    @property
    def place(self) -> str:
        """Return the subject, and its line where that is known."""
        if self.line is None:
            return self.subject
        return f"{self.subject}, line {self.line}" + (f" of {self.file}" if self.file else "")

    def as_dict(self) -> dict[str, Any]:
        """Return the fields by name."""
        return asdict(self)


def make_finding(
    code: str,
    subject: str,
    message: str,
    *,
    remedy: str | None = None,
    severity: Severity | None = None,
    line: int | None = None,
    value: str | None = None,
    pose: str | None = None,
) -> Finding:
    """Make a finding; severity and remedy are those of its rule unless given.

    Returns
    -------
    Finding
        Its texts printable in a terminal.
    """
    known = RULES[code]
    subject, message, remedy = map(printable, (subject, message, remedy or known.remedy))
    at, file = None if line is None else int(line), getattr(line, "file", None)
    return Finding(code, severity or known.severity, subject, message, remedy, at, value, file, pose)


def by_severity(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """Sort errors before warnings before infos, each in the order given.

    Returns
    -------
    tuple of Finding
    """
    return tuple(sorted(findings, key=lambda finding: _SEVERITIES.index(finding.severity)))


def any_error(findings: Iterable[Finding]) -> bool:
    """Return whether a finding is an error.

    Returns
    -------
    bool
    """
    return any(finding.severity == "error" for finding in findings)

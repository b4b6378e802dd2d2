"""A rule: one kind of finding, with its reason and remedy, whatever the file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "info"]


@dataclass(frozen=True)
class Rule:
    """One kind of finding, or one reason to refuse a file.

    Attributes
    ----------
    name : str
        Stable: programs may rely on it.
    severity : "error", "warning" or "info"
        With an error no robot is made of the file. A finding may be milder than its code, where the page says so.
    summary : str
        What is wrong or odd.
    reason : str
        Why it matters for a robot that floats freely.
    remedy : str
        What to do about it.
    example : str
        The smallest piece of a file that has it.
    unreadable : bool
        Whether the file is refused as a whole, by `UrdfError` and exit status 2.
    fixable : bool
        Whether ``ospace check --fix`` repairs it, in part or always.
    """

    name: str
    severity: Severity
    summary: str
    reason: str
    remedy: str
    example: str
    unreadable: bool = False
    fixable: bool = False

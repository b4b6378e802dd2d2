"""Errors of reading a scenario."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ospace.exceptions import OspaceError, printable, printable_lines

_SHOWN = 50


class ScenarioError(OspaceError):
    """A scenario could not be read, or holds mistakes.

    Attributes
    ----------
    path : Path
        The file.
    problems : tuple of (str, str)
        Key, as ``phase[1].task[0].stiffness``, and what is wrong with it, in the order found.
    key : str
        That of the first problem.
    """

    def __init__(self, path: Path, problems: Iterable[tuple[str, str]]) -> None:
        self.path, self.problems = path, tuple(problems)
        self.key = self.problems[0][0] if self.problems else ""
        texts = [
            f"{printable(key)}: {printable_lines(what)}" if key else printable_lines(what)
            for key, what in self.problems[:_SHOWN]
        ]
        if len(self.problems) > _SHOWN:
            texts.append(f"… and {len(self.problems) - _SHOWN} more")
        super().__init__(f"{path}:" + (f" {texts[0]}" if len(texts) == 1 else "".join(f"\n  {text}" for text in texts)))

"""Text for a terminal, formatted by rich and kept until it is printed."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from ospace.exceptions import printable

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.urdf.lint.findings import Finding

SEVERITY_COLOURS = {"error": "bold red", "warning": "yellow", "info": "cyan"}


def buffered_console(width: int, *, fits_terminal: bool = False) -> Console:
    """Return a console that keeps what is printed on it, with the colours that standard output can show.

    Names are of the file's making: ``:robot:`` in one stays text.
    """
    from rich.console import Console

    terminal = Console().is_terminal
    return Console(
        file=io.StringIO(),
        force_terminal=terminal,
        width=None if terminal and fits_terminal else width,
        emoji=False,
        highlight=False,
        soft_wrap=True,
    )


def buffered_text(written: Console) -> str:
    """Return what was printed, without the spaces that fill lines."""
    kept = cast(io.StringIO, written.file)  # as `buffered_console` made it
    return "".join(f"{line.rstrip()}\n" for line in kept.getvalue().split("\n")[:-1])


def plain(text: str) -> str:
    """Keep a text from being read as markup, and a terminal from obeying it."""
    from rich.markup import escape

    return escape(printable(text))


def show_findings(console: Console, findings: Sequence[Finding], title: str = "Findings") -> None:
    """Show findings below a title, each with its remedy."""
    console.print(plain(title), style="bold")
    for finding in findings:
        mark = f"[{SEVERITY_COLOURS.get(finding.severity, '')}]{finding.severity:8}[/]"
        console.print(f"  {mark} {finding.code}: {plain(finding.place)}: {plain(finding.message)}")
        if finding.severity != "info":
            console.print(f"           {plain(finding.remedy)}")

"""Text for a terminal, formatted by rich and kept until it is printed."""

from __future__ import annotations

import io
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from ospace.cli.columns import fit, wrap
from ospace.cli.dialect import shell
from ospace.exceptions import printable

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.cli.columns import Column
    from ospace.urdf.lint.findings import Finding

SEVERITY_COLOURS = {"error": "bold red", "warning": "yellow", "info": "cyan"}
_BELOW_MARK = " " * 11  # where the code of a finding stands


def buffered_console() -> Console:
    """Return a console that keeps what is printed on it, as wide as the terminal, with the colours that it can show.

    Its width is 80 where there is no terminal and no ``COLUMNS``. With ``NO_COLOR`` it writes no escapes at all. Names
    are of the file's making: ``:robot:`` in one stays text.
    """
    from rich.console import Console

    terminal = Console().is_terminal
    return Console(
        file=io.StringIO(),
        force_terminal=terminal,
        color_system=None if no_colour() else "auto",
        emoji=False,
        highlight=False,
        soft_wrap=True,
    )


def no_colour() -> bool:
    """Return whether the user wants no escapes: https://no-color.org."""
    return bool(os.environ.get("NO_COLOR"))


def show_table(console: Console, columns: Sequence[Column], rows: Sequence[Sequence[str]], indent: str = "") -> None:
    """Show rows of cells, which may hold markup, below the headings of their columns."""
    table = fit(columns, rows, console.width, indent)
    for line in [*table.heading, *(line for row in table.rows for line in row)]:
        console.print(line)


def show_text(console: Console, text: str, first: str = "", then: str = "  ") -> None:
    """Show a sentence, which may hold markup: broken at words for a terminal or ``COLUMNS``, whole in a pipe.

    `first` stands before its first line, `then` before those that follow.
    """
    from rich.text import Text

    sentence = Text.from_markup(text, emoji=False)
    width = console.width if console.is_terminal or "COLUMNS" in os.environ else len(first) + sentence.cell_len
    fits = sentence.cell_len + len(first) <= width
    for line in [Text.assemble(first, sentence)] if fits else wrap(sentence, width, first, then):
        console.print(line)


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
    show_text(console, f"[bold]{plain(title)}[/]")
    for finding in findings:
        mark = f"[{SEVERITY_COLOURS.get(finding.severity, '')}]{finding.severity:8}[/]"
        text = f"{mark} {finding.code}: {plain(finding.place)}: {plain(shell(finding.message))}"
        show_text(console, text, "  ", _BELOW_MARK)
        if finding.severity != "info":
            show_text(console, plain(shell(finding.remedy)), _BELOW_MARK, _BELOW_MARK)

"""A map as text for a terminal."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from ospace.cli.console import buffered_console, buffered_text, plain

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.analysis.map_result import MapResult

_WIDTH = 80
_NAME = 18


def text(result: MapResult) -> str:
    """Return the tables of a map.

    Parameters
    ----------
    result : MapResult

    Returns
    -------
    str
    """
    console = buffered_console(_WIDTH)
    _show(console, result)
    return buffered_text(console)


def _show(console: Console, result: MapResult) -> None:
    from ospace.analysis import map_text

    for line in _wrapped(map_text.heading(result), ""):
        console.print(f"[bold]{plain(line)}[/]")
    for name, value in map_text.facts(result):
        for line in _wrapped(f"  {name:{_NAME}} {value}", " " * (_NAME + 3)):
            console.print(plain(line))
    if extremes := list(map_text.extremes(result)):
        console.print(f"\n[bold]{'quantity':36}  {'smallest':>9}  {'mean':>9}  {'largest':>9}[/]")
        for title, numbers, unit in extremes:
            console.print(plain(f"{title:36}  {'  '.join(f'{one:>9}' for one in numbers)}  {unit}"))
    if grades := list(map_text.grades(result)):
        console.print(f"\n[bold]{'turn at most':>12}  {'postures':>8}  {'voxels':>7}  hand from the mass centre[/]")
        for turn, share, volume, reach in grades:
            console.print(plain(f"{turn:>12}  {share:>8}  {volume:>7}  {reach}"))
    if places := list(map_text.places(result)):
        console.print()
        for title, at in places:
            for line in _wrapped(f"{title} at {at}", "  "):
                console.print(plain(line))


def _wrapped(line: str, indent: str) -> list[str]:
    return textwrap.wrap(
        line, _WIDTH, subsequent_indent=indent, drop_whitespace=True, break_long_words=False, break_on_hyphens=False
    )

"""A map as text for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ospace.cli.columns import Column
from ospace.cli.console import buffered_console, buffered_text, plain, show_table, show_text

if TYPE_CHECKING:
    from ospace.analysis.map_result import MapResult

_FACTS = (Column(), Column(wraps=True))
_EXTREMES = (Column("quantity"), *(Column(one, right=True) for one in ("smallest", "mean", "largest")), Column("unit"))
_GRADES = (
    *(Column(one, right=True) for one in ("turn at most", "postures", "voxels")),
    Column("hand from the mass centre"),
)


def text(result: MapResult) -> str:
    """Return the tables of a map.

    Parameters
    ----------
    result : MapResult

    Returns
    -------
    str
    """
    from ospace.analysis import map_text

    console = buffered_console()
    show_text(console, f"[bold]{plain(map_text.heading(result))}[/]")
    show_table(console, _FACTS, [tuple(map(plain, row)) for row in map_text.facts(result)], "  ")
    if extremes := [(title, *numbers, unit) for title, numbers, unit in map_text.extremes(result)]:
        console.print()
        show_table(console, _EXTREMES, extremes)
    if grades := list(map_text.grades(result)):
        console.print()
        show_table(console, _GRADES, grades)
    if places := list(map_text.places(result)):
        console.print()
        for title, at in places:
            show_text(console, plain(f"{title} at {at}"))
    return buffered_text(console)

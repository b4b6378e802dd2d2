"""Tables that fit the width they are given: a cell goes on below itself, and nothing is cut off.

Where a table is wider than its place, cells of columns that wrap are broken at words; then a first cell that is too
long stands on a line of its own; where even that is not enough, each row is stacked: its first cell, and below it the
others, each behind its heading.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from rich.text import Text

_GAP = "  "
_NARROWEST = 8  # characters of a first column beside which the rest may stand


class Column(NamedTuple):
    """One column of a table.

    Attributes
    ----------
    heading : str
    right : bool
        Numbers, which end below each other.
    wraps : bool
        Its cells are sentences, which may be broken at words.
    """

    heading: str = ""
    right: bool = False
    wraps: bool = False


class Fitted(NamedTuple):
    """Lines of a table: of its heading, and of each row.

    Attributes
    ----------
    heading : list of Text
        Empty where rows are stacked, or no column has one.
    rows : list of list of Text
    """

    heading: list[Text]
    rows: list[list[Text]]


def fit(columns: Sequence[Column], rows: Sequence[Sequence[str]], width: int, indent: str = "") -> Fitted:
    """Lay out rows of cells, which may hold rich's markup, in `width` characters.

    Parameters
    ----------
    columns : sequence of Column
    rows : sequence of sequence of str
        A cell for each column.
    width : int
    indent : str
        Before each line.

    Returns
    -------
    Fitted
    """
    from rich.text import Text

    cells = [[Text.from_markup(cell, emoji=False) for cell in row] for row in rows]
    heading = [Text(column.heading, style="bold") for column in columns]
    widths = _widths(columns, [heading, *cells], width - len(indent))
    if widths is None:
        return Fitted([], [_stacked(heading, row, width, indent) for row in cells])
    shown = _row(columns, heading, widths, width, indent) if any(column.heading for column in columns) else []
    return Fitted(shown, [_row(columns, row, widths, width, indent) for row in cells])


def wrap(text: Text, width: int, first: str = "", then: str = "") -> list[Text]:
    """Break a text at words; a word longer than a line is folded.

    Parameters
    ----------
    text : Text
    width : int
    first, then : str
        Before the first line, and before those that follow.

    Returns
    -------
    list of Text
    """
    from rich.console import Console
    from rich.text import Text

    room = max(1, width - max(len(first), len(then)))
    lines = text.wrap(Console(width=room, color_system=None), room, overflow="fold")
    for line in lines:
        line.rstrip()
    return [Text.assemble(then if k else first, line) for k, line in enumerate(lines)]


def _widths(columns: Sequence[Column], rows: Sequence[Sequence[Text]], width: int) -> list[int] | None:
    """Return the width of each column; None where the rows must be stacked."""
    widths = [max(row[k].cell_len for row in rows) for k in range(len(columns))]
    over = sum(widths) + len(_GAP) * (len(columns) - 1) - width
    for k in reversed(range(len(columns))):
        if columns[k].wraps and over > 0:
            least = max(len(word) for row in rows for word in [*row[k].plain.split(), ""])
            taken = min(over, max(0, widths[k] - max(least, width // 4)))
            widths[k], over = widths[k] - taken, over - taken
    if over > 0:
        taken = min(over, max(0, widths[0] - _NARROWEST))
        widths[0], over = widths[0] - taken, over - taken
    return widths if over <= 0 else None


def _row(columns: Sequence[Column], row: Sequence[Text], widths: Sequence[int], width: int, indent: str) -> list[Text]:
    """Return the lines of one row."""
    from rich.text import Text

    lines: list[Text] = []
    cells = list(row)
    if not columns[0].wraps and cells[0].cell_len > widths[0]:
        lines, cells[0] = wrap(cells[0], width, indent, indent + _GAP), Text()
    broken = [wrap(cell, size) if cell.cell_len > size else [cell] for cell, size in zip(cells, widths, strict=True)]
    for k in range(max(map(len, broken))):
        line = Text(indent)
        for column, cell, size in zip(columns, broken, widths, strict=True):
            part = cell[k].copy() if k < len(cell) else Text()
            fill = " " * (size - part.cell_len)
            line = line.append(fill).append_text(part) if column.right else line.append_text(part).append(fill)
            line.append(_GAP)
        line.rstrip()
        lines.append(line)
    return [line for line in lines if line.plain]


def _stacked(heading: Sequence[Text], row: Sequence[Text], width: int, indent: str) -> list[Text]:
    """Return the first cell of a row, and below it the others with their headings."""
    from rich.text import Text

    lines = wrap(row[0], width, indent, indent + _GAP)
    packed = Text()
    for title, cell in zip(heading[1:], row[1:], strict=True):
        if cell.plain:
            named = Text.assemble((title.plain, "bold"), " ", cell) if title.plain else cell
            if packed.plain and packed.cell_len + len(_GAP) + named.cell_len > width - len(indent) - len(_GAP):
                lines += wrap(packed, width, indent + _GAP, indent + 2 * _GAP)
                packed = Text()
            packed = Text.assemble(packed, _GAP, named) if packed.plain else named
    return lines + wrap(packed, width, indent + _GAP, indent + 2 * _GAP) if packed.plain else lines

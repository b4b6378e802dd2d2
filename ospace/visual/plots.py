"""Curves of a run: on a figure, or one by one as SVGs that stand in a page.

Matplotlib is loaded when something is drawn. All axes of a figure, and of all panels, begin and end at the same place,
so that times stand below each other.
"""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from lxml import etree

from ospace.exceptions import printable
from ospace.extras import require as require_extra
from ospace.files import replacing
from ospace.kernels.tree import Floats, Ints
from ospace.scenario.result import PhaseResult
from ospace.scenario.series import Series

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 10.0, 3.0
"""Of a panel, inches; a page shows it in any width."""
_LEFT, _RIGHT, _BOTTOM, _TOP = 0.085, 0.79, 0.5, 0.62
"""Edges of the axes: share of the width; inches from below and above."""
_COLUMNS = 1000
"""In which a curve is thinned: about as many as pixels."""
_LARGEST = 145_000
"""Bytes of a panel; noise of many curves is thinned to that."""
_BESIDE = 0.25
"""A limit is shown where values come to this share of it."""
_LEAST = 1e-17
"""On an axis of decades, what is smaller is drawn as if it were this."""
_DASHES: tuple[Any, ...] = ("solid", (0, (5.0, 1.6)), (0, (1.4, 1.4)), (0, (6.0, 1.4, 1.4, 1.4)))
_LEGEND_ROWS, _LEGEND_FONTS = (9, 14), (8.5, 6.8)
"""Rows and size of letters (points) of a legend of one column, and of two."""
_SMALLEST_FONT, _PHASE_FONT = 5.6, 8.5
_LETTER = 0.61
"""Width of a letter over its size."""
_HANDLE = 3.3
"""Width of the line beside a name in a legend, and of the gaps, over the size of letters."""


@dataclass(frozen=True)
class Theme:
    """Colours: curves by Okabe and Ito, for all kinds of colour vision, but for those too near the background."""

    curves: tuple[str, ...]
    text: str
    grid: str
    band: str
    limit: str
    background: str


LIGHT = Theme(
    ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"),
    text="#1c2333", grid="#c9ced9", band="#eef1f6", limit="#b3261e", background="#ffffff",
)  # fmt: skip
DARK = Theme(
    ("#56B4E9", "#E69F00", "#009E73", "#CC79A7", "#F0E442", "#D55E00", "#ffffff"),
    text="#d7deee", grid="#2b3553", band="#141c36", limit="#ff8a80", background="#0b1020",
)  # fmt: skip


@dataclass(frozen=True)
class Panel:
    """One series as an SVG that stands in a page.

    Attributes
    ----------
    name, title : str
        Those of the series.
    svg : str
        An ``<svg>`` element as wide as what it stands in; its ids are its own.
    left, right : float
        Edges of the axes, as shares of the width.
    start, end : float
        Times at these, s.
    description : str
        The curves in words, for readers who do not see them.
    """

    name: str
    title: str
    svg: str
    left: float
    right: float
    start: float
    end: float
    description: str


def require() -> None:
    """Raise `OspaceError` where Matplotlib is not installed."""
    require_extra("matplotlib", "a plot")


# -- what is drawn -----------------------------------------------------------------------------------------------


def draw(
    axes: Axes,
    series: Series | Mapping[str, Series],
    phases: Sequence[PhaseResult] = (),
    *,
    dark: bool = False,
    columns: int = _COLUMNS,
) -> None:
    """Draw a series on axes, phases shaded and named.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
    series : Series or mapping of str to Series
        The same series of several runs by their names: the first solid, the second dashed.
    phases : sequence of PhaseResult
    dark : bool
        For a dark background.
    columns : int
        As of `thinned`.
    """
    theme = DARK if dark else LIGHT
    runs = {"": series} if isinstance(series, Series) else dict(series)
    first = next(iter(runs.values()))
    labels = list(dict.fromkeys(label for one in runs.values() for label in one.labels))
    names = list(runs)
    handles: dict[str, Any] = {}
    if len(runs) > 1 and len(labels) > 1:
        handles |= {name: axes.plot([], color=theme.text, linestyle=_DASHES[k])[0] for k, name in enumerate(names)}
    for number, one in enumerate(runs.values()):
        for k, label in enumerate(one.labels):
            place = labels.index(label) if len(labels) > 1 else number  # one curve of each run: they differ in colour
            values = np.maximum(one.values[:, k], _LEAST) if one.logarithmic else one.values[:, k]
            kept = thinned(one.time, values, columns)
            style = _style(place, number, len(runs), theme)
            (line,) = axes.plot(one.time[kept], values[kept], **style)
            handles.setdefault(label if len(labels) > 1 or len(runs) == 1 else names[number], line)
    start, end = _span(runs.values())
    axes.set_xlim(start, end)
    if first.logarithmic and any(np.isfinite(one.values).any() for one in runs.values()):
        axes.set_yscale("log")
    limit = _draw_limits(axes, first, theme)
    if limit is not None:
        handles["limit"] = limit
    _draw_phases(axes, phases, theme)
    _dress(axes, first, theme)
    _draw_legend(axes, handles, theme)


def figure(
    series: Sequence[Series | Mapping[str, Series]],
    phases: Sequence[PhaseResult] = (),
    *,
    dark: bool = False,
    columns: int = _COLUMNS,
) -> Figure:
    """Return a figure of several series, below each other; arguments as of `draw`."""
    from matplotlib.figure import Figure

    height = HEIGHT * len(series)
    made = Figure(figsize=(WIDTH, height), facecolor=(DARK if dark else LIGHT).background)
    for k, one in enumerate(series):
        low, high = height - HEIGHT * (k + 1) + _BOTTOM, height - HEIGHT * k - _TOP
        axes = made.add_axes((_LEFT, low / height, _RIGHT - _LEFT, (high - low) / height))
        draw(axes, one, phases, dark=dark, columns=columns)
    return made


def save(made: Figure, path: Path) -> None:
    """Write a figure; its suffix selects the format."""
    with _settings("figure"), replacing(path) as part:
        made.savefig(part, dpi=150, metadata=_UNDATED.get(path.suffix))


def svg(series: Series, phases: Sequence[PhaseResult] = (), *, dark: bool) -> Panel:
    """Return a series as a panel of a page; `phases` and `dark` as of `draw`."""
    description, columns = describe(series), _COLUMNS
    while True:
        made = figure([series], phases, dark=dark, columns=columns)
        text = embedded(made, series.name, series.title, description, dark=dark)
        if len(text) <= _LARGEST or columns == 1:
            break
        columns = max(1, int(0.9 * columns * _LARGEST / len(text)))
    start, end = made.axes[0].get_xlim()
    return Panel(series.name, series.title, text, _LEFT, _RIGHT, float(start), float(end), description)


def embedded(made: Figure, name: str, title: str, description: str, *, dark: bool) -> str:
    """Return a figure as an ``<svg>`` element that stands in a page with others, `name` its own."""
    written = io.BytesIO()
    with _settings(name):
        made.savefig(written, format="svg", transparent=True, metadata=_UNDATED[".svg"])
    return _embedded(written.getvalue(), f"{name}-{'dark' if dark else 'light'}", title, description)


def describe(series: Series) -> str:
    """Return in words what a series shows: of how many curves, and where they peak."""
    unit = f" {series.unit}" if series.unit else ""
    size = np.abs(series.values)
    begin, end = _span([series])
    text = f"{series.title}, from {begin:.4g} s to {end:.4g} s."
    if np.isnan(size).all():
        return f"{text} No values."
    k, curve = np.unravel_index(int(np.nanargmax(size)), size.shape)
    label, value = printable(series.labels[int(curve)]), series.values[k, curve]
    of = f" of {len(series.labels)} curves" if len(series.labels) > 1 else ""
    return f"{text} Largest{of}: {label}, {value:.3g}{unit} at {series.time[k]:.4g} s."


def thinned(time: Floats, values: Floats, columns: int) -> Ints:
    """Return which points of a curve to draw: in each of so many columns the smallest and the largest.

    Parameters
    ----------
    time, values : (N,)
        Ascending; NaN where the curve is broken, of which the first is kept in each column.
    columns : int

    Returns
    -------
    (M,) int array
        Ascending, with the first and the last point; all where they are few.
    """
    if len(time) <= 4 * columns:
        return np.arange(len(time))
    edges = np.searchsorted(time, np.linspace(time[0], time[-1], columns + 1)[1:-1])
    kept = []
    for part in np.split(np.arange(len(time)), edges):
        own = values[part]
        broken = np.isnan(own)
        if not len(part) or broken.all():
            kept.append(part[:1])
            continue
        kept.append(np.unique([part[np.nanargmin(own)], part[np.nanargmax(own)], *part[broken][:1]]))
    return np.unique(np.concatenate([[0], *kept, [len(time) - 1]])).astype(np.int64)


def _style(place: int, number: int, runs: int, theme: Theme) -> dict[str, Any]:
    colour, round_ = theme.curves[place % len(theme.curves)], place // len(theme.curves)
    if runs == 1:
        return {"color": colour, "linestyle": _DASHES[round_ % len(_DASHES)], "linewidth": 1.3}
    return {"color": colour, "linestyle": _DASHES[number % len(_DASHES)], "linewidth": max(0.5, 1.4 - 0.4 * round_)}


def _span(series: Any) -> tuple[float, float]:
    times = [one.time for one in series if len(one.time)]
    start = min((float(time[0]) for time in times), default=0.0)
    end = max((float(time[-1]) for time in times), default=0.0)
    return start, end if end > start else start + 1.0


def _draw_limits(axes: Axes, series: Series, theme: Theme) -> Any:
    """Draw the limits that values come near to; return one of the lines, if any."""
    low, high = axes.get_ylim()
    line = None
    for limit in series.limits:
        if series.logarithmic or abs(limit) * _BESIDE <= max(abs(low), abs(high)):
            line = axes.axhline(limit, color=theme.limit, linewidth=0.9, zorder=1.5)
    return line


def _draw_phases(axes: Axes, phases: Sequence[PhaseResult], theme: Theme) -> None:
    start, end = axes.get_xlim()
    inches = (_RIGHT - _LEFT) * WIDTH / (end - start)
    for k, phase in enumerate(phases):
        from_, to = max(start, phase.start), min(end, phase.end)
        if to <= from_:
            continue
        if k % 2 == 0:
            axes.axvspan(from_, to, color=theme.band, linewidth=0.0, zorder=0.0)
        name, letters = phase.name, int((to - from_) * inches * 72.0 / (_LETTER * _PHASE_FONT))
        if len(name) > letters:
            name = f"{name[: letters - 1]}…" if letters > 2 else ""
        axes.text(
            0.5 * (from_ + to), 1.015, as_text(name), transform=axes.get_xaxis_transform(),
            ha="center", va="bottom", fontsize=_PHASE_FONT, color=theme.text, alpha=0.8,
        )  # fmt: skip


def _dress(axes: Axes, series: Series, theme: Theme) -> None:
    from matplotlib.ticker import MaxNLocator

    axes.set_title(as_text(series.title), loc="left", pad=19.0, fontsize=11.0, color=theme.text)
    axes.set_xlabel("time, s", color=theme.text, labelpad=2.0)
    axes.set_ylabel(series.unit, color=theme.text)
    axes.yaxis.set_label_coords(-0.085, 0.5)
    axes.xaxis.set_major_locator(MaxNLocator(10, steps=[1, 2, 5, 10]))
    axes.tick_params(which="both", colors=theme.text, labelsize=9.0)
    axes.set_facecolor("none")
    axes.grid(True, color=theme.grid, linewidth=0.6)
    axes.set_axisbelow(True)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(theme.text)


def _draw_legend(axes: Axes, handles: Mapping[str, Any], theme: Theme) -> None:
    """Put names at the right of the axes, in two columns where they are many, as large as there is room for."""
    shown = list(handles.items())
    columns = 1 if len(shown) <= _LEGEND_ROWS[0] else 2
    most = columns * _LEGEND_ROWS[columns - 1]
    if len(shown) > most:
        shown[most - 1 :] = [(f"… and {len(shown) - most + 1} more", axes.plot([], linestyle="none")[0])]
    room = 0.95 * (1.0 - _RIGHT) * WIDTH * 72.0 / columns
    longest = max((len(name) for name, _ in shown), default=0)
    size = min(_LEGEND_FONTS[columns - 1], max(_SMALLEST_FONT, room / (_HANDLE + _LETTER * longest)))
    letters = int((room / size - _HANDLE) / _LETTER)
    axes.legend(
        [handle for _, handle in shown], [_label(name, letters) for name, _ in shown],
        loc="upper left", bbox_to_anchor=(1.01, 1.04), borderaxespad=0.0, borderpad=0.0, ncols=columns, fontsize=size,
        labelcolor=theme.text, frameon=False, handlelength=2.2, handletextpad=0.5, columnspacing=0.6, labelspacing=0.45,
    )  # fmt: skip


def _label(name: str, letters: int) -> str:
    """Return a name of at most so many letters: joints differ at either end."""
    if len(name) > letters:
        name = f"{name[: (letters - 1) // 2]}…{name[-(letters // 2) :]}"
    text = as_text(name)
    return f" {text}" if text.startswith("_") else text  # Matplotlib hides what begins with an underscore


def as_text(name: str) -> str:
    """Keep a name from being read as mathematics, or from breaking the XML."""
    return printable(name).replace("$", r"\$")


# -- SVG ---------------------------------------------------------------------------------------------------------

_SVG, _XLINK = "{http://www.w3.org/2000/svg}", "{http://www.w3.org/1999/xlink}"
_UNDATED: dict[str, dict[str, Any]] = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}


@contextmanager
def _settings(salt: str) -> Iterator[None]:
    """Keep text as text, files reproducible, and silence warnings about missing glyphs."""
    from matplotlib import rc_context

    with rc_context({"svg.fonttype": "none", "svg.hashsalt": salt}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph")
        yield


def _embedded(document: bytes, prefix: str, title: str, description: str) -> str:
    """Return the ``<svg>`` element of a document, fit to stand in a page with others of its kind."""
    root = etree.fromstring(document)
    for unwanted in [*root.iter(f"{_SVG}metadata"), *root.iter(f"{_SVG}style"), *root.iter(etree.Comment)]:
        parent = unwanted.getparent()
        if parent is not None:
            parent.remove(unwanted)  # a style would hold for the whole page
    for name in ("width", "height", "version"):
        root.attrib.pop(name, None)
    for element in root.iter():
        for name, value in element.attrib.items():
            if name == "id":
                element.set(name, f"{prefix}-{value}")
            elif name == f"{_XLINK}href":
                element.set(name, value.replace("#", f"#{prefix}-"))
            elif name == "d":
                element.set(name, _NUMBER.sub(_rounded, value))
            elif "url(#" in value:
                element.set(name, value.replace("url(#", f"url(#{prefix}-"))
    root.set("width", "100%")
    root.set("role", "img")
    root.set("style", "stroke-linejoin: round; stroke-linecap: butt")
    labels = []
    for tag, text in (("title", title), ("desc", description)):
        label = etree.Element(f"{_SVG}{tag}", id=f"{prefix}-{tag}")
        label.text = text
        labels.append(label)
    root[:0] = labels
    root.set("aria-labelledby", f"{prefix}-title {prefix}-desc")
    return etree.tostring(root, encoding="unicode")


_NUMBER = re.compile(r"-?\d+\.\d{3,}")


def _rounded(number: re.Match[str]) -> str:
    """Return a coordinate to a hundredth of a point."""
    return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")

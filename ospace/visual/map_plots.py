"""Plots of a map: quantities over the distance from the mass centre, over two joints, and seen from the sides."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ospace.analysis import map_text
from ospace.analysis.arm_map import Quantity
from ospace.analysis.map_result import MapResult
from ospace.kernels.tree import Floats, Ints
from ospace.visual import plots
from ospace.visual.plots import Theme

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT, _MAP_HEIGHT = 10.0, 2.6, 4.4
"""Inches: of a plot, and of one that is a picture."""
_FREE, _SINGULAR = "#009E73", "#D55E00"
"""Colours of path-independent and path-dependent shells, for all kinds of colour vision."""


@dataclass(frozen=True)
class Plot:
    """A plot in a page.

    Attributes
    ----------
    name, title : str
    svg : str
        An ``<svg>`` element.
    description : str
        The plot in words.
    """

    name: str
    title: str
    svg: str
    description: str


@dataclass(frozen=True)
class _Drawing:
    name: str
    title: str
    description: str
    height: float
    draw: Callable[[Any, Theme], None]
    """Takes a figure, or a part of one."""


def panels(result: MapResult, *, dark: bool) -> list[Plot]:
    """Return the plots of a map as they stand in a page.

    Parameters
    ----------
    result : MapResult
    dark : bool
        For a dark background.

    Returns
    -------
    list of Plot
    """
    made = []
    for one in _drawings(result):
        figure = _figure([one], dark=dark)
        text = plots.embedded(figure, one.name, one.title, one.description, dark=dark)
        made.append(Plot(one.name, one.title, text, one.description))
    return made


def figure(result: MapResult, *, dark: bool = False) -> Figure:
    """Return all plots of a map below each other; arguments as of `panels`."""
    return _figure(list(_drawings(result)), dark=dark)


def _figure(drawings: list[_Drawing], *, dark: bool) -> Figure:
    from matplotlib.figure import Figure

    theme = plots.DARK if dark else plots.LIGHT
    heights = [one.height for one in drawings]
    made = Figure(figsize=(_WIDTH, max(sum(heights), 1.0)), facecolor=theme.background, layout="constrained")
    if drawings:
        parts = made.subfigures(len(drawings), 1, height_ratios=heights, squeeze=False)[:, 0]
        for part, one in zip(parts, drawings, strict=True):
            part.set_facecolor("none")
            one.draw(part, theme)
            part.suptitle(one.title, x=0.01, ha="left", fontsize=11.0, color=theme.text)
    return made


def _drawings(result: MapResult) -> Iterator[_Drawing]:
    found = result.arm_map
    if not found.count:
        return
    for c, quantity in enumerate(found.fields):
        if quantity.name == "reach":
            continue
        unit = map_text.shown_unit(quantity)[1]
        title = f"{quantity.title}{', ' + unit if unit else ''}"
        yield _Drawing(
            f"over-reach-{quantity.name}",
            f"{title}, over the distance of the hand from the mass centre",
            f"{title}: smallest and largest in each of {len(found.shells.index)} shells about the mass centre.",
            _HEIGHT,
            partial(_over_reach, result, c),
        )
        if len(found.plane.index):
            first, second = result.arm.joints
            yield _Drawing(
                f"over-joints-{quantity.name}",
                f"{title}, over {first} and {second}",
                f"{title}: the smallest by the positions of {first} and {second}.",
                _MAP_HEIGHT,
                partial(_over_joints, result, c),
            )
        yield _Drawing(
            f"sides-{quantity.name}",
            f"{title}, largest along each line of sight, by the place of the hand in the base frame",
            f"{title}: the largest along lines of sight, from three sides.",
            _MAP_HEIGHT,
            partial(_sides, result, c),
        )


def _over_reach(result: MapResult, c: int, part: Any, theme: Theme) -> None:
    found, axes = result.arm_map, part.subplots()
    factor, unit = map_text.shown_unit(found.fields[c])
    radii, half = found.shell_radii, 0.5 * found.shell
    edges = np.column_stack([radii - half, radii + half]).ravel()
    low, high = (np.repeat(factor * of[:, c], 2) for of in (found.shells.low, found.shells.high))
    axes.fill_between(edges, low, high, color=theme.curves[0], alpha=0.75, linewidth=0.0, label="in a shell")
    if result.workspaces is not None:
        for shells, colour, name in (
            (result.workspaces.path_independent, _FREE, "path-independent"),
            (result.workspaces.path_dependent, _SINGULAR, "path-dependent"),
        ):
            for k, (begin, end) in enumerate(shells):
                axes.axvspan(
                    begin, end, color=colour, alpha=0.25, zorder=0.5, linewidth=0.0, label=name if k == 0 else None
                )
    axes.set_xlim(0.0, float(radii.max() + half))
    axes.set_xlabel("distance from the mass centre, m", color=theme.text)
    axes.set_ylabel(unit, color=theme.text)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), frameon=False, labelcolor=theme.text, fontsize=8.5)
    _dress(axes, theme)


def _over_joints(result: MapResult, c: int, part: Any, theme: Theme) -> None:
    found, arm = result.arm_map, result.arm
    factor, _ = map_text.shown_unit(found.fields[c])
    picture = np.full((found.plane_cells, found.plane_cells), np.nan)
    picture[found.plane.index[:, 1], found.plane.index[:, 0]] = factor * found.plane.low[:, c]
    scale = [map_text.shown_unit(Quantity("", "", unit)) for unit in arm.units]
    ends = [
        factor * end for (factor, _), low, high in zip(scale, arm.lower, arm.upper, strict=True) for end in (low, high)
    ]
    axes = part.subplots()
    image = axes.imshow(picture, origin="lower", extent=ends, aspect="auto", cmap="viridis", interpolation="nearest")
    for label, name, (_, unit) in zip((axes.set_xlabel, axes.set_ylabel), arm.joints, scale, strict=True):
        label(f"{plots.as_text(name)}, {unit}", color=theme.text)
    _bar(part, image, [axes], theme)
    _dress(axes, theme)


def _sides(result: MapResult, c: int, part: Any, theme: Theme) -> None:
    found = result.arm_map
    factor, _ = map_text.shown_unit(found.fields[c])
    values, index = factor * found.voxels.high[:, c], found.voxels.index
    sides = [[a for a in range(3) if a != across] for across in range(3) if not _flat(index, across)] or [[0, 1]]
    rows = part.subplots(1, len(sides), squeeze=False)[0]
    for axes, columns in zip(rows, sides, strict=True):
        picture, first = _seen(index[:, columns], values)
        begin, end = found.voxel * (first - 0.5), found.voxel * (first - 0.5 + np.array(picture.shape[::-1]))
        image = axes.imshow(
            picture, origin="lower", extent=(begin[0], end[0], begin[1], end[1]), aspect="equal", cmap="viridis",
            vmin=values.min(), vmax=values.max(), interpolation="nearest",
        )  # fmt: skip
        axes.set_xlabel(f"{'xyz'[columns[0]]}, m", color=theme.text)
        axes.set_ylabel(f"{'xyz'[columns[1]]}, m", color=theme.text)
        _dress(axes, theme)
    _bar(part, image, list(rows), theme)


def _flat(index: Ints, across: int) -> bool:
    """Return whether the voxels, seen across a direction, are no more than a line."""
    return any(np.ptp(index[:, a]) == 0 for a in range(3) if a != across)


def _seen(index: Ints, values: Floats) -> tuple[Floats, Ints]:
    """Return the largest value in each cell of two directions, (rows, columns), NaN where none is, and the first."""
    first = index.min(axis=0)
    picture = np.full(tuple(np.ptp(index, axis=0)[::-1] + 1), -np.inf)
    np.maximum.at(picture, tuple((index - first).T[::-1]), values)
    return np.where(np.isfinite(picture), picture, np.nan), first


def _bar(part: Any, image: Any, of: list[Axes], theme: Theme) -> None:
    bar = part.colorbar(image, ax=of, shrink=0.85)
    bar.ax.tick_params(colors=theme.text, labelsize=9.0)


def _dress(axes: Axes, theme: Theme) -> None:
    axes.set_facecolor("none")
    axes.tick_params(colors=theme.text, labelsize=9.0)
    for spine in axes.spines.values():
        spine.set_color(theme.grid)

"""Result of a map in words: facts, extremes of quantities, and the level-base envelope."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ospace.analysis.arm import Arm
from ospace.analysis.arm_map import Quantity
from ospace.analysis.map_result import MapResult
from ospace.analysis.workspace_shells import Interval, Workspaces
from ospace.exceptions import printable
from ospace.kernels.tree import Floats

_ROWS: dict[tuple[bool, ...], str] = {
    (True,) * 6: "position and attitude",
    (True, True, True, False, False, False): "position",
    (False, False, False, True, True, True): "attitude",
}
_ROUNDING = 1e-12
_DIRECTIONS = ("x", "y", "z", "turn about x", "turn about y", "turn about z")


def shown_unit(quantity: Quantity) -> tuple[float, str]:
    """Return the factor and the name of the unit in which people read a quantity: degrees, where it is an angle."""
    return (float(np.rad2deg(1.0)), "deg") if quantity.unit == "rad" else (1.0, quantity.unit)


def posture(arm: Arm, x: Floats) -> str:
    """Return joint positions as ``shoulder=0.2147, boom=0.4``, which --pose takes in quotes; rad, m."""
    return ", ".join(f"{name}={_plain(value, 4)}" for name, value in zip(arm.joints, x.tolist(), strict=True))


def intervals(shells: Sequence[Interval]) -> str:
    """Return radii as ``0 to 0.3511 m, 0.5537 to 1.4362 m``."""
    return ", ".join(f"{_plain(low, 4)} to {_plain(high, 4)} m" for low, high in shells) or "none"


def rows(arm: Arm) -> str:
    """Return which rows of the hand count, as ``position``."""
    axes = tuple(arm.point.axes)
    return _ROWS[axes] if axes in _ROWS else ", ".join(_named(axes))


def heading(result: MapResult) -> str:
    """Return what was mapped: hand, rows and joints."""
    arm = result.arm
    joints = ", ".join(arm.joints) if len(arm.joints) <= 3 else f"{len(arm.joints)} joints"
    return printable(f"{arm.robot.name}: {arm.point.frame} ({rows(arm)}) over {joints}")


def facts(result: MapResult) -> Iterator[tuple[str, str]]:
    """Yield what holds for the whole map, by name."""
    arm, count = result.arm, result.arm_map.count
    mapped = str(count) if count == result.wanted else f"{count} of {result.wanted}"
    yield "postures", f"{mapped}, {result.postures}"
    yield "base", "free-floating, momentum zero"
    yield "length L", f"{arm.length:.4g} m: with it, J* mixes no metres with radians"
    unused = [wanted and not used for wanted, used in zip(arm.point.axes, arm.rows, strict=True)]
    if any(unused):
        yield "left out", f"no joint moves the hand along: {', '.join(_named(unused))}"
    if result.workspaces is not None:
        yield from _workspaces(result.workspaces)
    if result.rays is not None:
        rays = result.rays
        span = rays.distance[rays.reached]
        ends = f"{_plain(span.min(), 4)} to {_plain(span.max(), 4)} m along" if len(span) else "the hand comes onto"
        yield "base level", f"{ends} {len(span)} of {len(rays.directions)} rays"


def _workspaces(found: Workspaces) -> Iterator[tuple[str, str]]:
    size = "area" if found.planar else "volume"
    yield "reach", f"{intervals([found.reach])} from the mass centre, any attitude of the base"
    yield "path-independent", f"{intervals(found.path_independent)} (PIW)"
    yield (
        "path-dependent",
        (f"{intervals(found.path_dependent)} (PDW), {100 * found.singular_share:.3g} % of the {size}"),
    )
    yield "searches", f"{found.singular} of {found.starts} met a singular posture"


def extremes(result: MapResult) -> Iterator[tuple[str, list[str], str]]:
    """Yield title, smallest, mean and largest, and unit of each quantity."""
    found = result.arm_map
    for c, quantity in enumerate(found.quantities if found.count else ()):
        factor, unit = shown_unit(quantity)
        numbers = factor * np.array([found.whole.low[0, c], found.mean[c], found.whole.high[0, c]])
        numbers[np.abs(numbers) < _ROUNDING * np.abs(numbers).max()] = 0.0
        yield quantity.title, [f"{number:.4g}" for number in numbers], unit


def places(result: MapResult) -> Iterator[tuple[str, str]]:
    """Yield the extremes that matter, and the posture of each."""
    found = result.arm_map
    for c, quantity in enumerate(found.quantities if found.count else ()):
        if found.whole.high[0, c] > 0.0 and quantity.name in (
            "singular_value",
            "base_turn",
            "disturbance",
            "wheel_x",
            "wheel_y",
            "wheel_z",
            "reach",
        ):
            least = quantity.name == "singular_value"
            at = (found.whole.at_low if least else found.whole.at_high)[0, c]
            yield quantity.title if least else f"largest {quantity.title}", posture(result.arm, at)


def grades(result: MapResult) -> Iterator[tuple[str, str, str, str]]:
    """Yield of the level-base envelope: the turn, the share of postures, the share of voxels, and the reach."""
    for one in result.grades:
        yield (
            f"{np.rad2deg(one.turn):.0f} deg",
            f"{100.0 * one.share:.1f} %",
            f"{100.0 * one.volume:.1f} %",
            intervals([one.reach]),
        )


def _named(axes: Sequence[bool]) -> list[str]:
    return [name for name, on in zip(_DIRECTIONS, axes, strict=True) if on]


def _plain(number: float, digits: int) -> str:
    """Return a number rounded; no zero has a sign."""
    text = f"{number:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text

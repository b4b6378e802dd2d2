"""Clearance: links keep away from each other, and from robots that move by themselves."""

from __future__ import annotations

import math
from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import ClassVar, NamedTuple

import numpy.typing as npt

from ospace.checks import check_kind
from ospace.collision import CollisionGeometry, Solid, pair_table
from ospace.exceptions import OspaceError, closest
from ospace.model.robot import SpaceRobot

Pair = tuple[str, str]
Named = str | Pair | Sequence[str]
"""A pair of links, or a link for all pairs that it is in."""
ROWS = 3
"""For each of the pairs that bound the motion at a time, on the average."""


@dataclass(frozen=True, eq=False)
class Obstacle:
    """A robot that moves by itself, as a target does.

    Attributes
    ----------
    robot : SpaceRobot
        Its links keep their names; those that the controlled robot has as well are called ``<name>/<link>``.
    motion : function of time
        Returns q (nq,) and v (nv,) at a time, s, as `SpaceRobot.state` takes them, in the inertial frame of the
        controlled robot. Between these it is taken to move freely.
    name : str, optional
        All its links are called ``<name>/<link>`` then, which tells obstacles of one model apart.
    """

    robot: SpaceRobot
    motion: Callable[[float], tuple[npt.ArrayLike, npt.ArrayLike]]
    name: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Clearance:
    """A distance that links keep from each other and from obstacles.

    Attributes
    ----------
    robot : SpaceRobot
        Read from a file, whose shapes count.
    distance : float
        m.
    deceleration : float
        By which links are slowed down as they come near, m/s²; those that are too near go apart by no more.
    obstacles : sequence of Obstacle
    ignore : sequence of pairs of links
        That are not kept apart; a link alone stands for all pairs with it.
    pairs : sequence of pairs of links, optional
        The only ones that are; else those that the table of allowed collisions leaves, and all with obstacles.
    geometry : CollisionGeometry, optional
        Of the robot, where it is not read from its file: `CollisionGeometry.of(chaser).on(robot)` of a robot that holds
        a target, whose links then do not count.
    most : int
        Pairs of solids that bound the motion at a time: the nearest ones.
    name : str
        Its name in a `Command`, behind those of the links.

    Raises
    ------
    OspaceError
        A number makes no sense, a link is unknown, has no shape or one that cannot be read, or no pair is left.
    """

    unit: ClassVar[str] = "m"
    robot: SpaceRobot
    distance: float
    deceleration: float = 0.2
    obstacles: Sequence[Obstacle] = ()
    ignore: Sequence[Named] = ()
    pairs: Sequence[Named] | None = None
    geometry: CollisionGeometry = None  # type: ignore[assignment]
    most: int = 20
    name: str = "clearance"

    def __post_init__(self) -> None:
        check_kind(self.robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
        if not _is_number(self.distance) or self.distance < 0.0:
            raise OspaceError(f"clearance: distance is {self.distance!r}: give a length in m, not below 0")
        if not _is_number(self.deceleration) or self.deceleration <= 0.0:
            raise OspaceError(f"clearance: deceleration is {self.deceleration!r}: give a finite number above 0")
        if not (isinstance(self.most, int) and 1 <= self.most <= 1000):
            raise OspaceError(f"clearance: most is {self.most!r}: give a number of pairs from 1 to 1000")
        if isinstance(self.obstacles, Obstacle):
            object.__setattr__(self, "obstacles", (self.obstacles,))
        for one in self.obstacles:
            check_kind(one, Obstacle, "make it of a robot and its motion: Obstacle(robot, motion)")
        if self.geometry is None:
            object.__setattr__(self, "geometry", CollisionGeometry.of(self.robot))
        check_kind(self.geometry, CollisionGeometry, "make it with CollisionGeometry.of(robot)")
        if self.geometry.robot is not self.robot:
            raise OspaceError(
                f"clearance: geometry is of another robot than '{self.robot.name}': make it with .on(robot)"
            )
        if not self.watched:
            raise OspaceError(
                f"clearance: no pair of links of robot '{self.robot.name}' is left to be kept apart: "
                + (
                    "they are ignored, or need no watch"
                    if len(self.links) > 1
                    else "the file gives a shape to less than two"
                )
            )

    @property
    def size(self) -> int:
        """Rows that it takes of a program."""
        return ROWS * self.most

    @cached_property
    def bodies(self) -> list[tuple[str, int, int, Solid]]:
        """Name of the link, number of the obstacle, or −1, joint and solid of all solids."""
        own = [(solid.link, -1, solid.joint, solid) for solid in self.geometry.solids]
        taken = set(self.robot.frame_names)
        for k, one in enumerate(self.obstacles):
            for solid in CollisionGeometry.of(one.robot).solids:
                own.append((link_name(one, solid.link, taken), k, solid.joint, solid))
        return own

    @cached_property
    def links(self) -> list[str]:
        """Names of all links that have a shape."""
        return list(dict.fromkeys(name for name, *_ in self.bodies))

    @cached_property
    def watched(self) -> list[Pair]:
        """Pairs of links that are kept apart."""
        ignored, chosen = self._named("ignore", self.ignore), self._named("pairs", self.pairs or ())
        self._refuse_unread(ignored, chosen)
        table = pair_table(self.geometry, self.distance, sampled=self.pairs is None)
        own = self.geometry.links
        table |= {(link, other): "watched" for other in self.links if other not in own for link in own}
        if self.pairs is None:
            among = [pair for pair, reason in table.items() if reason == "watched"]
        else:
            among = [pair for pair in table if _is_among(pair, chosen)]
            for names in chosen:
                moving = [pair for pair in among if names <= set(pair) and table[pair] != "one body"]
                if not moving:
                    raise OspaceError(f"clearance: pairs has {' / '.join(sorted(names))}, whose distance never changes")
            among = [pair for pair in among if table[pair] != "one body"]
        return [pair for pair in among if not _is_among(pair, ignored)]

    def _named(self, key: str, given: Iterable[Named]) -> list[frozenset[str]]:
        """Return names of links, one or two together; those that are unknown are refused."""
        if isinstance(given, str) or not isinstance(given, Iterable):
            raise OspaceError(f"clearance: {key} is {given!r}: give a sequence of pairs of links")
        found = []
        known = [*self.links, *self.geometry.unread]
        for one in given:
            names = (one,) if isinstance(one, str) else tuple(one) if isinstance(one, Iterable) else (one,)
            if len(names) not in (1, 2) or len(set(names)) != len(names):
                raise OspaceError(f"clearance: {key} has {one!r}: give two links, or one for all pairs that it is in")
            for name in names:
                if name not in known:
                    frames = self.robot.frame_names
                    what = "has no shape in its file" if name in frames else f"is unknown{closest(str(name), known)}"
                    raise OspaceError(f"clearance: {key}: link {name!r} {what}")
            found.append(frozenset(names))
        return found

    def _refuse_unread(self, ignored: Sequence[frozenset[str]], chosen: Sequence[frozenset[str]]) -> None:
        """Refuse a link whose mesh cannot be read, unless it is ignored or no pair of it is chosen."""
        unread = dict(self.geometry.unread)
        for one in self.obstacles:
            unread |= CollisionGeometry.of(one.robot).unread
        for link, reason in unread.items():
            wanted = self.pairs is None or any(link in names for names in chosen)
            if wanted and frozenset([link]) not in ignored:
                raise OspaceError(
                    f"clearance: a shape of link '{link}' cannot be read, {reason}: give the folder of its package, or "
                    f"ignore the link"
                )


def link_name(obstacle: Obstacle, link: str, taken: Container[str]) -> str:
    """Return what a link of an obstacle is called beside a robot that has frames of the names `taken`."""
    return f"{obstacle.name or obstacle.robot.name}/{link}" if obstacle.name or link in taken else link


class Nearest(NamedTuple):
    """The two links that are nearest to each other, of those that are kept apart.

    Attributes
    ----------
    distance : float
        Of the two, m; negative where they overlap.
    links : (str, str)
    """

    distance: float
    links: Pair


def _is_among(pair: Pair, named: Iterable[frozenset[str]]) -> bool:
    return any(names <= set(pair) for names in named)


def _is_number(given: object) -> bool:
    return isinstance(given, Real) and not isinstance(given, bool) and math.isfinite(given)

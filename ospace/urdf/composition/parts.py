"""Parts of a robot: as they are given, as they stand in it, and the robot that they make."""

from __future__ import annotations

import os
import re
from bisect import bisect
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from ospace.checks import checked_vector
from ospace.exceptions import OspaceError, printable
from ospace.kernels.tree import Floats
from ospace.urdf.composition.simple_body import is_simple_body, mesh_file
from ospace.urdf.description import ZERO, Triple
from ospace.urdf.lint.findings import Finding

_SUBJECT = re.compile(r"(link|joint|part) '(.*?)'(?: with \d+ fixed to it)?", re.DOTALL)


@dataclass(frozen=True)
class Part:
    """A part of a robot, and where it stands.

    Attributes
    ----------
    source : path-like
        A URDF or xacro, or a body in a few words: ``box:1x1x0.8m,250kg``, ``cylinder:``, ``sphere:``, ``body:``, or a
        mesh with its mass or density, ``bus.stl,250kg``.
    at, rpy : (3,)
        Placement of its root's frame in that of the link `on`. m; roll, pitch, yaw about fixed axes, rad.
    on : str, optional
        Link that it is fixed to, by its name in the composed robot; the base without it.
    prefix : str
        Comes before its names of links, joints and all else.
    remove : tuple of str
        Links to leave out, by their names in the file, with all that they carry. Where nothing that has mass would be
        left, the link is a stand: it goes, with what is fixed to it, and the arm on it stays.
    name : str
        Link of a body in a few words; ``bus`` for the first part, ``body`` for others without it.
    xacro_args : mapping of str to str
        Values of the <xacro:arg> of a xacro.

    Raises
    ------
    OspaceError
        Source, placement, prefix or names of links make no sense.
    """

    source: str | os.PathLike[str]
    at: Triple = ZERO
    rpy: Triple = ZERO
    on: str | None = None
    prefix: str = ""
    remove: tuple[str, ...] = ()
    name: str = ""
    xacro_args: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not isinstance(self.source, str | os.PathLike) or not os.fspath(self.source):
            raise OspaceError(f"source {self.source!r}: give the path of a URDF, or a body as 'box:1x1x0.8m,250kg'")
        for key in ("at", "rpy"):
            object.__setattr__(
                self, key, tuple(checked_vector(getattr(self, key), 3, f"{key} of {self.source}").tolist())
            )
        prefix = self.prefix if isinstance(self.prefix, str) else " "
        if not re.fullmatch(r"[^\s<>&\"']*", prefix) or not prefix.isprintable():
            raise OspaceError(f"prefix {self.prefix!r}: give a word, such as 'left_'")
        if isinstance(self.remove, str):
            object.__setattr__(self, "remove", (self.remove,))

    @property
    def file(self) -> Path | None:
        """Return the file that it is read from, a robot's or a mesh; None where there is none."""
        text = os.fspath(self.source)
        return mesh_file(text) if is_simple_body(text) else Path(text)


@dataclass(frozen=True)
class PlacedPart:
    """A part as it stands in the robot.

    Attributes
    ----------
    part : Part
    robot : str
        Name of the robot in its file.
    on : str
        The link that it is fixed to; empty for the first part.
    links, joints : tuple of str
        Their names in the composed robot.
    moving : int
        Joints that are not fixed.
    mass : float
        kg.
    removed : tuple of str
        Links that were left out, by their names in the file; `WORLD` among them where that was only a frame.
    note : str
        On a mesh: how large it is, and whether it is closed.
    """

    part: Part
    robot: str
    on: str
    links: tuple[str, ...]
    joints: tuple[str, ...]
    moving: int
    mass: float
    removed: tuple[str, ...]
    note: str

    @property
    def label(self) -> str:
        """Return what it is called: its prefix, or else its source."""
        return self.part.prefix or self.source

    @property
    def source(self) -> str:
        """Return the name of its file without the folder; the words that describe a body."""
        text = os.fspath(self.part.source)
        file = self.part.file
        return text if file is None else file.name + text.removeprefix(str(file))

    @property
    def comment(self) -> str:
        """Return the comment that stands before it in the file."""
        part = self.part
        words = [f"'{self.robot}' of {os.fspath(part.source)}"]
        if part.prefix:
            words.append(f"prefix {part.prefix}")
        if self.on:
            words.append(f"on {self.on} at {_numbers(part.at)} m, rpy {_numbers(part.rpy)} rad")
        if self.removed:
            words.append(f"without {', '.join(self.removed)}")
        return re.sub("-(?=-|$)", "- ", printable("; ".join(words)))


@dataclass(frozen=True)
class Composition:
    """A robot of several parts.

    Attributes
    ----------
    content : bytes
        Its URDF.
    parts : tuple of PlacedPart
    findings : tuple of Finding
        Of the whole, as `ospace check` has them, and what xacro warned of; with an error among them no robot is made
        of the file.
    total_mass : float
        kg.
    mass_centre : (3,)
        Centre of mass in the frame of the base link, joints at zero. m.
    base : str
        The base link.
    """

    content: bytes
    parts: tuple[PlacedPart, ...]
    findings: tuple[Finding, ...]
    total_mass: float
    mass_centre: Floats
    base: str

    def part_of(self, finding: Finding) -> PlacedPart | None:
        """Return the part that a finding is about; None where it is about the whole.

        Returns
        -------
        PlacedPart or None
        """
        match = _SUBJECT.match(finding.subject)
        if match and match[1] == "part":
            return next((part for part in self.parts if part.label == match[2]), None)
        if match:
            key = "links" if match[1] == "link" else "joints"
            return next((part for part in self.parts if match[2] in getattr(part, key)), None)
        if finding.line is None:
            return None
        k = bisect(self._starts, finding.line) - 1
        return self.parts[k] if k >= 0 else None

    @cached_property
    def _starts(self) -> list[int]:
        """Return the line in which each part starts."""
        starts, at = list[int](), 0
        for part in self.parts:
            at = self.content.index(f"<!-- {part.comment} -->".encode(), at)
            starts.append(self.content.count(b"\n", 0, at) + 1)
        return starts


def _numbers(values: Triple) -> str:
    return " ".join(f"{value:g}" for value in values)

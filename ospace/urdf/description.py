"""Content of a URDF, in numbers: the part that dynamics, shapes and findings need."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

Triple = tuple[float, float, float]
Colour = tuple[float, float, float, float]
ZERO: Triple = (0.0, 0.0, 0.0)


class SourceLine(int):
    """Line of a file that a xacro includes, which is called `file`."""

    file: str

    def __new__(cls, line: int, file: str) -> SourceLine:
        """Make one."""
        made = super().__new__(cls, line)
        made.file = file
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        """Keep the name across processes."""
        return SourceLine, (int(self), self.file)


@dataclass(frozen=True)
class Pose:
    """Placement in the frame above: m, and roll, pitch, yaw about fixed axes in rad."""

    xyz: Triple = ZERO
    rpy: Triple = ZERO


@dataclass(frozen=True)
class Inertial:
    """Mass (kg), and the tensor (kg m²) about the centre of mass in the axes of `pose`."""

    line: int | None
    pose: Pose
    mass: float
    tensor: tuple[float, float, float, float, float, float]
    """ixx, ixy, ixz, iyy, iyz, izz."""


@dataclass(frozen=True)
class Shape:
    """One <visual> or <collision>.

    `size` is that of URDF: (x, y, z) of a box, (radius, length) of a cylinder or capsule, (radius,) of a sphere; for a
    mesh the three factors of its scale. `colour` is red, green, blue and opacity from 0 to 1, None where the file has
    none.
    """

    line: int | None
    role: Literal["visual", "collision"]
    pose: Pose
    kind: Literal["box", "cylinder", "capsule", "sphere", "mesh"]
    size: tuple[float, ...]
    filename: str = ""
    colour: Colour | None = None


@dataclass(frozen=True)
class Link:
    """A link; without `inertial` it has no mass."""

    line: int | None
    name: str
    inertial: Inertial | None
    shapes: tuple[Shape, ...] = ()

    @property
    def subject(self) -> str:
        """Return the name that findings use."""
        return f"link '{self.name}'"

    @property
    def weightless(self) -> bool:
        """Return whether the link has no <inertial>, or one of zeros alone."""
        return self.inertial is None or not (self.inertial.mass or any(self.inertial.tensor))


@dataclass(frozen=True)
class Limit:
    """Limits of a joint; infinite where there are none."""

    line: int | None
    lower: float
    upper: float
    effort: float
    velocity: float


@dataclass(frozen=True)
class Mimic:
    """position = multiplier × position of `joint` + offset."""

    line: int | None
    joint: str
    multiplier: float
    offset: float


@dataclass(frozen=True)
class Joint:
    """A joint; `axis` is of unit length, in the joint's frame, `limit` None where the file gives none."""

    line: int | None
    name: str
    kind: str
    parent: str
    child: str
    pose: Pose
    axis: Triple
    limit: Limit | None
    damping: float
    friction: float
    mimic: Mimic | None

    @property
    def subject(self) -> str:
        """Return the name that findings use."""
        return f"joint '{self.name}'"


@dataclass(frozen=True)
class Description:
    """A robot as its file describes it; from `tree.span` on, each joint stands behind those on its way."""

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]

    @cached_property
    def link(self) -> dict[str, Link]:
        """Return the links by name."""
        return {link.name: link for link in self.links}

    @cached_property
    def joint(self) -> dict[str, Joint]:
        """Return the joints by name."""
        return {joint.name: joint for joint in self.joints}

    @cached_property
    def root(self) -> str:
        """Return the name of the link that is the child of no joint."""
        children = {joint.child for joint in self.joints}
        return next(link.name for link in self.links if link.name not in children)

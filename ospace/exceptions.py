"""Errors of ospace: `OspaceError` and its few children, each with the data that explains it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any


def printable(text: str) -> str:
    """Return the text with escapes for what a terminal would obey or not show, as control characters."""
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in text)


def printable_lines(text: str) -> str:
    """Return the text with such escapes, its line breaks kept."""
    return "\n".join(map(printable, text.split("\n")))


class OspaceError(Exception):
    """Base of all errors that ospace raises on purpose; the message says what is wrong and what would be right.

    Each crosses process boundaries, and copies, with its message, attributes and notes, whatever its constructor takes.
    """

    def __reduce__(self) -> tuple[Any, ...]:
        """Keep what the constructor left; Python would call it again, with the message for its arguments."""
        return _restored, (type(self), *self.args), vars(self)


def _restored(kind: type[OspaceError], *arguments: object) -> OspaceError:
    return kind.__new__(kind, *arguments)


class SingularInertiaError(OspaceError):
    """A joint moves nothing, or the base: no inertia is left to resist it, so accelerations are not defined.

    Attributes
    ----------
    joint : str or None
        The joint; None for the base.
    """

    def __init__(self, joint: str | None) -> None:
        super().__init__(
            "the base has no inertia about some axis in this state, beside that of what it carries, so the joint-space "
            "inertia is singular: give it three moments of inertia, and masses in kg, or choose a heavier root link"
            if joint is None
            else f"joint '{joint}' carries no inertia in this state, so the joint-space inertia is singular: "
            f"give the links beyond '{joint}' mass and inertia, or make the joint fixed"
        )
        self.joint = joint


class DependentRowsError(OspaceError):
    """The rows of the operational points depend on each other, so Γ_e has no inverse.

    Attributes
    ----------
    rank, rows : int
        Rank found, and rows given.
    points : tuple of str
        Points with rows that take part in the dependency.
    """

    def __init__(self, rank: int, rows: int, points: Iterable[str]) -> None:
        self.rank, self.rows, self.points = rank, rows, tuple(points)
        named = ", ".join(f"'{name}'" for name in self.points)
        super().__init__(
            f"the {rows} rows of the operational points have rank {rank} in this state; rows of {named} depend on "
            f"each other: take fewer rows with robot.point(…, axes=…), or strict=False for the pseudo-inverse"
        )


_COMPARED = 100  # characters: to compare two names takes their product


def closest(name: str, choices: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for an unknown `name`, or the choices where nothing is near."""
    known = sorted(choice for choice in set(choices) if len(choice) <= _COMPARED)
    near = difflib.get_close_matches(name[:_COMPARED], known, n=3)
    if near:
        return "; did you mean " + " or ".join(f"'{printable(one)}'" for one in near) + "?"
    shown = printable(", ".join(known[:12])) + (f", … ({len(known)} in all)" if len(known) > 12 else "")
    return f"; known: {shown}" if known else ""

"""Limits that stand for none, as exporters, converters and SDF write them."""

from __future__ import annotations

import math
import re
import sys

from ospace.urdf.numbers import LARGEST, NumberError, number, without_space_around

POSITION = ("lower", "upper")
_INFINITE = re.compile(r"[+-]?(?:\.?inf(?:inity)?|1\.#inf0*)", re.IGNORECASE)
_NINES = re.compile(r"[+-]?9{4,}(?:\.[09]*)?")
_OF_SDF = -1.0
MOST_ANGLE, NEVER_REACHED = 1e4, 1e6
"""Limits of an angle beyond the first mean none; from the second on a limit is as good as none: `--fix` writes 1e9."""


def stands_for_none(text: str, key: str, kind: str) -> bool:
    """Return whether a limit is written as one that means "no limit".

    Infinite numbers, those beyond 1e12, and rows of nines (9999, 999999.0) do; so do −1 of effort and velocity, and
    angles from 1e4 to 1e6 rad. The sign must be that of a limit on this side.

    Parameters
    ----------
    text : str
        As the file has it.
    key : str
        Attribute of <limit>: lower, upper, effort or velocity.
    kind : str
        Type of the joint.

    Returns
    -------
    bool
    """
    word = without_space_around(text)
    if word.startswith("-") != (key == "lower"):
        return key not in POSITION and _value(word) == _OF_SDF
    if _INFINITE.fullmatch(word) or _NINES.fullmatch(word):
        return True
    size = abs(_value(word))
    if key in POSITION and kind == "revolute" and MOST_ANGLE <= size < NEVER_REACHED:
        return True
    return LARGEST < size < sys.float_info.max  # the largest of all is Pinocchio's own way to write none


def _value(word: str) -> float:
    try:
        return number(word)
    except NumberError:
        return math.nan

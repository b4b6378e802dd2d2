"""Numbers of a URDF, strictly: what is not plainly a finite decimal number is none."""

from __future__ import annotations

import math
import re

LARGEST, SMALLEST, LIGHTEST = 1e12, 1e-100, 1e-15
"""The largest mass, length or inertia, the smallest inertia and the lightest mass that are not zero, in SI units:
products and inverses of several must stay finite."""

_PLAIN = re.compile(r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_SPACE = " \t\r\n"


class NumberError(ValueError):
    """The text is not a number; the message says why."""


class RangeError(NumberError):
    """The number is too large, or so small that it reads as zero."""


def number(text: str, largest: float = math.inf, smallest: float = 0.0) -> float:
    """Read one number, which white space may surround.

    Returns
    -------
    float

    Raises
    ------
    NumberError
        The text is not a finite decimal number; `RangeError` where its size exceeds `largest`, or is not zero and
        smaller than `smallest`, or reads as zero.
    """
    word = without_space_around(text)
    if not _PLAIN.fullmatch(word):
        raise NumberError(_reason(word))
    value = float(word)
    if math.isinf(value):
        raise NumberError("is too large for a floating-point number")
    if abs(value) > largest:
        raise RangeError(f"is larger than {largest:g}")
    if 0.0 < abs(value) < smallest:
        raise RangeError(f"is smaller than {smallest:g} and not zero")
    if value == 0.0 and re.search("[1-9]", re.split("[eE]", word)[0]):
        raise RangeError("is so small that it reads as zero")
    return value


def numbers(text: str, count: int, largest: float = math.inf, smallest: float = 0.0) -> tuple[float, ...]:
    """Read `count` numbers that white space separates.

    Returns
    -------
    tuple of float

    Raises
    ------
    NumberError
        There are more or fewer, or one of them is not a number, as `number` has it.
    """
    parts = words(text)
    if len(parts) != count:
        raise NumberError(_hidden(text) or f"has {len(parts)} numbers instead of {count}")
    return tuple(number(word, largest, smallest) for word in parts)


def words(text: str) -> list[str]:
    """Split at the white space of XML, which alone separates numbers.

    Returns
    -------
    list of str
    """
    return [word for word in re.split(f"[{_SPACE}]+", text) if word]


def has_space_around(text: str) -> bool:
    """Return whether white space surrounds the text.

    Returns
    -------
    bool
    """
    return text != without_space_around(text)


def without_space_around(text: str) -> str:
    """Return the text without the white space that surrounds it.

    Returns
    -------
    str
    """
    return text.strip(_SPACE)


def _reason(word: str) -> str:
    if not word:
        return "is empty"
    if hidden := _hidden(word):
        return hidden
    if re.fullmatch(r"[+-]?(nan|inf|infinity)", word, re.IGNORECASE):
        return "is not finite"
    if re.fullmatch(r"[+-]?0[xX][0-9a-fA-F.pP+-]+", word):
        return "is hexadecimal"
    if _PLAIN.fullmatch(word.removesuffix(",")):
        return f"has a comma behind '{word.removesuffix(',')}', where white space alone separates numbers"
    if _PLAIN.fullmatch(word.replace(",", ".", 1)):
        return "has a decimal comma"
    leading = _PLAIN.match(word)
    return f"has '{word[leading.end() :].strip()}' behind the number" if leading else "is not a number"


def _hidden(text: str) -> str:
    """Name the first character that cannot be seen, as a no-break space: a message cannot show it."""
    unseen = next((letter for letter in text if not letter.isprintable() and letter not in _SPACE), None)
    return "" if unseen is None else f"has the character U+{ord(unseen):04X}"

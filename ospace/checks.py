"""Checks of numbers that users hand in, and of numbers that are handed out."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Real

import numpy as np
import numpy.typing as npt

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats


def real_numbers(given: object) -> Floats:
    """Return `given` as an array of float64, itself if it is one; raise `TypeError` or `ValueError` for anything else.

    NumPy by itself drops imaginary parts, reads text, and takes None for NaN and True for 1.
    """
    array = np.asarray(given)
    if array.dtype == np.float64:
        return array
    if array.dtype.kind == "O":
        if not all(isinstance(one, Real) for one in array.flat):
            raise TypeError("not all are real numbers")
    elif array.dtype.kind not in "iuf":
        raise TypeError(f"{array.dtype} is not a type of real numbers")
    try:
        return array.astype(np.float64)
    except OverflowError as error:
        raise ValueError(str(error)) from None


def checked_number(given: object, name: str) -> float:
    """Return `given` as a float; raises `OspaceError` unless it is one finite real number."""
    number = checked_numbers(given, name)
    if number.shape != ():
        raise OspaceError(f"{name} is {given!r}: give a finite number")
    return float(number)


def checked_numbers(given: object, name: str) -> Floats:
    """Return `given` as an array of float64; raises `OspaceError` unless all are finite real numbers."""
    try:
        numbers = real_numbers(given)
    except (TypeError, ValueError):
        numbers = np.full(1, np.nan)
    if not np.isfinite(numbers).all():
        raise OspaceError(f"{name} is {given!r}: give a finite number")
    return numbers


def check_whole(name: str, number: object, least: int) -> None:
    """Raise `OspaceError` where `number` is no whole number from `least` on."""
    if not isinstance(number, int | np.integer) or isinstance(number, bool) or number < least:
        raise OspaceError(f"{name} is {number!r}: give a whole number from {least} on")


def checked_names(given: object, known: Iterable[str], what: str) -> tuple[str, ...]:
    """Return one name or several as a tuple; raises `OspaceError` for one that is not among the `known`."""
    known = tuple(known)
    names = (given,) if isinstance(given, str) else tuple(given) if isinstance(given, Iterable) else (given,)
    for name in names:
        if name not in known:
            raise OspaceError(f"{what} {name!r} is unknown: give some of {', '.join(known)}")
    return names


def checked_vector(given: npt.ArrayLike, size: int, name: str, robot: str | None = None) -> Floats:
    """Return a copy of `given` as (size,) float64; raises `OspaceError` for another shape or numbers not finite."""
    try:
        vector = np.array(real_numbers(given))
    except (TypeError, ValueError):
        raise OspaceError(f"{name} is not an array of real numbers: {given!r}") from None
    if vector.shape != (size,):
        needed = "it takes" if robot is None else f"robot '{robot}' needs"
        raise OspaceError(f"{name} has shape {vector.shape}; {needed} ({size},)")
    wrong = np.flatnonzero(~np.isfinite(vector))
    if wrong.size:
        raise OspaceError(f"{name}[{wrong[0]}] is {vector[wrong[0]]}: all numbers must be finite")
    return vector


def not_finite(what: str) -> OspaceError:
    """Return the error for results that are not finite: inputs so large that the arithmetic overflowed."""
    return OspaceError(
        f"{what} is not finite: masses, lengths, positions or velocities are too large or too small to compute with"
    )


def all_finite(results: tuple[Floats, ...], what: str) -> None:
    """Raise `OspaceError` if a result is not finite."""
    if not all(np.isfinite(result).all() for result in results):
        raise not_finite(what)


def check_kind(given: object, kind: type, remedy: str) -> None:
    """Raise `OspaceError` where an argument is not of its kind, such as a robot in the place of its state."""
    if not isinstance(given, kind):
        raise OspaceError(f"{given!r:.60} is not a {kind.__name__}: {remedy}")

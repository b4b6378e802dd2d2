"""Checks of numbers that users hand in, and of numbers that are handed out."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ospace.exceptions import OspaceError
from ospace.kernels.tables import Floats


def checked_vector(given: npt.ArrayLike, size: int, name: str, robot: str) -> Floats:
    """Return a copy of `given` as (size,) float64; raises `OspaceError` for another shape or numbers not finite."""
    try:
        vector = np.array(given, dtype=np.float64)
    except (TypeError, ValueError):
        raise OspaceError(f"{name} is no array of numbers: {given!r}") from None
    if vector.shape != (size,):
        raise OspaceError(f"{name} has shape {vector.shape}; robot '{robot}' needs ({size},)")
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

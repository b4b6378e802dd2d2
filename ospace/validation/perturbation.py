"""Error of an inverse on the numerical range when the matrix that is inverted is off by rounding.

Of a symmetric A with the rank k, k eigenvalues λ are inverted and the others (the largest of them λ_0) count as zero.
With A⁺ = Σ v vᵀ/λ and K = Σ v vᵀ/(λ (λ − λ_0)) over the eigenvectors that are kept, N = 1 − A A⁺, a change δA gives

    δ(A⁺) = −A⁺ δA A⁺ + K δA N + N δA K

to first order, so that ‖δ(A⁺)‖ is at most ‖A⁺‖² ‖δA‖ at full rank. It holds while ‖δA‖ stays below half the gap
λ_k − λ_0; from there on rounding decides what is kept, and nothing can be said of the inverse.

The rank itself is a decision: that of the Jacobian behind A, by singular values above a cutoff. Where one lies as near
the cutoff as its own rounding, two ways to compute it may decide differently, and again nothing can be said.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ospace.dynamics.dense import RANK_CUTOFF, scaled_singular_values
from ospace.kernels.tree import Floats


class Factor(NamedTuple):
    """A scaled factor beside an inverse, and how far it may be off, units of rounding."""

    value: Floats
    off: float = 0.0


class InversePerturbation:
    """Bound on the error of products L A⁺ R, where δA = D⁻¹ E D⁻¹ with ‖E‖ ≤ `off` units of rounding.

    D = diag(`scale`). At full rank D A D is inverted, else A as it stands: the inversion adds one unit of the size of
    what it inverts.

    Parameters
    ----------
    A : (r, r)
    rank : int
    scale : (r,)
    off : float
    unit : float
    decided : bool
        Whether the rank is.
    """

    def __init__(self, A: Floats, rank: int, scale: Floats, *, off: float, unit: float, decided: bool) -> None:
        r, full = len(A), rank == len(A)
        self._T = np.ones(r) if full else 1.0 / scale  # to the coordinates in which A is inverted
        eigenvalues, vectors = np.linalg.eigh(A * np.outer(scale, scale) if full else A)
        (nothing, values), (zero, kept) = (np.split(one, [r - rank], axis=-1) for one in (eigenvalues, vectors))
        self._off, self._rounding = off, float(np.abs(eigenvalues).max(initial=0.0))
        change = unit * (off * float(np.square(self._T).max()) + self._rounding)
        largest_zero = float(np.abs(nothing).max(initial=0.0))
        self._stable = decided and bool((values - largest_zero > 2.0 * change).all())
        inverse, N = kept / values @ kept.T, zero @ zero.T
        K = kept / (values * (values - largest_zero)) @ kept.T if self._stable else np.zeros_like(N)
        self._terms = [(inverse, inverse), (K, N), (N, K)]
        self._scaled_inverse = self._T[:, None] * inverse * self._T

    def of(self, left: Factor | None = None, right: Factor | None = None) -> float:
        """Return how far an element of `left` D⁻¹ A⁺ D⁻¹ `right` may be off, units; inf where rounding decides."""
        if not self._stable:
            return np.inf
        every = Factor(np.eye(len(self._T)))
        left, right = left or every, right or every
        L, R = left.value * self._T, self._T[:, None] * right.value
        off = left.off * _columns(self._scaled_inverse @ right.value)
        off += right.off * _rows(left.value @ self._scaled_inverse)
        for X, Y in self._terms:
            LX, YR = L @ X, Y @ R
            off += self._off * _rows(LX * self._T) * _columns(self._T[:, None] * YR)
            off += self._rounding * _rows(LX) * _columns(YR)
        return off


def rank_is_decided(J: Floats, mobility: Floats, inertia: Floats, *, off: float, unit: float) -> bool:
    """Return whether no scaled singular value of `J` is so near the cutoff that rounding decides on which side it is.

    `off` is that of the scaled `J`, in units. One way squares singular values before it compares, so that they are
    off by a unit of the largest square.
    """
    values = scaled_singular_values(J, mobility, inertia)
    most = max(1.0, float(values.max(initial=0.0)))
    band = unit * (2.0 * off * values + most**2)
    return bool((np.abs(values**2 - (RANK_CUTOFF * most) ** 2) > band).all())


def _rows(X: Floats) -> float:
    """Return the norm of the largest row."""
    return float(np.linalg.norm(X, axis=1).max(initial=0.0))


def _columns(X: Floats) -> float:
    """Return the norm of the largest column."""
    return float(np.linalg.norm(X, axis=0).max(initial=0.0))

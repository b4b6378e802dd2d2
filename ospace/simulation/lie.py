"""Increments of configurations that are no vectors, as power series of the adjoint.

A configuration is a product of groups: SE(3), SE(2), SO(3), and vectors. With A = ad_u of an increment u (block by
block; zero where the group is commutative), velocities in body axes,

    ∂(q ⊕ u)/∂u = Σ (−A)ᵏ/(k + 1)!            EXP
    ∂(q ⊕ u)/∂q = Σ (−A)ᵏ/k!                  TRANSPORT
    ∂(q⁺ ⊖ q)/∂q⁺ = Σ (−1)ᵏ B_k Aᵏ/k! = 1 + A/2 + A²/12 − …    LOG, at q⁺ = q ⊕ u

with the Bernoulli numbers B_k, B_1 = −1/2. Steps turn by far less than a radian, so that a dozen terms are exact to
rounding, where closed forms (`pin.dDifference`) lose digits to cancellation: 1e-8 at increments of 1e-3.
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats

_TERMS = 13
_LOG_OF_ROUNDING = math.log(1e-17)
_BERNOULLI = (1, -1 / 2, 1 / 6, 0, -1 / 30, 0, 1 / 42, 0, -1 / 30, 0, 5 / 66, 0, -691 / 2730)

EXP = np.array([(-1) ** k / math.factorial(k + 1) for k in range(_TERMS)])
TRANSPORT = np.array([(-1) ** k / math.factorial(k) for k in range(_TERMS)])
LOG = np.array([(-1) ** k * _BERNOULLI[k] / math.factorial(k) for k in range(_TERMS)])
_ALTERNATING = np.array([(-1) ** k for k in range(_TERMS)])
LOG_BACK = LOG * _ALTERNATING
"""−∂(q⁺ ⊖ q)/∂q."""

# (row, column, sign, number of the increment) of ad_u
_CROSS = ((0, 1, -1, 2), (0, 2, 1, 1), (1, 0, 1, 2), (1, 2, -1, 0), (2, 0, -1, 1), (2, 1, 1, 0))
_SO3 = _CROSS
_SE3 = (
    *((i, j, sign, k + 3) for i, j, sign, k in _CROSS),
    *((i, j + 3, sign, k) for i, j, sign, k in _CROSS),
    *((i + 3, j + 3, sign, k + 3) for i, j, sign, k in _CROSS),
)
_SE2 = ((0, 1, -1, 2), (1, 0, 1, 2), (0, 2, 1, 1), (1, 2, -1, 0))
_GROUPS = {"JointModelFreeFlyer": _SE3, "JointModelPlanar": _SE2, "JointModelSpherical": _SO3}


class Adjoint:
    """ad_u of the increments of one model's configurations."""

    def __init__(self, model: pin.Model) -> None:
        entries = [
            (model.idx_vs[j] + row, model.idx_vs[j] + column, sign, model.idx_vs[j] + k)
            for j in range(1, model.njoints)
            for row, column, sign, k in _entries(model, j)
        ]
        self._rows, self._columns, self._signs, self._numbers = (np.array(part) for part in zip(*entries, strict=True))
        self._A = np.zeros((model.nv, model.nv))

    def at(self, u: Floats) -> Floats:
        """Return A = ad_u (nv, nv), overwritten by the next call."""
        self._A[self._rows, self._columns] = self._signs * u[self._numbers]
        return self._A


def _entries(model: pin.Model, j: int) -> tuple[tuple[int, int, int, int], ...]:
    kind = model.joints[j].shortname()
    if kind == "JointModelComposite" and model.nqs[j] != model.nvs[j]:
        raise OspaceError(
            f"joint '{model.names[j]}' is composed of joints that are no vectors: "
            f"take integrator='rk4' without tolerance"
        )
    return _GROUPS.get(kind, ())


def terms_of(u: Floats) -> int:
    """Return how many terms of a series of ad_u count: no row of ad_u sums to more than four numbers of u."""
    size = 4.0 * float(np.abs(u).max())
    if not 0.0 < size < 1.0:
        return _TERMS
    return min(_TERMS, 2 + math.ceil(_LOG_OF_ROUNDING / math.log(size)))


def series(coefficients: Floats, A: Floats, x: Floats, terms: int = _TERMS) -> Floats:
    """Return Σ c_k Aᵏ x, of as many `terms`."""
    y: Floats = coefficients[terms - 1] * x
    for c in coefficients[: terms - 1][::-1]:
        y = A @ y + c * x
    return y

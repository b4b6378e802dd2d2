"""Operational-space dynamics where joints mimic others, from the composite bodies.

`pv_osimr` eliminates one joint after the other, which joints that move together do not allow. With H_m* and c_m* of
their common degrees of freedom, (7) and (12) give the same:

    H_m* = L Lᵀ,   Y = L⁻¹ J_m*ᵀ,   u = L⁻¹ c_m*
    Λ⁻¹ = Yᵀ Y,   Γ_e⁻¹ = Λ⁻¹ + J_b H_b⁻¹ J_bᵀ,   μ = Yᵀ u − ẍ_e(φ̈ = 0)
    H⁻¹ J_eᵀ = [H_b⁻¹ J_bᵀ + J_b* Φ; Φ],   Φ = L⁻ᵀ Y
"""

from __future__ import annotations

from ospace.kernels.articulated_body import relative_pivot
from ospace.kernels.jit.compile import Number, inlined
from ospace.kernels.jit.simd import full_like, minimum, sqrt
from ospace.kernels.response import base_inertia_inverse
from ospace.kernels.tree import Joints
from ospace.kernels.workspace import Robot, Work


@inlined
def factorize(joints: Joints, w: Work) -> Number:
    """L of H_m*; return the smallest pivot of a degree of freedom over its inertia with the base at rest."""
    L, H = w.factor, w.generalized_inertia
    smallest = full_like(1.0, w.R[0, 0])
    for i in range(w.relative_pivot.shape[0]):
        w.relative_pivot[i, 0] = smallest
    for j in range(L.shape[0]):
        pivot = H[j, j]
        for k in range(j):
            pivot = pivot - L[j, k] * L[j, k]
        relative = relative_pivot(pivot, w.inertia_diagonal[j + 6, 0])
        w.relative_pivot[joints.link_of[j], 0] = relative
        smallest = minimum(smallest, relative)
        L[j, j] = sqrt(pivot)
        scale = 1.0 / L[j, j]
        for i in range(j + 1, L.shape[0]):
            x = H[i, j]
            for k in range(j):
                x = x - L[i, k] * L[j, k]
            L[i, j] = x * scale
    return smallest


@inlined
def mobility(robot: Robot, w: Work, biased: bool) -> Number:
    """Γ_e⁻¹, and μ where it is wanted; return the smallest relative pivot.

    Y is left in the rows of `response` that belong to the joints.
    """
    smallest = factorize(robot.joints, w)
    rows, L, Y, J, n = robot.rows, w.factor, w.response, w.generalized_jacobian, w.factor.shape[0]
    for j in range(rows.size):
        for i in range(n):
            y = J[j, i]
            for k in range(i):
                y = y - L[i, k] * Y[k + 6, j]
            Y[i + 6, j] = y / L[i, i]
    base_inertia_inverse(robot, w)
    for i in range(rows.size):
        for j in range(i + 1):
            s = w.base_inertia_inverse[i, j]
            for k in range(n):
                s = s + Y[k + 6, i] * Y[k + 6, j]
            w.inertia_inverse[i, j] = s
            w.inertia_inverse[j, i] = s
    if biased:
        bias(robot, w)
    return smallest


@inlined
def bias(robot: Robot, w: Work) -> None:
    """μ; u takes the place of the given accelerations."""
    rows, L, u = robot.rows, w.factor, w.given
    for i in range(L.shape[0]):
        x = w.generalized_bias[i, 0]
        for k in range(i):
            x = x - L[i, k] * u[k + 6, 0]
        u[i + 6, 0] = x / L[i, i]
    for i in range(rows.size):
        s = -w.drift[rows[i] // 6, rows[i] % 6]
        for k in range(L.shape[0]):
            s = s + w.response[k + 6, i] * u[k + 6, 0]
        w.bias_acceleration[i, 0] = s


@inlined
def respond(robot: Robot, w: Work) -> None:
    """H⁻¹ J_eᵀ (nv, r), from the Y that `mobility` leaves."""
    L, X, n = w.factor, w.response, w.factor.shape[0]
    for j in range(robot.rows.size):
        for c in range(6):
            X[c, j] = w.base_mobility[j, c]
        for back in range(n):
            i = n - 1 - back
            x = X[i + 6, j]
            for k in range(i + 1, n):
                x = x - L[k, i] * X[k + 6, j]
            x = x / L[i, i]
            X[i + 6, j] = x
            for c in range(6):
                X[c, j] = X[c, j] + w.J_b_star[i + 1, c] * x

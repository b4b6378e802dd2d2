"""Rotations and their vectors: exponential and logarithm of SO(3), for numbers of one state."""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Mat3, Number, Vec3, inlined
from ospace.kernels.spatial import scale3

_SMALL = 1e-8
_NEAR_HALF_TURN = -0.99


@inlined
def exponential(rho: Vec3) -> Mat3:
    """Rotation by the vector ρ, by columns: 1 + sin θ [n]× + (1 − cos θ) [n]×², θ = |ρ|, n = ρ/θ."""
    theta = math.sqrt(rho[0] * rho[0] + rho[1] * rho[1] + rho[2] * rho[2])
    if theta < _SMALL:
        return rodrigues(rho, 1.0, 0.5)
    half = math.sin(0.5 * theta) / theta
    return rodrigues(rho, math.sin(theta) / theta, 2.0 * half * half)


@inlined
def rodrigues(rho: Vec3, a: Number, b: Number) -> Mat3:
    """1 + a ρ̃ + b ρ̃², by columns; a = sin θ/θ, b = (1 − cos θ)/θ² = 2 (sin(θ/2)/θ)². Numbers, or arrays of them."""
    x, y, z = rho[0], rho[1], rho[2]
    return (
        (1.0 - b * (y * y + z * z), b * x * y + a * z, b * x * z - a * y)
        + (b * x * y - a * z, 1.0 - b * (x * x + z * z), b * y * z + a * x)
        + (b * x * z + a * y, b * y * z - a * x, 1.0 - b * (x * x + y * y))
    )


@inlined
def rotation_vector(R: Mat3) -> Vec3:
    """Return ρ of the rotation R, |ρ| ≤ π; the inverse of `exponential`."""
    w = (0.5 * (R[5] - R[7]), 0.5 * (R[6] - R[2]), 0.5 * (R[1] - R[3]))
    sine = math.sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])
    cosine = 0.5 * (R[0] + R[4] + R[8] - 1.0)
    theta = math.atan2(sine, cosine)
    if cosine > _NEAR_HALF_TURN:
        return scale3(w, theta / sine if sine > _SMALL else 1.0)
    # near a half turn w vanishes: the axis is the largest column of n nᵀ = (R + Rᵀ − 2 cos θ)/(2 (1 − cos θ))
    s = 1.0 / (1.0 - cosine)
    xx, yy, zz = (R[0] - cosine) * s, (R[4] - cosine) * s, (R[8] - cosine) * s
    xy, xz, yz = 0.5 * (R[1] + R[3]) * s, 0.5 * (R[2] + R[6]) * s, 0.5 * (R[5] + R[7]) * s
    if xx >= yy and xx >= zz:
        n = (xx, xy, xz)
    elif yy >= zz:
        n = (xy, yy, yz)
    else:
        n = (xz, yz, zz)
    theta = theta / math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    return scale3(n, -theta if n[0] * w[0] + n[1] * w[1] + n[2] * w[2] < 0.0 else theta)

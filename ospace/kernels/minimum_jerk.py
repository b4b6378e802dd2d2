"""The quintic from 0 to 1 that is at rest at both ends."""

from __future__ import annotations

from ospace.kernels.jit.compile import Number, Vec3, inlined


@inlined
def minimum_jerk(u: float) -> Vec3:
    """Way, velocity and acceleration of the quintic from 0 to 1, at rest at both ends."""
    if u <= 0.0:
        return (0.0, 0.0, 0.0)
    if u >= 1.0:
        return (1.0, 0.0, 0.0)
    return rest_to_rest(u)


@inlined
def rest_to_rest(u: Number) -> Vec3:
    """The same for u from 0 to 1; a number, or an array of them."""
    return (
        u * u * u * (10.0 + u * (-15.0 + 6.0 * u)),
        30.0 * u * u * (1.0 - u) * (1.0 - u),
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )

"""The quadratic program, its limits, weights and solution."""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.tree import Floats, Ints

UNLIMITED = 1e30
"""Bounds beyond it count as none."""
POSITION, VELOCITY, ACCELERATION = range(3)
"""Limits of which a bound on φ̈ may come."""


class ProgramLimits(NamedTuple):
    """Joint and base limits; ±`UNLIMITED` where there is none."""

    torque: Floats
    """(2, n) lower, upper."""
    position: Floats
    """(2, n)."""
    velocity: Floats
    """(n,)."""
    acceleration: Floats
    """(n,)."""
    wrench: Floats
    """(2, k) of û."""
    reaction: float
    """h, s."""
    horizon: float
    """T, s."""
    braking: float
    """Share of what the torque limit could decelerate that the clamp counts on."""


class Resistance(NamedTuple):
    """Torques that drives provide while all accelerations are zero."""

    damping: Floats
    """(n,)."""
    coulomb: Floats
    """(2, n) at negative, then at positive rates."""
    bias: Floats
    """(n,) work: c_m* − τ_f at φ̇."""


class Program(NamedTuple):
    """The quadratic program."""

    H: Floats
    f: Floats
    C: Floats
    """(n + g, n + k) rows of torque, then of inequalities that users bring."""
    lower: Floats
    upper: Floats
    """(n + k + n + g,) of z, then of C z."""
    cause: Ints
    """(2, n) which limit each bound on φ̈ comes of."""


class Weights(NamedTuple):
    """Task weights and regularization."""

    task: Floats
    """(T,); zero for tasks of a strict level."""
    regularization: float
    """ε on φ̈ and û."""
    singular: float
    """Independence of a task's rows below which they are damped."""
    damping: float
    """Largest damping there, relative to the mean diagonal of A Aᵀ."""
    trust_radius: float
    """δ, rad or m."""
    independence: Floats
    """(T,) work: smallest pivot of A Aᵀ of each task at unit diagonal."""
    orthogonal: Floats
    """(m, n + k) work."""
    damped: Floats
    """(T, n) work: D of each task over its weight, zero for tasks that are not geometric."""
    slowed: Floats
    """(T, n) work: D_s d φ̇, likewise."""


class Answer(NamedTuple):
    """Quantities of a solution."""

    torque: Floats
    base_acceleration: Floats
    """(1, 6)."""
    residual: Floats
    """(m,) A z − b."""
    short: Floats
    """(T, 2) by how much linear and angular rows of each task about points stay short: |A z − b| / k."""
    allowed: Floats
    """(T, 2) what each may be short by."""

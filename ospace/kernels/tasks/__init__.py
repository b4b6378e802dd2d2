"""Rows of tasks: accelerations z = [φ̈; û] of the reduced dynamics that each task demands.

With û the actuated part of the base wrench over its scale, B its columns, and a⁰ the drift while z = 0,

    ẍ_e = J_m* φ̈ + J_b H_b⁻¹ B û + a⁰_e                             (5), (7)
    A z = ẍ_ref + d (ẋ_ref − ẋ) + k e − a⁰ = b

where e is the error, k a stiffness (1/s²) and d = 2 ζ √k. All in inertial axes at the point. What k e + d ė demands in
the rows taken is saturated at `rows.LARGEST`, linear and angular by themselves, so that a target out of reach leaves
the program well scaled.

The error of an orientation is the rotation vector of what is left, R_ref Rᵀ; its rate is ω_ref − ω, and that of its
rate α_ref − α − ω_ref × ω, for small errors.
"""

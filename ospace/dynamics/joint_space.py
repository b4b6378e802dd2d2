"""Dynamics in joint space (§2): momentum (1), inertia and bias (6), and the base eliminated (7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ospace.checks import all_finite, checked_vector
from ospace.kernels import composite
from ospace.kernels.tables import Floats
from ospace.state import State


@dataclass(frozen=True)
class JointSpaceDynamics:
    """The terms of (6): [H_b H_bm; H_bmᵀ H_m] [ẍ_b; φ̈] + [c_b; c_m] = [F_b; τ] + J_eᵀ F_e.

    Base rows in inertial axes at the base-link frame's origin, ẍ_b classical.

    Attributes
    ----------
    base_inertia : (6, 6)
        H_b; kg, kg m, kg m².
    coupling_inertia : (6, n)
        H_bm.
    manipulator_inertia : (n, n)
        H_m.
    base_bias : (6,)
        c_b; N, N m.
    manipulator_bias : (n,)
        c_m; N m, or N for prismatic joints.
    """

    base_inertia: Floats
    coupling_inertia: Floats
    manipulator_inertia: Floats
    base_bias: Floats
    manipulator_bias: Floats


@dataclass(frozen=True)
class GeneralizedDynamics:
    """The terms of (7): H_m* φ̈ + c_m* = τ + J_b*ᵀ F_b + J_m*ᵀ F_e.

    Attributes
    ----------
    generalized_inertia : (n, n)
        H_m* = H_m − H_bmᵀ H_b⁻¹ H_bm.
    generalized_bias : (n,)
        c_m* = c_m − H_bmᵀ H_b⁻¹ c_b; N m, or N for prismatic joints.
    """

    generalized_inertia: Floats
    generalized_bias: Floats


@dataclass(frozen=True)
class Composite:
    """Composite bodies of a state: what the public quantities of §2 and §5 are made of.

    Attributes
    ----------
    H_b, H_bm, H_m : (6, 6), (6, n), (n, n)
    J_b_star : (6, n)
    H_b_inv : (6, 6)
    """

    H_b: Floats
    H_bm: Floats
    H_m: Floats
    J_b_star: Floats
    H_b_inv: Floats

    @property
    def diagonal(self) -> Floats:
        """Diagonal of H (nv,)."""
        return np.concatenate([np.diag(self.H_b), np.diag(self.H_m)])


def composite_bodies(state: State) -> Composite:
    """Run the composite recursion (21), (27)."""
    IC, F, H_m = composite.composite_inertia(state.robot.links, state.tree)
    J_b_star, H_b_inv = composite.base_generalized_jacobian(IC, F)
    return Composite(symmetric(IC[0]), F[1:].T, H_m, J_b_star.T, symmetric(H_b_inv[0]))


def symmetric(lower_rows: Floats) -> Floats:
    """Return the (6, 6) matrix of its lower rows (21,)."""
    matrix = np.empty((6, 6))
    rows, columns = np.tril_indices(6)
    matrix[rows, columns] = matrix[columns, rows] = lower_rows
    return matrix


def inverse_dynamics(state: State, acceleration: npt.ArrayLike) -> Floats:
    """Compute the forces [F_b; τ] of (6) that make base and joints accelerate as given, by (17)–(19).

    Parameters
    ----------
    acceleration : (nv,)
        [ẍ_b; φ̈]; ẍ_b classical, inertial axes, at the base-link frame's origin; m/s², rad/s².

    Returns
    -------
    (nv,) array
        Wrench on the base, inertial axes, about the base-link frame's origin (N, N m); then joint torques.

    Raises
    ------
    OspaceError
        `acceleration` has the wrong length or a number that is not finite; or the result is not finite.
    """
    given = checked_vector(acceleration, state.robot.nv, "acceleration", state.robot.name)
    # Seen from the frame that moves along with the base, its classical and its spatial acceleration are the same.
    F_b, tau = composite.composite_force(state.robot.links, state.tree, given[:6], given[6:])
    forces = np.concatenate([F_b, tau])
    all_finite((forces,), "the force")
    return forces


def bias(state: State) -> tuple[Floats, Floats]:
    """Return c_b (6,) and c_m (n,): forces of the motion with ẍ_b = 0 and φ̈ = 0."""
    c = inverse_dynamics(state, np.zeros(state.robot.nv))
    return c[:6], c[6:]


def momentum(state: State) -> Floats:
    """Compute the momentum M_0 = H_b ẋ_b + H_bm φ̇ (1), by the recursion (20), (25).

    Returns
    -------
    (6,) array
        Linear (kg m/s) and angular (kg m²/s) momentum, inertial axes, about the base-link frame's origin.

    Raises
    ------
    OspaceError
        The result is not finite: the state's velocities are too large.
    """
    L_0: Floats = composite.momentum(state.tree)  # as seen from the frame that moves along with the base
    v_b = state.base_twist[:3]
    mass = state.robot.total_mass
    with np.errstate(over="ignore", invalid="ignore"):  # told below
        M_0 = L_0 + mass * np.concatenate([v_b, np.cross(_mass_centre(state), v_b)])
    all_finite((M_0,), "the momentum")
    return M_0


def _mass_centre(state: State) -> Floats:
    """Return the centre of mass about the base, inertial axes: the first moments of H_b over the mass."""
    I_0C = state.tree.I.sum(axis=0)
    centre: Floats = I_0C[[16, 8, 10]] / state.robot.total_mass
    return centre


def joint_space_dynamics(state: State) -> JointSpaceDynamics:
    """Compute the inertia and bias of (6) by composite bodies (21) and inverse dynamics (17)–(19).

    Raises
    ------
    OspaceError
        A result is not finite: the state's velocities are too large.
    """
    bodies = composite_bodies(state)
    c_b, c_m = bias(state)
    all_finite((bodies.H_b, bodies.H_m, c_b, c_m), "the joint-space dynamics")
    return JointSpaceDynamics(bodies.H_b, bodies.H_bm, bodies.H_m, c_b, c_m)


def generalized_dynamics(state: State) -> GeneralizedDynamics:
    """Eliminate the base from (6): the generalized inertia H_m* and bias c_m* of (7).

    Raises
    ------
    OspaceError
        A result is not finite: the state's velocities are too large.
    """
    bodies = composite_bodies(state)
    c_b, c_m = bias(state)
    H_m_star: Floats = bodies.H_m + bodies.H_bm.T @ bodies.J_b_star
    c_m_star = c_m + bodies.J_b_star.T @ c_b
    all_finite((H_m_star, c_m_star), "the generalized dynamics")
    return GeneralizedDynamics(0.5 * (H_m_star + H_m_star.T), c_m_star)

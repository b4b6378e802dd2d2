"""Dynamics in joint space (§2): momentum (1), inertia and bias (6), and the base eliminated (7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ospace.checks import checked_vector, not_finite
from ospace.dynamics import workspace
from ospace.kernels import evaluation as kernel
from ospace.kernels.tree import Floats
from ospace.model.state import State
from ospace.results import Result


@dataclass(frozen=True)
class JointSpaceDynamics(Result):
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
class GeneralizedDynamics(Result):
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
    run = workspace.of(state)
    given = checked_vector(acceleration, state.robot.nv, "acceleration", state.robot.name)
    # Seen from the frame that moves along with the base, its classical and its spatial acceleration are the same.
    if kernel.inverse_dynamics(given, run.memory):
        raise not_finite("the force")
    return np.concatenate([run.table("base_force")[0], run.table("joint_force")[:, 0]])


def momentum(state: State) -> Floats:
    """Compute the momentum M_0 = H_b ẋ_b + H_bm φ̇ (1), by the recursion (20), (25).

    Parameters
    ----------
    state : State

    Returns
    -------
    (6,) array
        Linear (kg m/s) and angular (kg m²/s) momentum, inertial axes, about the base-link frame's origin.

    Raises
    ------
    OspaceError
        The result is not finite: the state's velocities are too large.
    """
    run = workspace.of(state)
    run.evaluate(kernel.FLOATING_BASE)
    M_0: Floats = run.table("momentum")[0].copy()
    return M_0


def joint_space_dynamics(state: State) -> JointSpaceDynamics:
    """Compute the inertia and bias of (6) by composite bodies (21) and inverse dynamics (17)–(19).

    Parameters
    ----------
    state : State

    Returns
    -------
    JointSpaceDynamics
        H_b, H_bm, H_m, c_b and c_m of (6), inertial axes, base quantities at the base-link frame's origin.

    Raises
    ------
    OspaceError
        A result is not finite: the state's velocities are too large.
    """
    run = workspace.of(state)
    run.evaluate(kernel.MANIPULATOR_INERTIA | kernel.JOINT_BIAS)
    return JointSpaceDynamics(
        _symmetric(run.table("IC")[0]),
        run.table("H_bm")[1:].T.copy(),
        run.copy("manipulator_inertia"),
        run.table("base_force")[0].copy(),
        run.table("joint_force")[:, 0].copy(),
    )


def _symmetric(lower_rows: Floats) -> Floats:
    """Return the (6, 6) matrix of its lower rows (21,)."""
    matrix = np.empty((6, 6))
    rows, columns = np.tril_indices(6)
    matrix[rows, columns] = matrix[columns, rows] = lower_rows
    return matrix


def generalized_dynamics(state: State) -> GeneralizedDynamics:
    """Eliminate the base from (6): the generalized inertia H_m* and bias c_m* of (7).

    Parameters
    ----------
    state : State

    Returns
    -------
    GeneralizedDynamics
        H_m* (n, n) and c_m* (n,).

    Raises
    ------
    OspaceError
        A result is not finite: the state's velocities are too large.
    """
    run = workspace.of(state)
    run.evaluate(kernel.GENERALIZED_INERTIA | kernel.GENERALIZED_BIAS)
    return GeneralizedDynamics(run.copy("generalized_inertia"), run.table("generalized_bias")[:, 0].copy())

"""Generalized Jacobians (§5): the motion of base and points by the joints of a freely floating robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ospace.dynamics import workspace
from ospace.kernels import evaluation as kernel
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.state import State
from ospace.results import Result


@dataclass(frozen=True)
class GeneralizedJacobian(Result):
    """ẋ_b = J_b* φ̇ + H_b⁻¹ M_0 (2) and ẋ_e = J_m* φ̇ + J_b H_b⁻¹ M_0 (4); inertial axes, at base and points.

    Attributes
    ----------
    base_generalized_jacobian : (6, n)
        J_b* = −H_b⁻¹ H_bm (3).
    generalized_jacobian : (r, n)
        J_m* = J_m − J_b H_b⁻¹ H_bm (5).
    momentum_velocity : (r,)
        J_b H_b⁻¹ M_0: what the points do while the joints rest; m/s, rad/s.
    base_momentum_velocity : (6,)
        H_b⁻¹ M_0: what the base does while the joints rest; m/s, rad/s.
    """

    base_generalized_jacobian: Floats
    generalized_jacobian: Floats
    momentum_velocity: Floats
    base_momentum_velocity: Floats


def base_generalized_jacobian(state: State) -> Floats:
    """Compute J_b* = −H_b⁻¹ H_bm (3), (6, n): how the base follows the joints of a robot without momentum.

    Returns
    -------
    (6, n) array
        Of ẋ_b; inertial axes, at the base-link frame's origin.

    Raises
    ------
    OspaceError
        A result is not finite.
    """
    run = workspace.of(state)
    run.evaluate(kernel.FLOATING_BASE)
    J_b_star: Floats = run.table("J_b_star")[1:].T.copy()
    return J_b_star


def centre_of_mass(state: State) -> Floats:
    """Compute the centre of mass of the robot, (3,), in the inertial frame; m.

    Returns
    -------
    (3,) array

    Raises
    ------
    OspaceError
        A result is not finite.
    """
    run = workspace.of(state)
    run.evaluate(kernel.FLOATING_BASE)
    centre: Floats = run.table("mass_centre")[0] + state.q[:3]
    return centre


def generalized_jacobian(state: State, points: OperationalPoint | Sequence[OperationalPoint]) -> GeneralizedJacobian:
    """Compute J_b* (27), (28), J_m* (29)–(31) and the velocities that momentum leaves (26).

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        Any frames of the state's robot, the base included; r rows in the order given.

    Returns
    -------
    GeneralizedJacobian
        J_b* (6, n), J_m* (r, n), and the velocities that momentum leaves to points (r,) and base (6,); inertial axes.

    Raises
    ------
    OspaceError
        No point, or another robot's; or a result that is not finite.
    """
    run = workspace.of(state, points)
    run.evaluate(kernel.FLOATING_BASE)
    return GeneralizedJacobian(
        run.table("J_b_star")[1:].T.copy(),
        run.copy("generalized_jacobian"),
        run.table("momentum_velocity").ravel()[run.rows],
        run.table("base_momentum_velocity")[0].copy(),
    )

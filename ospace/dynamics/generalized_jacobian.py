"""Generalized Jacobians (§5): the motion of base and points by the joints of a freely floating robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ospace.checks import all_finite
from ospace.dynamics.joint_space import composite_bodies
from ospace.kernels import composite
from ospace.kernels.tables import Floats
from ospace.points import OperationalPoint, PointSet, point_set
from ospace.state import State


@dataclass(frozen=True)
class GeneralizedJacobian:
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


def point_jacobian(state: State, points: PointSet) -> Floats:
    """Return J_e = [J_b J_m] (r, 6 + n) of the rows taken."""
    columns = composite.point_jacobian(points.table, state.placements, state.tree)
    J_e: Floats = columns.reshape(state.robot.nv, -1).T[points.rows]
    return J_e


def generalized_jacobian(state: State, points: OperationalPoint | Sequence[OperationalPoint]) -> GeneralizedJacobian:
    """Compute J_b* (27), (28), J_m* (29)–(31) and the velocities that momentum leaves (26).

    Parameters
    ----------
    state : State
    points : OperationalPoint or sequence of them
        Any frames of the state's robot, the base included; r rows in the order given.

    Raises
    ------
    OspaceError
        No point, or another robot's; or a result that is not finite.
    """
    J_e = point_jacobian(state, point_set(state.robot, points))
    bodies = composite_bodies(state)
    # Seen from the frame that moves along with the base the momentum lacks what translates all bodies alike: v_b.
    rest = bodies.H_b_inv @ composite.momentum(state.tree)
    rest[:3] += state.base_twist[:3]
    J_b, J_m = J_e[:, :6], J_e[:, 6:]
    J_m_star = J_m + J_b @ bodies.J_b_star
    all_finite((bodies.J_b_star, J_m_star, rest), "the generalized Jacobian")
    return GeneralizedJacobian(bodies.J_b_star, J_m_star, J_b @ rest, rest)

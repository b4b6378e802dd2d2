"""Measures of how joints, hand and base move each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ospace.analysis.null_spaces import fixed_attitude_jacobian
from ospace.checks import check_kind
from ospace.dynamics.generalized_jacobian import base_generalized_jacobian, generalized_jacobian
from ospace.dynamics.joint_space import generalized_dynamics, joint_space_dynamics
from ospace.dynamics.operational_space import operational_space
from ospace.exceptions import OspaceError, closest
from ospace.kernels.tree import Floats
from ospace.model.points import Axes, OperationalPoint, parse_axes, points_of
from ospace.model.state import State
from ospace.results import Result

BASES = ("floating", "fixed", "fixed attitude")


@dataclass(frozen=True)
class DisturbanceMap(Result):
    """Disturbance of the base by joint rates: singular values of rows of J_b*, and their directions.

    Attributes
    ----------
    sizes : (k,)
        Of the base's motion per unit joint rate, the largest first; rad/rad, or m/rad.
    directions : (n, k)
        Unit joint rates that move the base by so much.
    by_joint : (n,)
        Norm of what each joint by itself does to the base.
    """

    sizes: Floats
    directions: Floats
    by_joint: Floats


@dataclass(frozen=True)
class ImpulseMap(Result):
    """Jumps of the velocities of a free-flying robot per unit impulse at a point.

    Attributes
    ----------
    base : (6, r)
        Jump of ẋ_b, inertial axes, at the base-link frame's origin; m/s, rad/s per N s or N m s.
    joints : (n, r)
        Jumps of the joint rates.
    point : (r, r)
        Jump of the point's own velocity, Γ_e⁻¹.
    least_reaction : (r,)
        The unit impulse that turns the base least.
    """

    base: Floats
    joints: Floats
    point: Floats
    least_reaction: Floats


def disturbance_map(state: State, axes: Axes = "angular") -> DisturbanceMap:
    """Compute the disturbance map of the base (EDM of Torres and Dubowsky, 1992).

    Parameters
    ----------
    state : State
    axes : "all", "linear", "angular" or six booleans
        Rows of J_b* (27); "all" mixes metres with radians.

    Returns
    -------
    DisturbanceMap

    Raises
    ------
    OspaceError
        `axes` make no sense.
    """
    check_kind(state, State, "make it with robot.state(q, v)")
    J = base_generalized_jacobian(state)[list(parse_axes(axes))]
    _, sizes, right = np.linalg.svd(J, full_matrices=False)
    return DisturbanceMap(sizes, right.T, np.asarray(np.linalg.norm(J, axis=0)))


def coupling_factor(state: State, point: OperationalPoint, axes: Axes = "angular") -> float:
    """Compute the dynamic coupling factor: how much the base moves per unit motion of the hand (Xu, 1993).

    Parameters
    ----------
    state : State
    point : OperationalPoint
        The hand; rows as it takes them.
    axes : "all", "linear", "angular" or six booleans
        Rows of J_b* (27).

    Returns
    -------
    float
        Product of the singular values of J_b* J_m*⁺, the joints moving the hand with the smallest rates.

    Raises
    ------
    OspaceError
        Another robot's point, or `axes` make no sense.
    """
    jacobians = generalized_jacobian(state, point)
    J_b_star = jacobians.base_generalized_jacobian[list(parse_axes(axes))]
    K = J_b_star @ np.linalg.pinv(jacobians.generalized_jacobian)
    return float(np.prod(np.linalg.svd(K, compute_uv=False)))


def dynamic_manipulability(state: State, point: OperationalPoint, base: str = "floating") -> float:
    """Compute the dynamic manipulability of a hand, √det(J M⁻² Jᵀ) (Yoshikawa, 1985).

    Parameters
    ----------
    state : State
    point : OperationalPoint
        The hand; rows as it takes them.
    base : "floating", "fixed" or "fixed attitude"
        J and M are J_m* and H_m*; J_m and H_m; or `fixed_attitude_jacobian` and H_m*.

    Returns
    -------
    float
        Zero where the joints cannot accelerate the hand in some direction.

    Raises
    ------
    OspaceError
        Another robot's point, or an unknown base.
    """
    if base not in BASES:
        raise OspaceError(f"base '{base}' is unknown{closest(str(base), BASES)}")
    check_kind(state, State, "make it with robot.state(q, v)")
    points_of(state.robot, point)
    if base == "fixed":
        J, M = operational_space(state, point).jacobian[:, 6:], joint_space_dynamics(state).manipulator_inertia
    else:
        M = generalized_dynamics(state).generalized_inertia
        J = fixed_attitude_jacobian(state, point)
        if base == "floating":
            J = generalized_jacobian(state, point).generalized_jacobian
    reached = J @ np.linalg.inv(M)
    if reached.shape[1] < reached.shape[0]:
        return 0.0
    return float(np.prod(np.linalg.svd(reached, compute_uv=False)))


def impulse_map(state: State, point: OperationalPoint) -> ImpulseMap:
    """Compute how a unit impulse at a hand changes the velocities of base and joints, H⁻¹ J_eᵀ.

    Parameters
    ----------
    state : State
    point : OperationalPoint
        The hand; rows as it takes them.

    Returns
    -------
    ImpulseMap

    Raises
    ------
    OspaceError
        Another robot's point.
    """
    here = operational_space(state, point)
    base, joints = here.response[:6], here.response[6:]
    least = np.linalg.svd(base[3:])[2][-1]
    return ImpulseMap(base, joints, here.inertia_inverse, least)


def wheel_momentum(state: State) -> Floats:
    """Compute what wheels have to store per unit joint rate while they hold the base's attitude: h = K φ̇.

    The base floats otherwise: it shifts so that the mass centre stays. With linear rows l and angular rows a of H_b and
    H_bm, K = H_am − H_al H_ll⁻¹ H_lm, the angular momentum about the mass centre.

    Parameters
    ----------
    state : State

    Returns
    -------
    (3, n) array
        K; inertial axes; kg m².
    """
    dynamics = joint_space_dynamics(state)
    H_b, H_bm = dynamics.base_inertia, dynamics.coupling_inertia
    K: Floats = H_bm[3:] - H_b[3:, :3] @ np.linalg.solve(H_b[:3, :3], H_bm[:3])
    return K

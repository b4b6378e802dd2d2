"""Quantities that the literature derives for a floating arm: rates, null spaces, maps of reaction, base motion."""

from ospace.analysis.arm import Arm
from ospace.analysis.arm_map import ArmMap, map_arm
from ospace.analysis.base_motion import base_motion, base_turn
from ospace.analysis.bias_derivative import bias_acceleration_derivative, bias_force_derivative
from ospace.analysis.measures import (
    DisturbanceMap,
    ImpulseMap,
    coupling_factor,
    disturbance_map,
    dynamic_manipulability,
    impulse_map,
    wheel_momentum,
)
from ospace.analysis.null_spaces import (
    NullSpace,
    coupling_null_space,
    fixed_attitude_jacobian,
    reaction_null_space,
)
from ospace.analysis.rates import (
    generalized_jacobian_derivative,
    generalized_jacobian_rate,
    inertia_inverse_derivative,
)
from ospace.analysis.rays import Rays, reach_along
from ospace.analysis.workspace_shells import Workspaces, workspaces
from ospace.model.base_displacement import base_displacement

__all__ = [
    "Arm",
    "ArmMap",
    "DisturbanceMap",
    "ImpulseMap",
    "NullSpace",
    "Rays",
    "Workspaces",
    "base_displacement",
    "base_motion",
    "base_turn",
    "bias_acceleration_derivative",
    "bias_force_derivative",
    "coupling_factor",
    "coupling_null_space",
    "disturbance_map",
    "dynamic_manipulability",
    "fixed_attitude_jacobian",
    "generalized_jacobian_derivative",
    "generalized_jacobian_rate",
    "impulse_map",
    "inertia_inverse_derivative",
    "map_arm",
    "reach_along",
    "reaction_null_space",
    "wheel_momentum",
    "workspaces",
]

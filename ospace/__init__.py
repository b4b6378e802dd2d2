"""Operational-space dynamics and control of space robots.

The recursions of Abiko & Hirzinger, *Operational Space Dynamics of a Space Robot and Computational Efficient
Algorithm*, on Pinocchio's frame data, with the dense forms beside them to check against.

    >>> import ospace
    >>> robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    >>> state = robot.state(robot.configuration({"right_arm_4": 1.2}))
    >>> ospace.operational_space(state, robot.point("right_hand")).inertia.shape
    (6, 6)

Names load on first use, so that ``import ospace`` costs nothing.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ospace import models as models
    from ospace.control.controller import Controller as Controller
    from ospace.dynamics.batch import operational_space_batch as operational_space_batch
    from ospace.dynamics.evaluator import OperationalSpaceEvaluator as OperationalSpaceEvaluator
    from ospace.dynamics.free_floating import free_floating as free_floating
    from ospace.dynamics.generalized_jacobian import generalized_jacobian as generalized_jacobian
    from ospace.dynamics.joint_space import generalized_dynamics as generalized_dynamics
    from ospace.dynamics.joint_space import inverse_dynamics as inverse_dynamics
    from ospace.dynamics.joint_space import joint_space_dynamics as joint_space_dynamics
    from ospace.dynamics.joint_space import momentum as momentum
    from ospace.dynamics.operational_space import operational_space as operational_space
    from ospace.exceptions import DependentRowsError as DependentRowsError
    from ospace.exceptions import OspaceError as OspaceError
    from ospace.exceptions import SingularInertiaError as SingularInertiaError
    from ospace.model.points import OperationalPoint as OperationalPoint
    from ospace.model.robot import SpaceRobot as SpaceRobot
    from ospace.model.state import State as State
    from ospace.scenario.errors import ScenarioError as ScenarioError
    from ospace.simulation.errors import SimulationError as SimulationError
    from ospace.simulation.simulate import simulate as simulate
    from ospace.urdf.composition.compose import compose as compose
    from ospace.urdf.composition.parts import Part as Part
    from ospace.urdf.errors import UnsoundModelError as UnsoundModelError
    from ospace.urdf.errors import UrdfError as UrdfError
    from ospace.urdf.source import Limits as Limits

__version__ = "0.1.0"
DOCUMENTATION = "https://ospace-robotics.github.io/ospace/"

_HOME = {
    "SpaceRobot": "model.robot",
    "State": "model.state",
    "Limits": "urdf.source",
    "OperationalPoint": "model.points",
    "momentum": "dynamics.joint_space",
    "joint_space_dynamics": "dynamics.joint_space",
    "generalized_dynamics": "dynamics.joint_space",
    "inverse_dynamics": "dynamics.joint_space",
    "generalized_jacobian": "dynamics.generalized_jacobian",
    "operational_space": "dynamics.operational_space",
    "OperationalSpaceEvaluator": "dynamics.evaluator",
    "operational_space_batch": "dynamics.batch",
    "free_floating": "dynamics.free_floating",
    "Controller": "control.controller",
    "simulate": "simulation.simulate",
    "compose": "urdf.composition.compose",
    "Part": "urdf.composition.parts",
    "OspaceError": "exceptions",
    "UrdfError": "urdf.errors",
    "UnsoundModelError": "urdf.errors",
    "SingularInertiaError": "exceptions",
    "SimulationError": "simulation.errors",
    "ScenarioError": "scenario.errors",
    "DependentRowsError": "exceptions",
}
_PACKAGES = ("models", "analysis", "bridge", "control", "scenario", "simulation", "visual")
__all__ = ["models"]
__all__ += list(_HOME)


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return importlib.import_module(f"ospace.{name}")
    if name not in _HOME:
        raise AttributeError(f"module 'ospace' has no attribute '{name}'")
    value = getattr(importlib.import_module(f"ospace.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted([*globals(), *__all__])

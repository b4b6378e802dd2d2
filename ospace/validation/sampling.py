"""Random states of a robot, inside its joint limits."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.model.state import State

FAR = 7e6
"""Distance from the origin of a satellite on a low orbit, m."""
_WIDEST = np.pi


def random_state(robot: SpaceRobot, rng: np.random.Generator, *, far: bool = False) -> State:
    """Draw a state: base pose and twist, joint positions inside their limits, joint rates.

    Joints without limits are drawn from ±π (rad, m), as is what of wider limits lies there. With `far`, the base is
    7e6 m from the origin, else some metres.
    """
    model = robot.model
    step: Floats = rng.uniform(-_WIDEST, _WIDEST, robot.nv)
    for j in range(2, model.njoints):
        if model.nqs[j] == model.nvs[j] == 1:
            low, high = model.lowerPositionLimit[model.idx_qs[j]], model.upperPositionLimit[model.idx_qs[j]]
            if max(low, -_WIDEST) <= min(high, _WIDEST):
                low, high = max(low, -_WIDEST), min(high, _WIDEST)
            if np.isfinite((low, high)).all() and low <= high:
                step[model.idx_vs[j]] = rng.uniform(low, high)
    q = pin.integrate(model, pin.neutral(model), step)
    q[:3] = rng.normal(size=3)
    if far:
        q[:3] *= FAR / np.linalg.norm(q[:3])
    return robot.state(q, rng.normal(size=robot.nv))

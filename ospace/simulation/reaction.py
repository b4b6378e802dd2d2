"""How the base answers a motion of the joints when nothing else acts: momentum stays zero, the mass centre where it is.

With M_0 = 0 the base follows the joints by (2), ẋ_b = J_b* φ̇. Seen in base axes, J_b* depends on the joints alone:

    R' = R [ω_B(t)]_×,    ω_B = (J_b* φ̇)_angular
    R(t + h) = R(t) exp(h/2 (ω_1 + ω_2) + √3/12 h² ω_1 × ω_2),        a Magnus integrator of fourth order,
                                                                      ω_1, ω_2 at the Gauss points of the step
    p(t) = c − R(t) r_c(φ),                                           c the mass centre, r_c the same in the base

so that the linear part of the momentum is kept by its integral, without an error that adds up.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.dynamics.generalized_jacobian import generalized_jacobian
from ospace.exceptions import OspaceError
from ospace.kernels.tables import Floats
from ospace.robot import SpaceRobot

Joints = Callable[[float], tuple[Floats, Floats]]
"""From time, s, to how far the joints have moved (n,) since the start, and their rates (n,); rad, m."""
_STEP = 0.02  # s
_GAUSS = 0.5 / math.sqrt(3.0)
_TURN, _SHIFT = math.pi, 0.5  # rad, m: range to either side of a joint without limits
_PAUSE, _PACE = 0.4, 0.4  # s of every leg of a sweep, and s per rad or m beside them


@dataclass(frozen=True)
class FloatingMotion:
    """A motion with zero momentum.

    Attributes
    ----------
    time : (N,)
        s.
    q, v : (N, nq), (N, nv)
        As of `SpaceRobot.state`.
    """

    time: Floats
    q: Floats
    v: Floats


def react(robot: SpaceRobot, q: npt.ArrayLike, joints: Joints, duration: float) -> FloatingMotion:
    """Let the joints move, and the base react.

    Parameters
    ----------
    robot : SpaceRobot
    q : (nq,)
        Start, at rest.
    joints : function
        Of time: how far the joints have moved since the start, (n,), and their rates, (n,); smooth. rad, m, s.
    duration : float
        s.

    Raises
    ------
    OspaceError
        q is no configuration, the duration is not positive, or a momentum or rate is not finite.
    """
    if not 0.0 < duration < math.inf:
        raise OspaceError(f"duration {duration} s: give a positive number")
    start = robot.state(q)
    model, data = robot.model, robot.model.createData()
    bent = start.q.copy()
    bent[:7] = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    point = robot.point(robot.frame_names[0])

    def twist(time: float) -> tuple[Floats, Floats]:
        """Return configuration with the base at the origin, and velocity."""
        moved, rates = joints(time)
        q_B = np.asarray(pin.integrate(model, bent, np.r_[np.zeros(6), moved]))
        J_b_star = generalized_jacobian(robot.state(q_B), point).base_generalized_jacobian
        return q_B, np.r_[J_b_star @ rates, rates]

    steps = max(1, math.ceil(duration / _STEP - 1e-6))
    time = np.linspace(0.0, duration, steps + 1)
    h = duration / steps
    Q, V = np.empty((steps + 1, robot.nq)), np.empty((steps + 1, robot.nv))
    R = start.T_WB.rotation.copy()
    centre = np.array(pin.centerOfMass(model, data, start.q))
    for k, t in enumerate(time):
        Q[k], V[k] = twist(t)
        p = centre - R @ pin.centerOfMass(model, data, Q[k])
        Q[k, :7] = pin.SE3ToXYZQUAT(pin.SE3(R, p))
        first, second = (twist(t + (0.5 + side) * h)[1][3:6] for side in (-_GAUSS, _GAUSS))
        R = R @ pin.exp3(0.5 * h * (first + second) + h * h * math.sqrt(3.0) / 12.0 * np.cross(first, second))
    return FloatingMotion(time, Q, V)


def sweep(robot: SpaceRobot, q: npt.ArrayLike) -> FloatingMotion:
    """Move one joint after the other from `q` to its upper limit, to its lower one and back, the base reacting.

    Each way is one of minimum jerk.

    A joint without limits turns by half a turn to either side, or shifts by half a metre.

    Raises
    ------
    OspaceError
        The robot has no joint, or `q` is no configuration of it.
    """
    if robot.n_joints == 0:
        raise OspaceError(f"robot '{robot.name}' has no joint to move")
    start = robot.state(q).q
    legs: list[tuple[float, float, int, float, float]] = []  # from time, for how long, joint, from, to
    begin = 0.0
    for i, (low, high) in enumerate(_ranges(robot, start)):
        for here, there in ((0.0, high), (high, low), (low, 0.0)):
            lasts = _STEP * math.ceil((_PAUSE + _PACE * abs(there - here)) / _STEP)  # no step across two ways
            legs.append((begin, lasts, i, here, there))
            begin += lasts
    return react(robot, start, _along(legs, robot.n_joints), begin)


def _along(legs: Sequence[tuple[float, float, int, float, float]], n: int) -> Joints:
    begins = np.array([leg[0] for leg in legs])

    def joints(time: float) -> tuple[Floats, Floats]:
        moved, rates = np.zeros(n), np.zeros(n)
        k = max(0, int(np.searchsorted(begins, time, side="right")) - 1)
        begin, lasts, i, here, there = legs[k]
        share = min(1.0, max(0.0, (time - begin) / lasts))
        moved[i] = here + (there - here) * share**3 * (10.0 - 15.0 * share + 6.0 * share**2)
        rates[i] = (there - here) / lasts * 30.0 * (share * (1.0 - share)) ** 2
        return moved, rates

    return joints


def _ranges(robot: SpaceRobot, q: Floats) -> list[tuple[float, float]]:
    """Return how far each degree of freedom of the joints may move down and up from `q`."""
    model, ranges = robot.model, []
    for j in range(2, model.njoints):
        straight = model.joints[j].shortname().startswith(("JointModelP", "JointModelTranslation"))
        free = _SHIFT if straight else _TURN
        for _ in range(model.nvs[j]):
            low, high = -free, free
            if model.nqs[j] == 1:
                k = model.idx_qs[j]
                lower, upper = model.lowerPositionLimit[k] - q[k], model.upperPositionLimit[k] - q[k]
                low, high = (own if np.isfinite(own) else other for own, other in ((lower, low), (upper, high)))
            ranges.append((float(low), float(high)))
    return ranges

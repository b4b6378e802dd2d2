"""Motion of the base when the joints move and nothing else acts: momentum stays zero, the mass centre where it is.

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

from ospace.dynamics.generalized_jacobian import base_generalized_jacobian
from ospace.exceptions import OspaceError
from ospace.kernels.minimum_jerk import minimum_jerk
from ospace.kernels.tree import Floats, Ints
from ospace.model.base_displacement import base_displacement
from ospace.model.robot import SpaceRobot
from ospace.results import Result

Joints = Callable[[float], tuple[Floats, Floats]]
"""From time, s, to how far the joints have moved (n,) since the start, and their rates (n,); rad, m."""
_STEP = 0.02  # s
_GAUSS = 0.5 / math.sqrt(3.0)
_TURN, _SHIFT = math.pi, 1.0  # rad, m: to either side of a joint whose range is wider than both
_PAUSE, _PACE = 0.4, 0.4  # s of every way of a sweep, and s per rad or m beside them
_LONGEST = 4.0  # s of a way


@dataclass(frozen=True)
class FloatingMotion(Result):
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


@dataclass(frozen=True)
class JointSweep(FloatingMotion):
    """A motion with zero momentum in which one degree of freedom after the other moves and comes back.

    Attributes
    ----------
    moving : (N,) int array
        Which of the n joint rates; at the time in which one ends and another begins, the latter.
    ranges : (n, 2)
        How far each moves down and up from the start; rad or m.
    base : (N, 2)
        Shift (m) and turn (rad) of the base since the start.
    """

    moving: Ints
    ranges: Floats
    base: Floats

    @property
    def largest(self) -> Floats:
        """The largest shift (m) and turn (rad) of the base while each of them moves (n, 2)."""
        return np.array([self.base[self.moving == i].max(axis=0) for i in range(len(self.ranges))])


def zero_momentum_motion(
    robot: SpaceRobot,
    q: npt.ArrayLike,
    joints: Joints,
    duration: float,
    *,
    progress: Callable[[float], None] | None = None,
) -> FloatingMotion:
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
    progress : function, optional
        Called with the share that is done, 0 to 1, after each step; Ctrl-C may be raised in it.

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

    def twist(time: float) -> tuple[Floats, Floats]:
        """Return configuration with the base at the origin, and velocity."""
        moved, rates = joints(time)
        q_B = np.asarray(pin.integrate(model, bent, np.r_[np.zeros(6), moved]))
        J_b_star = base_generalized_jacobian(robot.state(q_B))
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
        if progress is not None:
            progress(k / steps)
    return FloatingMotion(time, Q, V)


def joint_sweep(robot: SpaceRobot, q: npt.ArrayLike, *, progress: Callable[[float], None] | None = None) -> JointSweep:
    """Move one joint after the other from `q` to its upper limit, to its lower one and back, the base reacting.

    Each way is one of minimum jerk and takes 4 s at most, so the whole at most 12 s for each degree of freedom.

    A range of up to a turn, or two metres, is gone through as a whole. Where it is wider, or a limit is missing, a
    joint turns by half a turn to either side of `q`, or shifts by a metre, unless a limit comes first. What both turns
    and shifts, as a screw, turns.

    Parameters
    ----------
    robot : SpaceRobot
    q : (nq,)
        Start, at rest.
    progress : function, optional
        As of `zero_momentum_motion`.

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
    ranges = _ranges(robot, start)
    for i, (low, high) in enumerate(ranges):
        for here, there in ((0.0, high), (high, low), (low, 0.0)):
            lasts = min(_LONGEST, _PAUSE + _PACE * abs(there - here))
            lasts = _STEP * math.ceil(lasts / _STEP - 1e-6)  # no step across two ways
            legs.append((begin, lasts, i, here, there))
            begin += lasts
    motion = zero_momentum_motion(robot, start, _along(legs, robot.n_joints), begin, progress=progress)
    moving = np.array([legs[k][2] for k in _leg_at(legs, motion.time)])
    return JointSweep(motion.time, motion.q, motion.v, moving, np.array(ranges), base_displacement(motion.q[:, :7]))


def _along(legs: Sequence[tuple[float, float, int, float, float]], n: int) -> Joints:
    def joints(time: float) -> tuple[Floats, Floats]:
        moved, rates = np.zeros(n), np.zeros(n)
        begin, lasts, i, here, there = legs[int(_leg_at(legs, time))]
        way, rate, _ = minimum_jerk((time - begin) / lasts)
        moved[i] = here + (there - here) * way
        rates[i] = (there - here) / lasts * rate
        return moved, rates

    return joints


def _leg_at(legs: Sequence[tuple[float, float, int, float, float]], time: npt.ArrayLike) -> Ints:
    """Return the number of the way that each time belongs to."""
    begins = [leg[0] for leg in legs]
    return np.asarray(np.maximum(0, np.searchsorted(begins, time, side="right") - 1))


def _ranges(robot: SpaceRobot, q: Floats) -> list[tuple[float, float]]:
    """Return how far each degree of freedom of the joints may move down and up from `q`."""
    model, ranges = robot.model, []
    for j in range(2, model.njoints):
        for i in range(model.nvs[j]):
            most = _TURN if robot.turning_rates[model.idx_vs[j] - 6 + i] else _SHIFT
            low, high, at = -math.inf, math.inf, 0.0
            if model.nqs[j] == model.nvs[j]:  # of others, coordinates are no degrees of freedom
                k = model.idx_qs[j] + i
                low, high, at = map(float, (model.lowerPositionLimit[k], model.upperPositionLimit[k], q[k]))
            if high - low <= 2.0 * most:
                most *= 2.0  # the farthest that a limit is away, unless `at` is beyond the other
            ranges.append((_within(low - at, most), _within(high - at, most)))
    return ranges


def _within(way: float, most: float) -> float:
    return min(max(way, -most), most)

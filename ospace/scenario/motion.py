"""Motions that a task follows from the phase's start on: towards a goal that stays or moves by itself.

The goal is at g(t), R_g(t). By itself the point would go on with x_s(t) = x_0 + v_0 t and F(t) R_0, F = exp(ω_0 t).
With the quintic s from 0 to 1 with rest at both ends, the place goes over from the one to the other,

    x = x_s + s (g − x_s)

The rotation does so in axes that turn with F, in which the goal is at G = Fᵀ R_g with velocity ω_G = Fᵀ (ω_g − ω_0). A
turn E_1 brings the point from where it is to where the goal was, and E_2 makes the goal's turning set in smoothly: with
the turn φ from the goal to the point at the start, the rate Ω = −Gᵀ ω_G at the start, and the quintic r(t) that starts
with rate 1 and ends at rest, both zero,

    R = F E_1 G E_2,     E_1 = exp((1 − s) φ),     E_2 = exp(χ),     χ = r Ω
    ω = ω_0 + F w,       w = −ṡ φ + E_1 y,         y = ω_G + G χ̇
    α = F ẇ + ω_0 × F w,     ẇ = −s̈ φ − ṡ φ × E_1 y + E_1 ẏ,     ẏ = ω̇_G + ω_G × G χ̇ + G χ̈

Position and velocity start with those of the point, and position, velocity and acceleration end with those of the goal:
at contact hand and fixture move as one. Only the turn at the start is a logarithm: from there on the point turns with
the goal, by any angle and any number of turns. Where the turn to make is given, it is made in full, however long it is.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.minimum_jerk import rest_to_rest
from ospace.kernels.so3 import rodrigues
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario.disturbances import Disturbances
from ospace.simulation import Certificate, simulate
from ospace.simulation.plant import Plant

_AHEAD = 1.0
"""Length of the target's motion that is computed at a time, s."""


class Motion(NamedTuple):
    """A moving frame at N instants: place (N, 3), rotation (N, 3, 3), velocity and classical acceleration (N, 6)."""

    place: Floats
    rotation: Floats
    velocity: Floats
    acceleration: Floats


Goal = Callable[[int, int], Motion]
"""Returns the goal's motion from one cycle of the run to before another."""


def still(pose: pin.SE3) -> Goal:
    """Return a goal that stays."""

    def motion(first: int, last: int) -> Motion:
        n = last - first
        return Motion(
            np.tile(pose.translation, (n, 1)), np.tile(pose.rotation, (n, 1, 1)), np.zeros((n, 6)), np.zeros((n, 6))
        )

    return motion


def point_motion(point: OperationalPoint, Q: Floats, V: Floats, A: Floats) -> Motion:
    """Return the motion of a point at N states (N, nq), (N, nv) and accelerations (N, nv)."""
    model, data = point.robot.model, point.robot.model.createData()
    n, here = len(Q), point.placement
    place, rotation, rates = np.empty((n, 3)), np.empty((n, 3, 3)), np.empty((4, n, 3))
    for k in range(n):
        pin.forwardKinematics(model, data, Q[k], V[k], A[k])
        T = data.oMi[point.joint] * here
        velocity, acceleration = here.actInv(data.v[point.joint]), here.actInv(data.a[point.joint])
        place[k], rotation[k] = T.translation, T.rotation
        rates[0, k], rates[1, k] = velocity.linear, velocity.angular
        rates[2, k], rates[3, k] = acceleration.linear, acceleration.angular
    rates[2] += np.cross(rates[1], rates[0])  # the classical one
    v, omega, a, alpha = np.einsum("kij,rkj->rki", rotation, rates)
    return Motion(place, rotation, np.hstack([v, omega]), np.hstack([a, alpha]))


class FreeMotion:
    """A target that moves by itself, cycle by cycle, as far as it was asked for.

    Parameters
    ----------
    robot : SpaceRobot
    start : State
    first : int
        Control cycle of the start.
    period, step : float
        Of a control cycle and of the integrator, s.
    integrator : "rk4" or "symplectic"
    disturbances : Disturbances, optional
        That act on it.

    Attributes
    ----------
    first : int
        Cycle of the run at which it begins.
    certificates : list of Certificate
        Of what was simulated.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        start: State,
        first: int = 0,
        period: float = 1e-3,
        step: float | None = None,
        integrator: str = "rk4",
        disturbances: Disturbances | None = None,
    ) -> None:
        self.robot, self.first = robot, first
        self._disturbances = disturbances or Disturbances({}, step or period)
        self._period, self._step, self._integrator = period, step or period, integrator
        self._q, self._v = [start.q.copy()], [start.v.copy()]
        self.certificates: list[Certificate] = []

    def state(self, cycle: int) -> State:
        """Return the target's state at a cycle.

        Parameters
        ----------
        cycle : int
            From the start of the run; not before `first`.

        Returns
        -------
        State
        """
        self._reach(cycle)
        return self.robot.state(self._q[cycle - self.first], self._v[cycle - self.first])

    def states(self, first: int, last: int) -> tuple[Floats, Floats]:
        """Return q and v from one cycle to before another.

        Parameters
        ----------
        first, last : int
            Cycles.

        Returns
        -------
        q : (last − first, nq)
            m, rad.
        v : (last − first, nv)
            Base twist in base axes; m/s, rad/s.
        """
        self._reach(last - 1)
        taken = slice(first - self.first, last - self.first)
        return np.array(self._q[taken]), np.array(self._v[taken])

    def frame(self, point: OperationalPoint) -> Goal:
        """Return the motion of a point of the target as a goal.

        Parameters
        ----------
        point : OperationalPoint
            Of the target.

        Returns
        -------
        callable
            From two cycles to the point's pose, velocity and acceleration at each from the one to before the other.
        """
        plant = Plant(self.robot, self._disturbances.wrenches)

        def motion(first: int, last: int) -> Motion:
            Q, V = self.states(first, last)
            base = Q[:, :3].copy()
            Q[:, :3] = 0.0
            A = np.empty_like(V)
            for cycle, q, v, a in zip(range(first, last), Q, V, A, strict=True):
                self._disturbances.begin(cycle * self._period)
                plant.accelerate(cycle * self._period, q, v, a)
            beside = point_motion(point, Q, V, A)
            return beside._replace(place=beside.place + base)

        return motion

    def _reach(self, cycle: int) -> None:
        """Simulate up to a cycle."""
        ticks, ahead = round(self._period / self._step), max(1, round(_AHEAD / self._period))
        while len(self._q) <= cycle - self.first:
            start = (self.first + len(self._q) - 1) * self._period
            self._disturbances.begin(start)
            run = simulate(
                self.robot,
                self._q[-1],
                self._v[-1],
                duration=ahead * ticks * self._step,
                step=self._step,
                integrator=self._integrator,
                wrenches=self._disturbances.wrenches,
                log_every=ticks,
                start=start,
                on_step=self._disturbances.begin,
            )
            if run.interrupted:
                raise KeyboardInterrupt
            self._q.extend(run.q[1:])
            self._v.extend(run.v[1:])
            known = {one.name: one.given for one in self.certificates[-1].quantities} if self.certificates else {}
            self.certificates.append(  # what came from outside goes on from one part to the next
                Certificate(
                    tuple(
                        replace(one, given=one.given + known.get(one.name, 0.0)) for one in run.certificate().quantities
                    )
                )
            )


class Tabulated(ABC):
    """Reference that is computed ahead, cycle by cycle; callable as `control.Function` asks.

    Parameters
    ----------
    first : int
        Control cycle at the start.
    period : float
        Of a control cycle, s.
    name : str
        Of the task, for errors.
    """

    def __init__(self, first: int, period: float, name: str) -> None:
        self._first, self._period, self._name = first, period, name
        self._table: list[tuple[pin.SE3, Floats, Floats]] = []

    @abstractmethod
    def _motion(self, begun: int, ended: int) -> Motion:
        """Return the motion from one cycle after the start to before another."""

    def __call__(self, time: float) -> tuple[pin.SE3, npt.ArrayLike, npt.ArrayLike]:
        """Return pose, velocity and acceleration at a cycle's time, s."""
        k = max(0, round(time / self._period) - self._first)
        while k >= len(self._table):
            self._extend()
        return self._table[k]

    def _extend(self) -> None:
        begun = len(self._table)
        ended = begun + max(1, round(_AHEAD / self._period))
        motion = self._motion(begun, ended)
        if not all(np.isfinite(one).all() for one in motion):
            raise OspaceError(f"what task '{self._name}' follows is not finite")
        self._table.extend(
            (pin.SE3(R, p), v, a)
            for p, R, v, a in zip(motion.place, motion.rotation, motion.velocity, motion.acceleration, strict=True)
        )


class Approach(Tabulated):
    """Reference from a point's motion to a goal's, by minimum jerk.

    Parameters
    ----------
    pose, velocity : pin.SE3, (6,)
        Of the point at the start, inertial axes.
    goal : Goal
    duration : float
        s; with 0 the goal is followed at once.
    first : int
        Control cycle at the start.
    period : float
        Of a control cycle, s.
    turn : (3,), optional
        Rotation vector from the point to the goal, inertial axes, made in full however long it is; the shortest way
        without it.
    name : str
        Of the task, for errors.
    """

    def __init__(
        self,
        pose: pin.SE3,
        velocity: Floats,
        goal: Goal,
        *,
        duration: float,
        first: int = 0,
        period: float = 1e-3,
        turn: Floats | None = None,
        name: str = "approach",
    ) -> None:
        super().__init__(first, period, name)
        self._pose, self._velocity, self._goal, self._duration = pose, velocity, goal, duration
        at = goal(first, first + 1)
        R_g = at.rotation[0]
        self._turn = -(pin.log3(R_g @ pose.rotation.T) if turn is None else turn)
        self._spin = R_g.T @ (velocity[3:] - at.velocity[0, 3:])

    def _motion(self, begun: int, ended: int) -> Motion:
        goal = self._goal(self._first + begun, self._first + ended)
        return self._towards(goal, np.arange(begun, ended, dtype=np.float64) * self._period)

    def _towards(self, goal: Motion, elapsed: Floats) -> Motion:
        on_way = elapsed < self._duration
        n = int(on_way.sum())
        if n == 0:
            return goal
        t = elapsed[:n, None]
        s, rate, curve = rest_to_rest(t / self._duration)
        rate, curve = rate / self._duration, curve / self._duration**2
        g, R_g, V_g, A_g = (one[:n] for one in goal)
        v_0, omega_0 = self._velocity[:3], self._velocity[3:]

        x_s = self._pose.translation + v_0 * t
        left, left_rate = g - x_s, V_g[:, :3] - v_0
        place = x_s + s * left
        v = v_0 + rate * left + s * left_rate
        a = curve * left + 2.0 * rate * left_rate + s * A_g[:, :3]

        r, r_1, r_2 = run_out(t / self._duration)
        r, r_2 = r * self._duration, r_2 / self._duration
        F = exponentials(omega_0 * t)
        F_T = F.transpose(0, 2, 1)
        E_1, G, E_2 = exponentials((1.0 - s) * self._turn), F_T @ R_g, exponentials(r * self._spin)
        omega_G, setting_in = turned(F_T, V_g[:, 3:] - omega_0), turned(G, r_1 * self._spin)
        y = turned(E_1, omega_G + setting_in)
        y_1 = turned(F_T, A_g[:, 3:] - np.cross(omega_0, V_g[:, 3:])) + np.cross(omega_G, setting_in)
        y_1 += turned(G, r_2 * self._spin)
        w = turned(F, y - rate * self._turn)
        w_1 = turned(E_1, y_1) - curve * self._turn - np.cross(rate * self._turn, y)
        omega, alpha = omega_0 + w, turned(F, w_1) + np.cross(omega_0, w)
        return Motion(
            np.concatenate([place, goal.place[n:]]),
            np.concatenate([F @ E_1 @ G @ E_2, goal.rotation[n:]]),
            np.concatenate([np.hstack([v, omega]), goal.velocity[n:]]),
            np.concatenate([np.hstack([a, alpha]), goal.acceleration[n:]]),
        )


# -- rotations, many at once --------------------------------------------------------------------------------------


def run_out(u: Floats) -> tuple[Floats, Floats, Floats]:
    """Way, velocity and acceleration of the quintic that is zero at both ends, with rate 1 at the first."""
    return (
        u * (1.0 - u) ** 3 * (1.0 + 3.0 * u),
        (1.0 - u) ** 2 * (1.0 + u * (2.0 - 15.0 * u)),
        u * (1.0 - u) * (60.0 * u - 36.0),
    )


def turned(R: Floats, x: Floats) -> Floats:
    """Return R x, row by row: (N, 3, 3), (N, 3)."""
    return np.asarray(np.einsum("kij,kj->ki", R, x))


def exponentials(x: Floats) -> Floats:
    """Return the rotation (N, 3, 3) of each rotation vector (N, 3)."""
    theta = np.linalg.norm(x, axis=1)
    columns = rodrigues(tuple(x.T), np.sinc(theta / np.pi), 0.5 * np.sinc(0.5 * theta / np.pi) ** 2)
    return np.ascontiguousarray(np.array(columns).reshape(3, 3, -1).transpose(2, 1, 0))

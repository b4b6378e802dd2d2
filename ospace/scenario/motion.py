"""Motions that a task follows from the phase's start on: towards a goal that stays or moves by itself.

The goal g(t), Q_g(t) is approached from the motion that the point would go on with by itself, x_s(t) = x_0 + v_0 t and
R_s(t) = exp(ω_0 t) R_0, by the quintic s from 0 to 1 with rest at both ends:

    x = x_s + s (g − x_s),     R = exp(θ) R_s,     θ = s φ,     φ = log(Q_g R_sᵀ)

so that position and velocity start with those of the point, and position, velocity and acceleration end with those of
the goal: at contact hand and fixture move as one. With J the left Jacobian of the exponential,

    φ̇ = J(φ)⁻¹ ω_φ,    ω_φ = ω_g − Q ω_0,    Q = exp(φ)
    ω = J(θ) θ̇ + exp(θ) ω_0

and likewise for the accelerations.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tables import Floats
from ospace.points import OperationalPoint
from ospace.simulation import Certificate, simulate
from ospace.state import State

_AHEAD = 1.0
"""How far the target's motion is computed at a time, s."""
_SMALL_ANGLE = 1e-2
_LARGEST_TURN = math.radians(175.0)


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
    start : State
    first : int
        Control cycle of the start.
    period, step : float
        Of a control cycle and of the integrator, s.
    integrator : "rk4" or "symplectic"

    Attributes
    ----------
    first : int
        Cycle of the run at which it begins.
    certificates : list of Certificate
        Of what was simulated.
    """

    def __init__(
        self,
        start: State,
        first: int = 0,
        period: float = 1e-3,
        step: float | None = None,
        integrator: str = "rk4",
    ) -> None:
        self.robot, self.first = start.robot, first
        self._period, self._step, self._integrator = period, step or period, integrator
        self._q, self._v = [start.q.copy()], [start.v.copy()]
        self.certificates: list[Certificate] = []

    def state(self, cycle: int) -> State:
        """Return the target's state."""
        self._reach(cycle)
        return self.robot.state(self._q[cycle - self.first], self._v[cycle - self.first])

    def states(self, first: int, last: int) -> tuple[Floats, Floats]:
        """Return q and v from one cycle to before another."""
        self._reach(last - 1)
        taken = slice(first - self.first, last - self.first)
        return np.array(self._q[taken]), np.array(self._v[taken])

    def frame(self, point: OperationalPoint) -> Goal:
        """Return the motion of a point of the target as a goal."""
        model, data, idle = self.robot.model, self.robot.model.createData(), np.zeros(self.robot.nv)

        def motion(first: int, last: int) -> Motion:
            Q, V = self.states(first, last)
            base = Q[:, :3].copy()
            Q[:, :3] = 0.0
            A = np.array([pin.aba(model, data, q, v, idle) for q, v in zip(Q, V, strict=True)])
            beside = point_motion(point, Q, V, A)
            return beside._replace(place=beside.place + base)

        return motion

    def _reach(self, cycle: int) -> None:
        """Simulate up to a cycle."""
        ticks, ahead = round(self._period / self._step), max(1, round(_AHEAD / self._period))
        while len(self._q) <= cycle - self.first:
            run = simulate(
                self.robot,
                self._q[-1],
                self._v[-1],
                duration=ahead * ticks * self._step,
                step=self._step,
                integrator=self._integrator,
                log_every=ticks,
                start=(self.first + len(self._q) - 1) * self._period,
            )
            if run.interrupted:
                raise KeyboardInterrupt
            self._q.extend(run.q[1:])
            self._v.extend(run.v[1:])
            self.certificates.append(run.certificate())


class Approach:
    """What a task follows: from a point's motion to a goal's, by minimum jerk; callable as `control.Function` asks.

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
        name: str = "approach",
    ) -> None:
        self._pose, self._velocity, self._goal, self._name = pose, velocity, goal, name
        self._first, self._period, self._duration = first, period, duration
        self._table: list[tuple[pin.SE3, Floats, Floats]] = []

    def __call__(self, time: float) -> tuple[pin.SE3, npt.ArrayLike, npt.ArrayLike]:
        """Return pose, velocity and acceleration at a cycle's time, s."""
        k = max(0, round(time / self._period) - self._first)
        while k >= len(self._table):
            self._extend()
        return self._table[k]

    def _extend(self) -> None:
        begun = len(self._table)
        ended = begun + max(1, round(_AHEAD / self._period))
        goal = self._goal(self._first + begun, self._first + ended)
        motion = self._towards(goal, np.arange(begun, ended, dtype=np.float64) * self._period)
        if not all(np.isfinite(one).all() for one in motion):
            raise OspaceError(f"what task '{self._name}' follows is not finite")
        self._table.extend(
            (pin.SE3(R, p), v, a)
            for p, R, v, a in zip(motion.place, motion.rotation, motion.velocity, motion.acceleration, strict=True)
        )

    def _towards(self, goal: Motion, elapsed: Floats) -> Motion:
        on_way = elapsed < self._duration
        n = int(on_way.sum())
        if n == 0:
            return goal
        t = elapsed[:n, None]
        s, rate, curve = _minimum_jerk(t / self._duration)
        rate, curve = rate / self._duration, curve / self._duration**2
        g, R_g, V_g, A_g = (one[:n] for one in goal)
        v_0, omega_0 = self._velocity[:3], self._velocity[3:]

        x_s = self._pose.translation + v_0 * t
        left, left_rate = g - x_s, V_g[:, :3] - v_0
        place = x_s + s * left
        v = v_0 + rate * left + s * left_rate
        a = curve * left + 2.0 * rate * left_rate + s * A_g[:, :3]

        R_s = _exp(omega_0 * t) @ self._pose.rotation
        Q = R_g @ R_s.transpose(0, 2, 1)
        phi = _log(Q)
        if np.linalg.norm(phi, axis=1).max() > _LARGEST_TURN:
            raise OspaceError(
                f"task '{self._name}' is to turn by more than {math.degrees(_LARGEST_TURN):.0f} deg to reach its goal: "
                f"go there in several phases"
            )
        carried = Q @ omega_0
        omega = V_g[:, 3:] - carried
        alpha = A_g[:, 3:] - np.cross(omega, carried)
        phi_1 = np.linalg.solve(_jacobian(phi), omega[..., None])[..., 0]
        phi_2 = np.linalg.solve(_jacobian(phi), (alpha - _jacobian_rate(phi, phi_1))[..., None])[..., 0]
        theta, theta_1 = s * phi, rate * phi + s * phi_1
        theta_2 = curve * phi + 2.0 * rate * phi_1 + s * phi_2
        E, J = _exp(theta), _jacobian(theta)
        turning = (J @ theta_1[..., None])[..., 0]
        carried = E @ omega_0
        angular = turning + carried
        angular_rate = (J @ theta_2[..., None])[..., 0] + _jacobian_rate(theta, theta_1) + np.cross(turning, carried)
        return Motion(
            np.concatenate([place, goal.place[n:]]),
            np.concatenate([E @ R_s, goal.rotation[n:]]),
            np.concatenate([np.hstack([v, angular]), goal.velocity[n:]]),
            np.concatenate([np.hstack([a, angular_rate]), goal.acceleration[n:]]),
        )


# -- rotations, many at once --------------------------------------------------------------------------------------


def _minimum_jerk(u: Floats) -> tuple[Floats, Floats, Floats]:
    """Way, velocity and acceleration of the quintic from 0 to 1, for u from 0 to 1."""
    return (
        u**3 * (10.0 + u * (-15.0 + 6.0 * u)),
        30.0 * u**2 * (1.0 - u) ** 2,
        60.0 * u * (1.0 - u) * (1.0 - 2.0 * u),
    )


def _skew(x: Floats) -> Floats:
    S = np.zeros((*x.shape, 3))
    S[:, 0, 1], S[:, 0, 2], S[:, 1, 2] = -x[:, 2], x[:, 1], -x[:, 0]
    return S - S.transpose(0, 2, 1)


def _coefficients(x: Floats) -> tuple[Floats, ...]:
    """Return sin x/x, a = (1 − cos x)/x², b = (x − sin x)/x³, and a'/x, b'/x; x the length of each vector, (N, 1)."""
    t = np.linalg.norm(x, axis=1, keepdims=True)
    w = t * t
    near = t < _SMALL_ANGLE
    t = np.where(near, 1.0, t)
    sine, cosine = np.sin(t), np.cos(t)
    a, b = (1.0 - cosine) / t**2, (t - sine) / t**3
    return (
        np.where(near, 1.0 - w / 6.0 + w * w / 120.0, sine / t),
        np.where(near, 0.5 - w / 24.0 + w * w / 720.0, a),
        np.where(near, 1.0 / 6.0 - w / 120.0 + w * w / 5040.0, b),
        np.where(near, -1.0 / 12.0 + w / 180.0 - w * w / 6720.0, (sine / t - 2.0 * a) / t**2),
        np.where(near, -1.0 / 60.0 + w / 1260.0 - w * w / 60480.0, (a - 3.0 * b) / t**2),
    )


def _exp(x: Floats) -> Floats:
    sine, a, *_ = _coefficients(x)
    S = _skew(x)
    return np.asarray(np.eye(3) + sine[..., None] * S + a[..., None] * (S @ S))


def _jacobian(x: Floats) -> Floats:
    """Left Jacobian of the exponential."""
    _, a, b, *_ = _coefficients(x)
    S = _skew(x)
    return np.asarray(np.eye(3) + a[..., None] * S + b[..., None] * (S @ S))


def _jacobian_rate(x: Floats, rate: Floats) -> Floats:
    """Return the rate of the left Jacobian, times `rate`."""
    _, _, b, a_1, b_1 = _coefficients(x)
    along = np.sum(x * rate, axis=1, keepdims=True)
    once = np.cross(x, rate)
    return np.asarray(along * (a_1 * once + b_1 * np.cross(x, once)) + b * np.cross(rate, once))


def _log(R: Floats) -> Floats:
    return np.array([pin.log3(one) for one in R])

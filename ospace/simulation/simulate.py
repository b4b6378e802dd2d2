"""A robot, a controller, and time."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ospace.checks import check_kind, checked_number, checked_vector
from ospace.exceptions import OspaceError
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.simulation.actuation import ControllerLike, Law, as_command, law_of
from ospace.simulation.delay_line import DelayLine
from ospace.simulation.errors import SimulationError
from ospace.simulation.integrators import integrator_of
from ospace.simulation.moving_frame import MovingFrame
from ospace.simulation.plant import Plant, Wrench
from ospace.simulation.recorder import Recorder
from ospace.simulation.runge_kutta import IntegratedMotion
from ospace.simulation.sensor_noise import Noise, Sensors
from ospace.simulation.trajectory import Trajectory

_ROUNDING = 1e-9


def simulate(
    robot: SpaceRobot,
    q: npt.ArrayLike,
    v: npt.ArrayLike,
    controller: ControllerLike | Law | None = None,
    *,
    duration: float,
    step: float = 1e-3,
    period: float | None = None,
    integrator: str = "rk4",
    tolerance: float | None = None,
    wrenches: Mapping[OperationalPoint, Wrench] | None = None,
    noise: Noise | None = None,
    delay: float = 0.0,
    wheel_momentum: npt.ArrayLike = (0.0, 0.0, 0.0),
    log_every: int = 1,
    start: float = 0.0,
    on_step: Callable[[float], bool | None] | None = None,
) -> Trajectory:
    """Simulate a space robot under a controller and external wrenches.

    Parameters
    ----------
    robot : SpaceRobot
    q, v : (nq,), (nv,)
        State at the start, as of `SpaceRobot.state`.
    controller : ControllerLike or function, optional
        Called as ``update(time, q, v)``, or as a function of these, once a `period`; what it returns is held until
        the next one, base quantities in inertial axes. A function may return joint torques (n,) alone. Nothing acts
        without it.
    duration : float
        A whole number of steps, s.
    step : float
        Step of the integrator, s; with `tolerance`, the largest one.
    period : float, optional
        From one call of the controller to the next, a whole number of steps, s; each step without it.
    integrator : "rk4" or "symplectic"
        Runge–Kutta of order 4 on the manifold; or the variational midpoint rule, which keeps momentum to rounding and
        lets the energy swing within O(h²) but not drift.
    tolerance : float, optional
        Error that each step may make, relative to the speeds of the run so far; steps are then divided as it asks,
        by the Dormand–Prince pair of order 5(4).
    wrenches : mapping of OperationalPoint to (6,) or function of time, optional
        External wrenches, inertial axes, at the points, linear first; N, N m. All six rows act, whatever rows the
        point takes.
    noise : Noise, optional
        Sensor noise on the state that the controller sees.
    delay : float
        From a call of the controller to when its command acts, a whole number of steps, s. Nothing acts before the
        first one does.
    wheel_momentum : (3,)
        Angular momentum stored in reaction wheels at the start, inertial axes, kg m²/s.
    log_every : int
        Steps from one record to the next; the last state is recorded always.
    start : float
        Time of the start, s.
    on_step : function, optional
        Called with the time (s) after each step; the run ends where it returns True.

    Returns
    -------
    Trajectory

    Raises
    ------
    SimulationError
        The state, or a command, is no longer finite; carries the trajectory so far.
    OspaceError
        An argument makes no sense.

    Notes
    -----
    Ctrl-C ends the run; its trajectory is then `interrupted`. Motion is integrated in the frame that moves along with
    the base's start, so that no digit is lost on an orbit. Damping and friction of the robot's model act at the joints
    (`ospace.dynamics.joint_friction`).
    """
    clock = _Clock.of(duration, step, period, delay, log_every, start)
    check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
    state = robot.state(q, v)
    frame = MovingFrame.of(state)
    plant = Plant(robot, wrenches)
    stepper = integrator_of(plant, integrator, tolerance)
    recorder = Recorder(plant, frame, clock.steps // log_every + 2, start, integrator)
    motion = IntegratedMotion.starting(*state.base_frame_state())
    wheels = checked_vector(wheel_momentum, 3, "wheel_momentum", robot.name)
    driver = (
        None if controller is None else _Driver(law_of(controller, robot), Sensors(robot, noise), frame, plant, clock)
    )

    interrupted = False
    k = 0
    try:
        with np.errstate(over="ignore", invalid="ignore"):  # reported below
            while k < clock.steps:
                if driver is not None:
                    driver.drive(k, motion)
                if k % log_every == 0:
                    recorder.record(k * step, motion, wheels)
                stepper.step(clock.time(k), step, motion)
                wheels = wheels - step * plant.wheel_torque
                k += 1
                if not math.isfinite(motion.work + motion.v.sum()):
                    raise OspaceError(_not_finite(robot, clock.time(k)))
                if on_step is not None and on_step(clock.time(k)):
                    break
        recorder.record(k * step, motion, wheels)
    except KeyboardInterrupt:
        interrupted = True
    except OspaceError as error:
        if not recorder.count:
            recorder.record(0.0, motion, wheels)
        raise SimulationError(str(error), clock.time(k), recorder.trajectory()) from error
    if not recorder.count:
        recorder.record(0.0, motion, wheels)
    return recorder.trajectory(interrupted)


@dataclass(frozen=True)
class _Clock:
    """Time in whole steps: nothing is added up."""

    step: float
    steps: int
    ticks: int
    delay: int
    start: float

    @classmethod
    def of(
        cls, duration: float, step: float, period: float | None, delay: float, log_every: int, start: float
    ) -> _Clock:
        step, start = checked_number(step, "step"), checked_number(start, "start")
        if not step > 0.0:
            raise OspaceError(f"step {step!r}: give a time above zero, s")
        if isinstance(log_every, bool) or not isinstance(log_every, int) or log_every < 1:
            raise OspaceError(f"log_every {log_every!r}: give a whole number from 1 on")
        return cls(
            step,
            _whole(duration, step, "duration", 1),
            1 if period is None else _whole(period, step, "period", 1),
            _whole(delay, step, "delay", 0),
            start,
        )

    def time(self, k: int) -> float:
        return self.start + k * self.step


def _whole(time: float, step: float, name: str, least: int) -> int:
    """Return how many steps `time` takes; raises `OspaceError` where that is no whole number."""
    time = checked_number(time, name)
    count = time / step
    if not math.isfinite(count) or round(count) < least or abs(count - round(count)) > _ROUNDING * max(1.0, count):
        near = max(least, round(count)) * step if math.isfinite(count) else step
        raise OspaceError(f"{name} {time!r} s is no whole number of steps of {step!r} s; {near:.9g} s would be one")
    return round(count)


class _Driver:
    """Calls the controller in time, and lets its commands act in time."""

    def __init__(self, law: Law, sensors: Sensors, frame: MovingFrame, plant: Plant, clock: _Clock) -> None:
        self._law, self._sensors, self._frame, self._plant, self._clock = law, sensors, frame, plant, clock
        self._under_way = DelayLine(clock.delay)

    def drive(self, k: int, motion: IntegratedMotion) -> None:
        """Do what is due before step `k`."""
        clock, time = self._clock, self._clock.time(k)
        if k % clock.ticks == 0:
            q, v = self._sensors.measure(*self._frame.to_user_frame_at(k * clock.step, motion.q, motion.v))
            command = as_command(self._law(time, q, v), time)
            if not clock.delay:
                self._plant.hold(command, time)
                return
            self._under_way.put(k, command)
        if (acting := self._under_way.acting(k)) is not None:
            self._plant.hold(acting, time)


def _not_finite(robot: SpaceRobot, time: float) -> str:
    return (
        f"the state of robot '{robot.name}' is no longer finite at {time:.6g} s: "
        f"take a smaller step or a tolerance, or look for a torque that grows without bound"
    )

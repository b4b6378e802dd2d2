"""Reaction wheels: torques that keep them within their momentum, in the units of the program."""

import arms
import numpy as np
import pytest

from ospace.control import Base, BaseAttitudeTask, Controller, DampingTask
from ospace.control.wheels import Wheels


def test_bounds_are_those_of_the_momentum_that_is_left():
    """h − u T within ± the largest, u in units of `scale`: torque = scale × û."""
    scale, period, most = np.array([2.0, 2.0, 5.0]), 0.1, 3.0
    wheels = Wheels(np.ones(3, dtype=bool), np.arange(3), most, np.full(3, 100.0), scale)
    stored, bounds = np.array([0.5, -3.0, 2.0]), np.zeros((2, 3))
    wheels.limit(stored, period, bounds)
    for edge, end in ((bounds[0], most), (bounds[1], -most)):
        np.testing.assert_allclose(stored - edge * scale * period, end, rtol=1e-12)
    wheels.limit(stored, 1e-6, bounds)
    assert (np.abs(bounds).max(axis=0) == 100.0).all()


@pytest.mark.parametrize("moment", [5.0, 50.0, 500.0])
def test_a_cycle_fills_the_wheels_and_no_more(moment):
    """Whatever the base's inertia, by which the program scales torques."""
    robot = arms.arm(moment=moment)
    q, v = robot.configuration(), np.zeros(robot.nv)
    v[3:6] = 1.0, -2.0, 1.5
    tasks = [BaseAttitudeTask(name="base", robot=robot, stiffness=1e4), DampingTask(name="rest")]
    run = Controller(robot, tasks, base=Base(torque=1e9, wheels=True, wheel_momentum=0.2), period=0.01)
    command = run.update(0.0, q, v)
    np.testing.assert_allclose(np.abs(run.wheel_momentum), 0.2, rtol=1e-6)
    assert sum("wheel momentum" in name for name in command.active_limits) == 3
    assert command.status == "falling short"
    (short,) = command.shortfalls
    assert short.reason == "held back by limits"
    assert "base torque" in short.cause

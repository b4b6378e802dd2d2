"""Momentum wheels: what they take and what they keep within."""

import numpy as np
import pinocchio as pin
from commands import accelerations

from ospace.control import (
    Base,
    BaseAttitudeTask,
    Constant,
    Controller,
    DampingTask,
)


def test_wheels_keep_within_their_momentum(chaser):
    q, v = chaser.configuration(), np.zeros(24)
    goal = Constant(pin.SE3(pin.exp3(np.array([0.0, 0.0, 1.0])), np.zeros(3)))
    base = Base(torque=50.0, wheels=True, wheel_momentum=2.0)
    run = Controller(
        chaser, [BaseAttitudeTask(name="turn", robot=chaser, reference=goal), DampingTask(name="rest")], base=base
    )
    largest = 0.0
    assert {f"base torque z, {side}" for side in ("lower", "upper")} & {*run.update(0.0, q, v).active_limits}
    for k in range(2000):
        command = run.update(k * 1e-3, q, v)
        a = accelerations(chaser, q, v, command)
        v = v + 1e-3 * a
        q = pin.integrate(chaser.model, q, v * 1e-3)
        largest = max(largest, np.abs(chaser.base_pose(q).rotation.T @ run.wheel_momentum).max())
    assert 1.9 < largest < 2.0 + 1e-3
    assert {f"base torque z: wheel momentum, {side}" for side in ("lower", "upper")} & {*command.active_limits}

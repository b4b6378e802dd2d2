"""`Controller.warm_up` takes what the first cycle would load out of it, and changes nothing else."""

import json
import os
import subprocess
import sys

import numba
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.control import BaseAttitudeTask, Controller, Function, OrientationTask, PoseTask, PostureTask
from ospace.kernels.jit import cache
from ospace.validation.sampling import random_state

FIRST_CYCLE = """
import json, sys
import numpy as np, ospace
from ospace.control import BaseAttitudeTask, Controller, PoseTask, PostureTask
from ospace.kernels import evaluation
from ospace.kernels.qp import program

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
tasks = [PoseTask(name="hand", point=robot.point("end_effector")), PostureTask(name="posture")]
controller = Controller(robot, tasks, solver=sys.argv[1])
if sys.argv[2] == "warm":
    controller.warm_up()
entries = [getattr(module, name) for module in (evaluation, program) for name in dir(module)]
entries = [one for one in entries if hasattr(one, "overloads")]
before, codes = set(sys.modules), sum(len(one.overloads) for one in entries)
controller.update(0.0, robot.configuration(), np.zeros(robot.nv))
print(json.dumps([sorted(set(sys.modules) - before), sum(len(one.overloads) for one in entries) - codes]))
"""


def first_cycle(solver, how):
    """What the first cycle of a process imports, and how many kernels it loads."""
    environment = os.environ | {"OSPACE_CACHE_DIR": str(cache.directory().parent)}
    done = subprocess.run(
        [sys.executable, "-c", FIRST_CYCLE, solver, how], capture_output=True, text=True, check=True, env=environment
    )
    return json.loads(done.stdout)


@pytest.mark.skipif(cache.directory() is None, reason="kernels are not kept")
@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="about compiled kernels")
@pytest.mark.parametrize("solver", ["daqp", "proxqp", "clarabel"])
def test_the_first_cycle_loads_nothing(solver):
    assert any(first_cycle(solver, "cold"))
    assert first_cycle(solver, "warm") == [[], 0]


def controller_of(robot, calls, base):
    def motion(time):
        calls.append(time)
        return pin.SE3(np.eye(3), np.array([0.5, 0.1 * time, 0.3])), np.zeros(6), np.zeros(6)

    tasks = [
        PoseTask(name="hand", point=robot.point("right_hand"), reference=Function(motion)),
        OrientationTask(name="head", point=robot.point("head"), level=1),
        BaseAttitudeTask(name="base", robot=robot),
        PostureTask(name="posture"),
    ]
    return Controller(robot, tasks, base=base, wheel_momentum=(0.1, 0.0, -0.2) if base == "wheels" else np.zeros(3))


def numbers(command):
    return [command.torque, command.base_wrench, command.wheel_torque, *command.errors.values()]


@pytest.mark.parametrize("base", ["floating", "wheels"])
@pytest.mark.parametrize("at", [0, 2])
def test_commands_are_those_without_it_bit_for_bit(base, at):
    """Warmed before its first cycle, or between two."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    calls, others = [], []
    warmed, plain = controller_of(robot, calls, base), controller_of(robot, others, base)
    state = random_state(robot, np.random.default_rng(3))
    q, v = state.q, state.v
    for cycle in range(4):
        if cycle == at:
            before = len(calls), warmed._begun, list(warmed._references), warmed.wheel_momentum.copy()
            tables = warmed._run.memory, warmed._program.H, warmed._tasks.reference
            known = [one.tobytes() for one in tables]
            warmed.warm_up()
            assert (len(calls), warmed._begun, warmed._references) == before[:3]
            assert np.array_equal(warmed.wheel_momentum, before[3])
            assert known == [one.tobytes() for one in tables]
        time = 1e-3 * cycle
        a, b = numbers(warmed.update(time, q, v)), numbers(plain.update(time, q, v))
        assert all(map(np.array_equal, a, b))
        assert np.array_equal(warmed.wheel_momentum, plain.wheel_momentum)
    assert calls == others

"""One control cycle of ospace beside one of pink, on the same robot: ``pytest benchmarks/test_control.py -s``.

pink solves for joint velocities, by differential inverse kinematics: its cycle has neither dynamics nor torque limits.
The tasks are comparable: pose of a hand, orientation of head and base, posture; limits of position and velocity on both
sides.
"""

import itertools

import numpy as np
import pytest

import ospace
from ospace.benchmark.timing import Ratio, window_times
from ospace.control import BaseAttitudeTask, Controller, OrientationTask, PoseTask, PostureTask
from ospace.validation.sampling import random_state

pink = pytest.importorskip("pink", reason="pip install pin-pink")

ROBOT = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
HAND, HEAD = ROBOT.point("right_hand"), ROBOT.point("head")


def states():
    """Slow states inside all limits, so that both sides solve what they are made for."""
    drawn = [random_state(ROBOT, np.random.default_rng(seed)) for seed in range(32)]
    return [(0.9 * state.q + 0.1 * ROBOT.configuration(), 0.05 * state.v) for state in drawn]


def unit(q):
    q = q.copy()
    q[3:7] /= np.linalg.norm(q[3:7])
    return q


STATES = [(unit(q), v) for q, v in states()]


def ours():
    tasks = [
        PoseTask(name="hand", point=HAND),
        OrientationTask(name="head", point=HEAD),
        BaseAttitudeTask(name="base", robot=ROBOT),
        PostureTask(name="posture"),
    ]
    run, clock = Controller(ROBOT, tasks), itertools.count()
    return lambda q, v: run.update(next(clock) * 1e-3, q, v)


def pinks():
    from pink.tasks import FrameTask, PostureTask

    tasks = [
        FrameTask("right_hand", position_cost=1.0, orientation_cost=1.0),
        FrameTask("head", position_cost=0.0, orientation_cost=1.0),
        FrameTask("base", position_cost=0.0, orientation_cost=1.0),
        PostureTask(cost=1e-3),
    ]
    configuration = pink.Configuration(ROBOT.model, ROBOT.model.createData(), STATES[0][0])
    for task in tasks:
        task.set_target_from_configuration(configuration)

    def cycle(q, v):
        configuration.update(q)
        return pink.solve_ik(configuration, tasks, 1e-3, solver="daqp", safety_break=False)

    return cycle


@pytest.mark.parametrize("side", [ours, pinks])
def test_one_cycle(benchmark, side):
    benchmark.group = "one control cycle"
    way, rotating = side(), itertools.cycle(STATES)
    benchmark.pedantic(way, setup=lambda: (next(rotating), {}), rounds=2000, warmup_rounds=100)


def test_side_by_side(capsys):
    times = Ratio.of(window_times((ours(), pinks()), STATES, seconds=4.0, tick=lambda: None))
    spread = f"{times.low:.1f}-{times.high:.1f}"
    with capsys.disabled():
        print(f"\nospace {times.ours:.1f} µs, pink {times.theirs:.1f} µs, ratio {times.ratio:.1f} ({spread})")

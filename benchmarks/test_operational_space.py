"""ospace and Pinocchio on one state, by pytest-benchmark: ``pytest benchmarks --benchmark-group-by=param:quantity``.

`ospace bench` times the same contests in windows that take turns, which a noisy machine disturbs less.
"""

import itertools

import numpy as np
import pytest

import ospace
from ospace.benchmark import peers, report

PLAN = report.prepare(ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof")), 3)
CASES = [
    pytest.param(contest, side, f"{contest.quantity}, p = {count}", id=f"{contest.quantity}-{count}-{side}")
    for count, contest in PLAN.contests
    for side in ("ours", "theirs")
]


@pytest.mark.parametrize(("contest", "side", "quantity"), CASES)
def test_one_state(benchmark, contest, side, quantity):
    benchmark.group = quantity
    states, way = itertools.cycle(PLAN.states), getattr(contest, side)
    benchmark.pedantic(way, setup=lambda: (next(states), {}), rounds=2000, warmup_rounds=100)


@pytest.mark.parametrize("output", ["inertia_inverse", "inertia_inverse_packed", "bias_force", "generalized_jacobian"])
def test_many_states(benchmark, output):
    benchmark.group = "8192 states"
    points = peers.spread_points(PLAN.robot, 3)
    Q, V = (np.array([PLAN.states[k % len(PLAN.states)][side] for k in range(8192)]) for side in (0, 1))
    benchmark(ospace.operational_space_batch, PLAN.robot, points, Q, V, (output,))

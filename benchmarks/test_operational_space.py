"""ospace and Pinocchio on one state, by pytest-benchmark: ``pytest benchmarks --benchmark-group-by=param:quantity``.

`ospace bench` times the same comparisons in windows that take turns, which a noisy machine disturbs less.
"""

import itertools

import numpy as np
import pytest

import ospace
from ospace.benchmark import pinocchio_baseline, report

PLAN = report.prepare(ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof")), 3)
CASES = [
    pytest.param(comparison, side, f"{comparison.quantity}, p = {count}", id=f"{comparison.quantity}-{count}-{side}")
    for count, comparison in PLAN.comparisons
    for side in ("ours", "theirs")
]


@pytest.mark.parametrize(("comparison", "side", "quantity"), CASES)
def test_one_state(benchmark, comparison, side, quantity):
    benchmark.group = quantity
    states, way = itertools.cycle(PLAN.states), getattr(comparison, side)
    benchmark.pedantic(way, setup=lambda: (next(states), {}), rounds=2000, warmup_rounds=100)


@pytest.mark.parametrize("output", ["inertia_inverse", "inertia_inverse_packed", "bias_force", "generalized_jacobian"])
def test_many_states(benchmark, output):
    benchmark.group = "8192 states"
    points = pinocchio_baseline.spread_points(PLAN.robot, 3)
    Q, V = (np.array([PLAN.states[k % len(PLAN.states)][side] for k in range(8192)]) for side in (0, 1))
    benchmark(ospace.operational_space_batch, PLAN.robot, points, Q, V, (output,))

"""Pinocchio by hand: both sides compute the same, and a difference is reported, not timed."""

from dataclasses import replace

import numpy as np
import pytest
import trees

import ospace
from ospace.benchmark import pinocchio_baseline
from ospace.validation.sampling import random_state


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.mark.parametrize("make", pinocchio_baseline.COMPARISONS)
@pytest.mark.parametrize("seed", range(3))
def test_both_sides_compute_the_same_on_any_robot(make, seed):
    robot = trees.tree(seed, 12, ("revolute", "prismatic", "revolute about any axis"))
    states = [trees.state(robot, k) for k in range(4)]
    make(robot, [robot.point("link_11")]).check([(state.q.copy(), state.v.copy()) for state in states])


@pytest.mark.parametrize("make", pinocchio_baseline.COMPARISONS)
def test_a_difference_is_told_and_not_timed(chaser, make):
    comparison = make(chaser, [chaser.point("right_hand")])
    state = random_state(chaser, np.random.default_rng(0))

    def wrong(q, v):
        return [(ours * (1.0 + 1e-6), theirs) for ours, theirs in comparison.results(q, v)]

    with pytest.raises(ospace.OspaceError, match=r"differ by 1\.0e-06"):
        replace(comparison, results=wrong).check([(state.q.copy(), state.v.copy())])

"""The oracle of rates is right: against differences of eighth order of the dense forms."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.dynamics.dense import Dense
from ospace.validation.dense_rates import DenseRates, has_rates

WEIGHTS = ((1, 4 / 5), (2, -1 / 5), (3, 4 / 105), (4, -1 / 280))
STEP = 1e-3
QUANTITIES = ("H", "J_e", "J_m_star", "Gamma_e_inv", "c", "drift", "mu")
KINDS = sorted(kind for kind in trees.JOINT_TYPES if has_rates(trees.tree(0, 1, (kind,))))


def difference(state, points, quantity):
    robot = state.robot

    def at(h):
        moved = ospace.State(robot, pin.integrate(robot.model, state.q, h * state.v), (1.0 + h) * state.v)
        return getattr(Dense(moved, points), quantity)

    return sum(weight * (at(k * STEP) - at(-k * STEP)) for k, weight in WEIGHTS) / STEP


@pytest.mark.parametrize("robot", [trees.tree(4, 16, KINDS), trees.coupled(1)], ids=["free", "coupled"])
@pytest.mark.parametrize("quantity", QUANTITIES)
def test_rates_of_the_dense_forms_are_their_differences(robot, quantity):
    state = trees.state(robot, 1)
    points = [robot.point("link_8", offset=pin.SE3(pin.exp3(np.ones(3)), np.ones(3))), robot.point("link_3", "angular")]
    reference = difference(state, points, quantity)
    rate = getattr(DenseRates(state, points), f"{quantity}_dot")
    np.testing.assert_allclose(rate, reference, rtol=0, atol=1e-10 * max(1.0, np.abs(reference).max()))


def test_joints_whose_columns_turn_within_have_no_rates():
    assert {kind for kind in trees.JOINT_TYPES if kind not in KINDS} == {
        "composite",
        "spherical by angles",
        "universal",
    }

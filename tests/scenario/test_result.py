"""The certificate of a whole run: the worst of its segments and of its grasps."""

import dataclasses

import numpy as np
import pinocchio as pin
import pytest

from ospace.scenario import result, runner
from ospace.simulation import Certificate, Conserved, grasp, rigid_body, tumbling


@pytest.mark.parametrize("order", [1, -1])
def test_the_worst_certificate_is_the_one_that_cannot_be_computed(order):
    """Whichever comes first: NaN compares with nothing."""
    lines = [Conserved("linear momentum", error, 1e-9, 1.0, "kg m/s", 0.0) for error in (1e-15, np.nan, 1e-3)]
    chosen = result.worst([Certificate((line,)) for line in lines[::order]])
    assert np.isnan(chosen["linear momentum"].error)
    assert not chosen.passed
    boundless = Conserved("linear momentum", 0.0, 1e-9, np.inf, "kg m/s", 0.0)
    good = Conserved("linear momentum", 1e-12, 1e-9, 1.0, "kg m/s", 0.0)
    assert not result.worst([Certificate((one,)) for one in (good, boundless)[::order]]).passed


@pytest.mark.parametrize(("speed", "spoilt"), [(0.1, {"energy_lost": np.nan}), (1e160, {})])
def test_a_grasp_whose_balance_cannot_be_computed_fails(speed, spoilt):
    """One whose energy is not finite is the scale of both lines."""
    bodies = [rigid_body(10.0, (1.0, 1.0, 1.0), name=name) for name in ("chaser", "target")]
    chaser, target = (tumbling(one, pin.SE3.Identity(), (0, 0, 0)) for one in bodies)
    held = grasp(chaser, bodies[0].point("chaser"), target, bodies[1].point("target"))
    moving = tumbling(bodies[1], pin.SE3.Identity(), (0.0, 0.0, speed))
    with np.errstate(over="ignore", invalid="ignore"):
        lines = runner.conserved_in_grasp(chaser, moving, dataclasses.replace(held, **spoilt), 0.0)
    assert not lines[1].passed
    assert np.isnan(lines[1].error)

"""The fixed-attitude Jacobian of ETS-VII (Nenchev, Umetani and Yoshida), by Pinocchio's joint-space inertia alone."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from proven import row
from scipy.linalg import null_space

import ospace
from ospace import analysis


@pytest.fixture(scope="module")
def state():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("ets_vii"))
    return robot.state(robot.configuration())


def by_pinocchio(state, point):
    """J N: angular momentum about the mass centre is K φ̇ while base and attitude rest, and K N = 0."""
    model = state.robot.model
    data = model.createData()
    H = np.triu(pin.crba(model, data, state.q))
    H = H + np.triu(H, 1).T
    shift = -np.linalg.solve(H[:3, :3], H[:3, 6:])  # of the base, its attitude fixed: the mass centre stays
    N = null_space(H[3:6, 6:] + H[3:6, :3] @ shift)
    J = pin.computeFrameJacobian(model, data, state.q, model.getFrameId(point.frame), pin.LOCAL_WORLD_ALIGNED)
    R = state.T_WB.rotation
    return (J[:, 6:] + np.vstack([R @ shift, 0.0 * shift])) @ N


@pytest.mark.parametrize(("axes", "unit"), [("linear", "m"), ("angular", "rad")])
def test_singular_values_at_the_home_configuration(state, axes, unit):
    point = state.robot.point("end_effector", axes)
    ours = np.linalg.svd(analysis.fixed_attitude_jacobian(state, point), compute_uv=False)
    rows = slice(0, 3) if axes == "linear" else slice(3, 6)
    other = np.linalg.svd(by_pinocchio(state, point)[rows], compute_uv=False)
    row(f"ETS-VII, arm at home: σ of the fixed-attitude Jacobian, {unit} per rad").equals(*ours)
    row(f"the same {unit} per rad by Pinocchio's `crba`").within(np.abs(ours - other).max())


def test_three_of_six_rates_are_left(state):
    space = analysis.reaction_null_space(state)
    row("ETS-VII: joint rates that leave the attitude alone").counts(space.basis.shape[1], state.robot.n_joints)
    base = ospace.generalized_jacobian(state, state.robot.point("end_effector")).base_generalized_jacobian
    assert np.abs(base[3:] @ space.basis).max() < 1e-15

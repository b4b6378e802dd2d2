"""The impact of a grasp against one dense solve of momentum and constraint together, by Pinocchio's crba and Jacobians.

⎡ H_c   0    J_cᵀ⎤ ⎡v_c⁺⎤   ⎡H_c v_c⎤
⎢ 0    H_t  −J_tᵀ⎥ ⎢v_t⁺⎥ = ⎢H_t v_t⎥        both points at the hand, inertial axes
⎣J_c  −J_t    0  ⎦ ⎣ λ  ⎦   ⎣   0   ⎦
"""

import numpy as np
import pinocchio as pin
import pytest
import trees
from test_grasp import REVERSIBLE

from ospace.simulation import grasp


def parts(state, joint, place):
    """Return H (nv, nv), and J (6, nv) of the material point of a joint's body at a place, inertial axes."""
    model = state.robot.model
    data = model.createData()
    upper = np.triu(pin.crba(model, data, state.q))
    pin.computeJointJacobians(model, data, state.q)
    J = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
    arm = pin.skew(place - data.oMi[joint].translation)
    return upper + np.triu(upper, 1).T, np.vstack([J[:3] - arm @ J[3:], J[3:]])


def solved(chaser, hand, target, fixture):
    """Return v_c⁺, v_t⁺ and λ of the dense system."""
    place = chaser.placement(hand).translation
    (H_c, J_c), (H_t, J_t) = parts(chaser, hand.joint, place), parts(target, fixture.joint, place)
    n, m = len(H_c), len(H_t)
    K = np.zeros((n + m + 6, n + m + 6))
    K[:n, :n], K[n:-6, n:-6] = H_c, H_t
    K[-6:, :-6] = np.hstack([J_c, -J_t])
    K[:-6, -6:] = K[-6:, :-6].T
    x = np.linalg.solve(K, np.concatenate([H_c @ chaser.v, H_t @ target.v, np.zeros(6)]))
    return x[:n], x[n:-6], x[-6:]


@pytest.mark.parametrize("seed", range(60))
@pytest.mark.parametrize(("joints", "held"), [(0, "base"), (4, "base"), (4, "link_3")])
def test_the_impact_is_that_of_a_dense_solve(seed, joints, held):
    chaser, target = trees.tree(seed, 7), trees.tree(seed + 1000, joints, REVERSIBLE)
    target.name = "target"
    a, b = trees.state(chaser, seed), trees.state(target, seed + 1000)
    rng = np.random.default_rng(seed)
    offset = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
    hand, fixture = chaser.point("link_3", offset=offset), target.point(held, offset=offset.inverse())
    one = grasp(a, hand, b, fixture)
    v_c, v_t, impulse = solved(a, hand, b, fixture)
    assert np.abs(one.chaser.v - v_c).max() < 2e-12 * np.abs(v_c).max()
    assert np.abs(one.target.v - v_t).max() < 2e-12 * np.abs(v_t).max()
    assert np.abs(one.impulse - impulse).max() < 2e-12 * np.abs(impulse).max()

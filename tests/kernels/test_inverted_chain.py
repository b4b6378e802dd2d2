"""Inverted chain of the paper: its step against its definition, the whole against dense forms and 50 digits."""

import booms
import numpy as np
import pinocchio as pin
import pytest
import trees
from exact import exact
from kernels.test_forward_chain import close, error

import ospace
from ospace.dynamics import paper_sweeps
from ospace.dynamics.dense import Dense
from ospace.kernels import forward_chain, inverted_chain
from ospace.kernels.tree import path_to


@pytest.fixture(params=[*trees.JOINT_TYPES, "mixed"])
def state(request):
    types = None if request.param == "mixed" else (request.param,)
    return trees.state(trees.tree(17, 16 if types is None else 6, types), 9, far=True)


def every_link(robot):
    offset = pin.SE3(pin.exp3(np.array([0.3, 0.1, -0.2])), np.array([0.1, -0.2, 0.3]))
    names = ["base", *(f"link_{k}" for k in range(robot.model.njoints - 2))]
    return [robot.point(name, offset=offset) for name in names]


def test_inverted_chain_against_the_dense_forms(state):
    for point in every_link(state.robot):
        dense = Dense(state, [point])
        Gamma, mu_e, Gamma_inv, mu, pivots = paper_sweeps.inverted(state, [point])
        close(Gamma, dense.Gamma_e, 1e-12)
        close(mu_e, dense.Gamma_e @ dense.mu, 1e-11)
        close(Gamma_inv, dense.Gamma_e_inv, 1e-12)
        close(mu, dense.mu, 1e-12)
        assert (pivots[1:] > 1e-6).all()


def test_one_step_outward_is_the_printed_one(state):
    """(33) and (35), with the factor that (35) lacks, for the first link behind the base."""
    robot = state.robot
    chain, _ = paper_sweeps.paper_frames(state, [robot.point("base")])
    body = forward_chain.links_alone(chain)
    inverted_chain.pass_outward(chain, body, 1)
    X, S, p = np.linalg.inv(chain.X[1]), chain.S[1], forward_chain.initial_bias_forces(chain)
    I_h, p_h = X @ chain.I[0] @ X.T, X @ p[0]
    alpha = S @ I_h @ S + chain.armature[1]
    L = np.eye(6) - np.outer(S, S @ I_h) / alpha
    close(body.I[1], chain.I[1] + I_h @ L, 1e-12)
    close(body.p[1], p[1] + p_h - I_h @ L @ chain.c[1] - I_h @ S * (S @ p_h) / alpha, 1e-12)
    close(body.beta[1], alpha)
    close(body.moved[1], I_h)
    close(body.IC[1], chain.I[1] + I_h)


def test_the_path_to_a_link_is_the_tree_s():
    robot = trees.tree(17, 16)
    chain, _ = paper_sweeps.paper_frames(trees.state(robot, 1), [robot.point("base")])
    for i in range(len(chain.parent)):
        assert path_to(chain.parent, i) == path_to(robot.links.parent, i)


@pytest.mark.parametrize(
    ("reach", "finger", "digits"),
    [
        (20.0, "finger", 1e-12),
        (20.0, "finger about any axis", 1e-12),
        (20.0, "sliding finger", 1e-12),
        # Γ_e itself is carried out along the boom, and Γ_e⁻¹ taken of it there: that costs reach² m/I of rounding
        (100.0, "finger", 2e-11),
        # behind a first phalanx what is light lies on no axis of the second one's frame
        (20.0, "two phalanges", 1e-10),
    ],
)
def test_a_light_finger_on_a_long_boom(reach, finger, digits):
    robot = booms.boom(reach, finger)
    for seed in range(3):
        state, point = trees.state(robot, seed, far=True), robot.point("finger_0")
        result, reference = ospace.operational_space(state, point, "inverted"), exact(state, [point])
        assert max(error(result, reference)) < digits


@pytest.mark.parametrize("method", ["forward", "inverted", "dense"])
def test_a_last_link_that_nothing_keeps_from_turning_is_refused(method):
    """A point mass on the axis of its joint."""
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia.FromBox(10.0, 1.0, 1.0, 1.0), pin.SE3.Identity())
    placement = pin.SE3(pin.exp3(np.array([0.3, -0.4, 0.5])), np.array([0.7, 0.2, -0.4]))
    hand = model.addJoint(root, pin.JointModelRY(), placement, "wrist")
    model.appendBodyToJoint(hand, pin.Inertia.FromBox(1.0, 0.2, 0.3, 0.4), pin.SE3.Identity())
    bead = model.addJoint(hand, pin.JointModelRX(), placement, "bead's")
    model.appendBodyToJoint(bead, pin.Inertia(1.0, np.zeros(3), np.zeros((3, 3))), pin.SE3.Identity())
    model.addBodyFrame("bead", bead, pin.SE3.Identity(), 0)
    robot = ospace.SpaceRobot.from_model(model)
    with pytest.raises(ospace.SingularInertiaError, match="bead's"):
        ospace.operational_space(trees.state(robot, 2), robot.point("bead"), method)

"""Joints that mimic others: every quantity is Gᵀ(·)G of the free robot, in every way in."""

from __future__ import annotations

import pickle

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.dynamics.dense import Dense, solve
from ospace.dynamics.joint_space import inverse_dynamics

SEEDS = range(8)
DIGITS = 1e-12


def close(value, reference, digits=DIGITS):
    """Assert that both are the same to within that share of the largest element, or of 1."""
    np.testing.assert_allclose(value, reference, rtol=0, atol=digits * max(1.0, np.abs(reference).max()))


class Twin:
    """The free robot of a coupled one, of free joints in ospace: as if nothing mimicked anything."""

    def __init__(self, seed, frames=("link_8", "link_4")):
        self.robot = trees.coupled(seed)
        self.free = ospace.SpaceRobot.from_model(self.robot.free.model)
        self.state = trees.state(self.robot, seed)
        self.free_state = self.free_at(self.state)
        self.points = [self.robot.point(frame) for frame in frames]
        self.free_points = [self.free.point(frame) for frame in frames]
        self.G = self.robot.free.G  # base rows are the same in base axes and in inertial ones

    def free_at(self, state):
        return self.free.state(self.robot.free.configuration(state.q), self.robot.free.G @ state.v)


def joint_space(state):
    """H and c."""
    own = ospace.joint_space_dynamics(state)
    H = np.block([[own.base_inertia, own.coupling_inertia], [own.coupling_inertia.T, own.manipulator_inertia]])
    return H, np.r_[own.base_bias, own.manipulator_bias]


@pytest.mark.parametrize("seed", SEEDS)
def test_followers_stand_where_their_leaders_place_them(seed):
    twin = Twin(seed)
    assert twin.robot.nv == twin.free.nv - len(twin.robot.links.followers) < twin.free.nv
    for frame in twin.robot.frame_names:
        own, free = (one.state.placement(one.robot.point(frame)) for one in (twin, _Free(twin)))
        close(own.homogeneous, free.homogeneous)


class _Free:
    def __init__(self, twin):
        self.robot, self.state = twin.free, twin.free_state


@pytest.mark.parametrize("seed", SEEDS)
def test_joint_space_dynamics_of_a_coupled_robot(seed):
    """H = Gᵀ H_free G, c = Gᵀ c_free, and the momentum is the same."""
    twin = Twin(seed)
    (H, c), (H_free, c_free) = joint_space(twin.state), joint_space(twin.free_state)
    close(H, twin.G.T @ H_free @ twin.G)
    close(c, twin.G.T @ c_free)
    close(ospace.momentum(twin.state), ospace.momentum(twin.free_state))


@pytest.mark.parametrize("seed", SEEDS)
def test_inverse_dynamics_gives_the_leader_the_torque_of_its_followers(seed):
    twin = Twin(seed)
    a = np.random.default_rng(seed).normal(size=twin.robot.nv)
    close(inverse_dynamics(twin.state, a), twin.G.T @ inverse_dynamics(twin.free_state, twin.G @ a))


@pytest.mark.filterwarnings("ignore:divide by zero", "ignore:invalid value")  # interpreted, of rows that are dependent
@pytest.mark.parametrize("seed", SEEDS)
def test_operational_space_of_a_coupled_robot(seed):
    """Γ_e⁻¹ = J (Gᵀ H G)⁻¹ Jᵀ with J = J_free G, and all that follows from it."""
    twin = Twin(seed)
    H_free, c_free = joint_space(twin.free_state)
    free = ospace.operational_space(twin.free_state, twin.free_points)
    J = free.jacobian @ twin.G
    response = solve(twin.G.T @ H_free @ twin.G, J.T)
    drift = free.response.T @ c_free - free.bias_acceleration
    mu = response.T @ (twin.G.T @ c_free) - drift
    for own in (
        ospace.operational_space(twin.state, twin.points),
        ospace.operational_space(twin.state, twin.points, "dense"),
        ospace.OperationalSpaceEvaluator(twin.robot, twin.points).update(twin.state.q, twin.state.v),
    ):
        close(own.jacobian, J)
        close(own.inertia_inverse, J @ response)
        close(own.response, response)
        close(own.bias_acceleration, mu, 1e-11)
        assert own.rank == np.linalg.matrix_rank(J, tol=1e-8)
        close(own.bias_force, own.inertia @ mu, 1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_free_floating_dynamics_of_a_coupled_robot(seed):
    twin = Twin(seed)
    dense, own = Dense(twin.state, twin.points), ospace.free_floating(twin.state, twin.points)
    close(own.floating_inertia_inverse, dense.Lambda_inv)
    close(own.base_inertia_inverse, dense.Lambda_b_inv)
    close(own.torque_map, dense.torque_map)
    close(own.bias_acceleration, dense.mu, 1e-11)
    free = ospace.generalized_jacobian(twin.free_state, twin.free_points)
    jacobians = ospace.generalized_jacobian(twin.state, twin.points)
    close(jacobians.generalized_jacobian, free.generalized_jacobian @ twin.G[6:, 6:])
    close(jacobians.base_generalized_jacobian, free.base_generalized_jacobian @ twin.G[6:, 6:])
    close(jacobians.momentum_velocity, free.momentum_velocity)


@pytest.mark.parametrize("seed", [0, 1])
def test_every_quantity_of_the_batch_for_a_coupled_robot(seed):
    robot = trees.coupled(seed)
    points = [robot.point("link_8"), robot.point("link_4", axes="linear")]
    states = [trees.state(robot, k) for k in range(11)]
    Q, V = (np.array([getattr(one, name) for one in states]) for name in "qv")
    names = ("inertia_inverse", "inertia", "bias_acceleration", "bias_force", "generalized_jacobian")
    names += ("generalized_inertia", "momentum")
    batch = ospace.operational_space_batch(robot, points, Q, V, quantities=names)
    evaluator = ospace.OperationalSpaceEvaluator(robot, points, names)
    assert not batch.bad.size
    for k, state in enumerate(states):
        one = evaluator.update(state.q, state.v)
        for name in names:
            close(getattr(batch, name)[k], getattr(one, name), 1e-10)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_coupled_robot_by_pinocchio_s_own_mimic_joints(seed):
    """Its rnea knows them; its crba is wrong where joints hang from a follower (Pinocchio 4.1)."""
    twin, rng = Twin(seed), np.random.default_rng(seed)
    q, v = twin.state.base_frame_state()
    model, T = twin.robot.model, np.eye(twin.robot.nv)
    data, a = model.createData(), rng.normal(size=model.nv)
    T[:3, :3] = T[3:6, 3:6] = twin.state.T_WB.rotation
    close(inverse_dynamics(twin.robot.state(q, v), T @ a), T @ pin.rnea(model, data, q, v, a), 1e-11)


def test_a_continuous_joint_leads_by_its_angle():
    """The angle of a pair (cos, sin) lies in (−π, π]."""
    free = trees.tree(3, 3, ("continuous", "continuous about any axis", "revolute"), branching=0.0)
    following = {"joint_1": trees.Following("joint_0", 2.0, 0.3), "joint_2": trees.Following("joint_0", -1.0, 0.0)}
    robot = ospace.SpaceRobot.from_model(trees.couple(free.model, following))
    assert (robot.nq, robot.nv, robot.joint_names) == (9, 7, ["joint_0"])
    for angle in (-3.0, 0.4, 2.9):
        q = robot.configuration({"joint_0": angle})
        own = robot.state(q).placement(robot.point("link_2"))
        at = free.configuration({"joint_0": angle, "joint_1": 2.0 * angle + 0.3, "joint_2": -angle})
        close(own.homogeneous, free.state(at).placement(free.point("link_2")).homogeneous)


def test_damping_and_friction_of_followers_are_felt_by_their_leader():
    free = trees.tree(5, 2, ("revolute", "prismatic"))
    free.model.damping[6:] = 1.0, 2.0
    free.model.lowerDryFrictionLimit[6:], free.model.upperDryFrictionLimit[6:] = (-0.1, -0.2), (0.1, 0.2)
    model = trees.couple(free.model, {"joint_1": trees.Following("joint_0", -0.5, 0.0)})
    assert model.damping[6:].tolist() == [1.0 + 0.25 * 2.0]
    np.testing.assert_allclose(model.upperDryFrictionLimit[6:], [0.1 + 0.5 * 0.2])
    np.testing.assert_allclose(model.lowerDryFrictionLimit[6:], [-0.1 - 0.5 * 0.2])


def test_copies_of_a_coupled_robot_keep_their_couplings():
    """Pinocchio writes mimic joints without what they couple, and dies where that is read."""
    robot = trees.coupled(2)
    copy = pickle.loads(pickle.dumps(robot))
    state = trees.state(robot, 2)
    same = copy.state(state.q, state.v)
    assert copy.joint_names == robot.joint_names
    assert copy.frame_names == robot.frame_names
    for name in ("lowerPositionLimit", "upperPositionLimit", "effortLimit", "damping", "armature"):
        np.testing.assert_array_equal(getattr(copy.model, name), getattr(robot.model, name))
    points = [one.point("link_8") for one in (robot, copy)]
    own, copied = (ospace.operational_space(at, point) for at, point in zip((state, same), points, strict=True))
    np.testing.assert_allclose(copied.inertia, own.inertia, rtol=1e-12)


@pytest.mark.parametrize("method", ["forward", "inverted"])
def test_the_chains_of_the_paper_refuse_coupled_joints(method):
    robot = trees.coupled(0)
    with pytest.raises(ospace.OspaceError, match="mimic others: use 'pv_osimr' or 'dense'"):
        ospace.operational_space(trees.state(robot, 0), robot.point("link_8"), method)


def test_names_are_those_of_leaders_alone():
    robot = trees.coupled(1)
    followers = set(robot.free.followers)
    assert not followers & set(robot.joint_names)
    assert set(robot.joint_positions(robot.neutral())) == set(robot.joint_names)
    assert len(robot.rate_names) == robot.n_joints
    with pytest.raises(ospace.OspaceError, match="no joint"):
        robot.configuration({followers.pop(): 0.1})

"""Robots from URDF against MuJoCo, an engine that shares no code with Pinocchio.

Rows are compared in the units that the kinetic energy sets, √H_ii for forces and √(Γ_e⁻¹)_ii for accelerations: metres,
radians, heavy bases and light fingers then count alike.
"""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
import pytest
from mujoco_robot import FREE_JOINT, MujocoRobot, example_robot

import ospace

# An inertia about the base loses m d²/I of a link at distance d to rounding: a factor of 2e4 at tiago_pro's fingers.
TOLERANCE = 1e-10
OWN = ("planar_2r", "chaser_7dof", "ets_vii", "chaser_24dof")
EXAMPLES = {
    "a1": "a1_description/urdf/a1.urdf",
    "kinova": "kinova_description/robots/kinova.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "baxter": "baxter_description/urdf/baxter.urdf",
    "simple_humanoid": "simple_humanoid_description/urdf/simple_humanoid.urdf",
    "talos_reduced": "talos_data/robots/talos_reduced.urdf",
    "tiago_pro": "tiago_pro_description/robots/tiago_pro.urdf",
    "g1": "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
}


@functools.cache
def load(name):
    urdf = ospace.models.path(name) if name in OWN else example_robot(EXAMPLES[name])
    return ospace.SpaceRobot.from_urdf(urdf, free_mimic=True), MujocoRobot(urdf)


def random_state(robot, rng):
    """Every joint and the base somewhere, and moving."""
    angles = dict(zip(robot.joint_names, rng.uniform(-1.5, 1.5, robot.n_joints), strict=True))
    T_WB = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3))
    return robot.state(robot.configuration(angles, T_WB), rng.normal(size=robot.nv))


def links(robot, engine):
    """The base, the link that most joints carry, and one amid the tree."""
    points = [robot.point(name) for name in robot.leaf_links]
    tip = max(points, key=lambda point: len(robot.model.supports[point.joint]))
    middle = engine.link_of(robot.joint_names[(robot.n_joints - 1) // 2])
    return [robot.point(engine.link_of(FREE_JOINT)), tip, robot.point(middle)]


@pytest.fixture(params=(*OWN, *EXAMPLES))
def pair(request):
    return load(request.param)


@pytest.fixture(params=range(3))
def case(pair, request):
    """A robot in a random state, the same in MuJoCo, three points, and a generator for the rest."""
    robot, engine = pair
    rng = np.random.default_rng(request.param)
    state = random_state(robot, rng)
    engine.take(state)
    return state, engine, links(robot, engine), rng


def inertia(state):
    terms = ospace.joint_space_dynamics(state)
    H_bm = terms.coupling_inertia
    return np.block([[terms.base_inertia, H_bm], [H_bm.T, terms.manipulator_inertia]])


def assert_agree(ours, theirs, unit):
    """Entries differ by less than the tolerance times the largest, all taken in their `unit`."""
    largest = np.abs(theirs / unit).max()
    np.testing.assert_allclose(ours / unit, theirs / unit, rtol=0.0, atol=TOLERANCE * largest)


def test_mujoco_s_robot_has_the_same_joints_and_mass(pair):
    robot, engine = pair
    assert engine.model.nv == robot.nv
    assert engine.model.body_mass.sum() == pytest.approx(robot.total_mass, rel=1e-14)
    assert all(engine.joint(name) >= 0 for name in robot.joint_names)


def test_the_joint_space_inertia_is_mujoco_s(case):
    state, engine, _, _ = case
    theirs = engine.inertia()
    unit = np.sqrt(np.diag(theirs))
    assert_agree(inertia(state), theirs, np.outer(unit, unit))


def test_the_joint_space_bias_is_mujoco_s(case):
    state, engine, _, _ = case
    terms = ospace.joint_space_dynamics(state)
    assert_agree(np.r_[terms.base_bias, terms.manipulator_bias], engine.bias(), np.sqrt(np.diag(engine.inertia())))


def test_the_jacobian_is_mujoco_s(case):
    state, engine, points, _ = case
    assert_agree(ospace.operational_space(state, points).jacobian, engine.jacobian(points), 1.0)


def test_the_operational_space_inertia_is_mujoco_s(case):
    state, engine, points, _ = case
    theirs = engine.inertia_inverse(points)
    unit = np.sqrt(np.diag(theirs))
    assert_agree(ospace.operational_space(state, points).inertia_inverse, theirs, np.outer(unit, unit))


def test_the_free_flying_acceleration_is_mujoco_s(case):
    """ẍ_e + μ = (H⁻¹ J_eᵀ)ᵀ [F_b; τ] + Γ_e⁻¹ F_e (8)."""
    state, engine, points, rng = case
    forces, F_e = random_forces(state, points, rng)
    terms = ospace.operational_space(state, points)
    ours = terms.response.T @ forces + terms.inertia_inverse @ F_e - terms.bias_acceleration
    assert_agree(ours, engine.accelerations(points, forces, F_e), np.sqrt(np.diag(terms.inertia_inverse)))


def test_the_free_floating_acceleration_is_mujoco_s(case):
    """ẍ_e + μ = J_m* H_m*⁻¹ τ + Γ_e⁻¹ F_e (12)."""
    state, engine, points, rng = case
    forces, F_e = random_forces(state, points, rng)
    forces[:6] = 0.0
    terms = ospace.free_floating(state, points)
    Gamma_inv = terms.floating_inertia_inverse + terms.base_inertia_inverse
    ours = terms.torque_map @ forces[6:] + Gamma_inv @ F_e - terms.bias_acceleration
    assert_agree(ours, engine.accelerations(points, forces, F_e), np.sqrt(np.diag(Gamma_inv)))


def random_forces(state, points, rng):
    """[F_b; τ] (nv,) and F_e (r,), as large as what they move can bear."""
    forces = rng.normal(size=state.robot.nv) * np.diag(inertia(state))
    Gamma_inv = ospace.operational_space(state, points).inertia_inverse
    return forces, rng.normal(size=len(Gamma_inv)) / np.diag(Gamma_inv)

"""The bridge to Drake: against a stand-in that keeps numbers as Drake does, and against Drake where it is installed."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.bridge import drake

JOINTS = ("joint_2", "joint_1")


class Plant:
    """Drake's numbering of planar_2r, with joints in another order, and another body's before all."""

    def __init__(self, floating=True):
        self.floating = floating

    def num_positions(self):
        return 10

    def num_velocities(self):
        return 9

    def GetBodyByName(self, name):
        if name != "base":
            raise RuntimeError(f"GetBodyByName(): There is no Body named '{name}'")
        return SimpleNamespace(
            has_quaternion_dofs=lambda: self.floating,
            floating_positions_start=lambda: 1,
            floating_velocities_start_in_v=lambda: 1,
        )

    def GetJointByName(self, name):
        if name not in JOINTS:
            raise RuntimeError(f"GetJointByName(): There is no Joint named '{name}'")
        k = JOINTS.index(name)
        return SimpleNamespace(position_start=lambda: 8 + k, velocity_start=lambda: 7 + k)


def read(name):
    return ospace.SpaceRobot.from_urdf(ospace.models.path(name))


def random_state(robot):
    rng = np.random.default_rng(0)
    angles = dict(zip(robot.joint_names, rng.uniform(-1.0, 1.0, robot.n_joints), strict=True))
    q = robot.configuration(angles, pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)))
    return robot.state(q, rng.normal(size=robot.nv))


def inertia(state):
    terms = ospace.joint_space_dynamics(state)
    return np.block(
        [[terms.base_inertia, terms.coupling_inertia], [terms.coupling_inertia.T, terms.manipulator_inertia]]
    )


def test_numbers_stand_where_drake_has_them():
    robot = read("planar_2r")
    state = random_state(robot)
    p, u = drake.Coordinates(robot, Plant()).export_state(state.q, state.v)
    x, y, z, w = state.q[3:7]
    np.testing.assert_allclose(p, np.r_[0.0, w, x, y, z, state.q[:3], state.q[8], state.q[7]], atol=1e-15)
    np.testing.assert_allclose(
        u, np.r_[0.0, state.base_twist[3:], state.base_twist[:3], state.v[7], state.v[6]], atol=1e-15
    )


def test_a_state_and_the_inertia_come_back():
    robot = read("planar_2r")
    state, coordinates = random_state(robot), drake.Coordinates(robot, Plant())
    q, v = coordinates.import_state(*coordinates.export_state(state.q, state.v))
    np.testing.assert_allclose(q, state.q, atol=1e-15)
    np.testing.assert_allclose(v, state.v, atol=1e-15)
    H = inertia(state)
    M = coordinates.export_inertia(q, H)
    assert not M[0].any()
    np.testing.assert_allclose(M[1:4, 1:4], H[3:6, 3:6])
    np.testing.assert_allclose(M[7, 7], H[7, 7])
    np.testing.assert_allclose(coordinates.import_inertia(q, M), H, atol=1e-13)


def test_what_the_plant_lacks_is_named():
    with pytest.raises(ospace.OspaceError, match="no Joint named 'joint_3'"):
        drake.Coordinates(read("ets_vii"), Plant())
    with pytest.raises(ospace.OspaceError, match="do not weld it"):
        drake.Coordinates(read("planar_2r"), Plant(floating=False))


@pytest.mark.parametrize("name", ["planar_2r", "chaser_24dof"])
def test_the_mass_matrix_is_drake_s(name):
    tree = pytest.importorskip("pydrake.multibody.plant")
    parser = pytest.importorskip("pydrake.multibody.parsing")
    robot = read(name)
    plant = tree.MultibodyPlant(0.0)
    parser.Parser(plant).AddModels(str(ospace.models.path(name)))
    plant.Finalize()
    context, state = plant.CreateDefaultContext(), random_state(robot)
    coordinates = drake.Coordinates(robot, plant)
    plant.SetPositionsAndVelocities(context, np.concatenate(coordinates.export_state(state.q, state.v)))
    H = inertia(state)
    np.testing.assert_allclose(
        coordinates.import_inertia(state.q, plant.CalcMassMatrix(context)), H, atol=1e-11 * np.abs(H).max()
    )
    hand = robot.point(robot.leaf_links[0])
    theirs = plant.EvalBodyPoseInWorld(context, plant.GetBodyByName(hand.frame)).translation()
    np.testing.assert_allclose(state.placement(hand).translation, theirs, atol=1e-12)
    twist = plant.EvalBodySpatialVelocityInWorld(context, plant.GetBodyByName(hand.frame))
    ours = ospace.operational_space(state, hand).jacobian @ np.r_[state.base_twist, state.v[6:]]
    np.testing.assert_allclose(ours, np.r_[twist.translational(), twist.rotational()], atol=1e-12)

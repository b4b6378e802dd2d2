"""The bridge to SPART: its H written out as its documentation defines it, and its velocities by finite differences."""

import numpy as np
import pinocchio as pin
import pytest
from urdf.corpus.parts import joint, link
from urdf.corpus.parts import robot as urdf

import ospace
from ospace.bridge import spart

INERTIAL = (
    '<inertial><origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/><mass value="20"/>'
    '<inertia ixx="1" iyy="2" izz="2.5" ixy="0.1" ixz="0" iyz="0"/></inertial>'
)


@pytest.fixture
def robot(tmp_path):
    """A base whose inertial frame is elsewhere and turned; two arms, the second in the alphabet first in the file."""
    text = urdf(
        f'<link name="bus">{INERTIAL}</link>',
        *(link(name) for name in ("z1", "z2", "a1")),
        joint("z_first", "revolute", "bus", "z1"),
        joint("a_first", "revolute", "bus", "a1"),
        joint("z_second", "prismatic", "z1", "z2"),
    )
    (tmp_path / "r.urdf").write_text(text)
    return ospace.SpaceRobot.from_urdf(tmp_path / "r.urdf")


@pytest.fixture
def state(robot):
    rng = np.random.default_rng(0)
    angles = dict(zip(robot.joint_names, rng.uniform(-1.0, 1.0, robot.n_joints), strict=True))
    q = robot.configuration(angles, pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)))
    return robot.state(q, rng.normal(size=robot.nv))


def test_joints_are_numbered_as_urdf2robot_numbers_them(robot):
    q = robot.configuration({"z_first": 0.1, "z_second": 0.2, "a_first": 0.3})
    assert robot.joint_names == ["a_first", "z_first", "z_second"]
    np.testing.assert_allclose(spart.Coordinates(robot).export_pose(q)[2], [0.1, 0.2, 0.3])
    given = spart.Coordinates(robot, ["a_first", "z_second", "z_first"])
    np.testing.assert_allclose(given.export_pose(q)[2], [0.3, 0.2, 0.1])


def test_the_pose_is_that_of_the_inertial_frame(robot, state):
    R0, r0, _ = spart.Coordinates(robot).export_pose(state.q)
    T_WB = pin.XYZQUATToSE3(np.array(state.q[:7]))
    np.testing.assert_allclose(r0, T_WB.act(np.array([0.1, -0.2, 0.3])), atol=1e-14)
    np.testing.assert_allclose(R0, T_WB.rotation @ pin.rpy.rpyToMatrix(0.4, -0.5, 0.6), atol=1e-14)


def test_velocities_are_the_rates_of_the_pose(robot, state):
    """ω of R0ᵀ Ṙ0 in its own axes, ṙ0 in inertial axes."""
    coordinates, h = spart.Coordinates(robot), 1e-6
    _, u = coordinates.export_state(state.q, state.v)
    R0, r0, qm = coordinates.export_pose(state.q)
    after, before = (coordinates.export_pose(pin.integrate(robot.model, state.q, s * h * state.v)) for s in (1, -1))
    np.testing.assert_allclose(pin.log3(before[0].T @ after[0]) / (2 * h), u[:3], atol=1e-8)
    np.testing.assert_allclose((after[1] - before[1]) / (2 * h), u[3:6], atol=1e-8)
    np.testing.assert_allclose((after[2] - before[2]) / (2 * h), u[6:], atol=1e-8)
    assert R0.shape == (3, 3)
    assert (len(r0), len(qm)) == (3, 3)


def test_a_state_comes_back(robot, state):
    coordinates = spart.Coordinates(robot)
    q, v = coordinates.import_state(*coordinates.export_state(state.q, state.v))
    assert np.abs(q - state.q).max() < 1e-14 or np.abs(q[3:7] + state.q[3:7]).max() < 1e-14
    np.testing.assert_allclose(v, state.v, atol=1e-14)
    np.testing.assert_allclose(coordinates.import_pose(*coordinates.export_pose(q)), q, atol=1e-14)


def test_the_map_is_of_the_velocities(robot, state):
    coordinates = spart.Coordinates(robot)
    _, u = coordinates.export_state(state.q, state.v)
    np.testing.assert_allclose(coordinates.velocity_map(state.q) @ u, np.r_[state.base_twist, state.v[6:]], atol=1e-14)


def test_the_inertia_is_that_of_spart(robot, state):
    """H0 of a base by itself is diag(I0 in its own axes, m 1); with the arms uᵀ H u is twice the kinetic energy."""
    coordinates = spart.Coordinates(robot)
    terms = ospace.joint_space_dynamics(state)
    H = np.block([[terms.base_inertia, terms.coupling_inertia], [terms.coupling_inertia.T, terms.manipulator_inertia]])
    M = coordinates.export_inertia(state.q, H)
    _, u = coordinates.export_state(state.q, state.v)
    twice = 2.0 * pin.computeKineticEnergy(robot.model, robot.model.createData(), np.array(state.q), np.array(state.v))
    assert u @ M @ u == pytest.approx(twice, rel=1e-12)
    np.testing.assert_allclose(M[3:6, 3:6], robot.total_mass * np.eye(3), atol=1e-12)
    np.testing.assert_allclose(coordinates.import_inertia(state.q, M), H, atol=1e-12)


def test_what_does_not_fit_is_refused(robot):
    with pytest.raises(ospace.OspaceError, match="once each"):
        spart.Coordinates(robot, ["z_first"])
    with pytest.raises(ospace.OspaceError, match="no rotation"):
        spart.Coordinates(robot).import_pose(np.diag([1.0, 1.0, -1.0]), np.zeros(3), np.zeros(3))
    with pytest.raises(ospace.OspaceError, match="no URDF"):
        spart.Coordinates(ospace.SpaceRobot.from_model(robot.model))

"""States between the records of a motion, for a page to draw it without a visible error."""

import numpy as np
import pinocchio as pin
import pytest

from ospace import SpaceRobot, models
from ospace.simulation.zero_momentum import FloatingMotion
from ospace.visual import resample


@pytest.fixture(scope="module")
def robot():
    return SpaceRobot.from_urdf(models.path("planar_2r"))


def swinging(robot, time):
    """Return a motion of all degrees of freedom, by formulas."""
    n = robot.n_joints
    pace = np.linspace(1.0, 2.0, n)
    q = np.array(
        [
            robot.configuration(T_WB=pin.SE3(pin.exp3(np.array([0.0, 0.3, 0.5]) * t), np.array([t, t**2, 0.0])))
            for t in time
        ]
    )
    q[:, 7:] = np.sin(time[:, None] * pace)
    v = np.zeros((len(time), robot.nv))
    v[:, 3:6] = [0.0, 0.3, 0.5]
    for k, t in enumerate(time):
        v[k, :3] = pin.XYZQUATToSE3(q[k, :7]).rotation.T @ [1.0, 2.0 * t, 0.0]
    v[:, 6:] = np.cos(time[:, None] * pace) * pace
    return FloatingMotion(time, q, v)


def poses_of(robot):
    data = robot.model.createData()

    def poses(q):
        pin.forwardKinematics(robot.model, data, q)
        return np.array([pin.SE3ToXYZQUAT(data.oMi[j]) for j in range(1, robot.model.njoints)])

    return poses


def test_records_far_apart_are_joined_by_their_velocities(robot):
    """To the fourth power of their distance."""
    worst = []
    for records in (26, 51):
        motion = swinging(robot, np.linspace(0.0, 2.0, records))
        time, places, error = resample.resample_poses(
            robot.model, motion.time, motion.q, motion.v, poses_of(robot), 1e-6
        )
        assert error == 1e-6
        assert len(time) == len(places) > 10 * records
        assert set(motion.time) <= set(time)
        true = swinging(robot, time)
        wanted = np.array([poses_of(robot)(q) for q in true.q])
        same = np.sign(np.sum(wanted[..., 3:] * places[..., 3:], axis=-1, keepdims=True))
        wanted[..., 3:] *= same
        worst.append(np.abs(places - wanted).max())
    assert worst[0] < 1e-5
    assert worst[0] / worst[1] == pytest.approx(16.0, rel=0.5)


def test_close_records_stay_as_they_are(robot):
    motion = swinging(robot, np.linspace(0.0, 0.05, 101))
    time, places, _ = resample.resample_poses(robot.model, motion.time, motion.q, motion.v, poses_of(robot), 1e-6)
    np.testing.assert_array_equal(time, motion.time)
    assert len(places) == len(motion.q)


def test_records_without_velocities_are_joined_by_the_geodesic(robot):
    q = np.array([robot.configuration({"joint_1": angle}) for angle in (0.0, 0.4, 0.6)])
    time, places, _ = resample.resample_poses(
        robot.model, np.array([0.0, 0.2, 0.4]), q, np.zeros((3, robot.nv)), poses_of(robot), 1e-6
    )
    k = len(time) // 3
    assert 0.0 < time[k] < 0.2
    wanted = poses_of(robot)(pin.interpolate(robot.model, q[0], q[1], time[k] / 0.2))
    np.testing.assert_allclose(places[k], wanted, rtol=0, atol=1e-12)


def test_too_many_states_cost_precision(robot, monkeypatch):
    monkeypatch.setattr(resample, "_MOST", 500)
    motion = swinging(robot, np.linspace(0.0, 2.0, 51))
    time, _, error = resample.resample_poses(robot.model, motion.time, motion.q, motion.v, poses_of(robot), 1e-6)
    assert len(time) <= 501
    assert error > 1e-6

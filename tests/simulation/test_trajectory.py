"""Trajectories: their files, states between records, and joints outside their limits."""

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

from ospace import OspaceError, SpaceRobot
from ospace.simulation import Trajectory, simulate

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture(scope="module")
def robot():
    return trees.tree(9, 8)


@pytest.fixture(scope="module")
def start(robot):
    state = trees.state(robot, 9)
    return state.q, 0.3 * state.v


def run(robot, state, controller=None, **options):
    return simulate(robot, *state, controller, **{"duration": 0.05, **options})


def test_a_trajectory_is_saved_and_loaded(robot, start, tmp_path):
    result = run(robot, start, lambda *_: np.ones(robot.n_joints))
    loaded = Trajectory.load(result.save(tmp_path / "run"))
    assert np.array_equal(loaded.q, result.q)
    assert loaded.robot_name == robot.name
    assert loaded.interrupted is False
    assert str(loaded.certificate()) == str(result.certificate())
    files = result.to_csv(tmp_path / "csv")
    table = np.loadtxt(next(file for file in files if file.name == "q.csv"), delimiter=",", skiprows=1)
    assert np.array_equal(table, np.c_[result.time, result.q])
    (tmp_path / "other.npz").write_bytes(b"no archive")
    (tmp_path / "cut.npz").write_bytes((tmp_path / "run.npz").read_bytes()[:-100])
    for name in ("other.npz", "cut.npz", "missing.npz"):
        with pytest.raises(OspaceError, match="no trajectory can be read"):
            Trajectory.load(tmp_path / name)
    np.savez(tmp_path / "else.npz", q=np.zeros(3))
    with pytest.raises(OspaceError, match="holds no trajectory"):
        Trajectory.load(tmp_path / "else.npz")


def test_a_state_between_records_is_interpolated(robot, start):
    result = run(robot, start)
    for k in (0, 7, 50):
        assert np.array_equal(result.at(robot, result.time[k])[0], result.q[k])
    coarse = run(robot, start, log_every=2)
    q, v = coarse.at(robot, 0.011)
    assert np.abs(pin.difference(robot.model, q, result.q[11])).max() < 1e-4
    assert np.abs(v - result.v[11]).max() < 1e-3
    with pytest.raises(OspaceError, match=r"reaches from 0\.0 s to 0\.05 s"):
        result.at(robot, 0.1)
    with pytest.raises(OspaceError, match="not of"):
        result.at(trees.tree(1, 2), 0.0)


def test_state_between_records_of_a_base_in_orbit(robot, start):
    """The same but for the orbit: a base that turns as it flies by does not go along a screw of kilometres."""
    q, v = start
    place, fast = np.array([7e6, -3e6, 1e6]), np.array([0.0, 7.5e3, 0.0])
    far, moving = q.copy(), v.copy()
    far[:3] += place
    moving[:3] += pin.Quaternion(q[3:7]).matrix().T @ fast
    here, there = (run(robot, state, log_every=10) for state in ((q, v), (far, moving)))
    for time in (0.003, 0.0171, 0.048):
        seen = there.at(robot, time)[0]
        seen[:3] -= place + time * fast
        assert np.abs(pin.difference(robot.model, seen, here.at(robot, time)[0])).max() < 1e-8


def test_joints_beyond_their_limits_are_told_with_amount_and_time(tmp_path):
    robot = SpaceRobot.from_urdf(MODELS / "planar_2r.urdf")
    upper = robot.model.upperPositionLimit[7:]
    q, v = robot.configuration({"joint_1": upper[0] - 0.05, "joint_2": upper[1] + 0.2}), np.zeros(8)
    v[6] = 1.0
    run = simulate(robot, q, v, duration=0.1)
    assert set(run.outside_limits) == {"joint_1", "joint_2"}
    for joint, column in (("joint_1", 7), ("joint_2", 8)):
        excess = run.outside_limits[joint]
        assert excess.amount == pytest.approx((run.q[:, column] - upper[column - 7]).max(), rel=1e-12)
        assert excess.time == run.time[np.argmax(run.q[:, column])]
        assert excess.unit == "rad"
        assert f"'{joint}' by {excess.amount:.3g} rad ({np.degrees(excess.amount):.3g} deg) at" in str(run)
    assert robot.outside_limits(run.q[-1]).keys() == run.outside_limits.keys()
    file = run.save(tmp_path / "run")
    assert Trajectory.load(file).outside_limits == run.outside_limits
    inside = simulate(robot, robot.neutral(), np.zeros(8), duration=0.01)
    assert inside.outside_limits == {}
    assert str(inside).endswith("outside limits of joints: none")

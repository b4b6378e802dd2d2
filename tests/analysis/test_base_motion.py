"""The base along a path of the joints: published turns, momentum, and simulation."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import analysis

CIRCLE_TURN = -2.628303218
"""deg, by Stokes' theorem, of joints on a circle of 0.5 rad about (0.6, 1.0)."""


@pytest.fixture(scope="module")
def planar():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))


def attitude(pose):
    return pin.XYZQUATToSE3(pose).rotation


def turn_about_z(poses):
    return math.degrees(pin.log3(attitude(poses[0]).T @ attitude(poses[-1]))[2])


def circle(rows):
    at = np.linspace(0.0, 2.0 * np.pi, rows)
    return np.column_stack([0.6 + 0.5 * np.cos(at), 1.0 + 0.5 * np.sin(at)])


def test_the_published_turn_of_a_base_while_one_joint_turns(planar):
    """Papadopoulos and Dubowsky's arm: joint 1 from 0 to 90 deg."""
    poses = analysis.base_motion(planar, [[0.0, 0.0], [np.pi / 2, 0.0]])
    assert turn_about_z(poses) == pytest.approx(-43.28500849, abs=1e-8)
    assert analysis.base_turn(poses) == pytest.approx(math.radians(43.28500849), abs=1e-10)


def test_a_closed_loop_of_the_joints_turns_the_base(planar):
    assert turn_about_z(analysis.base_motion(planar, circle(401))) == pytest.approx(CIRCLE_TURN, abs=3e-9)
    assert turn_about_z(analysis.base_motion(planar, circle(401)[::-1])) == pytest.approx(-CIRCLE_TURN, abs=3e-9)


def test_a_path_of_few_corners_is_a_polygon(planar):
    """Rows between the corners of a square, or none, are the same path."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]])
    along = np.linspace(0.0, 1.0, 11)[:-1, None]
    fine = np.vstack([*(a + along * (b - a) for a, b in itertools.pairwise(corners)), corners[-1:]])
    once, often = (turn_about_z(analysis.base_motion(planar, path)) for path in (corners, fine))
    assert once == pytest.approx(often, abs=1e-8)


@pytest.mark.parametrize("seed", range(3))
def test_momentum_along_a_path_is_the_given_one(seed):
    """By differences of the poses: of all joint types, some of which follow others."""
    robot = trees.coupled(seed) if seed else trees.tree(seed, 6)
    start, way = trees.state(robot, seed), np.random.default_rng(seed).normal(size=robot.n_joints)
    times = np.linspace(0.0, 0.4, 41)
    path = [pin.integrate(robot.model, start.q, np.r_[np.zeros(6), time * way])[7:] for time in times]
    given = np.array([3.0, -1.0, 2.0, 0.5, 1.0, -0.7])
    poses = analysis.base_motion(robot, path, given, time=times, T_WB=start.T_WB)
    Q = np.column_stack([poses, path])
    for k in (1, 20, 39):
        v = pin.difference(robot.model, Q[k - 1], Q[k + 1]) / (times[k + 1] - times[k - 1])
        state = robot.state(Q[k], v)
        M_0 = ospace.momentum(state)
        c = (robot.free or robot).model
        data = c.createData()
        q = Q[k] if robot.free is None else robot.free.configuration(Q[k])
        centre = pin.centerOfMass(c, data, q) - Q[k, :3]
        np.testing.assert_allclose(M_0[:3], given[:3], atol=2e-2)
        np.testing.assert_allclose(M_0[3:] - np.cross(centre, M_0[:3]), given[3:], atol=2e-2)


def test_a_base_with_momentum_moves_as_in_simulation():
    """A body of three different moments tumbles."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("target"))
    start = robot.state(robot.neutral(), [0.3, 0.0, -0.2, 0.4, 0.2, -0.5])
    run = ospace.simulate(robot, start.q, start.v, duration=2.0, tolerance=1e-12)
    M_0 = ospace.momentum(start)
    centre = pin.centerOfMass(robot.model, robot.model.createData(), start.q)
    kept = np.r_[M_0[:3], M_0[3:] - np.cross(centre, M_0[:3])]
    poses = analysis.base_motion(robot, np.zeros((21, robot.nq - 7)), kept, time=np.linspace(0.0, 2.0, 21))
    np.testing.assert_allclose(poses[-1, :3], run.q[-1, :3], atol=1e-8)
    np.testing.assert_allclose(np.abs(poses[-1, 3:] @ run.q[-1, 3:7]), 1.0, atol=1e-12)


def test_the_mass_centre_rests_where_there_is_no_momentum(planar):
    poses, data = analysis.base_motion(planar, circle(31)), planar.model.createData()
    centres = [
        pin.centerOfMass(planar.model, data, np.r_[pose, row]).copy()
        for pose, row in zip(poses, circle(31), strict=True)
    ]
    np.testing.assert_allclose(centres, np.tile(centres[0], (31, 1)), atol=1e-14)


@pytest.mark.parametrize(
    ("path", "options", "message"),
    [
        ([[0.0]], {}, "path has shape"),
        ([], {}, "path has shape"),
        ([[0.0, np.nan]], {}, "path"),
        ([[0.0, 0.0], [1.0, 0.0]], {"momentum": [1.0]}, "momentum has shape"),
        ([[0.0, 0.0], [1.0, 0.0]], {"time": [1.0, 1.0]}, "do not rise"),
        ([[0.0, 0.0], [1.0, 0.0]], {"time": [1.0]}, "time has shape"),
    ],
)
def test_a_path_that_makes_no_sense_is_refused(planar, path, options, message):
    with pytest.raises(ospace.OspaceError, match=message):
        analysis.base_motion(planar, path, **options)


def test_a_path_of_one_row_is_a_pose(planar):
    T_WB = pin.SE3(pin.exp3(np.array([0.1, 0.2, 0.3])), np.array([1.0, 2.0, 3.0]))
    poses = analysis.base_motion(planar, [[0.2, 0.4]], T_WB=T_WB)
    np.testing.assert_allclose(poses, [pin.SE3ToXYZQUAT(T_WB)], atol=1e-15)

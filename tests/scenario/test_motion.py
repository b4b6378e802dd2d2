"""What tasks follow: it starts with the point's motion, ends with the goal's, and its rates are its own derivatives."""

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.scenario import Approach, FreeMotion
from ospace.scenario.motion import still
from ospace.simulation import rigid_body, tumbling

PERIOD, DURATION = 1e-3, 2.0
SPIN = np.array([0.3, -0.4, 0.5])


@pytest.fixture(scope="module")
def target():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("target"))


def free(target, spin=SPIN, **options):
    return FreeMotion(
        target, tumbling(target, pin.SE3(pin.exp3(SPIN), np.array([1.0, 2.0, 3.0])), spin, SPIN), **options
    )


@pytest.fixture(scope="module")
def begun():
    return pin.SE3(pin.exp3(np.array([-0.5, 0.2, 0.9])), np.array([0.5, 0.1, -0.4])), np.array(
        [0.1, 0.2, -0.3, 0.2, -0.1, 0.4]
    )


@pytest.fixture(scope="module")
def goal(target):
    point = target.point("grapple", offset=pin.SE3(pin.exp3(SPIN), np.array([0.1, 0.2, 0.3])))
    return free(target).frame(point)


@pytest.fixture(scope="module")
def way(begun, goal):
    return Approach(*begun, goal, duration=DURATION)


def rates(motion, cycle):
    """Central differences of the poses, and of the velocities."""
    (before, v_0, _), (after, v_1, _) = motion((cycle - 1) * PERIOD), motion((cycle + 1) * PERIOD)
    turn = pin.log3(after.rotation @ before.rotation.T)
    return np.concatenate([after.translation - before.translation, turn]) / (2 * PERIOD), (v_1 - v_0) / (2 * PERIOD)


@pytest.mark.parametrize("cycle", [1, 2, 500, 1000, 1500, 1998, 2500])
def test_velocities_and_accelerations_are_derivatives(way, cycle):
    _, velocity, acceleration = way(cycle * PERIOD)
    first, second = rates(way, cycle)
    np.testing.assert_allclose(velocity, first, rtol=0, atol=2e-5)
    np.testing.assert_allclose(acceleration, second, rtol=0, atol=2e-4)


def test_an_approach_starts_with_the_point(way, begun):
    pose, velocity, _ = way(0.0)
    assert pose.isApprox(begun[0], 1e-14)
    np.testing.assert_allclose(velocity, begun[1], rtol=0, atol=1e-14)


def test_an_approach_ends_with_the_goal_in_place_and_velocity_and_acceleration(begun, goal):
    """Just before the end, by the blend, as just after, by the goal itself."""
    way = Approach(*begun, goal, duration=DURATION + 1e-9)
    pose, velocity, acceleration = way(DURATION)
    at = goal(2000, 2001)
    np.testing.assert_allclose(pose.translation, at.place[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(pose.rotation, at.rotation[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(velocity, at.velocity[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(acceleration, at.acceleration[0], rtol=0, atol=1e-7)


@pytest.mark.parametrize("cycle", [1, 700])
def test_the_goal_s_rates_are_derivatives(goal, cycle):
    def motion(time):
        k = round(time / PERIOD)
        at = goal(k, k + 1)
        return pin.SE3(at.rotation[0], at.place[0]), at.velocity[0], at.acceleration[0]

    first, second = rates(motion, cycle)
    _, velocity, acceleration = motion(cycle * PERIOD)
    np.testing.assert_allclose(velocity, first, rtol=0, atol=1e-6)
    np.testing.assert_allclose(acceleration, second, rtol=0, atol=1e-6)


def test_the_target_moves_by_itself_as_if_simulated_at_once(target):
    start = tumbling(target, pin.SE3.Identity(), SPIN, SPIN)
    run = ospace.simulate(target, start.q, start.v, duration=2.5)
    motion = FreeMotion(target, start)
    state = motion.state(2500)
    np.testing.assert_allclose(state.q, run.q[-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(state.v, run.v[-1], rtol=0, atol=1e-12)
    assert all(certificate.passed for certificate in motion.certificates)


def test_a_goal_that_stays_is_reached_at_rest(begun):
    goal = pin.SE3(pin.exp3(SPIN), SPIN)
    way = Approach(*begun, still(goal), duration=DURATION)
    pose, velocity, acceleration = way(3.0)
    assert pose.isApprox(goal, 1e-14)
    assert not np.any(velocity)
    assert not np.any(acceleration)


def test_half_a_turn_and_more_of_the_goal_is_followed(target, begun):
    """A target that turns by 1000 deg in the meantime, about an axis that moves: no jump, derivatives, and the end."""
    spin = np.radians([60.0, -90.0, 130.0])
    start = tumbling(target, pin.SE3(begun[0].rotation, np.ones(3)), spin, SPIN)
    goal = FreeMotion(target, start).frame(target.point("grapple"))
    way = Approach(*begun, goal, duration=6.0 + 1e-9)
    for cycle in (1, 700, 1500, 2300, 3100, 3900, 4700, 5500, 5999):
        _, velocity, acceleration = way(cycle * PERIOD)
        first, second = rates(way, cycle)
        np.testing.assert_allclose(velocity, first, rtol=0, atol=1e-4)
        np.testing.assert_allclose(acceleration, second, rtol=0, atol=1e-4)
    speeds = [np.linalg.norm(way(k * PERIOD)[1][3:]) for k in range(6000)]
    assert max(speeds) < 3.0 * np.linalg.norm(spin)
    pose, velocity, acceleration = way(6.0)
    at = goal(6000, 6001)
    np.testing.assert_allclose(pose.rotation, at.rotation[0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(velocity, at.velocity[0], rtol=0, atol=1e-11)
    np.testing.assert_allclose(acceleration, at.acceleration[0], rtol=0, atol=1e-6)


def test_an_approach_starts_with_a_point_that_turns_while_the_goal_does(target, begun):
    way = Approach(*begun, free(target).frame(target.point("grapple")), duration=40.0)
    pose, velocity, _ = way(0.0)
    assert pose.isApprox(begun[0], 1e-14)
    np.testing.assert_allclose(velocity, begun[1], rtol=0, atol=1e-14)


@pytest.mark.parametrize("seconds", [10.0, 36.0, 40.0, 90.0, 400.0])
def test_the_point_turns_with_the_goal_any_number_of_turns(seconds):
    """A target that turns by 5 deg/s: the point makes its turns, less what it is ahead by at the start."""
    period = 0.01
    body = rigid_body(50.0, (3.0, 4.0, 5.0))
    goal = FreeMotion(body, tumbling(body, pin.SE3.Identity(), np.radians([0.0, 0.0, 5.0])), period=period).frame(
        body.point("target")
    )
    origin = pin.SE3(pin.exp3(np.array([0.0, 0.0, 0.4])), np.zeros(3))
    way = Approach(origin, np.zeros(6), goal, duration=seconds, period=period)
    n = round(seconds / period)
    turned = [0.5 * period * (way(k * period)[1][5] + way((k + 1) * period)[1][5]) for k in range(n)]
    assert sum(turned) == pytest.approx(np.radians(5.0) * seconds - 0.4, abs=1e-4)
    assert max(abs(v) for v in turned) < np.radians(5.0) * period * 2.0 + np.pi / n
    end = pin.exp3(np.array([0.0, 0.0, np.radians(5.0 * seconds)]))
    np.testing.assert_allclose(way(seconds)[0].rotation, end, rtol=0, atol=1e-9)


def test_half_a_turn_is_one_turn_about_one_axis():
    upside_down = pin.SE3(pin.exp3(np.array([np.pi, 0.0, 0.0])), np.zeros(3))
    way = Approach(pin.SE3.Identity(), np.zeros(6), still(upside_down), duration=1.0)
    axes = np.array([way(k * PERIOD)[1][3:] for k in range(1, 1000)])
    assert np.sum(np.linalg.norm(axes, axis=1)) * PERIOD == pytest.approx(np.pi, abs=1e-6)
    np.testing.assert_allclose(axes[:, 1:], 0.0, atol=1e-12)
    assert way(1.0)[0].isApprox(upside_down, 1e-12)


@pytest.mark.parametrize("turns", [-2.25, 0.6, 1.0, 3.5])
def test_a_given_turn_is_made_in_full(turns):
    axis = np.array([0.0, 0.6, 0.8])
    turn = 2.0 * np.pi * turns * axis
    origin = pin.SE3(pin.exp3(np.array([0.3, 0.2, 0.1])), np.zeros(3))
    goal = pin.SE3(pin.exp3(turn) @ origin.rotation, np.zeros(3))
    way = Approach(origin, np.zeros(6), still(goal), duration=1.0, turn=turn)
    made = sum(way(k * PERIOD)[1][3:] @ axis for k in range(1001)) * PERIOD
    assert made == pytest.approx(2.0 * np.pi * turns, abs=1e-6)
    assert way(1.0)[0].isApprox(goal, 1e-12)


def test_a_goal_of_a_target_with_friction_accelerates_as_the_target_does():
    model = pin.Model(trees.tree(4, 3, ("revolute",)).model)
    model.damping = np.r_[np.zeros(6), [1.0, 2.0, 3.0]]
    robot = ospace.SpaceRobot.from_model(model)
    start = trees.state(robot, 4)
    period = 1e-4
    goal = FreeMotion(robot, start, period=period).frame(robot.point("link_2"))
    before, at, after = (goal(k, k + 1) for k in (99, 100, 101))
    change = (after.velocity - before.velocity) / (2 * period)
    np.testing.assert_allclose(at.acceleration, change, rtol=0, atol=1e-5)

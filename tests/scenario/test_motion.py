"""What tasks follow: it starts with the point's motion, ends with the goal's, and its rates are its own derivatives."""

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.scenario import Approach, FreeMotion
from ospace.scenario.motion import still
from ospace.simulation import tumbling

PERIOD, DURATION = 1e-3, 2.0
SPIN = np.array([0.3, -0.4, 0.5])


@pytest.fixture(scope="module")
def target():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("target"))


def free(target, spin=SPIN, **options):
    return FreeMotion(tumbling(target, pin.SE3(pin.exp3(SPIN), np.array([1.0, 2.0, 3.0])), spin, SPIN), **options)


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


def test_it_starts_with_the_point(way, begun):
    pose, velocity, _ = way(0.0)
    assert pose.isApprox(begun[0], 1e-14)
    np.testing.assert_allclose(velocity, begun[1], rtol=0, atol=1e-14)


def test_it_ends_with_the_goal_in_place_and_velocity_and_acceleration(begun, goal):
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
    motion = FreeMotion(start)
    state = motion.state(2500)
    np.testing.assert_allclose(state.q, run.q[-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(state.v, run.v[-1], rtol=0, atol=1e-12)
    assert all(certificate.passed for certificate in motion.certificates)


def test_a_goal_that_stays(begun):
    goal = pin.SE3(pin.exp3(SPIN), SPIN)
    way = Approach(*begun, still(goal), duration=DURATION)
    pose, velocity, acceleration = way(3.0)
    assert pose.isApprox(goal, 1e-14)
    assert not np.any(velocity)
    assert not np.any(acceleration)


def test_half_a_turn_is_refused():
    upside_down = pin.SE3(pin.exp3(np.array([np.pi, 0.0, 0.0])), np.zeros(3))
    way = Approach(pin.SE3.Identity(), np.zeros(6), still(upside_down), duration=1.0, name="hand")
    with pytest.raises(ospace.OspaceError, match="task 'hand' is to turn by more than 175 deg"):
        way(0.0)

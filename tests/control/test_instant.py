"""What tasks in Python see of a state: against Pinocchio of the same state, on trees of all joint types."""

import numpy as np
import pinocchio as pin
import pytest
import trees

from ospace.control import Instant
from ospace.exceptions import OspaceError

SEEDS = range(4)


def robot_of(seed, kind):
    return trees.tree(seed, 9) if kind == "free" else trees.coupled(seed)


@pytest.fixture(params=[(seed, kind) for seed in SEEDS for kind in ("free", "coupled")], ids=str)
def case(request):
    seed, kind = request.param
    robot = robot_of(seed, kind)
    state = trees.state(robot, seed)
    offset = pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([0.1, 0.2, -0.1]))
    points = [robot.point(robot.leaf_links[-1], offset=offset), robot.point("base"), robot.point("link_3")]
    at = Instant(robot, points)
    at.observe(1.5, state.q.copy(), state.v.copy())
    return robot, state, points, at


def test_places_and_velocities_are_those_of_the_state(case):
    _, state, points, at = case
    assert at.time == 1.5
    np.testing.assert_allclose(at.q, state.q, atol=1e-15)
    np.testing.assert_array_equal(at.v, state.v)
    for point in points:
        T = state.placement(point)
        np.testing.assert_allclose(at.position(point), T.translation, atol=1e-12)
        np.testing.assert_allclose(at.rotation(point), T.rotation, atol=1e-12)
        np.testing.assert_allclose(at.jacobian(point) @ state.v, at.velocity(point), atol=1e-12)


def test_jacobian_and_drift_are_derivatives_along_the_motion(case):
    robot, state, points, at = case
    h, rng = 1e-5, np.random.default_rng(0)
    u = rng.normal(size=robot.nv)

    def moved(by, v):
        q = pin.integrate(robot.model, state.q, by)
        there = Instant(robot, points)
        there.observe(0.0, q, v)
        return there

    ahead, behind = moved(h * u, state.v), moved(-h * u, state.v)
    for point in points:
        rate = (ahead.position(point) - behind.position(point)) / (2.0 * h)
        turn = pin.log3(ahead.rotation(point) @ behind.rotation(point).T) / (2.0 * h)
        np.testing.assert_allclose(at.jacobian(point) @ u, np.r_[rate, turn], atol=1e-7)
    ahead, behind = moved(h * state.v, state.v), moved(-h * state.v, state.v)
    for point in points:
        drift = (ahead.velocity(point) - behind.velocity(point)) / (2.0 * h)
        np.testing.assert_allclose(at.drift(point), drift, atol=2e-6 * (1.0 + np.abs(drift).max()))


def test_later_is_later_by_a_step_and_follows_the_state(case):
    robot, state, points, at = case
    for q, v in ((state.q, state.v), (robot.neutral(), 0.5 * state.v)):
        at.observe(2.0, q.copy(), v.copy())
        later, step = at.later()
        assert later.time == 2.0 + step
        for point in points:
            rate = (later.velocity(point) - at.velocity(point)) / step
            np.testing.assert_allclose(rate, at.drift(point), atol=1e-5 * (1.0 + np.abs(at.drift(point)).max()))


def test_arrays_are_read_only_and_other_points_are_refused(case):
    robot, _, points, at = case
    for array in (at.q, at.v, at.position(points[0]), at.jacobian(points[0])):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(OspaceError, match=r"'link_3' is none of those .* keep the point that robot.point"):
        at.position(robot.point("link_3"))


def test_far_from_the_origin_the_drift_by_differences_still_holds():
    robot = trees.tree(1, 6)
    state = trees.state(robot, 1)
    point, far = robot.point(robot.leaf_links[-1]), state.q.copy()
    far[:3] += 7e6
    at = Instant(robot, [point])
    at.observe(0.0, far, state.v.copy())
    later, step = at.later()
    by_differences = (later.velocity(point) - at.velocity(point)) / step
    np.testing.assert_allclose(by_differences, at.drift(point), atol=1e-3 * (1.0 + np.abs(at.drift(point)).max()))

"""The clamp of joint accelerations: what it allows keeps every limit, and is the most that does."""

from types import SimpleNamespace

import numpy as np
import pytest

from ospace.kernels.qp.joint_limits import ceiling, clamp_joints
from ospace.kernels.qp.tables import ACCELERATION, POSITION, UNLIMITED, VELOCITY
from ospace.kernels.tree import CONTINUOUS, REVOLUTE

PERIOD = 1e-2


def clamp(angle, rate, **settings):
    """Bounds on φ̈ of one joint, lower and upper, and which limits they come of."""
    return clamp_and_measure(angle, rate, **settings)[:4]


def clamp_and_measure(
    angle,
    rate,
    *,
    position=(-1.0, 1.0),
    velocity=0.5,
    acceleration=2.0,
    torque=(-3.0, 3.0),
    inertia=1.0,
    kind=REVOLUTE,
    braking=0.8,
    horizon=PERIOD,
):
    """Likewise; and by how much the joint is outside its position limits, by itself and as the largest of all."""
    joints = SimpleNamespace(kind=np.array([0, kind]), first=np.array([0, 7]), link_of=np.array([1]))
    w = SimpleNamespace(
        q=np.r_[np.zeros(7), angle][:, None], velocity=np.r_[np.zeros(6), rate][:, None],
        generalized_inertia=np.array([[inertia]]),
    )  # fmt: skip
    limits = SimpleNamespace(
        torque=np.array(torque)[:, None], position=np.array(position)[:, None], velocity=np.array([velocity]),
        acceleration=np.array([acceleration]), reaction=PERIOD, horizon=horizon, braking=braking,
    )  # fmt: skip
    program = SimpleNamespace(lower=np.zeros(1), upper=np.zeros(1), cause=np.zeros((2, 1), dtype=np.int64))
    outside = np.full(1, np.nan)
    farthest = clamp_joints(joints, w, limits, program, outside)
    return program.lower[0], program.upper[0], program.cause[0, 0], program.cause[1, 0], outside[0], farthest


# -- ceiling ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("d", [1e-9, 1e-4, 0.3, 20.0])
@pytest.mark.parametrize("a", [0.1, 5.0])
def test_from_the_ceiling_a_stop_within_the_distance_is_just_possible(d, a):
    """ceiling(d) = √((a h)² + 2 a d) − a h: with the way of one more period, h v, v²/(2 a) + h v = d."""
    speed = ceiling(d, a, PERIOD)
    assert speed > 0.0
    assert speed**2 / (2.0 * a) + PERIOD * speed == pytest.approx(d, rel=1e-12)
    assert ceiling(-d, a, PERIOD) == -speed


def test_at_the_limit_itself_no_speed_is_left():
    assert ceiling(0.0, 2.0, PERIOD) == 0.0
    assert ceiling(0.0, 0.0, PERIOD) == 0.0


# -- bounds ----------------------------------------------------------------------------------------------------


def test_far_from_all_limits_acceleration_bounds():
    assert clamp(0.0, 0.0) == (-2.0, 2.0, ACCELERATION, ACCELERATION)


def test_a_joint_keeps_its_velocity_limit():
    """Within one period the rate reaches the limit and no more; from beyond it, it comes back."""
    low, high, of_low, of_high = clamp(0.0, 0.495)
    assert (low, of_low) == (-2.0, ACCELERATION)
    assert 0.495 + PERIOD * high == pytest.approx(0.5, rel=1e-14)
    assert of_high == VELOCITY
    low, high, of_low, of_high = clamp(0.0, -0.495)
    assert (high, of_high) == (2.0, ACCELERATION)
    assert -0.495 + PERIOD * low == pytest.approx(-0.5, rel=1e-14)
    assert of_low == VELOCITY
    assert clamp(0.0, 0.505)[1] == pytest.approx((0.5 - 0.505) / PERIOD)
    assert clamp(0.0, -0.505)[0] == pytest.approx((-0.5 + 0.505) / PERIOD)


def decelerating(braking=0.8, torque=(-3.0, 3.0), inertia=1.0, acceleration=2.0):
    return min(acceleration, braking * min(torque[1], -torque[0]) / inertia)


@pytest.mark.parametrize("rate", [0.0, 0.19, 0.195, 0.2, 0.205])
def test_a_joint_stops_at_its_position_limit(rate):
    """The highest rate at the end of the period is the ceiling of the way that is left, both ways round."""
    way, a = 0.013, decelerating()
    expected = (ceiling(way - 0.5 * PERIOD * rate, a, PERIOD) - rate) / PERIOD
    _, high, _, of_high = clamp(1.0 - way, rate)
    low, _, of_low, _ = clamp(-1.0 + way, -rate)
    if rate == 0.0:
        assert (low, high, of_low, of_high) == (-2.0, 2.0, ACCELERATION, ACCELERATION)
    else:
        assert abs(expected) < a
        assert (-low, high) == (pytest.approx(expected, rel=1e-10), pytest.approx(expected, rel=1e-10))
        assert (of_low, of_high) == (POSITION, POSITION)


def test_deceleration_is_what_the_weaker_torque_limit_leaves():
    for torque in ((-1.0, 3.0), (-3.0, 1.0)):
        a = decelerating(torque=torque, inertia=4.0)
        assert a == 0.8 * 1.0 / 4.0
        rate = 0.05
        for side in (1.0, -1.0):
            bounds = clamp(side * 0.993, side * rate, torque=torque, inertia=4.0)
            expected = (ceiling(0.007 - 0.5 * PERIOD * rate, a, PERIOD) - rate) / PERIOD
            expected = max(expected, -a)
            assert bounds[1 if side > 0.0 else 0] == pytest.approx(side * expected, rel=1e-12)


@pytest.mark.parametrize("horizon", [0.5 * PERIOD, 2.0 * PERIOD, 20.0 * PERIOD])
def test_a_horizon_is_looked_ahead_and_no_less_than_a_period(horizon):
    """(φ̇_max − φ̇)/r with r = max(h, T/4), and the ceiling of T."""
    way, rate, a, T = 0.05, 0.4, decelerating(), max(horizon, PERIOD)
    r = max(PERIOD, 0.25 * T)
    expected = max((ceiling(way - 0.5 * PERIOD * rate, a, T) - rate) / r, -a)
    assert clamp(1.0 - way, rate, horizon=horizon)[1] == pytest.approx(expected, rel=1e-12)
    slow = (0.5 - 0.495) / r
    assert clamp(0.0, 0.495, horizon=horizon)[1] == pytest.approx(slow, rel=1e-12)


def test_against_a_limit_a_joint_comes_to_rest_critically_damped():
    """T²/4 φ̈ + T φ̇ + (φ − φ_max) = 0 close to it, whatever pushes."""
    T, step = 20.0 * PERIOD, 1e-7
    at = clamp(1.0, 0.0, horizon=T)[1]
    by_position = (clamp(1.0 - step, 0.0, horizon=T)[1] - at) / step
    by_rate = (clamp(1.0, -step, horizon=T)[1] - at) / step
    assert at == 0.0
    assert by_position == pytest.approx(4.0 / T**2, rel=1e-3)
    assert by_rate == pytest.approx(4.0 / T + 0.5 * PERIOD * 4.0 / T**2, rel=1e-3)


def test_outside_of_its_limits_a_joint_is_asked_back_no_harder_than_it_can_brake():
    a = decelerating(inertia=4.0)
    low, high, _, of_high = clamp(1.3, 0.0, inertia=4.0)
    assert (high, of_high) == (-a, POSITION)
    assert low == -2.0
    low, high, of_low, _ = clamp(-1.3, 0.0, inertia=4.0)
    assert (low, of_low) == (a, POSITION)
    assert high == 2.0


def test_outside_and_on_its_way_back_it_is_left_to_its_way():
    """At −ceiling(way back) nothing more is asked."""
    a = decelerating()
    back = ceiling(0.001, a, PERIOD)
    _, high, _, _ = clamp(1.001 + 0.5 * PERIOD * back, -back)
    assert high == pytest.approx(0.0, abs=1e-10)
    low, _, _, _ = clamp(-1.001 - 0.5 * PERIOD * back, back)
    assert low == pytest.approx(0.0, abs=1e-10)


def test_a_continuous_joint_has_no_position_limits():
    angle = 17.0
    assert clamp(angle, 0.0, kind=CONTINUOUS) == (-2.0, 2.0, ACCELERATION, ACCELERATION)
    assert clamp(angle, 0.0)[1] < 0.0


def test_how_far_outside_a_joint_is():
    for angle, way in ((0.5, 0.0), (1.0, 0.0), (-1.0, 0.0), (1.25, 0.25), (-1.5, 0.5)):
        assert clamp_and_measure(angle, 0.3)[4:] == (way, way)
        assert clamp_and_measure(angle, 0.3, torque=(0.0, 0.0))[4:] == (way, way)
    assert clamp_and_measure(1.25, 0.0, kind=CONTINUOUS)[4:] == (0.0, 0.0)


def test_a_joint_without_a_drive_has_no_bounds():
    assert clamp(1.3, 0.7, torque=(0.0, 0.0))[:2] == (-UNLIMITED, UNLIMITED)


def test_each_joint_is_clamped_by_its_own_numbers():
    """A revolute joint near its limit, a continuous one, which has two numbers in q, and one outside its limits."""
    joints = SimpleNamespace(
        kind=np.array([REVOLUTE, REVOLUTE, CONTINUOUS, REVOLUTE]),
        first=np.array([0, 7, 8, 10]),
        link_of=np.arange(1, 4),
    )
    w = SimpleNamespace(
        q=np.r_[np.zeros(7), -0.987, -3.0, 4.0, 1.02][:, None],
        velocity=np.r_[np.zeros(6), -0.195, 0.998, -0.1][:, None],
        generalized_inertia=np.diag([1.0, 4.0, 2.0]),
    )
    limits = SimpleNamespace(
        torque=np.array([[-3.0, -5.0, -2.0], [3.0, 5.0, 2.0]]),
        position=np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]]),
        velocity=np.array([0.5, 1.0, 0.7]),
        acceleration=np.array([2.0, 3.0, 4.0]),
        reaction=PERIOD,
        horizon=PERIOD,
        braking=0.8,
    )
    program = SimpleNamespace(lower=np.zeros(3), upper=np.zeros(3), cause=np.zeros((2, 3), dtype=np.int64))
    outside = np.full(3, np.nan)
    farthest = clamp_joints(joints, w, limits, program, outside)
    alone = [
        clamp_and_measure(-0.987, -0.195),
        clamp_and_measure(0.0, 0.998, velocity=1.0, acceleration=3.0, torque=(-5.0, 5.0), inertia=4.0, kind=CONTINUOUS),
        clamp_and_measure(1.02, -0.1, velocity=0.7, acceleration=4.0, torque=(-2.0, 2.0), inertia=2.0),
    ]
    for j, expected in enumerate(alone):
        assert (program.lower[j], program.upper[j], *program.cause[:, j], outside[j]) == expected[:5]
    assert farthest == alone[2][5] == pytest.approx(0.02)


def test_without_limits_nothing_bounds():
    none = UNLIMITED
    low, high, _, _ = clamp(3.0, 1.0, position=(-none, none), velocity=none, acceleration=none, torque=(-none, none))
    assert low <= -none
    assert high >= none


def test_bounds_never_contradict_each_other_nor_the_acceleration_limit():
    rng = np.random.default_rng(3)
    for _ in range(3000):
        low, high, _, _ = clamp(rng.uniform(-2.0, 2.0), rng.normal(), inertia=10.0 ** rng.uniform(-2, 2))
        assert -2.0 <= low <= high <= 2.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_driven_at_the_bound_a_joint_stops_at_its_limit(side):
    """φ̈ held over each period, always the most that is allowed: the joint arrives, and does not pass."""
    angle, rate = -side * 0.2, 0.0
    for _ in range(2000):
        low, high, _, _ = clamp(angle, rate)
        push = high if side > 0.0 else low
        angle, rate = angle + PERIOD * rate + 0.5 * PERIOD**2 * push, rate + PERIOD * push
        assert side * angle <= 1.0 + 1e-12
        assert abs(rate) <= 0.5 + 1e-12
    assert side * angle == pytest.approx(1.0, abs=1e-6)
    assert abs(rate) < 1e-5

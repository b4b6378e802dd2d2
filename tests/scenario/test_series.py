"""Curves of a log: their order, their units, their gaps, and their peaks."""

import math
from dataclasses import replace

import missions
import numpy as np
import pinocchio as pin
import pytest

from ospace.scenario import series


@pytest.fixture(scope="module")
def curves(of_run):
    return series.of(of_run)


def test_series_come_in_their_order(curves):
    assert list(curves) == [name for name in series.TITLES if name in curves]
    without = {"momentum-error", "angular-momentum-error", "unlimited-torque", "clearance"}
    assert set(series.TITLES) - set(curves) == without
    for one in curves.values():
        assert one.values.shape == (len(one.time), len(one.labels))
        assert (np.diff(one.time) >= 0.0).all()
        assert one.title


def test_errors_in_units_for_people_with_gaps(run, curves):
    position = curves["position-error"]
    assert position.labels == ("tip",)
    tip = [phase.errors["tip"].norms[:, 0] if "tip" in phase.errors else np.full(50, np.nan) for phase in run.phases]
    np.testing.assert_allclose(position.values[:, 0], 1e3 * np.concatenate(tip))
    angles = curves["angle-error"]
    assert set(angles.labels) == {"base", "tip", "look"}
    look = angles.values[:, angles.labels.index("look")]
    assert np.isnan(look[:150]).all()
    np.testing.assert_allclose(look[150:], np.degrees(run.phases[2].errors["look"].norms[:, 1]))
    assert curves["joint-error"].labels == ("rest",)
    assert [one.unit for one in (position, angles, curves["joint-error"])] == ["mm", "deg", "rad"]


def test_the_curve_of_orientation_is_the_angle_of_the_rotation(run, curves):
    turned = curves["orientation"]
    assert turned.labels == ("base", "end_effector")
    start, k = None, 0
    for phase in run.phases:
        _, Q, _ = missions.at_cycles(run, phase)
        for q in Q:
            R = pin.Quaternion(q[3:7]).toRotationMatrix()
            start = R if start is None else start
            assert math.radians(turned.values[k, 0]) == pytest.approx(np.linalg.norm(pin.log3(start.T @ R)), abs=1e-9)
            k += 1
    robot, Q, _ = missions.at_cycles(run, run.phases[2])
    first, last = (robot.state(Q[k]).placement(robot.point("end_effector")).rotation for k in (0, -1))
    expected = np.degrees(np.linalg.norm(pin.log3(first.T @ last)))
    assert turned.values[-1, 1] == pytest.approx(expected, abs=1e-7)
    assert np.isnan(turned.values[:150, 1]).all()


def test_curves_of_path_and_torque_are_the_recorded_ones(run, curves):
    path = curves["path"]
    assert path.labels == ("end_effector x", "end_effector y", "end_effector z")
    np.testing.assert_array_equal(path.values[:100], run.phases[0].poses["end_effector"][:, :3])
    torque = curves["torque"]
    assert (torque.unit, torque.limits) == ("%", (-100.0, 100.0))
    np.testing.assert_allclose(
        torque.values, 5.0 * np.concatenate([segment.trajectory.torque for segment in run.segments])
    )


def test_torque_of_joints_without_limit_and_without_drive(of_run):
    """The first has a series of its own, in N m; what has no drive has no curve."""
    first = of_run.segments[0]
    free = replace(first, torque_limits=np.array([math.inf, 20.0]))
    idle = replace(first, torque_limits=np.array([0.0, 20.0]))
    made = series.of(replace(of_run, segments=(free, *of_run.segments[1:])))
    assert made["unlimited-torque"].labels == ("joint_1",)
    np.testing.assert_array_equal(made["unlimited-torque"].values[:201, 0], first.trajectory.torque[:, 0])
    assert np.isnan(made["torque"].values[:201, made["torque"].labels.index("joint_1")]).all()
    made = series.of(replace(of_run, segments=(idle,), phases=of_run.phases[:1]))
    assert made["torque"].labels == ("joint_2",)
    assert "unlimited-torque" not in made


def test_the_certificate_is_the_peak_of_its_curves(run, curves):
    first = 0
    for segment in run.segments:
        own = slice(first, first + len(segment.trajectory))
        first = own.stop
        certificate = segment.trajectory.certificate()
        for name in ("momentum", "energy"):
            one = curves[name]
            assert one.logarithmic
            for k, quantity in enumerate(one.labels):
                told = certificate[quantity]
                assert one.values[own, k].max() == told.error
                assert one.time[own][one.values[own, k].argmax()] == told.time
                assert one.limits == (told.limit,)
    peaks = dict(zip(curves["momentum"].labels, curves["momentum"].values.max(axis=0), strict=True))
    for quantity, peak in peaks.items():
        assert peak <= run.certificate[quantity].error  # which is of the target by itself, too


def test_the_curve_of_sigma_min_has_gaps_where_no_task_is(run, curves):
    one = curves["sigma-min"]
    tip = one.values[:, one.labels.index("tip")]
    assert np.isnan(tip[100:150]).all()
    np.testing.assert_array_equal(tip[:100], run.phases[0].sigma_min["tip"])


def test_cycle_times_are_positive_and_sum_to_the_curve(run, curves):
    for phase in run.phases:
        assert phase.cycle_time.shape == phase.time.shape
        assert (phase.cycle_time > 1e-6).all()
    total = sum(phase.cycle_time.sum() for phase in run.phases)
    assert total < run.seconds
    assert curves["cycle-time"].values.sum() == pytest.approx(total * 1e6)

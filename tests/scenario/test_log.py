"""Logs: a file holds what the run left behind, and the curves of it are those that can be computed by themselves."""

import json
import math
from dataclasses import replace

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.scenario import cycle_log, log, runner, series


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    made = missions.flown(tmp_path_factory.mktemp("mission"))
    assert made.passed, [phase.reason for phase in made.phases]
    assert len(made.segments) == 3
    return made


@pytest.fixture(scope="module")
def of_run(run):
    return log.of(run)


@pytest.fixture(scope="module")
def curves(of_run):
    return series.of(of_run)


# -- files -------------------------------------------------------------------------------------------------------


def test_what_is_loaded_equals_what_was_saved(run, of_run, tmp_path):
    file = log.save(run, tmp_path / "out.npz")
    read = log.load(file)
    assert read == of_run
    assert log.load(log.save(read, tmp_path / "again.npz")) == read
    assert read != replace(read, seconds=read.seconds + 1.0)
    first = read.phases[0]
    other = replace(first, cycle_time=first.cycle_time + 1e-9)
    assert read != replace(read, phases=(other, *read.phases[1:]))
    assert list(tmp_path.glob(".*")) == []


def test_a_log_tells_what_the_run_tells(run, tmp_path):
    read = log.load(log.save(run, tmp_path / "out.npz"))
    assert (read.passed, read.complete, read.duration, read.not_begun) == (True, True, run.duration, ())
    assert read.certificate == run.certificate
    assert read.scenario == missions.MISSION
    assert read.name == "A short mission"
    assert read.versions["pin"] == pin.__version__
    assert set(read.versions) == {"ospace", "pin", "numpy", "python"}
    assert [segment.joints for segment in read.segments] == [("joint_1", "joint_2")] * 3
    assert [list(segment.torque_limits) for segment in read.segments] == [[20.0, 20.0]] * 3
    assert [segment.target is None for segment in read.segments] == [False, True, False]
    assert read.phases[0].grasp.energy_lost == run.phases[0].grasp.energy_lost
    assert read.phases[2].errors["tip"].units == ("m", "rad")
    for stored, phase in zip(read.phases, run.phases, strict=True):
        assert (stored.name, stored.outcome, stored.statuses) == (phase.name, phase.outcome, phase.statuses)


def test_each_array_is_stored_once(run, tmp_path):
    with np.load(log.save(run, tmp_path / "out.npz")) as file:
        stored = {name: file[name] for name in file.files}
    about = json.loads(str(stored.pop("about")))
    assert about["name"] == "A short mission"
    large = [array for array in stored.values() if array.ndim == 2 and len(array) > 10 and array.any()]
    for k, one in enumerate(large):
        assert not any(one.shape == other.shape and np.array_equal(one, other) for other in large[:k])


def changed(file, change):
    """Write a log with something in it changed."""
    with np.load(file) as read:
        stored = {name: read[name] for name in read.files}
    about = json.loads(str(stored["about"]))
    change(about, stored)
    np.savez(file, **stored | {"about": json.dumps(about)})


def shorten(about, stored):
    stored["phases/0/time"] = stored["phases/0/time"][1:]


def lose_a_pose(about, stored):
    about["phases"][0]["poses"] = {}


def without_about(about, stored):
    stored.clear()


@pytest.mark.parametrize(
    "change",
    [
        lambda about, stored: about.pop("format"),
        lambda about, stored: about.update(format="ospace run 0"),
        lambda about, stored: about.pop("certificate"),
        lambda about, stored: about.update(more=1),
        lambda about, stored: about["phases"][0].update(segment=7),
        lambda about, stored: about["segments"][0].update(joints=["joint_1"]),
        lambda about, stored: stored.pop("phases/0/cycle_time"),
        lambda about, stored: stored.update({"phases/0/cycle_time": np.array(["a"])}),
        shorten,
        lose_a_pose,
        without_about,
    ],
)
def test_what_is_no_log(run, tmp_path, change):
    file = log.save(run, tmp_path / "out.npz")
    changed(file, change)
    with pytest.raises(ospace.OspaceError, match=r"out\.npz: .* as ospace \S+ writes it: run the scenario again"):
        log.load(file)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        *(
            (f"segments/0/trajectory/{name}", change)
            for name in ("time", "q", "v", "torque", "momentum", "work", "impulse", "mass_centre", "rotation_drift")
            for change in (lambda a: a[1:], lambda a: a[..., None], lambda a: np.float64(1.0))
        ),
        ("segments/0/trajectory/time", lambda a: a[::-1]),
        ("segments/0/trajectory/time", lambda a: a * np.nan),
        ("segments/0/trajectory/time", lambda a: np.r_[a[:-1], np.inf]),
        ("segments/0/trajectory/q", lambda a: a[:, :5]),
        ("segments/0/trajectory/v", lambda a: a[:, :5]),
        ("segments/0/trajectory/torque", lambda a: a[:, :1]),
        ("segments/0/trajectory/base_wrench", lambda a: a[:, :5]),
        ("segments/0/trajectory/frame_velocity", lambda a: a[:2]),
        ("segments/0/torque_limits", lambda a: a[:1]),
        ("segments/0/target/q", lambda a: a[1:]),
        ("segments/0/target/time", lambda a: a[::-1]),
        ("phases/0/time", lambda a: a[::-1]),
        ("phases/0/cycle_time", lambda a: a[1:]),
        ("phases/0/errors/tip/norms", lambda a: a[:, :1]),
        ("phases/0/sigma_min/tip", lambda a: a[:, None]),
        ("phases/0/poses/end_effector", lambda a: a[:, :6]),
        ("phases/0/grasp/impulse", lambda a: a[:3]),
    ],
)
def test_an_array_that_fits_nothing_is_named(run, tmp_path, name, change):
    file = log.save(run, tmp_path / "out.npz")
    changed(file, lambda about, stored: stored.update({name: change(stored[name])}))
    with pytest.raises(ospace.OspaceError, match=r"out\.npz: array '(.*)' .*run the scenario again") as told:
        log.load(file)
    assert name.rpartition("/")[0] in str(told.value)  # where two differ in length, either is named


def without_records(about, stored):
    for name, array in stored.items():
        if name.startswith("segments/0/trajectory/") and not name.endswith("frame_velocity"):
            stored[name] = array[:0]


@pytest.mark.parametrize(
    "change",
    [
        without_records,
        lambda about, stored: about["segments"][0].update(joints=[1, 2]),
        lambda about, stored: about["segments"][0]["trajectory"].update(total_mass="heavy"),
        lambda about, stored: about["segments"][0]["trajectory"].update(largest_inertia=-1.0),
        lambda about, stored: about["phases"][0].update(end=math.nan),
        lambda about, stored: about["phases"][0].update(name=None),
        lambda about, stored: about["phases"][0]["errors"]["tip"].update(units=["m"]),
        lambda about, stored: about["certificate"].update(quantities=[]),
    ],
)
def test_what_no_run_tells(run, tmp_path, change):
    file = log.save(run, tmp_path / "out.npz")
    changed(file, change)
    with pytest.raises(ospace.OspaceError, match="run the scenario again"):
        log.load(file)


@pytest.mark.parametrize("content", [b"", b"nothing", b"PK\x03\x04 broken", "an array", "damaged"])
def test_what_cannot_be_read(run, tmp_path, content):
    file = tmp_path / "a.npz"
    if content == "an array":
        np.save(tmp_path / "a.npy", np.zeros(3))
        content = (tmp_path / "a.npy").read_bytes()
    elif content == "damaged":
        content = bytearray(log.save(run, file).read_bytes())
        content[2000:2400] = bytes(400)
    file.write_bytes(content)
    with pytest.raises(ospace.OspaceError, match=r"a\.npz: no run can be read from it"):
        log.load(file)
    with pytest.raises(ospace.OspaceError, match=r"b\.npz: no run can be read from it"):
        log.load(tmp_path / "b.npz")


def test_names_that_files_cannot_have(run, tmp_path):
    """Two tasks that differ in a letter that is none of a file's name; and one that would leave the archive."""
    first = run.phases[0]
    errors = {"a/b": first.errors["tip"], "a_b": first.errors["base"], "../../c": first.errors["tip"]}
    made = replace(log.of(run), phases=(replace(first, errors=errors), *run.phases[1:]))
    read = log.load(log.save(made, tmp_path / "out.npz"))
    assert read == made
    for task, stored in read.phases[0].errors.items():
        np.testing.assert_array_equal(stored.norms, errors[task].norms)


# -- what is recorded --------------------------------------------------------------------------------------------


def at_cycles(run, phase):
    """Return states at the cycles of a phase, by the times of the records."""
    segment = run.segments[phase.segment]
    records = [int(np.argmin(np.abs(segment.trajectory.time - time))) for time in phase.time]
    return segment.robot, segment.trajectory.q[records], segment.trajectory.v[records]


def test_sigma_min_by_the_generalized_jacobian(run):
    for phase, task, axes in ((0, "tip", [1, 1, 0, 0, 0, 0]), (2, "tip", [1, 0, 0, 0, 0, 1])):
        robot, Q, V = at_cycles(run, run.phases[phase])
        for k in (0, len(Q) // 2, len(Q) - 1):
            J = ospace.generalized_jacobian(robot.state(Q[k], V[k]), robot.point("end_effector", axes=axes))
            values = np.linalg.svd(J.generalized_jacobian, compute_uv=False)
            assert run.phases[phase].sigma_min[task][k] == pytest.approx(values.min(), rel=1e-9)
    assert not run.phases[0].sigma_min["base"].any()  # three rows, two joints
    assert "rest" not in run.phases[1].sigma_min
    assert (run.phases[2].sigma_min["look"] >= 0.0).all()


def test_sigma_min_does_not_depend_on_how_many_are_taken_at_once(run, monkeypatch, tmp_path):
    monkeypatch.setattr(cycle_log, "_AT_ONCE", 7)
    again = missions.flown(tmp_path)
    for one, other in zip(run.phases, again.phases, strict=True):
        for task, values in one.sigma_min.items():
            np.testing.assert_array_equal(values, other.sigma_min[task])


def test_poses_by_the_states_themselves(run):
    for number in (0, 2):
        phase = run.phases[number]
        assert list(phase.poses) == ["end_effector"]  # once, though two tasks of the last phase are about it
        robot, Q, _ = at_cycles(run, phase)
        for k in range(0, len(Q), 10):
            pose = robot.state(Q[k]).placement(robot.point("end_effector"))
            np.testing.assert_allclose(phase.poses["end_effector"][k, :3], pose.translation, rtol=0, atol=1e-12)
            R = pin.Quaternion(phase.poses["end_effector"][k, 3:]).toRotationMatrix()
            np.testing.assert_allclose(R, pose.rotation, rtol=0, atol=1e-12)


def test_cycle_times(run, curves):
    for phase in run.phases:
        assert phase.cycle_time.shape == phase.time.shape
        assert (phase.cycle_time > 1e-6).all()
    total = sum(phase.cycle_time.sum() for phase in run.phases)
    assert total < run.seconds
    assert curves["cycle-time"].values.sum() == pytest.approx(total * 1e6)


def test_offsets_from_a_frame_have_names_of_their_own(tmp_path):
    other = (
        '[[phase.task]]\nname = "tool"\ntype = "position"\npoint = "end_effector"\noffset = { position = [0.1, 0, 0] }'
    )
    made = missions.flown(tmp_path, f"{missions.MISSION}{other}\nweight = 1e-6\n")
    last = made.phases[-1]
    assert list(last.poses) == ["end_effector", "end_effector (tool)"]
    apart = last.poses["end_effector (tool)"][:, :3] - last.poses["end_effector"][:, :3]
    np.testing.assert_allclose(np.linalg.norm(apart, axis=1), 0.1, rtol=1e-12)
    assert last.errors["tool"].points == ("end_effector (tool)",)


@pytest.mark.parametrize("when", [0.0, 0.001, 0.1])
def test_what_was_run_until_an_interrupt_can_be_logged(tmp_path, monkeypatch, when):
    honest = runner.Controller.update

    def update(self, time, q, v):
        if time >= when:
            raise KeyboardInterrupt
        return honest(self, time, q, v)

    monkeypatch.setattr(runner.Controller, "update", update)
    run = missions.flown(tmp_path)
    assert run.interrupted
    read = log.load(log.save(run, tmp_path / "out.npz"))
    assert read == log.of(run)
    assert not read.passed
    assert read.not_begun == ("carry", "leave")
    assert ("cycle-time" in series.of(read)) == (when > 0.0)


def test_an_interrupt_when_the_run_is_over_leaves_a_log(tmp_path, monkeypatch):
    def interrupted(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(cycle_log.CycleLog, "sigma_min", property(interrupted))
    run = missions.flown(tmp_path)
    assert run.interrupted
    read = log.load(log.save(run, tmp_path / "out.npz"))
    assert (read.phases, len(read.segments)) == ((), 1)
    assert "torque" in series.of(read)


# -- curves ------------------------------------------------------------------------------------------------------


def test_series_come_in_their_order(curves):
    assert list(curves) == [name for name in series.TITLES if name in curves]
    assert set(series.TITLES) - set(curves) == {"momentum-error", "angular-momentum-error", "unlimited-torque"}
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


def test_orientation_by_rotations(run, curves):
    turned = curves["orientation"]
    assert turned.labels == ("base", "end_effector")
    start, k = None, 0
    for phase in run.phases:
        _, Q, _ = at_cycles(run, phase)
        for q in Q:
            R = pin.Quaternion(q[3:7]).toRotationMatrix()
            start = R if start is None else start
            assert math.radians(turned.values[k, 0]) == pytest.approx(np.linalg.norm(pin.log3(start.T @ R)), abs=1e-9)
            k += 1
    robot, Q, _ = at_cycles(run, run.phases[2])
    first, last = (robot.state(Q[k]).placement(robot.point("end_effector")).rotation for k in (0, -1))
    expected = np.degrees(np.linalg.norm(pin.log3(first.T @ last)))
    assert turned.values[-1, 1] == pytest.approx(expected, abs=1e-7)
    assert np.isnan(turned.values[:150, 1]).all()


def test_path_and_torque(run, curves):
    path = curves["path"]
    assert path.labels == ("end_effector x", "end_effector y", "end_effector z")
    np.testing.assert_array_equal(path.values[:100], run.phases[0].poses["end_effector"][:, :3])
    torque = curves["torque"]
    assert (torque.unit, torque.limits) == ("%", (-100.0, 100.0))
    np.testing.assert_allclose(
        torque.values, 5.0 * np.concatenate([segment.trajectory.torque for segment in run.segments])
    )


def test_joints_without_limit_and_without_drive(of_run):
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


def test_sigma_min_and_its_gaps(run, curves):
    one = curves["sigma-min"]
    tip = one.values[:, one.labels.index("tip")]
    assert np.isnan(tip[100:150]).all()
    np.testing.assert_array_equal(tip[:100], run.phases[0].sigma_min["tip"])

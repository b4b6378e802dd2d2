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
    assert [segment.targets == () for segment in read.segments] == [False, True, False]
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
def test_a_file_that_is_no_log_is_refused(run, tmp_path, change):
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
        ("segments/0/targets/0/q", lambda a: a[1:]),
        ("segments/0/targets/0/time", lambda a: a[::-1]),
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
def test_a_log_with_values_of_no_run_is_refused(run, tmp_path, change):
    file = log.save(run, tmp_path / "out.npz")
    changed(file, change)
    with pytest.raises(ospace.OspaceError, match="run the scenario again"):
        log.load(file)


@pytest.mark.parametrize("content", [b"", b"nothing", b"PK\x03\x04 broken", "an array", "damaged"])
def test_a_damaged_log_is_refused(run, tmp_path, content):
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


def test_a_log_keeps_names_that_files_cannot_have(run, tmp_path):
    """Two tasks that differ in a letter that is none of a file's name; and one that would leave the archive."""
    first = run.phases[0]
    errors = {"a/b": first.errors["tip"], "a_b": first.errors["base"], "../../c": first.errors["tip"]}
    made = replace(log.of(run), phases=(replace(first, errors=errors), *run.phases[1:]))
    read = log.load(log.save(made, tmp_path / "out.npz"))
    assert read == made
    for task, stored in read.phases[0].errors.items():
        np.testing.assert_array_equal(stored.norms, errors[task].norms)


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

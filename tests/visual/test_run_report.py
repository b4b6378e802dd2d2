"""The report of a run: of one that ended early too."""

import missions
import numpy as np
import pinocchio as pin
import pytest

from ospace import OspaceError, scenario
from ospace.dynamics.generalized_jacobian import generalized_jacobian
from ospace.visual import run_report


def ended(folder, steps, text=missions.MISSION):
    """Return a run that Ctrl-C ended after some steps."""
    done = 0

    def progress(time):
        nonlocal done
        done += 1
        if done > steps:
            raise KeyboardInterrupt

    run = scenario.run(missions.loaded(folder, text), progress)
    assert run.interrupted
    return run


def test_a_target_with_one_record_goes_on_as_it_moved(tmp_path):
    """Two steps are a control cycle; the target is recorded once a cycle."""
    run = ended(tmp_path, 1)
    assert [(len(one.trajectory), len(one.targets[0].time)) for one in run.segments] == [(2, 1)]
    chaser, target = run_report.motions_of(run)
    np.testing.assert_array_equal(target.time, chaser.time)
    own = run.scenario.targets["target"].start
    np.testing.assert_array_equal(target.q[0], own.q)
    assert own.v[3:].any()
    later = pin.integrate(own.robot.model, own.q, 1e-3 * own.v)
    np.testing.assert_allclose(target.q[1], later, rtol=0, atol=1e-15)
    assert run_report.save(run, tmp_path / "out.html").read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


def test_of_what_has_not_moved_there_is_no_report(tmp_path):
    run = ended(tmp_path, 0)
    assert len(run.segments[0].trajectory) == 1
    with pytest.raises(OspaceError, match="the run ended before its first step: nothing has moved"):
        run_report.save(run, tmp_path / "out.html")
    assert not (tmp_path / "out.html").exists()
    with pytest.raises(OspaceError, match="nothing has moved"):
        run_report.motions_of(type(run)(**vars(run) | {"segments": ()}))


def test_a_report_that_fails_leaves_what_was_there(tmp_path, monkeypatch):
    def fail(run, about):
        raise KeyboardInterrupt

    monkeypatch.setattr(run_report, "render", fail)
    (tmp_path / "out.html").write_text("before")
    with pytest.raises(KeyboardInterrupt):
        run_report.save(None, tmp_path / "out.html")
    assert (tmp_path / "out.html").read_text() == "before"


def test_what_a_log_holds_of_a_segment_is_that_of_its_robot(grasped):
    """After the grasp curves are of the combined robot: momentum, centre of mass, energy, and σ_min of each task."""
    held = next(k for k, segment in enumerate(grasped.segments) if segment.holds)
    segment = grasped.segments[held]
    robot, run = segment.robot, segment.trajectory
    model, data = robot.model, robot.model.createData()
    offsets = []
    for k in np.linspace(0, len(run) - 1, 10, dtype=int):
        q, v = run.q[k], run.v[k].copy()
        v[:3] -= pin.XYZQUATToSE3(q[:7]).rotation.T @ run.frame_velocity  # as records of conserved quantities see it
        h = pin.computeCentroidalMomentum(model, data, q, v).vector
        offsets.append(data.com[0] - run.mass_centre[k] - run.frame_velocity * run.time[k])
        assert pin.computeKineticEnergy(model, data, q, v) == pytest.approx(run.kinetic_energy[k], rel=1e-6)
        np.testing.assert_allclose(run.momentum[k][:3], h[:3], rtol=0, atol=1e-9 * robot.total_mass)
    np.testing.assert_allclose(offsets, offsets[:1] * len(offsets), rtol=0, atol=1e-9)
    compared = 0
    for phase in grasped.phases:
        for task, values in phase.sigma_min.items():
            own = next(one for one in grasped.scenario.phases if one.name == phase.name)
            point = next(one.frames.get("point") for one in own.tasks if one.name == task)
            if phase.segment != held or point not in robot.frame_names:
                continue
            for k in np.linspace(0, len(values) - 1, 5, dtype=int):
                state = robot.state(*run.at(robot, phase.time[k]))
                of_all = generalized_jacobian(state, robot.point(point)).generalized_jacobian
                rows = (range(6), range(3), range(3, 6))
                sizes = [np.linalg.svd(of_all[some], compute_uv=False)[-1] for some in rows]
                assert min(abs(values[k] - size) for size in sizes) < 1e-6 * max(sizes)
                compared += 1
    assert compared >= 5

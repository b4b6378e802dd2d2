"""What a run records once a cycle: σ_min, poses, the time of the cycle."""

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.scenario import cycle_log


def test_recorded_sigma_min_is_that_of_the_generalized_jacobian(run):
    for phase, task, axes in ((0, "tip", [1, 1, 0, 0, 0, 0]), (2, "tip", [1, 0, 0, 0, 0, 1])):
        robot, Q, V = missions.at_cycles(run, run.phases[phase])
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


def test_recorded_poses_are_those_of_the_states(run):
    for number in (0, 2):
        phase = run.phases[number]
        assert list(phase.poses) == ["end_effector"]  # once, though two tasks of the last phase are about it
        robot, Q, _ = missions.at_cycles(run, phase)
        for k in range(0, len(Q), 10):
            pose = robot.state(Q[k]).placement(robot.point("end_effector"))
            np.testing.assert_allclose(phase.poses["end_effector"][k, :3], pose.translation, rtol=0, atol=1e-12)
            R = pin.Quaternion(phase.poses["end_effector"][k, 3:]).toRotationMatrix()
            np.testing.assert_allclose(R, pose.rotation, rtol=0, atol=1e-12)


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

"""Errors of masses: the controller has another model than the robot, and errors are those of the robot."""

import missions
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace import scenario
from ospace.scenario import log, runner, summary_text
from ospace.scenario.mass_errors import believed

HEAVY = {"link": "link_2", "mass": 0.2}


def moving(*errors, **tables):
    go = missions.TIP | {"goal": {"shift": ["-30 cm", "10 cm", 0], "duration": "1 s"}}
    return missions.toml(
        missions.phase("go", go, duration="1.2 s", timeout="2 s"),
        robot=missions.PLANAR,
        control={"step": "1 ms", "period": "2 ms"},
        tasks=[missions.REST],
        mass_errors=errors,
        **tables,
    )


def test_the_model_of_the_controller_has_the_errors_and_the_robot_has_not(load, monkeypatch):
    made = []
    honest = runner.Controller.__init__

    def init(self, robot, *given, **named):
        made.append(robot)
        honest(self, robot, *given, **named)

    monkeypatch.setattr(runner.Controller, "__init__", init)
    shift = HEAVY | {"inertia": -0.3, "mass_centre": ["1 cm", 0, "-2 cm"]}
    run = scenario.run(load(moving(shift, {"mass": 0.1})))
    true = run.scenario.robot
    known = made[-2]
    j = true.frame("link_2").parentJoint
    for k in range(1, true.model.njoints):
        was, now = true.model.inertias[k], known.model.inertias[k]
        on_link = k == j
        assert now.mass == pytest.approx(1.1 * was.mass * (1.2 if on_link else 1.0))
        np.testing.assert_allclose(now.inertia, 1.1 * (0.7 if on_link else 1.0) * was.inertia)
        np.testing.assert_allclose(now.lever - was.lever, [0.01, 0.0, -0.02] if on_link else 0.0, atol=1e-15)
    assert run.segments[0].robot is true
    assert run.segments[0].trajectory.total_mass == true.total_mass


def test_a_run_with_a_wrong_model_is_certified_and_its_errors_are_true(load, tmp_path):
    exact, wrong = (scenario.run(load(moving(*errors))) for errors in ((), (HEAVY | {"mass": 1.0},)))
    assert exact.passed
    assert wrong.passed
    worst = [run.phases[0].errors["tip"].worst[0] for run in (exact, wrong)]
    assert worst[1] > 1.5 * worst[0]
    phase = wrong.phases[0]
    robot, q, v = missions.at_cycles(wrong, phase)
    k = len(q) // 3
    tip = robot.point("end_effector", axes=missions.PLANE)
    J = ospace.generalized_jacobian(robot.state(q[k], v[k]), tip).generalized_jacobian
    assert phase.sigma_min["tip"][k] == pytest.approx(np.linalg.svd(J, compute_uv=False)[-1], rel=1e-9)
    assert log.load(log.save(wrong, tmp_path / "wrong.npz")) == log.of(wrong)


def test_a_target_is_held_with_the_masses_that_the_controller_believes(load, monkeypatch):
    seen = []
    honest = runner._Phase.__init__

    def init(self, plan, made, start, robot, shared):
        seen.append((start.robot, robot))
        honest(self, plan, made, start, robot, shared)

    monkeypatch.setattr(runner._Phase, "__init__", init)
    errors = [{"of": "target", "mass": 0.5}, {"of": "robot", "link": "link_1", "mass": -0.1}]
    text = missions.MISSION + "".join(
        "[[mass_error]]\n" + "".join(f"{key} = {value!r}\n" for key, value in one.items()) for one in errors
    )
    run = scenario.run(load(text))
    assert run.certificate.passed
    assert [phase.outcome for phase in run.phases] == ["complete"] * 3
    (first, true_first), (held, true_held), (last, _) = seen
    chaser, target = run.scenario.robot, run.scenario.targets["target"].robot
    less = 0.1 * chaser.model.inertias[chaser.frame("link_1").parentJoint].mass
    assert first is last
    assert true_first.total_mass - first.total_mass == pytest.approx(less)
    assert held.total_mass - true_held.total_mass == pytest.approx(0.5 * target.total_mass - less)
    assert held.frame_names == true_held.frame_names
    assert held.rate_names == true_held.rate_names


def test_a_robot_with_coupled_joints_is_believed_with_its_couplings():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    (error,) = scenario.schema.ScenarioTable.model_validate({"mass_error": [{"mass": 0.25}]}).mass_error
    known = believed(robot, [error])
    assert known.total_mass == pytest.approx(1.25 * robot.total_mass)
    q = pin.randomConfiguration(robot.model, robot.model.lowerPositionLimit, robot.model.upperPositionLimit)
    q[:3] = 0.0
    M = [pin.crba(one.model, one.model.createData(), q) for one in (robot, known)]
    np.testing.assert_allclose(np.triu(M[1]), 1.25 * np.triu(M[0]), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("change", "key", "what"),
    [
        ({"link": "link_3"}, "mass_error[0].link", "did you mean 'link_"),
        ({"mass": -1.0}, "mass_error[0].mass", "above -1"),
        ({"mass": "1 kg"}, "mass_error[0].mass", "is not a number"),
        ({"mass": 0.0}, "mass_error[0]", "changes nothing"),
        ({"of": "target"}, "mass_error[0].of", "there is no target"),
        ({"of": "chaser"}, "mass_error[0].of", "is unknown"),
        ({"link": None, "mass_centre": ["1 cm", 0, 0]}, "mass_error[0].mass_centre", "give link as well"),
    ],
)
def test_errors_of_masses_that_make_no_sense_are_refused(load, change, key, what):
    with pytest.raises(ospace.ScenarioError) as error:
        load(moving(HEAVY | change))
    ((named, said),) = error.value.problems
    assert named == key
    assert what in said


def test_the_table_tells_what_the_controller_believes(load):
    assert list(summary_text.conditions(load(moving(HEAVY)))) == [
        "the controller takes 'link_2' of the robot for +20 % in mass, +20 % in inertia, off by 0 mm"
    ]

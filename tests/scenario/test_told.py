"""A run tells what fell short, and what a failed certificate may come of; a scenario sets the controller."""

from types import SimpleNamespace

import pytest

import ospace
from ospace import scenario
from ospace.control import Controller
from ospace.scenario import summary_text
from ospace.simulation.certificate import Certificate, Conserved

SCENARIO = """
[robot]
model = "chaser_7dof"
[control]
trust_radius = 0.7
singular = 2e-5
damping = 0.03
regularization = 1e-5
limit_horizon = "60 ms"
[[phase]]
name = "reach"
duration = "0.5 s"
timeout = "1 s"
[[phase.task]]
name = "hand"
type = "position"
point = "hand"
goal = { shift = ["20 m", 0, 0], duration = "0.5 s" }
[[phase.task]]
name = "rest"
type = "damping"
"""


def test_a_scenario_sets_the_controller_and_its_run_tells(tmp_path):
    seen = {}

    class Watched(Controller):
        def __init__(self, *args, **settings):
            seen.update(settings)
            super().__init__(*args, **settings)

    file = tmp_path / "reach.toml"
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
    file.write_text(SCENARIO.replace('point = "hand"', f'point = "{robot.leaf_links[-1]}"'))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("ospace.scenario.runner.Controller", Watched)
        run = scenario.run(scenario.load(file))
    for name, value in (("trust_radius", 0.7), ("singular", 2e-5), ("damping", 0.03), ("limit_horizon", 0.06)):
        assert seen[name] == pytest.approx(value)
    (phase,) = run.phases
    assert phase.statuses["falling short"] == sum(phase.statuses.values()) - phase.statuses.get("nominal", 0)
    assert phase.shortfalls
    assert phase.shortfalls.keys() == phase.most_short.keys()
    cause = max(phase.shortfalls, key=phase.shortfalls.get)
    assert any(cause in line and phase.most_short[cause] in line for line in summary_text.remarks(phase))
    (stored,) = scenario.log.load(scenario.log.save(run, tmp_path / "run.npz")).phases
    assert (stored.shortfalls, stored.most_short) == (phase.shortfalls, phase.most_short)


def test_a_failed_certificate_says_how_to_tell_whether_it_is_the_step():
    off = Conserved("work and energy", 1e-6, 1e-8, 2.0, "J", 0.5)
    kept = Conserved("linear momentum", 1e-12, 1e-9, 2.0, "kg m/s", 0.5)
    run = SimpleNamespace(certificate=Certificate((off, kept)))
    said = summary_text.remedy(run, 1e-3)
    assert said.startswith("off: work and energy. ")
    assert 'control.step = "0.5 ms"' in said
    assert summary_text.remedy(SimpleNamespace(certificate=Certificate((kept,))), 1e-3) == ""

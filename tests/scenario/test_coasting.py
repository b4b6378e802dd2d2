"""Phases without tasks coast: nothing acts, and they last as long as they say."""

import missions
import numpy as np
import pytest

from ospace import ScenarioError, scenario
from ospace.scenario import log

SPINNING = missions.PLANAR | {"joint_rates": {"joint_1": "5 deg/s", "joint_2": "-3 deg/s"}}


def coasting(*, tasks=(missions.REST,), **keys):
    coast = {"name": "coast", "duration": "0.2 s", "timeout": "1 s", "task": []} | keys
    return missions.toml(
        missions.phase("hold", duration="0.1 s", timeout="1 s") if tasks else coast,
        *([coast] if tasks else []),
        robot=SPINNING,
        control={"step": "1 ms", "period": "10 ms"},
        tasks=tasks,
    )


@pytest.mark.parametrize("tasks", [(), (missions.REST,)])
def test_nothing_acts_in_a_phase_without_tasks(load, tmp_path, tasks):
    run = scenario.run(load(coasting(tasks=tasks)))
    assert run.passed
    phase = run.phases[-1]
    assert phase.outcome == "complete"
    assert phase.end - phase.start == pytest.approx(0.2)
    assert phase.statuses == {"coasting": 20}
    assert phase.errors == {}
    trajectory = run.segments[0].trajectory
    coasts = trajectory.time > phase.start - 1e-9
    assert not trajectory.torque[coasts].any()
    assert trajectory.torque[~coasts].any() == bool(tasks)
    assert np.abs(trajectory.v[-1, 6:]).max() > 1e-3
    assert np.ptp(trajectory.work[coasts]) == 0.0
    assert log.load(log.save(run, tmp_path / "coast.npz")) == log.of(run)


def test_a_scenario_that_coasts_alone_is_rehearsed(load):
    assert scenario.rehearse(load(coasting(tasks=()))) == ""


def test_a_phase_that_coasts_needs_a_duration(load):
    with pytest.raises(ScenarioError, match="nothing ends the phase: give a duration"):
        load(coasting(duration=None))


def test_joints_that_coast_past_their_limits_are_told(load):
    text = coasting(tasks=()).replace('joint_1 = "20 deg"', 'joint_1 = "2.5 rad"').replace("5 deg/s", "4 rad/s")
    run = scenario.run(load(text.replace('duration = "0.2 s"', 'duration = "0.9 s"')))
    assert "joint_1: position" in run.exceeded

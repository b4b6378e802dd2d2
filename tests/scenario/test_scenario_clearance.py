"""Clearance in a scenario: links keep apart, and log, table and plots say how near they came."""

import numpy as np
import pytest
from missions import PLANAR, phase, toml

from ospace.collision import CollisionGeometry
from ospace.collision.pairs import solver_of_links
from ospace.scenario import load, log, run, series, summary_text
from ospace.scenario.errors import ScenarioError

PAIR = ("base", "link_2")


def folded(clearance="3 cm", limits=None, **tables):
    """Return a scenario in which planar_2r folds into its base."""
    inside = {"name": "arm", "type": "posture", "posture": {"joint_1": "75 deg", "joint_2": "160 deg"}, "stiffness": 4}
    return toml(
        phase("fold", inside, timeout="9 s", duration="7 s"),
        robot=PLANAR,
        control={"step": "5 ms", "period": "5 ms"},
        limits={"clearance": clearance} | (limits or {}),
        **tables,
    )


@pytest.fixture
def written(tmp_path):
    def write(text):
        file = tmp_path / "one.toml"
        file.write_text(text)
        return file

    return write


def smallest(robot, q):
    solver, _ = solver_of_links(CollisionGeometry.of(robot), [PAIR])
    solver.configure(q)
    return solver.distances().min()


def test_an_arm_sent_into_its_base_stops_apart_and_all_tell_how_near(written, tmp_path):
    loaded = load(written(folded()))
    result = run(loaded)
    (phase_,) = result.phases
    kept = phase_.separation
    found = [smallest(loaded.robot, q) for q in result.segments[0].trajectory.q]
    assert 0.03 < min(found) < 0.031
    np.testing.assert_allclose(kept.distance, found[: len(kept.distance)], atol=1e-9)
    assert kept.clearance == 0.03
    assert kept.closest == {" / ".join(PAIR): pytest.approx(min(kept.distance))}
    assert any(one.startswith("fold: smallest distance: base / link_2, 30") for one in summary_text.remarks(phase_))
    assert f"{' / '.join(PAIR)}: clearance, lower" in phase_.active_limits
    stored = log.load(log.save(result, tmp_path / "run.npz"))
    assert stored == log.of(result)
    curve = series.of(stored)["clearance"]
    np.testing.assert_allclose(curve.values[:, 0], 1e3 * kept.distance)
    assert curve.limits == (30.0,)
    free = run(load(written(folded().replace('clearance = "3 cm"', ""))))
    assert min(smallest(loaded.robot, q) for q in free.segments[0].trajectory.q) < 0.0
    assert free.phases[0].separation is None
    assert "clearance" not in series.of(log.of(free))


def test_pairs_that_may_touch_are_left_alone(written):
    with pytest.raises(ScenarioError, match=r"limits.clearance: no pair of links of robot 'planar_2r' is left"):
        load(written(folded(limits={"may_touch": [list(PAIR)]})))


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ({"may_touch": [["base", "link_9"]]}, r"limits.may_touch: link 'link_9' is unknown; did you mean 'link_2'"),
        ({"may_touch": "base"}, "limits.may_touch: give a list of pairs of links"),
        ({"may_touch": [["base", "link_1", "link_2"]]}, "limits.may_touch: give a list of pairs of links"),
        ({"clearance": 0}, "limits.clearance: "),
        ({"clearance": "3 kg"}, "limits.clearance: "),
        ({"clearance": None, "may_touch": ["base"]}, "limits.may_touch: says nothing without limits.clearance"),
    ],
)
def test_what_makes_no_sense_is_refused_by_its_key(written, limits, words):
    with pytest.raises(ScenarioError, match=words):
        load(written(folded(limits=limits)))


def test_the_hand_may_touch_the_target_that_it_grasps_and_a_held_one_does_not_count(written):
    grasp = {"hand": "end_effector", "fixture": "grapple", "position": "inf m", "angle": "inf deg"}
    still = {"name": "rest", "type": "posture"}
    text = toml(
        phase("wait", duration="0.1 s", timeout="1 s"),
        phase("touch", duration="0.1 s", timeout="1 s", grasp=grasp),
        phase("hold", duration="0.1 s", timeout="1 s", release=True),
        phase("away", duration="0.1 s", timeout="1 s"),
        tasks=(still,),
        robot=PLANAR,
        target={"model": "target", "position": [1.2, 1.9, 0.0]},
        control={"step": "5 ms", "period": "5 ms"},
        limits={"clearance": "2 cm", "may_touch": [["base", "left_panel"]]},
    )
    phases = run(load(written(text))).phases
    assert [one.outcome for one in phases] == 4 * ["complete"]
    pairs = [set(one.separation.closest) for one in phases]
    target = {"target_bus", "left_panel", "right_panel", "grapple"}
    for k, (touching, free) in enumerate([("link_2", True), ("link_2", True), ("", False), ("link_2", True)]):
        named = {frozenset(pair.split(" / ")) for pair in pairs[k]}
        with_target = [pair for pair in named if pair & target]
        assert bool(with_target) == free, (k, pairs[k])
        if k == 1:
            assert not any(touching in pair for pair in with_target)

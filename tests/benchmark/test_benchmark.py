"""The comparison with Pinocchio: both sides compute the same, and what is told is what was measured."""

import json
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
import trees

import ospace
from ospace.benchmark import growth, peers, plot, report
from ospace.benchmark.timing import WINDOWS, Ratio, window_times
from ospace.cli.main import main
from ospace.validation.sampling import random_state


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture(scope="module")
def result(chaser):
    plan = replace(report.prepare(chaser, 2), sizes=(12, 24, 48))
    ticks = []
    measured = report.run(plan, seconds=1e-3, tick=lambda: ticks.append(1))
    assert len(ticks) == plan.turns
    return measured


@pytest.mark.parametrize("make", peers.CONTESTS)
@pytest.mark.parametrize("seed", range(3))
def test_both_sides_compute_the_same_on_any_robot(make, seed):
    robot = trees.tree(seed, 12, ("revolute", "prismatic", "revolute about any axis"))
    states = [trees.state(robot, k) for k in range(4)]
    make(robot, [robot.point("link_11")]).check([(state.q.copy(), state.v.copy()) for state in states])


@pytest.mark.parametrize("make", peers.CONTESTS)
def test_a_difference_is_told_and_not_timed(chaser, make):
    contest = make(chaser, [chaser.point("right_hand")])
    state = random_state(chaser, np.random.default_rng(0))

    def wrong(q, v):
        return [(ours * (1.0 + 1e-6), theirs) for ours, theirs in contest.results(q, v)]

    with pytest.raises(ospace.OspaceError, match=r"differ by 1\.0e-06"):
        replace(contest, results=wrong).check([(state.q.copy(), state.v.copy())])


def test_rows(result):
    shown = {(row.quantity, row.points) for row in result.rows}
    names = ("Γ_e⁻¹", "Γ_e⁻¹, Γ_e, μ, μ_e", "J_e", "J_m*, H_m*, M_0", "operational_space(state)")
    assert shown == {(name, p) for name in names for p in (1, 2)} | {("Γ_e⁻¹ of read-only q, v", 1)}
    for row in (*result.rows, *result.batch):
        assert 0.0 < row.times.low <= row.times.ratio <= row.times.high
    assert [each.shape for each in result.growth] == ["chain", "tree"]
    assert json.loads(json.dumps(result.as_dict(), allow_nan=False))["machine"]["pinocchio"]


def test_dependent_rows_have_no_inverse_to_compare(chaser):
    counts = {(contest.quantity, count) for count, contest in report.prepare(chaser, 6).contests}
    assert ("Γ_e⁻¹", 6) in counts
    assert ("Γ_e⁻¹, Γ_e, μ, μ_e", 6) not in counts


def test_more_points_than_links(chaser):
    with pytest.raises(ospace.OspaceError, match="18 moving links"):
        report.prepare(chaser, 19)


def test_a_robot_whose_joints_mimic_others_is_not_compared():
    with pytest.raises(ospace.OspaceError, match=r"mimic others, and Pinocchio's.*--free-mimic"):
        report.prepare(trees.coupled(0))


def test_windows_take_turns():
    calls = []
    ways = [lambda q, v, k=k: calls.append(k) for k in range(2)]
    times = window_times(ways, [(np.zeros(1), np.zeros(1))], seconds=1e-9, tick=lambda: calls.append("tick"))
    assert times.shape == (WINDOWS, 2)
    assert calls == [0, 0, 1, 1] + [0, 1, "tick"] * WINDOWS


def test_ratio_is_of_medians_over_windows():
    times = np.array([[1e-6, 2e-6], [1e-6, 4e-6], [2e-6, 6e-6]])
    assert Ratio.of(times) == Ratio(*(pytest.approx(x) for x in (1.0, 4.0, 3.0, 2.5, 3.5)))


@pytest.mark.parametrize("shape", growth.SHAPES)
@pytest.mark.parametrize("nv", [7, 12, 61])
def test_robots_of_the_growth_table(shape, nv):
    robot = growth.robot_of(shape, nv)
    assert robot.nv == nv
    state = trees.state(robot, 0)
    point = robot.point(robot.leaf_links[-1])
    reference = ospace.operational_space(state, point, "dense").inertia_inverse
    found = ospace.OperationalSpaceEvaluator(robot, point).update(state.q, state.v).inertia_inverse
    np.testing.assert_allclose(found, reference, rtol=0.0, atol=1e-10 * np.abs(reference).max())
    assert shape == "chain" or nv < 12 or len(robot.leaf_links) > 1


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_plot(result, tmp_path, suffix):
    path = tmp_path / f"plot{suffix}"
    plot.save(result, path)
    assert path.stat().st_size > 10_000


def called(program, *arguments):
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], check=True, stdout=subprocess.PIPE, text=True, timeout=300
    ).stdout


def test_command(tmp_path):
    program = "import ospace.benchmark.growth as g; g.SIZES = (12, 24); from ospace.cli.main import main; "
    program += "raise SystemExit(main())"
    path = tmp_path / "plot.svg"
    arguments = ["bench", "planar_2r", "--points", "1", "--seconds", "0.001", "--plot", str(path)]
    done = called(program, *arguments)
    for words in ("planar_2r", "pinocchio", "Γ_e⁻¹", "computeDelassusMatrix", "8192", "slope"):
        assert words in done
    assert path.read_text().startswith("<?xml")
    assert json.loads(called(program, *arguments[:6], "--json"))["growth"][0]["sizes"] == [12, 24]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["bench", "nowhere.urdf"], "nowhere.urdf"),
        (["bench", "chaser_24dof", "--points", "0"], "1 to 100"),
        (["bench", "chaser_24dof", "--points", "99"], "18 moving links"),
        (["bench", "target"], "0 moving links"),
        (["bench", "chaser_24dof", "--seconds", "nan"], "seconds"),
        (["bench", "chaser_24dof", "--plot", "x.doc"], ".svg"),
        (["bench", "chaser_24dof", "--plot", "nowhere/x.svg"], "no such folder"),
    ],
)
def test_wrong_use(capsys, arguments, words):
    try:
        status = main(arguments)
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert words in capsys.readouterr().err


def test_without_matplotlib_the_message_says_what_to_install(capsys, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert main(["bench", "chaser_24dof", "--plot", "x.svg"]) == 2
    assert "pip install 'ospace[visual]'" in capsys.readouterr().err


def test_an_interrupt_ends_it(monkeypatch, capsys):
    def interrupted(*arguments, **more):
        raise KeyboardInterrupt

    monkeypatch.setattr("ospace.benchmark.report.window_times", interrupted)
    assert main(["bench", "chaser_24dof", "--points", "1"]) == 130
    assert "interrupted" in capsys.readouterr().err

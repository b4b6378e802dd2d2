"""The measured table: its rows, its plot, and what it leaves out."""

import json
from dataclasses import replace

import pytest
import trees

import ospace
from ospace.benchmark import plot, report


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


def test_the_table_has_a_row_for_each_quantity_and_count_of_points(result):
    shown = {(row.quantity, row.points) for row in result.rows}
    names = ("Γ_e⁻¹", "Γ_e⁻¹, Γ_e, μ, μ_e", "J_e", "J_m*, H_m*, M_0", "operational_space(state)")
    assert shown == {(name, p) for name in names for p in (1, 2)} | {("Γ_e⁻¹ of read-only q, v", 1)}
    for row in (*result.rows, *result.batch):
        assert 0.0 < row.times.low <= row.times.ratio <= row.times.high
    assert [each.shape for each in result.growth] == ["chain", "tree"]
    assert json.loads(json.dumps(result.as_dict(), allow_nan=False))["machine"]["pinocchio"]


def test_dependent_rows_have_no_inverse_to_compare(chaser):
    counts = {(comparison.quantity, count) for count, comparison in report.prepare(chaser, 6).comparisons}
    assert ("Γ_e⁻¹", 6) in counts
    assert ("Γ_e⁻¹, Γ_e, μ, μ_e", 6) not in counts


def test_more_points_than_links_are_refused(chaser):
    with pytest.raises(ospace.OspaceError, match="18 moving links"):
        report.prepare(chaser, 19)


@pytest.mark.parametrize("suffix", [".svg", ".png"])
def test_a_plot_of_the_table_is_written(result, tmp_path, suffix):
    path = tmp_path / f"plot{suffix}"
    plot.save(result, path)
    assert path.stat().st_size > 10_000


def test_a_robot_whose_joints_mimic_others_is_not_compared():
    with pytest.raises(ospace.OspaceError, match=r"mimic others, and Pinocchio's.*--free-mimic"):
        report.prepare(trees.coupled(0))

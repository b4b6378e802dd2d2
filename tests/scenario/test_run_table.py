"""A run as one tidy table: phases, joints of all segments, errors of tasks."""

import csv

import missions
import numpy as np
import pytest

from ospace.scenario import log


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return missions.flown(tmp_path_factory.mktemp("mission"))


def test_a_row_is_a_record_with_its_phase(run):
    table = run.as_dict()
    records = [len(segment.trajectory) for segment in run.segments]
    assert {len(column) for column in table.values()} == {sum(records)}
    assert list(table)[:4] == ["time [s]", "phase", "segment", "base x [m]"]
    assert list(dict.fromkeys(table["phase"])) == [phase.name for phase in run.phases]
    assert np.bincount(table["segment"]).tolist() == records


def test_joints_of_one_segment_alone_are_empty_in_the_others(run):
    table = run.as_dict()
    first, second = run.segments[0].robot, run.segments[1].robot
    assert second.nq >= first.nq
    of_first = table["segment"] == 0
    np.testing.assert_array_equal(table["joint_2 [rad]"][of_first], run.segments[0].trajectory.q[:, 8])
    for name in set(table) - set(run.segments[0].trajectory.as_dict(first)) - {"phase", "segment"}:
        assert np.isnan(table[name][of_first]).all() or "error" in name


def test_errors_stand_at_the_cycles_of_their_phase(run):
    table, phase = run.as_dict(), run.phases[0]
    column = table["tip position error [m]"]
    in_reach = (table["phase"] == phase.name) & ~np.isnan(column)
    np.testing.assert_allclose(column[in_reach], phase.errors["tip"].norms[: in_reach.sum(), 0])
    assert in_reach.sum() >= len(phase.time) - 1


def test_the_file_holds_the_same_and_a_data_frame_too(run, tmp_path):
    files = log.to_csv(run, tmp_path)
    assert files[0] == tmp_path / "run.csv"
    with files[0].open(newline="") as file:
        heading, *rows = csv.reader(file)
    table = run.as_dict()
    assert heading == list(table)
    k = heading.index("joint_1 torque [N m]")
    assert [float(row[k]) for row in rows] == table["joint_1 torque [N m]"].tolist()
    empty = heading.index("tip position error [m]")
    assert [row[empty] == "" for row in rows] == np.isnan(table["tip position error [m]"]).tolist()
    frame = run.to_dataframe()
    assert list(frame.columns) == heading
    assert frame.groupby("phase")["time [s]"].max()["reach"] == pytest.approx(run.phases[0].end)


def test_results_print_in_a_line(run):
    assert repr(run) == (
        f"Run('A short mission', {run.duration:.6g} s: reach complete, carry complete, leave complete; "
        f"{'passed' if run.passed else 'failed'})"
    )
    assert repr(log.of(run)) == repr(run).replace("Run(", "Log(")
    for one in (*run.phases, *run.segments, run.segments[0].trajectory):
        assert len(repr(one)) < 1200
        assert "\n" not in repr(one)

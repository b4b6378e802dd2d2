"""The report of a run: small, complete, in agreement with the log, its plots on the clock of the animation."""

import math
import re

import missions
import numpy as np
import pinocchio as pin
import pytest

from ospace.cli.main import main
from ospace.scenario import log, series
from ospace.visual import run_report

pytestmark = pytest.mark.browser
MOST = 10e6  # bytes
TEXTS = "(rows) => rows.map((row) => [...row.cells].map((cell) => cell.textContent.trim()))"
TICKS = """(figure) => [...figure.querySelectorAll("[id*=-xtick_]")].map((tick) => {
  const mark = tick.querySelector("use").getBoundingClientRect();
  return [Number(tick.querySelector("text").textContent.replace("\u2212", "-")), mark.left + mark.width / 2];
})"""
CURSORS = """(times) => times.map((time) => {
  ospace.seek(time);
  return [...document.querySelectorAll("figure .cursor")].map((one) => one.getBoundingClientRect().left);
})"""


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """Return the report and the log of `ospace run`."""
    folder = tmp_path_factory.mktemp("report")
    file = missions.written(folder, missions.MISSION)
    status = main(
        ["run", str(file), "--headless", "--html", str(folder / "run.html"), "--log", str(folder / "run.npz")]
    )
    assert status == 0
    return folder / "run.html", log.load(folder / "run.npz")


@pytest.fixture
def report(open_page, reported):
    return open_page(reported[0], (700, 500))


def shown(norm, unit):
    """Return an error as people read it."""
    factor, name = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "deg")}.get(unit, (1.0, unit))
    return f"{norm * factor:.2g} {name}"


def test_tables_are_those_of_the_log(report, reported):
    kept = reported[1]
    rows = report.locator("#phase-table tbody tr").evaluate_all(TEXTS)
    expected = []
    for phase in kept.phases:
        for k, (task, errors) in enumerate(phase.errors.items()):
            norms = [
                ", ".join(
                    shown(norm, unit) for norm, unit in zip(row, errors.units, strict=True) if not math.isnan(norm)
                )
                for row in (errors.norms.max(axis=0), errors.norms[-1])
            ]
            begin = [phase.name, f"{phase.start:.3f}", f"{phase.end:.3f}", phase.outcome] if k == 0 else []
            count = sum(phase.statuses.values())
            end = [", ".join(f"{n} {status}" for status, n in phase.statuses.items())] if k == 0 else []
            assert count == len(phase.time)
            expected.append([*begin, task, *norms, *end])
        assert phase.errors
        moved = (phase.base_motion.max(axis=0), phase.base_motion[-1])
        expected.append(["base moved", *(f"{shown(row[0], 'm')}, {shown(row[1], 'rad')}" for row in moved)])
    assert len(rows) == sum(len(phase.errors) + 1 for phase in kept.phases) > 4
    assert rows == expected
    rows = report.locator("#certificate-table tbody tr").evaluate_all(TEXTS)
    assert [row[0] for row in rows] == [one.name for one in kept.certificate.quantities]
    for row, one in zip(rows, kept.certificate.quantities, strict=True):
        assert (row[1], row[2], row[4]) == (f"{one.error:.2e}", f"{one.limit:.0e}", "pass" if one.passed else "fail")
        assert float(row[3].split()[0]) == pytest.approx(one.scale, rel=1e-3)
    assert kept.passed
    assert report.locator(".verdict").inner_text() == "passed"
    assert report.locator("#scenario").text_content().strip() == kept.scenario.strip()
    for name, version in kept.versions.items():
        assert f"{name} {version}" in report.locator("#versions").inner_text()
    assert report.title().startswith(kept.name)


def test_every_series_is_drawn(report, reported):
    curves = series.of(reported[1])
    names = report.locator("figure").evaluate_all("(all) => all.map((one) => one.id)")
    assert names == [f"curve-{name}" for name in curves]
    for name, one in curves.items():
        drawn = report.locator(f"#curve-{name} svg")
        assert drawn.count() == 1
        assert drawn.locator("> title").text_content() == one.title
        assert drawn.locator("> desc").text_content().startswith(one.title)
        lines = report.locator(f"#curve-{name} svg [id*=line2d_] path").evaluate_all(
            "(all) => all.filter((one) => one.getTotalLength() > 30 && one.getBBox().width > 30).length"
        )
        assert lines >= len(one.labels)
        labels = drawn.locator("text").evaluate_all("(all) => all.map((one) => one.textContent)")
        assert one.title in labels
        assert {"reach", "carry"} <= set(labels)
    identities = report.evaluate("[...document.querySelectorAll('[id]')].map((one) => one.id)")
    assert len(identities) == len(set(identities))


def test_cursors_go_by_the_clock(report):
    """The line stands where the axis says that the time is."""
    end = report.evaluate("ospace.duration()")
    times = [0.0, 0.3711 * end, 0.9 * end]
    cursors = np.array(report.evaluate(CURSORS, times)).T
    axes = report.evaluate(f"[...document.querySelectorAll('figure')].map({TICKS})")
    assert len(axes) == len(cursors) > 8
    for ticks, found in zip(axes, cursors, strict=True):
        assert len(ticks) > 2
        slope, offset = np.polyfit(*np.array(ticks).T, 1)
        np.testing.assert_allclose(found, slope * np.array(times) + offset, rtol=0, atol=1.5)  # pixels


def test_a_click_on_a_plot_goes_there(report):
    for name, time in (("curve-torque", 0.2), ("curve-momentum", 0.1)):
        figure = report.locator(f"#{name}")
        figure.scroll_into_view_if_needed()
        ticks = dict(figure.evaluate(TICKS))
        box = figure.bounding_box()
        width = (ticks[0.2] - ticks[0.1]) / 0.1  # pixels a second
        # not by the figure's middle, which the player may cover
        report.mouse.click(ticks[time], box["y"] + 0.3 * box["height"])
        assert report.evaluate("Number(document.getElementById('time').value)") == pytest.approx(time, abs=1.5 / width)
        assert report.locator("#clock").inner_text() == f"{time:.2f} s"


def test_a_phase_s_button_goes_to_its_start(report, reported):
    buttons = report.locator("#phases button")
    phases = reported[1].phases
    assert buttons.all_inner_texts() == [phase.name for phase in phases]
    for k, phase in reversed(list(enumerate(phases))):
        buttons.nth(k).press("Enter")
        assert report.evaluate("Number(document.getElementById('time').value)") == pytest.approx(phase.start, abs=1e-6)


def test_the_report_of_grasp_is_small(open_page, grasped, tmp_path):
    """All of the demonstration in less than 10 MB; it opens, and its hand ends where the run says."""
    file = run_report.save(grasped, tmp_path / "grasp.html")
    assert file.stat().st_size < MOST
    assert not re.search(rb"""(?:src|href)\s*=\s*["']?(?:https?:)?//""", file.read_bytes().split(b"<script>")[0])
    page = open_page(file, drawn=True)
    page.until("() => ospace.viewer.renderer.info.render.triangles > 1000")
    assert page.evaluate("ospace.duration()") == pytest.approx(grasped.duration, abs=1e-6)
    assert page.locator(".verdict").inner_text() == "passed"
    assert page.locator("figure svg").count() == len(series.of(log.of(grasped)))
    last = grasped.segments[-1]
    hand = next(one["path"] for one in page.evaluate("ospace.data.labels") if one["text"] == "right_hand")
    for k, segment in ((0, grasped.segments[0]), (-1, last)):
        robot, trajectory = segment.robot, segment.trajectory
        data = robot.model.createData()
        pin.framesForwardKinematics(robot.model, data, trajectory.q[k])
        wanted = data.oMf[robot.model.getFrameId("right_hand")].homogeneous
        wanted[:3, 3] -= grasped.scenario.start.q[:3]  # the base starts at rest
        found = page.along([hand], [trajectory.time[k]])[0, 0]
        np.testing.assert_allclose(found, wanted, rtol=0, atol=2e-6)

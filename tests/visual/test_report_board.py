"""A report for a review board: whose it is, what it was made of, limits of joints, and the same on paper."""

import hashlib
import re
import shutil

import missions
import numpy as np
import pytest
from lxml import html

import ospace
from ospace import models
from ospace.cli.main import main
from ospace.visual import browser, joint_limits, run_report
from ospace.visual.provenance import Provenance

chromium = pytest.mark.skipif(not any(map(shutil.which, browser.NAMES)), reason="no Chromium")


def rows(text, table):
    tree = html.document_fromstring(text)
    return [
        [" ".join(cell.text_content().split()) for cell in row] for row in tree.xpath(f"//table[@id='{table}']//tr")
    ]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return missions.flown(tmp_path_factory.mktemp("mission"))


def test_a_check_says_whose_it_is_and_what_of(tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    page = tmp_path / "a.html"
    words = [
        "check",
        "planar_2r",
        "--samples",
        "1",
        "--html",
        str(page),
        "--project",
        "<b>SAT</b>",
        "--author",
        "N. N.",
    ]
    assert main(words) == 0
    text = page.read_text(encoding="utf-8")
    about = dict(rows(text, "about-table")[1:])
    assert about == {
        "project": "<b>SAT</b>",
        "author": "N. N.",
        "date": "1970-01-02 00:00 UTC",
        "file": "planar_2r",
        "SHA-256 of the file": hashlib.sha256(models.path("planar_2r").read_bytes()).hexdigest(),
        "command": f"ospace check planar_2r --samples 1 --html {page} --project '<b>SAT</b>' --author 'N. N.'",
    }
    assert "<b>SAT" not in text
    assert rows(text, "limits-table")[1:3] == [
        ["joint_1", "position", "rad", "-2.967", "2.967"],
        ["joint_1", "velocity", "rad/s", "-1", "1"],
    ]


def test_a_run_has_its_joints_beside_their_limits(run):
    shown = {(row.joint, row.kind): row for row in joint_limits.of_run(run)}
    assert {joint for joint, _ in shown} == {"joint_1", "joint_2"}
    q = np.concatenate([segment.trajectory.q[:, 7] for segment in run.segments])
    row = shown["joint_1", "position"]
    assert (row.lower, row.upper, row.least, row.most) == ("-2.967", "2.967", f"{q.min():.4g}", f"{q.max():.4g}")
    margin = 100.0 * min(q.min() + 2.9671, 2.9671 - q.max()) / (2 * 2.9671)
    assert row.margin == f"{margin:.1f} %"
    torque = np.concatenate([segment.trajectory.torque[:, 0] for segment in run.segments])
    assert float(shown["joint_1", "torque"].most) == pytest.approx(torque.max(), rel=1e-3)
    assert rows(run_report.render(run), "limits-table")[1][0] == "joint_1"


def test_without_provenance_there_is_no_such_table(run):
    assert rows(run_report.render(run), "about-table") == []
    about = Provenance("a.toml", "00", project="P")
    assert rows(run_report.render(run, about), "about-table")[1:] == [
        ["project", "P"],
        ["file", "a.toml"],
        ["SHA-256 of the file", "00"],
    ]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["check", "planar_2r", "--project", "P"], "--project is for a report"),
        (["run", "grasp", "--author", "A"], "--author is for a report"),
        (["check", "planar_2r", "--pdf", "a.html"], "does not end in .pdf"),
        (["check", "planar_2r", "target", "--pdf", "a.pdf"], "--pdf writes one file"),
    ],
)
def test_words_for_a_report_that_is_not_made_are_refused(capsys, words, said):
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 2
    assert said in capsys.readouterr().err


def test_without_chromium_a_pdf_is_refused_before_any_work(monkeypatch, capsys):
    monkeypatch.setattr("shutil.which", lambda name: None)
    assert main(["check", "planar_2r", "--pdf", "/tmp/a.pdf"]) == 2
    assert "PDF needs Chromium" in capsys.readouterr().err


@chromium
@pytest.mark.browser
def test_a_pdf_holds_the_report_and_a_picture(tmp_path, capsys):
    file = tmp_path / "a.pdf"
    assert main(["check", "planar_2r", "--samples", "1", "--pdf", str(file), "--project", "SAT"]) == 0
    assert capsys.readouterr().out.endswith(f"wrote {file}\n")
    content = file.read_bytes()
    assert content.startswith(b"%PDF-")
    assert len(re.findall(rb"/Type\s*/Page\b", content)) >= 2
    widths = [int(width) for width in re.findall(rb"/Width (\d+)", content)]
    assert 1400 in widths  # the picture of the scene


def test_reports_of_the_library_need_no_provenance(tmp_path, run):
    assert run_report.save(run, tmp_path / "run.html").is_file()
    assert ospace.scenario.log.of(run).passed == run.passed

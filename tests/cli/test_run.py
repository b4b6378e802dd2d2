"""`ospace run` as its users meet it: table, certificate, exit status, files, Ctrl-C."""

import contextlib
import csv
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import missions
import numpy as np
import pytest

import ospace
from ospace.cli.main import main
from ospace.scenario import log, runner

ROOT = Path(ospace.__file__).parents[1]
SECONDS = 120
LONG = missions.short(wait={"duration": "900 s", "timeout": "1000 s"})


@pytest.fixture(autouse=True, scope="module")
def compiled():
    """What the command says while it compiles kernels is said once for a machine; here it has been said."""
    main(["run", "--check", "grasp"])


@pytest.fixture
def run(capsys):
    def call(*arguments):
        try:
            status = main(["run", *map(str, arguments)])
        except SystemExit as leaving:
            status = leaving.code
        out, err = capsys.readouterr()
        return status, out, but_for_compiling(err)

    return call


def but_for_compiling(err):
    """What a machine says that has no compiled kernels yet is no message about the run."""
    return "".join(line for line in err.splitlines(True) if not line.startswith("ospace: compiling"))


@pytest.fixture
def made(tmp_path):
    return partial(missions.written, tmp_path)


@pytest.mark.parametrize("options", [[], ["--headless"]])
def test_a_run_that_passes(run, made, options):
    file = made()
    status, out, err = run(file, *options)
    assert (status, err) == (0, "")
    assert re.search(r"^wait, a little +0\.000 +0\.050 +complete +5 nominal$", out, re.MULTILINE)
    assert re.search(r"^move +0\.050 +0\.350 +complete +30 nominal\n  tip +\S+ mm +\S+ mm$", out, re.MULTILINE)
    assert len(re.findall(r"^  base moved +\S+ mm, \S+ deg +\S+ mm, \S+ deg$", out, re.MULTILINE)) == 2
    assert "limits of joints exceeded: none" in out
    assert re.search(r"^linear momentum .* pass$", out, re.MULTILINE)
    assert out.splitlines()[-1] == f"passed: {file}: 2 of 2 phases complete, certificate passed"


def test_a_phase_that_times_out(run, made):
    later = missions.phase("later", duration=1, timeout=2)
    text = missions.short(later, tip={"completion": {"position": "1e-30 m"}})
    status, out, _ = run(made(text))
    assert status == 1
    assert "move: not complete after 0.4 s: tip" in out
    assert "not begun: later" in out
    assert re.match(r"failed: .*: 1 of 3 phases complete, certificate passed", out.splitlines()[-1])


def test_a_certificate_that_fails(run, made):
    """A step that is much too long for the motion."""
    far = {"shift": ["-30 cm", "30 cm", 0], "duration": "0.2 s"}
    text = missions.short(control={"step": "10 ms"}, tip={"goal": far})
    status, out, _ = run(made(text))
    assert status == 1
    assert "FAIL" in out
    assert out.splitlines()[-1].endswith("certificate FAILED")


def test_limits_that_bind_are_named(run, made):
    far = {"shift": ["-10 cm", "1 cm", 0], "duration": "0.2 s"}
    text = missions.short(limits={"acceleration": "20 deg/s^2"}, tip={"goal": far})
    _, out, _ = run(made(text))
    assert re.search(r"^move: active limits: .*joint_\d: acceleration, (upper|lower) \(\d+ cycles\)", out, re.MULTILINE)


def test_check_runs_nothing(run, made):
    file = made(LONG)
    status, out, err = run(file, "--check")
    assert (status, err) == (0, "")
    not_rehearsed = "not rehearsed: it may take 1000.4 s, of which 200 s are the most that is rehearsed"
    assert out == f"A short one\nphases: wait, a little, move; at most 1000.4 s\n{not_rehearsed}\nvalid: {file}\n"


@pytest.mark.parametrize("name", ospace.models.scenarios())
def test_scenarios_that_come_with_ospace_are_valid(run, name):
    assert run(name, "--check")[0] == 0


@pytest.mark.parametrize("options", [[], ["--check"]])
def test_a_mistake_in_a_scenario_is_named(run, made, options):
    file = made(missions.SHORT.replace("timeout", "timout"))
    status, out, err = run(file, *options)
    assert (status, out) == (2, "")
    assert "phase[0].timeout: missing; did you mean 'timout'?" in err
    assert f"{file}:" in err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["nothing.toml"], "No such file"),
        (["grsp"], "did you mean 'grasp'?"),
        (["grasp", "--log", "out.csv"], "does not end in .npz"),
        (["grasp", "--log", "/no/such/folder/out.npz"], "no such folder"),
        (["grasp", "--csv", "/dev/null/folder"], "Not a directory"),
        ([], "required: SCENARIO"),
    ],
)
def test_run_refuses_wrong_usage(run, arguments, words):
    status, out, err = run(*arguments)
    assert (status, out) == (2, "")
    assert words in err
    assert "Traceback" not in err


def test_the_files_hold_what_the_table_says(run, made, tmp_path):
    npz, folder = tmp_path / "out.npz", tmp_path / "csv"
    status, out, _ = run(made(), "--log", npz, "--csv", folder)
    assert status == 0
    shown = re.search(r"^move .*\n  tip +(\S+) mm +(\S+) mm", out, re.MULTILINE)
    stored = log.load(npz)
    tip = stored.phases[1].errors["tip"].norms[:, 0] * 1e3
    assert [f"{tip.max():.2g}", f"{tip[-1]:.2g}"] == list(shown.groups())
    assert stored.passed
    with (folder / "phases.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[1][:3] == ["wait, a little", "complete", "0"]
    errors = np.loadtxt(folder / "errors_1_move.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(errors[:, 1] * 1e3, tip)
    np.testing.assert_array_equal(errors[:, 2:], stored.phases[1].base_motion)
    shift, turn = re.findall(r"^  base moved +(\S+) mm, (\S+) deg", out, re.MULTILINE)[1]
    assert shift == f"{1e3 * errors[:, 2].max():.2g}"
    assert turn == f"{np.degrees(errors[:, 3].max()):.2g}"
    q = np.loadtxt(folder / "segment_0" / "q.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(q[:, 1:], stored.segments[0].trajectory.q)
    assert list(tmp_path.glob(".*")) == []


@pytest.fixture
def terminal():
    ours, theirs = pty.openpty()
    yield ours, theirs
    for descriptor in (ours, theirs):
        with contextlib.suppress(OSError):
            os.close(descriptor)


def read_until(terminal, text):
    seen, end = b"", time.monotonic() + SECONDS
    while text not in seen and time.monotonic() < end:
        if select.select([terminal], [], [], 0.1)[0]:
            try:
                more = os.read(terminal, 4096)
            except OSError:
                break
            if not more:
                break
            seen += more
    return seen


def test_ctrl_c_keeps_what_was_run(made, terminal, tmp_path):
    ours, theirs = terminal
    npz = tmp_path / "out.npz"
    process = subprocess.Popen(
        [sys.executable, "-m", "ospace.cli", "run", made(LONG), "--log", npz],
        cwd=ROOT,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=theirs,
    )
    os.close(theirs)
    seen = read_until(ours, b"simulating")
    assert b"simulating" in seen
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    seen += read_until(ours, b"no such text")
    out, _ = process.communicate(timeout=SECONDS)
    assert process.returncode == 130
    assert b"Traceback" not in seen + out
    assert seen.endswith(b"ospace: interrupted\r\n")
    stored = log.load(npz)
    assert [phase.outcome for phase in stored.phases] == ["interrupted"]
    assert len(stored.segments[0].trajectory) > 1
    lines = out.decode().splitlines()
    assert re.match(r"interrupted: .*: 0 of 2 phases complete", lines[-1])
    assert f"{stored.phases[0].end:.3f}  interrupted" in out.decode()


# -- nothing is lost ---------------------------------------------------------------------------------------------


def test_log_and_table_outlive_a_report_that_cannot_be_written(run, made, tmp_path):
    file, npz = made(), tmp_path / "out.npz"
    status, out, err = run(file, "--log", npz, "--html", "/dev/full")
    assert status == 2
    assert out.splitlines()[-1].startswith("passed: ")
    assert err == "ospace: error: /dev/full: no report: No space left on device\n"
    assert log.load(npz).passed


def test_table_and_report_outlive_a_log_that_cannot_be_written(run, made, tmp_path):
    file, npz, html = made(), tmp_path / "out.npz", tmp_path / "out.html"
    npz.symlink_to("/dev/full")
    status, out, err = run(file, "--log", npz, "--csv", tmp_path / "csv", "--html", html)
    assert status == 2
    assert out.splitlines()[-1].startswith("passed: ")
    assert err == f"ospace: error: {npz}: no log: No space left on device\n"
    assert html.stat().st_size > 100_000
    assert (tmp_path / "csv" / "phases.csv").exists()


def test_log_and_table_outlive_ctrl_c_while_the_report_is_drawn(run, made, tmp_path, monkeypatch):
    def interrupted(run, about):
        raise KeyboardInterrupt

    monkeypatch.setattr("ospace.visual.run_report.render", interrupted)
    file, npz = made(), tmp_path / "out.npz"
    status, out, err = run(file, "--log", npz, "--html", tmp_path / "out.html")
    assert (status, err) == (130, "ospace: interrupted\n")
    assert out.splitlines()[-1].startswith("passed: ")
    assert log.load(npz).passed
    assert sorted(one.name for one in tmp_path.iterdir()) == ["made.toml", "out.npz"]


@pytest.fixture
def interrupt_after(monkeypatch):
    """End a run by Ctrl-C after some steps."""

    def call(steps):
        done = 0

        def stepped(self, time):
            nonlocal done
            done += 1
            if done > steps:
                os.kill(os.getpid(), signal.SIGINT)
            return honest(self, time)

        honest = runner._PhaseSequencer.stepped
        monkeypatch.setattr(runner._PhaseSequencer, "stepped", stepped)

    return call


@pytest.mark.parametrize("text", [missions.SHORT, missions.MISSION], ids=["alone", "with a target"])
def test_ctrl_c_before_the_first_step(run, made, tmp_path, interrupt_after, text):
    interrupt_after(0)
    html, npz = tmp_path / "out.html", tmp_path / "out.npz"
    status, out, err = run(made(text), "--log", npz, "--html", html)
    assert status == 130
    assert out.splitlines()[-1].startswith("interrupted: ")
    told = f"ospace: error: {html}: no report: the run ended before its first step: nothing has moved\n"
    assert err == f"{told}ospace: interrupted\n"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["made.toml", "out.npz"]
    assert log.load(npz).interrupted


@pytest.mark.parametrize("steps", [1, 3])
def test_ctrl_c_after_a_step_or_three(run, made, tmp_path, interrupt_after, steps):
    """A target then has one record, or two."""
    interrupt_after(steps)
    status, out, err = run(made(missions.MISSION), "--html", tmp_path / "out.html")
    assert (status, err) == (130, "ospace: interrupted\n")
    assert out.splitlines()[-1].startswith("interrupted: ")
    assert (tmp_path / "out.html").stat().st_size > 100_000


@pytest.mark.parametrize("options", [["--html", "made.toml"], ["--csv", "made.toml"], ["--log", "link.npz"]])
def test_a_scenario_is_not_overwritten(run, made, tmp_path, monkeypatch, options):
    monkeypatch.chdir(tmp_path)
    file = made()
    (tmp_path / "link.npz").symlink_to(file)
    status, out, err = run("made.toml", *options)
    assert (status, out) == (2, "")
    assert err == f"ospace: error: {options[1]}: is what is read, made.toml; give another file\n"
    assert file.read_text() == missions.SHORT


def test_a_file_is_not_written_twice(run, made, tmp_path):
    npz = tmp_path / "x.npz"
    status, out, err = run(made(), "--log", npz, "--html", npz)
    assert (status, out) == (2, "")
    assert err == f"ospace: error: {npz}: is to be written twice, as {npz} too; give another file\n"
    assert not npz.exists()


def test_run_in_a_process_of_its_own_prints_no_colour(made):
    done = subprocess.run(
        [sys.executable, "-W", "error", "-m", "ospace.cli", "run", made()],
        cwd=ROOT, capture_output=True, text=True, timeout=SECONDS, check=False,
    )  # fmt: skip
    assert (done.returncode, but_for_compiling(done.stderr)) == (0, "")
    assert done.stdout.splitlines()[-1].startswith("passed: ")
    assert "\x1b[" not in done.stdout


def test_a_start_outside_limits_is_told_by_check_and_by_the_run(run, made):
    """planar_2r turns by at most 170 deg."""
    file = made(missions.short(robot={"model": "planar_2r", "joints": {"joint_2": "200 deg"}}))
    status, out, _ = run(file, "--check")
    assert status == 0
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    excess = np.radians(200.0) - robot.model.upperPositionLimit[8]
    assert excess > 0.0
    told = f"by {excess:.3g} rad ({np.degrees(excess):.3g} deg)"
    assert f"robot starts outside limits of joints: 'joint_2' {told}\n" in out
    _, out, _ = run(file, "--headless")
    assert f"limits of joints exceeded: joint_2: position {told} at 0 s" in out.replace("\n", " ")
    assert "outside limits" not in run(made(), "--check")[1]

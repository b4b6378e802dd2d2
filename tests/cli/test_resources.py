"""What a command says, in one line, where streams, disk or memory give out, and where settings of others are broken."""

import os
import subprocess
import sys
from pathlib import Path

import missions
import pytest

import ospace
from ospace.cli.main import main
from ospace.scenario import log
from ospace.urdf import build

ROOT = Path(ospace.__file__).parents[1]
WRONG = {
    "no robot": ("check", "nosuch"),
    "no scenario": ("run", "nosuch.toml"),
    "a remark and a page": ("view", "planar_2r", "--pose", "joint_1=99", "--html", "page.html"),
}


def shell(folder, line, **settings):
    """Run a line of the shell in which $OSPACE is the command."""
    environment = os.environ | {"OSPACE": f"{sys.executable} -m ospace.cli", "PYTHONPATH": str(ROOT)} | settings
    return subprocess.run(
        ["sh", "-c", line], cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False
    )


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    return log.save(missions.flown(folder), folder / "log.npz")


@pytest.mark.parametrize("stream", ["2>/dev/full", "2>&-"])
@pytest.mark.parametrize(("what", "status"), [("no robot", 2), ("no scenario", 2), ("a remark and a page", 0)])
def test_the_exit_status_holds_where_nobody_can_be_told(tmp_path, stream, what, status):
    done = shell(tmp_path, f"$OSPACE {' '.join(WRONG[what])} {stream}")
    assert (done.returncode, done.stderr) == (status, "")
    assert "rror" not in done.stdout
    assert "warning" not in done.stdout


@pytest.mark.parametrize("megabytes", [250])  # with more, libraries print their own
def test_too_little_memory_is_one_line(tmp_path, megabytes):
    done = shell(tmp_path, f"ulimit -v {megabytes}000; $OSPACE check planar_2r --samples 1")
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "ospace: error: not enough memory\n")


def test_a_robot_is_not_rejected_for_lack_of_memory(monkeypatch, capsys):
    monkeypatch.setattr(build.ThreadPoolExecutor, "submit", no_thread)
    assert main(["check", "planar_2r"]) == 2
    assert capsys.readouterr() == ("", "ospace: error: not enough memory\n")


def no_thread(pool, call):
    raise RuntimeError("can't start new thread")


def test_plots_do_not_depend_on_which_windows_matplotlib_would_open(tmp_path, logged):
    done = shell(tmp_path, f"$OSPACE plot {logged} --out a.svg", MPLBACKEND="nosuch")
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "a.svg").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("written", "half_kilobytes"),
    [
        ("plot {log} --out a.svg", 20),
        ("plot {log} --out a.pdf", 4),  # Matplotlib fails otherwise at the end than while it writes
        ("plot {log} --out a.pdf", 20),
        ("view planar_2r --html a.html", 20),
    ],
)
def test_a_full_disk_is_one_line_that_names_the_file(tmp_path, logged, written, half_kilobytes):
    before = tmp_path / written.split()[-1]
    before.write_text("before")
    done = shell(tmp_path, f"ulimit -f {half_kilobytes}; $OSPACE {written.format(log=logged)}")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("ospace: error: ")
    assert done.stderr.endswith(f"{before.name}: File too large\n")
    assert done.stderr.count("\n") == 1
    assert before.read_text() == "before"
    assert [file.name for file in tmp_path.iterdir()] == [before.name]

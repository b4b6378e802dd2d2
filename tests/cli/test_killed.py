"""Commands that are killed while they write, or write one file at once: what was there stays, or all is there."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import missions
import pytest

import ospace
from ospace.scenario import log

ROOT = Path(ospace.__file__).parents[1]
KILLED = """
import os, signal, sys
from pathlib import Path
out = os.path.realpath(sys.argv.pop(1))
real = os.replace

def replace(part, file):
    if os.path.realpath(file) == out:
        with open(part, "r+b") as written:
            written.truncate(int(os.path.getsize(part) * 0.5))  # no more of it had been written
        os.kill(os.getpid(), signal.SIGKILL)
    real(part, file)

os.replace = replace
from ospace.cli.main import main
main(sys.argv[1:])
"""
WRITERS = {
    "a.svg": "plot log.npz --out a.svg",
    "a.png": "plot log.npz --out a.png",
    "a.pdf": "plot log.npz --out a.pdf",
    "a.html": "view planar_2r --html a.html",
    "check.html": "check planar_2r --samples 1 --html check.html",
    "fixed.urdf": "check faulty.urdf --samples 1 --fix fixed.urdf",
    "made.urdf": "compose box:1x1x0.8m,250kg planar_2r --prefix a_ --out made.urdf",
    "b.npz": "run made.toml --headless --log b.npz",
    "run.html": "run made.toml --headless --html run.html",
    "csv/phases.csv": "run made.toml --headless --csv csv",
}
NEW = "fixed.urdf"  # is never written over


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("inputs")
    log.save(missions.flown(folder, missions.short()), folder / "log.npz")
    text = ospace.models.path("planar_2r").read_text()
    (folder / "faulty.urdf").write_text(text.replace('xyz="0 0 1"', 'xyz="0 0 2"', 1))
    return folder


@pytest.fixture
def folder(inputs, tmp_path):
    """A folder with the inputs, and something under the name of each output."""
    for file in inputs.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    (tmp_path / "csv").mkdir()
    for name in WRITERS:
        if name != NEW:
            (tmp_path / name).write_text("before")
    return tmp_path


def started(folder, *arguments):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        [sys.executable, *arguments], cwd=folder, env=environment,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no kill -9 here")
@pytest.mark.parametrize("name", WRITERS)
def test_what_was_there_stays_where_a_command_is_killed(folder, name):
    process = started(folder, "-c", KILLED, name, *WRITERS[name].split())
    _, said = process.communicate(timeout=120)
    assert process.returncode == -signal.SIGKILL, said
    assert (folder / name).exists() == (name != NEW)
    if name != NEW:
        assert (folder / name).read_text() == "before"
    left = [file.name for file in (folder / name).parent.iterdir() if file.name.startswith(".")]
    assert [one.startswith(".ospace-") for one in left] == [True]


@pytest.mark.parametrize("name", ["a.pdf", "a.html", "made.urdf", "b.npz"])
def test_each_of_two_that_write_at_once_succeeds(folder, name):
    ways = [started(folder, "-m", "ospace.cli", *WRITERS[name].split()) for _ in range(2)]
    said = [process.communicate(timeout=120) for process in ways]
    assert [process.returncode for process in ways] == [0, 0], said
    assert (folder / name).stat().st_size > 1000
    assert not [file.name for file in folder.iterdir() if file.name.startswith(".")]

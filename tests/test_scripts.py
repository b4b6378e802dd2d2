"""Every example runs, and says something."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
WITHOUT_WINDOWS = {name: value for name, value in os.environ.items() if not name.endswith("DISPLAY")} | {
    "MPLBACKEND": "agg"
}
SCRIPTS = sorted([*(ROOT / "scripts").glob("*.py"), *(ROOT / "examples").glob("*.py")])


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_every_script_runs(script):
    done = subprocess.run(
        [sys.executable, "-W", "error", script],
        capture_output=True,
        text=True,
        env=WITHOUT_WINDOWS,
        timeout=300,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert len(done.stdout.splitlines()) > 3


def words_of(name):
    script = next(script for script in SCRIPTS if script.stem == name)
    return subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300, check=True).stdout


def test_the_hand_stops_at_the_plane_though_its_goal_is_beyond():
    (closest,) = re.findall(r"closest to the plane: (\S+) mm", words_of("keep_out_plane"))
    assert abs(float(closest)) < 1e-2


def test_the_camera_keeps_the_hand_in_view_by_its_inequality_alone():
    without, kept = (float(angle) for angle in re.findall(r"up to (\S+) deg", words_of("camera_view")))
    assert without > 10.0
    assert kept < 5.01  # asked for: 5 deg


def test_the_own_solver_finds_what_daqp_does():
    words = words_of("own_solver")
    calls, hits = (int(count) for count in re.findall(r"programs: (\d+), of which (\d+)", words)[0])
    assert calls / 2 < hits < calls
    assert float(re.findall(r"from DAQP: (\S+)", words)[0]) < 1e-9


def test_the_published_singularity_is_among_those_found():
    script = next(script for script in SCRIPTS if script.stem == "dynamic_singularities")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300, check=True)
    found = {row.split()[0]: [float(word) for word in row.split()[1:]] for row in done.stdout.splitlines()[1:]}
    assert any(abs(angle + 11.41) < 0.01 for angle in found["-65"])


def test_the_grasp_of_the_library_example():
    script = next(script for script in SCRIPTS if script.stem == "grasp")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300, check=True)
    distance, angle = (float(word) for word in re.findall(r"hand off by (\S+) mm, (\S+) deg", done.stdout)[0])
    assert distance < 0.01  # asked for: 1 mm, 0.1 deg
    assert angle < 1e-3
    assert "FAIL" not in done.stdout
    assert sum(bool(line.strip()) for line in script.read_text().splitlines()) < 30

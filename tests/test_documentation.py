"""README and docs: every block of code runs, and prints what the page says."""

import contextlib
import io
import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from pages_of_docs import blocks_of, commands_of, differs
from robots.mujoco_robot import example_robot

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FILES = {"ur5_robot.urdf": "ur_description/urdf/ur5_robot.urdf", "romeo.urdf": "romeo_description/urdf/romeo.urdf"}
FILES |= {"talos_full_v2.urdf": "talos_data/robots/talos_full_v2.urdf"}


def shell(command):
    """Run a command as a shell does; without colours, in 80 columns. What measures takes less time than it would."""
    words = shlex.split(command)
    assert words[0] == "ospace", command
    if words[1] == "bench":
        words += ["--seconds", "0.05"]
    done = subprocess.run(
        [sys.executable, "-m", "ospace.cli", *words[1:]],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        env={**os.environ, "NO_COLOR": "1", "COLUMNS": "80"},
        timeout=300,
        check=False,
    )
    assert "Traceback" not in done.stderr, done.stderr
    return done.stdout + "".join(line for line in done.stderr.splitlines(True) if "compiling" not in line)


@pytest.mark.parametrize("page", [page for page in PAGES if list(blocks_of(page))], ids=lambda page: page.stem)
def test_a_page_says_what_is_so(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("models").symlink_to(ROOT / "models")
    for name, place in FILES.items():
        if name in page.read_text() and example_robot(place).is_file():
            shutil.copy(example_robot(place), name)
    names, printed = {"__name__": "page"}, ""
    for block in blocks_of(page):
        where = f"{page.name}, line {block.line}"
        if block.file:
            Path(block.file).parent.mkdir(parents=True, exist_ok=True)
            Path(block.file).write_text(block.code)
        if block.language == "python":
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                exec(compile("\n" * block.line + block.code, page.name, "exec"), names)
            printed = out.getvalue()
        elif block.language == "text" and block.code.startswith("$ "):
            for command, page_has in commands_of(block):
                difference = differs(shell(command), page_has, measured=block.measured)
                assert not difference, f"{where}: {command}: {difference}"
        elif block.language == "text" and not block.file:
            difference = differs(printed, block.code, measured=block.measured)
            assert not difference, f"{where}: {difference}"
    plt = sys.modules.get("matplotlib.pyplot")
    if plt:
        plt.close("all")


@pytest.mark.parametrize(
    ("printed", "page", "same"),
    [
        ("a 1.00 b", "a   1.01 b", True),
        ("a 1.0 b", "a 1.1 b", False),
        ("off by 3e-15", "off by 9.9e-12", True),
        ("off by 3e-15", "off by 2e-3", False),
        ("off by 2e-5", "off by 8e-5", True),
        ("off by 2e-5", "off by 8e-7", False),
        ("a\nb\nc", "a\n…\nc", True),
        ("a\nb\nc", "a\nc", False),
        ("a\nb", "a", False),
        ("a\nb", "a\n…", True),
        ("19.7 s in 4.2 s", "19.7 s in … s", True),
        ("a", "b", False),
    ],
)
def test_what_is_printed_is_compared_with_the_page(printed, page, same):
    assert (not differs(printed, page)) == same


def test_measured_figures_may_be_any_but_words_may_not():
    assert not differs("median 3 µs", "median 140 µs", measured=True)
    assert differs("mean 3 µs", "median 140 µs", measured=True)

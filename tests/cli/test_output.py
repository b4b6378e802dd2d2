"""Where a verb may write, and what it says where it cannot."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import ospace
from ospace import OspaceError
from ospace.cli import output

ROOT = Path(ospace.__file__).parents[1]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("in.urdf").write_text("input")
    Path("link.html").symlink_to("in.urdf")
    os.link("in.urdf", "other.html")
    Path("sub").mkdir()
    Path("nowhere.html").symlink_to("new.html")
    return tmp_path


@pytest.mark.parametrize("out", ["in.urdf", "./in.urdf", "sub/../in.urdf", "link.html", "other.html"])
def test_an_output_is_no_input(folder, out):
    with pytest.raises(OspaceError, match=r"is what is read, in\.urdf; give another file") as refused:
        output.distinct([Path("in.urdf")], [None, Path(out)])
    assert str(refused.value).startswith(str(Path(out)))


@pytest.mark.parametrize("pair", [("a.png", "a.png"), ("a.png", "sub/../a.png"), ("new.html", "nowhere.html")])
def test_outputs_are_not_each_other(folder, pair):
    first, second = map(Path, pair)
    with pytest.raises(OspaceError, match="to be written twice") as refused:
        output.distinct([], [first, None, second])
    assert str(refused.value).startswith(str(second))
    assert str(first) in str(refused.value)


def test_distinct_files_are_accepted(folder):
    files = [Path("a.html"), Path("a.png"), Path("sub"), Path("sub/a.html"), Path("/dev/null")]
    output.distinct([Path("in.urdf"), Path("/dev/null"), Path("missing.toml")], files)
    output.distinct([], [Path("/dev/null"), Path("/dev/null")])


@pytest.mark.parametrize("name", ["/dev/stdout", "/proc/self/fd/1"])
@pytest.mark.parametrize("into", ["pipe", "file"])
def test_standard_output_holds_the_result_alone(tmp_path, name, into):
    command = [sys.executable, "-m", "ospace.cli", "view", "planar_2r", "--html", name]
    with (tmp_path / "out").open("wb") as file:
        done = subprocess.run(
            command, cwd=ROOT, stdout=subprocess.PIPE if into == "pipe" else file, stderr=subprocess.PIPE, text=True,
            timeout=60, check=False,
        )  # fmt: skip
    assert (done.returncode, done.stdout or "") == (2, "")
    assert done.stderr == f"ospace: error: {name}: is standard output, where the result is printed; give another file\n"
    assert (tmp_path / "out").read_bytes() == b""


def test_asking_whether_files_are_writable_leaves_them_as_they_are(folder):
    before = sorted(file.name for file in folder.iterdir())
    output.writable(Path("in.urdf"), None, Path("a.html"), Path("nowhere.html"), Path("/dev/full"))
    assert sorted(file.name for file in folder.iterdir()) == before
    assert Path("in.urdf").read_text() == "input"
    assert Path("nowhere.html").is_symlink()


@pytest.mark.parametrize("name", ["missing/a.html", "in.urdf/a.html", "sub"])
def test_an_unwritable_output_is_refused(folder, name):
    with pytest.raises(OSError, match=name):
        output.writable(Path(name))


@pytest.mark.parametrize(
    ("error", "reason"),
    [(OSError(28, "No space left on device"), "No space left on device"), (OspaceError("it is"), "it is"),
     (OSError("odd"), "odd")],
)  # fmt: skip
def test_an_output_that_cannot_be_written_is_reported(capsys, error, reason):
    def fail():
        raise error

    assert not output.written(Path("a.html"), "report", fail)
    assert capsys.readouterr() == ("", f"ospace: error: a.html: no report: {reason}\n")
    assert output.written(Path("a.html"), "report", lambda: None)
    assert capsys.readouterr() == ("", "")

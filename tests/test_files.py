"""A file appears when it is whole; until then, and where that fails, what was there stays."""

import os
import threading
from pathlib import Path

import pytest

from ospace.files import replacing


def write(path, text="after"):
    with replacing(path) as part:
        part.write_text(text)


def names(folder):
    return sorted(file.name for file in folder.iterdir())


@pytest.mark.parametrize("before", [None, "before"])
def test_a_file_appears_when_it_is_whole(tmp_path, before):
    file = tmp_path / "a.html"
    if before:
        file.write_text(before)
    with replacing(str(file)) as part:
        part.write_text("after")
        assert (part.parent, part.suffix) == (tmp_path, ".html")
        assert (file.read_text() if file.exists() else None) == before
    assert file.read_text() == "after"
    assert names(tmp_path) == ["a.html"]


@pytest.mark.parametrize("error", [OSError, KeyboardInterrupt])
@pytest.mark.parametrize("before", [None, "before"])
def test_a_write_that_fails_half_way_changes_nothing(tmp_path, before, error):
    file = tmp_path / "a.html"
    if before:
        file.write_text(before)

    def fail():
        with replacing(file) as part:
            part.write_text("half")
            raise error

    with pytest.raises(error):
        fail()
    assert names(tmp_path) == (["a.html"] if before else [])
    assert (file.read_text() if file.exists() else None) == before


@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_a_link(tmp_path, there):
    file, link = tmp_path / "real.txt", tmp_path / "link.html"
    if there:
        file.write_text("before")
    link.symlink_to("real.txt")
    write(link)
    assert link.is_symlink()
    assert file.read_text() == "after"
    assert names(tmp_path) == ["link.html", "real.txt"]


def test_the_rights_of_a_file_stay(tmp_path):
    file = tmp_path / "a.html"
    file.write_text("before")
    file.chmod(0o640)
    write(file)
    assert file.stat().st_mode & 0o777 == 0o640


def test_devices_are_written_themselves():
    with replacing("/dev/null") as part:
        assert part == Path("/dev/null")
    with pytest.raises(OSError, match="No space left"):
        write("/dev/full")
    assert not Path("/dev/full").is_file()


def test_a_pipe_is_written_itself(tmp_path):
    pipe, read = tmp_path / "pipe", []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write(pipe)
    reader.join(timeout=10.0)
    assert read == ["after"]
    assert names(tmp_path) == ["pipe"]


def test_in_a_folder_that_takes_no_other_a_file_is_written_itself(tmp_path, monkeypatch):
    file = tmp_path / "a.html"
    file.write_text("before")
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with replacing(file) as part:
        assert part == file

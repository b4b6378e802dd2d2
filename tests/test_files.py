"""A file appears when it is whole; until then, and where that fails, what was there stays."""

import errno
import os
import secrets
import threading
from pathlib import Path

import pytest

from ospace.files import check_writable, replacing


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


def test_several_that_write_one_file_each_have_a_part_of_their_own(tmp_path):
    file = tmp_path / "a.html"
    with replacing(file) as first:
        with replacing(file) as second:
            first.write_text("first")
            second.write_text("second")
        assert file.read_text() == "second"
    assert file.read_text() == "first"
    assert names(tmp_path) == ["a.html"]


def test_a_link_planted_under_the_name_of_a_part_is_not_followed(tmp_path, monkeypatch):
    victim = tmp_path / "victim.txt"
    victim.write_text("precious")
    monkeypatch.setattr(secrets, "token_hex", lambda size: "known")
    with replacing(tmp_path / "a.html") as part:
        planted = part.name
    (tmp_path / planted).symlink_to("victim.txt")
    with pytest.raises(FileExistsError, match=r"a\.html"):
        write(tmp_path / "a.html")
    assert victim.read_text() == "precious"


def test_a_new_file_has_the_rights_that_others_get(tmp_path):
    write(tmp_path / "a.html")
    (tmp_path / "plain.txt").write_text("")
    assert (tmp_path / "a.html").stat().st_mode == (tmp_path / "plain.txt").stat().st_mode


@pytest.mark.parametrize("name", ["n" * 250 + ".html", "a." + "n" * 253, "é" * 127])
def test_a_name_may_be_as_long_as_the_file_system_takes(tmp_path, name):
    check_writable(tmp_path / name)
    write(tmp_path / name)
    assert names(tmp_path) == [name]


@pytest.mark.parametrize("file", ["missing/a.html", "n" * 256])
@pytest.mark.parametrize("act", [write, check_writable])
def test_where_nothing_can_be_written_the_error_names_the_file(tmp_path, file, act):
    with pytest.raises(OSError) as refused:  # noqa: PT011
        act(tmp_path / file)
    assert refused.value.filename == str(tmp_path / file)
    assert refused.value.filename2 is None
    assert names(tmp_path) == []


def test_where_the_disk_is_full_the_error_names_the_file(tmp_path):
    def fail():
        with replacing(tmp_path / "a.html"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(OSError, match=r"No space left on device: '[^']*a\.html'$"):
        fail()


def test_an_error_about_another_file_still_names_that(tmp_path):
    def fail():
        with replacing(tmp_path / "a.html"):
            (tmp_path / "mesh.stl").read_bytes()

    with pytest.raises(FileNotFoundError, match=r"mesh\.stl"):
        fail()


def test_whether_a_file_can_be_written_is_asked_without_touching_what_others_write(tmp_path, monkeypatch):
    """Another process may put its result there between any two steps."""
    file, real = tmp_path / "a.html", os.unlink

    def late(path, **more):
        file.write_text("of another")
        real(path, **more)

    monkeypatch.setattr(os, "unlink", late)
    check_writable(file)
    assert file.read_text() == "of another"

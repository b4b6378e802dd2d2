"""Errors speak the language of who called: arguments in Python, options in the shell; and files are named."""

import errno

import pytest

import ospace
from ospace import models
from ospace.cli import os_errors
from ospace.cli.dialect import shell
from ospace.cli.main import main

MESH = '<visual><geometry><mesh filename="package://no_such/a.stl"/></geometry></visual></link>'


@pytest.mark.parametrize(
    ("python", "option"),
    [
        ("at most 5 are read (limits=Limits(bytes=N))", "at most 5 are read (--max-bytes N)"),
        ("give package_dirs=[DIR] or root='base'", "give --package-dir DIR or --root 'base'"),
        ("read it with free_mimic=True", "read it with --free-mimic"),
        ("such as prefix='two_'", "such as --prefix two_"),
        ("is_root='base' of myLimits(a=N)", "is_root='base' of myLimits(a=N)"),
    ],
)
def test_arguments_become_options(python, option):
    assert shell(python) == option


def test_an_error_is_in_the_language_of_its_caller(capsys):
    file = models.path("planar_2r")
    with pytest.raises(ospace.UrdfError, match=r"limits=Limits\(bytes=N\)") as caught:
        ospace.SpaceRobot.from_urdf(file, limits=ospace.Limits(bytes=100))
    assert "--max" not in str(caught.value)
    assert main(["check", str(file), "--max-bytes", "100"]) == 2
    said = capsys.readouterr().err
    assert "--max-bytes N" in said
    assert "Limits(" not in said


def test_a_finding_is_in_the_language_of_its_caller(tmp_path, capsys):
    file = tmp_path / "r.urdf"
    file.write_text(models.path("planar_2r").read_text().replace("</link>", MESH, 1))
    folder = tmp_path / "empty"
    folder.mkdir()
    findings = ospace.SpaceRobot.from_urdf(file, [folder]).findings
    assert any("package_dirs=[DIR]" in one.remedy for one in findings)
    main(["check", str(file), "--samples", "1", "--package-dir", str(folder)])
    said = capsys.readouterr().out
    assert "--package-dir DIR" in said
    assert "package_dirs" not in said


def test_no_error_of_the_system_shows_its_number():
    for number in (errno.ENOENT, errno.EROFS, errno.ENOSPC, errno.EACCES, errno.EIO):
        said = os_errors.text(OSError(number, "It is so", "a.urdf"))
        assert said.startswith("a.urdf: It is so")
        assert "Errno" not in said
    assert os_errors.text(OSError(errno.EROFS, "It is so", "a")).endswith("; choose a folder that can be written")
    assert os_errors.text(OSError("plain")) == "plain"


def test_a_file_that_cannot_be_written_is_named_with_a_remedy(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert main(["run", "grasp", "--csv", str(tmp_path / "file" / "sub")]) == 2
    said = capsys.readouterr().err
    assert "Errno" not in said
    assert f"{tmp_path / 'file'}" in said

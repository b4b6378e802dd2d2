"""A terminal obeys nothing of what names hold, of robots, files or arguments: all that is printed can be shown."""

import os
from contextlib import suppress

import missions
import pytest

import ospace
from ospace.cli.main import main

ODD = "o\x1b[2J\x9b\u202e"
LETTERS = "n\u202e\u2028\x9b"  # that XML can hold


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of an odd name, with a robot, and a scenario, that have odd names."""
    made = tmp_path / ODD
    made.mkdir()
    monkeypatch.chdir(made)
    text = ospace.models.path("planar_2r").read_text().replace("joint_1", LETTERS).replace("planar_2r", LETTERS)
    (made / f"{ODD}.urdf").write_text(text)
    (made / "faulty.urdf").write_text(text.replace('xyz="0 0 1"', 'xyz="0 0 2"'))
    title = LETTERS.replace("\x9b", "")
    (made / "odd.toml").write_text(missions.short().replace('"move"', f'"{title}"').replace("A short one", title))
    os.symlink("odd.toml", f"{ODD}.toml")
    return made


SAID = {
    "a sound robot": ("check", f"{ODD}.urdf", "--samples", "1"),
    "a robot of another name": ("check", ODD),
    "a point": ("check", f"{ODD}.urdf", "--point", ODD),
    "a repair": ("check", "faulty.urdf", "--samples", "1", "--fix", "fixed{}.urdf"),
    "no repair": ("check", f"{ODD}.urdf", "--fix", "fixed{}.urdf"),
    "a page": ("view", f"{ODD}.urdf", "--html", "page{}.html"),
    "a pose": ("view", f"{ODD}.urdf", "--html", "page{}.html", "--pose", f"{LETTERS}=99"),
    "a scenario": ("run", f"{ODD}.toml", "--check"),
    "a plugin": ("run", "odd.toml", "--plugin", ODD),
    "no scenario": ("run", f"no{ODD}.toml"),
    "no log": ("plot", f"no{ODD}.npz"),
    "no quantity": ("plot", "no.npz", "--quantity", ODD),
    "a verb": (ODD,),
    "a number": ("check", "planar_2r", "--samples", ODD),
    "an output": ("plot", "no.npz", "--out", ODD),
    "a kind": ("list", ODD),
    "an option": ("map", "planar_2r", f"--{ODD}"),
    "a folder of packages": ("check", f"{ODD}.urdf", "--package-dir", ODD),
    "parts": ("compose", f"{ODD}.urdf", "planar_2r", "--prefix", "b_", "--out", "made{}.urdf"),
    "a prefix": ("compose", "planar_2r", "planar_2r", "--prefix", ODD, "--out", "made{}.urdf"),
}


@pytest.mark.parametrize("what", SAID)
def test_all_that_is_printed_can_be_shown(folder, capsys, what):
    arguments = [one.replace("{}", ODD) for one in SAID[what]]
    with suppress(SystemExit):
        main(arguments)
    printed = capsys.readouterr()
    lines = (printed.out + printed.err).split("\n")
    assert len(lines) > 1
    assert [line for line in lines if not line.isprintable()] == []

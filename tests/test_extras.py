"""The command that a message gives for a package that is missing: it installs from where this ospace comes."""

import json
from importlib import metadata
from types import SimpleNamespace

import pytest

import ospace
from ospace import extras


def test_a_checkout_is_installed_as_one():
    assert extras.install_command("visual") == "pip install -e '.[visual]'"


@pytest.mark.parametrize(
    ("origin", "command"),
    [
        (None, "pip install 'ospace[mujoco]'"),
        ({"url": "file:///home/a/ospace", "dir_info": {}}, "pip install '/home/a/ospace[mujoco]'"),
        ({"url": "file:///tmp/ospace-0.1.0.whl", "archive_info": {}}, "pip install '/tmp/ospace-0.1.0.whl[mujoco]'"),
        (
            {"url": "https://example.org/ospace.git", "vcs_info": {"vcs": "git", "commit_id": "0"}},
            "pip install 'ospace[mujoco] @ git+https://example.org/ospace.git'",
        ),
    ],
)
def test_an_installed_ospace_is_installed_as_it_was(monkeypatch, tmp_path, origin, command):
    monkeypatch.setattr(extras, "__file__", str(tmp_path / "ospace" / "extras.py"))
    text = None if origin is None else json.dumps(origin)
    monkeypatch.setattr(metadata, "distribution", lambda name: SimpleNamespace(read_text=lambda file: text))
    assert extras.install_command("mujoco") == command


def test_what_is_missing_is_refused_by_its_title_and_extra(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(ospace.OspaceError, match=r"^a loop needs MuJoCo: pip install -e '\.\[mujoco\]'$"):
        extras.require("mujoco", "a loop")

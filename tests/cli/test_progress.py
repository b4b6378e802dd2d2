"""The progress bar counts the kernels that are compiled, on terminals; in a pipe it says once that some are."""

import argparse

import pytest
from rich.cells import cell_len
from rich.text import Text

from ospace.cli import progress
from ospace.kernels.jit import cache


@pytest.fixture
def given():
    return argparse.Namespace(refuse_if_interrupted=lambda: None)


def test_a_terminal_shows_which_kernel_of_how_many_in_80_columns(given, monkeypatch, capsys):
    for name, value in {"FORCE_COLOR": "1", "TERM": "xterm", "COLUMNS": "80"}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.delenv("NO_COLOR", raising=False)
    with progress.bar(given, "comparing states", 100) as advance:
        for number in range(1, 6):
            cache.report(number, 5)
        cache.report(0, 0)
        advance(100)
    lines = Text.from_ansi(capsys.readouterr().err.replace("\r", "\n")).plain.split("\n")
    for number in range(1, 6):
        assert any(f"compiling {number} of 5 kernels" in line for line in lines)
    assert max(map(cell_len, lines)) <= 80


def test_a_pipe_says_it_once(given, monkeypatch, capsys):
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    with progress.bar(given, "comparing states", 2):
        for number in (1, 2):
            cache.report(number, 2)
        cache.report(0, 0)
    assert capsys.readouterr().err == "ospace: compiling kernels, once for this machine (seconds each)\n"

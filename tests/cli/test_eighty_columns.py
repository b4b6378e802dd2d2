"""Tables in narrow places: every line fits, and no cell loses a letter or a digit."""

import contextlib
import os
import pty
import re
import subprocess
import sys
from collections import Counter

import missions
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ospace.cli import console
from ospace.cli.columns import Column, fit
from ospace.cli.main import main

COLUMNS = (Column("name"), Column("value", right=True), Column("remark", wraps=True))
WORDS = st.lists(st.text("abcxyz019.-", min_size=1, max_size=30), max_size=6).map(" ".join)
ROWS = st.lists(st.tuples(WORDS.filter(bool), WORDS, WORDS), min_size=1, max_size=4)


def letters(text):
    return Counter(text.replace(" ", "").replace("\n", ""))


@given(ROWS, st.integers(20, 120), st.sampled_from(["", "  "]))
def test_lines_fit_and_cells_are_whole(rows, width, indent):
    table = fit(COLUMNS, rows, width, indent)
    lines = [*table.heading, *(line for row in table.rows for line in row)]
    assert all(line.cell_len <= width for line in lines)
    for row, shown in zip(rows, table.rows, strict=True):
        text = "".join(line.plain for line in shown)
        headings = letters("".join(one.heading for one in COLUMNS[1:])) if not table.heading else Counter()
        assert letters("".join(row)) <= letters(text) <= letters("".join(row)) + headings


def test_a_wide_place_has_a_row_in_a_line_and_numbers_below_each_other():
    table = fit(COLUMNS, [("a", "1.5", "as it should be"), ("long name", "22.25", "")], 80)
    shown = [line.plain for line in table.heading] + [row[0].plain for row in table.rows]
    assert shown == ["name       value  remark", "a            1.5  as it should be", "long name  22.25"]


def test_sentences_are_broken_before_rows_are_stacked():
    remark = "a sentence that is longer than its place"
    (row,) = fit(COLUMNS, [("arm", "1.5", remark)], 40).rows
    assert [line.plain for line in row] == ["arm     1.5  a sentence that is longer", "             than its place"]
    (row,) = fit(COLUMNS, [("arm", "1234567890.12345", remark)], 30).rows
    assert row[0].plain == "arm"
    assert row[1].plain == "  value 1234567890.12345"


def test_markup_takes_no_place_and_stays_on_its_cell():
    table = fit((Column(), Column()), [("[bold]ab[/]", "[red]cd[/]")], 6)
    assert [line.plain for line in table.rows[0]] == ["ab  cd"]
    assert [(part.start, part.end, part.style) for part in table.rows[0][0].spans] == [(0, 2, "bold"), (4, 6, "red")]


@pytest.mark.parametrize("width", [60, 80])
@pytest.mark.parametrize(
    "verb",
    [
        ["check", "chaser_24dof", "--samples", "1"],
        ["check", "chaser_24dof", "--frames"],
        ["list"],
        ["compose", "box:1.2x1x0.8m,250kg", "planar_2r", "--at", "0.6,0,0", "--prefix", "arm_", "--out", "made.urdf"],
        ["run", "made.toml"],
    ],
    ids=lambda verb: " ".join(verb[:1] + verb[2:3]),
)
def test_what_a_verb_prints_fits_and_is_the_same_text_as_in_a_wide_place(tmp_path, monkeypatch, capsys, verb, width):
    monkeypatch.chdir(tmp_path)
    missions.written(tmp_path, missions.MISSION)
    texts = {}
    for columns in (width, 500):
        monkeypatch.setenv("COLUMNS", str(columns))
        main(verb)
        texts[columns] = re.sub(r"simulated in [\d.]+ s", "", capsys.readouterr().out)
    assert max(map(len, texts[width].splitlines())) <= width
    assert letters(texts[width]) >= letters(texts[500])


@pytest.mark.parametrize("where", ["pipe", "terminal"])
def test_sentences_are_broken_for_a_terminal_and_whole_in_a_pipe(monkeypatch, where):
    monkeypatch.delenv("COLUMNS", raising=False)
    shown = console.buffered_console()
    shown._force_terminal, shown.width = where == "terminal", 40
    console.show_text(shown, "a sentence of more than forty letters, which goes on")
    assert len(console.buffered_text(shown).splitlines()) == (2 if where == "terminal" else 1)


@pytest.mark.parametrize("setting", [{"NO_COLOR": "1"}, {}], ids=["NO_COLOR", "colours"])
def test_with_no_color_a_terminal_gets_no_escape(setting):
    ours, theirs = pty.openpty()
    environment = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    environment |= {"TERM": "xterm-256color", **setting}
    words = [sys.executable, "-m", "ospace.cli", "check", "planar_2r", "--samples", "2"]
    with subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs, env=environment) as process:
        os.close(theirs)
        shown = b""
        with contextlib.suppress(OSError):  # how a terminal ends
            while part := os.read(ours, 65536):
                shown += part
        os.close(ours)
        assert process.wait(120) == 0
    assert b"sound" in shown
    assert (b"\x1b" in shown) == (not setting)

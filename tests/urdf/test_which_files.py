"""The table of docs/check.md, "Which files are read, and how", says of each file of the corpus what is done with it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from urdf.corpus import VARIANTS

PAGE = (Path(__file__).parents[2] / "docs" / "check.md").read_text(encoding="utf-8")
TABLE = PAGE.partition("## Which files are read, and how")[2].partition("\n## ")[0]
ROWS = [
    [cell.strip() for cell in line.strip("| ").split(" | ")] for line in TABLE.splitlines() if line.startswith("| ")
]
BY_NAME = {variant.name: variant for variant in VARIANTS}


def test_the_table_has_rows():
    assert len(ROWS) > 40
    assert ROWS[0][0] == "what stands in the file"


@pytest.mark.parametrize("row", ROWS[1:], ids=lambda row: row[-1])
def test_a_row_says_what_the_corpus_holds(row):
    """`test_corpus.py` holds the file to its status and codes; the row says the same."""
    what, how, name = row
    variant = BY_NAME[name]
    codes = set(re.findall(r"`([a-z-]+)`", how))
    assert variant.status == (2 if "refused" in how else 1 if "unsound" in how else 0), what
    assert bool(codes) == bool(variant.codes), what
    assert variant.codes <= codes | {"massless-base"}, what

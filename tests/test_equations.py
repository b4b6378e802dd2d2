"""docs/equations.md is true: what it names is there, and no file that computes an equation is missing."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import pytest

import ospace
from ospace.validation import quantities

ROOT = Path(__file__).parents[1]
PACKAGE = Path(ospace.__file__).parent
PAGE = (ROOT / "docs/equations.md").read_text()
CITED = re.compile(r"(?<![A-Z])\(\d{1,2}\)|(?<![A-Z])\(\d{1,2}–\d{1,2}\)")  # "(n, k)" is a shape
NAMED = sorted(set(re.findall(r"`((?:kernels|dynamics)\.[\w.]+)`", PAGE)))
TABLES = [[cell.strip() for cell in line.strip("| \n").split(" | ")] for line in PAGE.splitlines() if line[:1] == "|"]
EQUATIONS = [cells for cells in TABLES if len(cells) == 5 and (cells[0].isdigit() or cells[0] == "–")]
SHORT = dict(re.findall(r"\*\*(\w)\*\* = `([\w/.]+)`", PAGE))


def docstrings(file: Path) -> str:
    tree = ast.parse(file.read_text())
    documented = (ast.Module, ast.FunctionDef, ast.ClassDef)
    return "\n".join(ast.get_docstring(node) or "" for node in ast.walk(tree) if isinstance(node, documented))


def functions_of(file: str) -> set[str]:
    return {node.name for node in ast.parse((ROOT / file).read_text()).body if isinstance(node, ast.FunctionDef)}


def resolve(name: str) -> object:
    """Return the module, or what of it is named."""
    found: object = ospace
    for part in name.split("."):
        if not hasattr(found, part):
            importlib.import_module(f"{found.__name__}.{part}")
        found = getattr(found, part)
    return found


def test_all_45_equations_are_there():
    assert [int(cells[0]) for cells in EQUATIONS if cells[0].isdigit()] == list(range(1, 46))


@pytest.mark.parametrize("folder", ["kernels", "dynamics"])
def test_every_file_that_cites_an_equation_is_named(folder):
    cited = [file for file in (PACKAGE / folder).rglob("*.py") if CITED.search(docstrings(file))]
    names = [".".join(file.relative_to(PACKAGE / folder).with_suffix("").parts) for file in cited]
    files = {name.removesuffix(".__init__") for name in names}
    assert files  # the pattern finds some
    named = {cells[0].strip("`").removeprefix(f"{folder}.") for cells in TABLES if len(cells) == 4}
    assert files - named == set()


@pytest.mark.parametrize("name", NAMED)
def test_what_is_named_exists(name):
    resolve(name)


@pytest.mark.parametrize("file", sorted(set(re.findall(r"`((?:tests|docs|ospace)/[\w/.]+)`", PAGE))))
def test_files_that_are_named_exist(file):
    assert (ROOT / file).exists()


@pytest.mark.parametrize("name", sorted(set(re.findall(r"\b[IRFVSME]::test_\w+…?", PAGE))))
def test_tests_that_are_named_exist(name):
    letter, _, test = name.partition("::")
    found = functions_of(SHORT[letter])
    if test.endswith("…"):
        assert any(one.startswith(test[:-1]) for one in found)
    else:
        assert test in found


@pytest.mark.parametrize("cells", EQUATIONS, ids=[cells[0] + cells[1][:12] for cells in EQUATIONS])
def test_rows_of_the_check_that_are_named_exist(cells):
    rows = sorted({row.name for row in quantities.TABLE} | {"placements of … links"}, key=len, reverse=True)
    left = cells[4]
    for row in rows:
        left = re.sub(rf"(^|, ){re.escape(row)}(?=$|, )", r"\1", left)
    assert left.strip(", ") == ""


def test_every_row_of_the_check_is_named():
    named = "\n".join(cells[4] for cells in EQUATIONS)
    assert [row.name for row in quantities.TABLE if row.name not in named] == []

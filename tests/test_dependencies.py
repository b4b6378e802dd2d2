"""What ospace imports, it declares: in the dependencies, or in the extra that `ospace.extras` names for it."""

from __future__ import annotations

import re
import sys
import tomllib
from collections import defaultdict
from importlib.metadata import packages_distributions, version
from pathlib import Path

import pytest
from imports import imports_of

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
ALWAYS = tuple(PROJECT["dependencies"])
EXTRAS = {name: tuple(wanted) for name, wanted in PROJECT["optional-dependencies"].items()}
PROVIDED_BY = {"pinocchio": "pin", "adam": "adam-robotics"}
"""Packages whose distribution says nothing of the modules that it installs."""
OF_VISUAL = ("ospace/visual/", "ospace/benchmark/plot.py")
OF_MUJOCO = ("ospace/bridge/mujoco.py",)
OF_DATAFRAME = ("ospace/simulation/trajectory.py", "ospace/scenario/result.py")
OF_BENCHMARKS = ("ospace/benchmark/codegen.py",)
"""Files that load only where the extra is asked for."""
PEERS = [one for one in EXTRAS["benchmarks"] if one.startswith(("casadi", "adam-robotics"))]


def canonical(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def name_of(requirement):
    return canonical(re.match(r"[A-Za-z0-9._-]+", requirement).group())


def with_extras(requirements):
    """Return names, those of extras of ospace itself followed."""
    names = set()
    for one in requirements:
        own = re.fullmatch(r"ospace\[(\w+)\]", one)
        names |= with_extras(EXTRAS[own.group(1)]) if own else {name_of(one)}
    return names


def others_imported(folder):
    """Return modules of others that the files of a folder import, anywhere in them, and which files do."""
    found = defaultdict(list)
    for file in sorted(folder.rglob("*.py")):
        for module, _ in imports_of(file):
            top = module.partition(".")[0]
            if top not in ("", "ospace") and top not in sys.stdlib_module_names:
                found[top].append(file.relative_to(ROOT).as_posix())
    return found


IMPORTS = others_imported(ROOT / "ospace")
DISTRIBUTIONS = packages_distributions()


def distributions(module):
    return {canonical(one) for one in DISTRIBUTIONS.get(module, [PROVIDED_BY.get(module, module)])}


def test_the_walk_sees_imports_in_functions_and_at_the_top():
    assert {"numpy", "pinocchio", "numba", "qpsolvers", "tornado", "umsgpack", "llvmlite"} <= set(IMPORTS)


@pytest.mark.parametrize("module", sorted(IMPORTS))
def test_every_import_is_declared(module):
    declared = with_extras([*ALWAYS, *EXTRAS["visual"], *EXTRAS["mujoco"], *EXTRAS["dataframe"], *PEERS])
    assert distributions(module) & declared, f"{module} is imported by {IMPORTS[module]} and not declared"


@pytest.mark.parametrize("module", sorted(IMPORTS))
def test_what_comes_with_an_extra_is_imported_by_the_parts_that_ask_for_it(module):
    """Everything else that is imported comes with a plain ``pip install ospace``."""
    of_extras = ((OF_BENCHMARKS, PEERS), (OF_MUJOCO, EXTRAS["mujoco"]), (OF_DATAFRAME, EXTRAS["dataframe"]))
    files = next((files for files, extra in of_extras if distributions(module) & with_extras(extra)), OF_VISUAL)
    if not distributions(module) & with_extras(ALWAYS):
        assert [file for file in IMPORTS[module] if not file.startswith(files)] == []


def test_every_requirement_is_a_range():
    """A lower bound that the installed version meets, and no version nailed down."""
    for one in [*ALWAYS, *EXTRAS["visual"]]:
        assert re.fullmatch(r"[A-Za-z0-9._-]+>=[0-9.]+(,<[0-9.]+)?", one), one
        least = re.search(r">=([0-9.]+)", one).group(1)
        assert numbers(version(name_of(one))) >= numbers(least), one


def numbers(text):
    return [int(digits) for digits in re.findall(r"\d+", text)]


def test_what_is_declared_is_imported():
    """Nothing is installed for nothing; plug-ins are named where they are used."""
    used = {one for module in IMPORTS for one in distributions(module)}
    through = {"pycollada": "trimesh reads .dae by it"}
    assert with_extras([*ALWAYS, *EXTRAS["visual"]]) - used - set(through) == set()

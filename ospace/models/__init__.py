"""The robots, scenarios and examples that come with ospace, by name.

Sources and assumptions of a robot stand in the header of its file.
"""

from __future__ import annotations

import ast
import os
import re
import tomllib
from pathlib import Path

from ospace.exceptions import OspaceError, closest


def _folder() -> Path:
    """Beside this file where ospace is installed; in a checkout, ``models/`` at its top."""
    here = Path(__file__).parent
    return here if any(here.glob("*.urdf")) else here.parents[1] / "models"


def names() -> list[str]:
    """Return the names that `path` knows.

    Returns
    -------
    list of str
        In alphabetical order.
    """
    return sorted(file.stem for file in _folder().glob("*.urdf"))


def path(name: str) -> Path:
    """Return the URDF of the robot called `name`, such as ``"chaser_24dof"``.

    Parameters
    ----------
    name : str

    Returns
    -------
    Path

    Raises
    ------
    OspaceError
        No robot of that name comes with ospace.
    """
    if name not in names():
        raise OspaceError(f"'{name}' is neither a file nor a model that comes with ospace{closest(name, names())}")
    return _folder() / f"{name}.urdf"


def find(text: str | os.PathLike[str], *, scenarios: bool = False) -> Path:
    """Return the file of that path; where there is none, the file of that name that comes with ospace.

    Parameters
    ----------
    text : path-like
        As ``"arm.urdf"``, or ``"chaser_24dof"``.
    scenarios : bool
        Look among scenarios, not among robots.

    Returns
    -------
    Path
    """
    given = Path(text)
    files = (_folder() / "scenarios").glob("*.toml") if scenarios else _folder().glob("*.urdf")
    known = {file.stem: file for file in files}
    return given if os.path.lexists(given) else known.get(os.fspath(text), given)


def summary(name: str) -> str:
    """Return the first sentence of the header of a robot's file, after its name.

    Parameters
    ----------
    name : str
        Of the robot.

    Returns
    -------
    str
        Empty where the file has no such sentence.

    Raises
    ------
    OspaceError
        No robot of that name comes with ospace.
    """
    header = " ".join(path(name).read_text(encoding="utf-8").partition("-->")[0].split())
    match = re.search(rf"{re.escape(name)}: (.*?)\. ", header)
    return match[1] if match else ""


def scenarios() -> list[str]:
    """Return the names that `scenario` knows.

    Returns
    -------
    list of str
        In alphabetical order.
    """
    return sorted(file.stem for file in (_folder() / "scenarios").glob("*.toml"))


def scenario(name: str) -> Path:
    """Return the scenario called `name`, such as ``"grasp"``.

    Parameters
    ----------
    name : str

    Returns
    -------
    Path

    Raises
    ------
    OspaceError
        No scenario of that name comes with ospace.
    """
    if name not in scenarios():
        raise OspaceError(
            f"'{name}' is neither a file nor a scenario that comes with ospace{closest(name, scenarios())}"
        )
    return _folder() / "scenarios" / f"{name}.toml"


def scenario_summary(name: str) -> str:
    """Return the name that the file of a scenario gives it.

    Parameters
    ----------
    name : str
        Of the scenario, as `scenarios` lists it.

    Returns
    -------
    str

    Raises
    ------
    OspaceError
        No scenario of that name comes with ospace.
    """
    return str(tomllib.loads(scenario(name).read_text(encoding="utf-8")).get("name", ""))


def examples() -> list[Path]:
    """Return the example scripts that come with ospace, to be run or copied.

    Returns
    -------
    list of Path
        In alphabetical order.
    """
    installed = Path(__file__).parents[1] / "examples"
    folder = installed if installed.is_dir() else Path(__file__).parents[2] / "examples"
    return sorted(folder.glob("*.py"))


def example_summary(file: Path) -> str:
    """Return the first sentence of an example.

    Parameters
    ----------
    file : Path
        One of `examples`.

    Returns
    -------
    str
    """
    text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    lines = [line for line in text.splitlines() if line.strip("=-~ ")]  # a title may be underlined
    return lines[0].rstrip(".") if lines else ""

"""Packages that only some of ospace needs: extras, as ``pip install 'ospace[visual]'``."""

from __future__ import annotations

import importlib.util
import json
from importlib import metadata
from pathlib import Path

from ospace.exceptions import OspaceError

_TITLES = {"matplotlib": "Matplotlib", "meshcat": "MeshCat", "jinja2": "Jinja", "mujoco": "MuJoCo", "pandas": "pandas"}
_EXTRAS = {"mujoco": "mujoco", "pandas": "dataframe"}
"""Which extra a module is of; ``visual`` where it is not named."""


def require(module: str, what: str) -> None:
    """Raise `OspaceError` where a module of an extra is not installed, before any work is done.

    Parameters
    ----------
    module : str
        As it is imported.
    what : str
        That needs it, as ``"a plot"``.
    """
    if importlib.util.find_spec(module) is None:
        command = install_command(_EXTRAS.get(module, "visual"))
        raise OspaceError(f"{what} needs {_TITLES.get(module, module)}: {command}")


def require_scene(what: str) -> None:
    """Likewise for all that a page with a scene is made with."""
    for module in ("meshcat", "jinja2"):
        require(module, what)


def install_command(extra: str) -> str:
    """Return the command that installs an extra from where this ospace comes: an index, a checkout, or an address."""
    if (Path(__file__).parents[1] / "pyproject.toml").is_file():
        return f"pip install -e '.[{extra}]'"
    try:
        origin = json.loads(metadata.distribution("ospace").read_text("direct_url.json") or "{}")
    except metadata.PackageNotFoundError:
        origin = {}
    if "vcs_info" in origin:
        return f"pip install 'ospace[{extra}] @ {origin['vcs_info']['vcs']}+{origin['url']}'"
    if origin.get("url", "").startswith("file://"):
        return f"pip install '{origin['url'].removeprefix('file://')}[{extra}]'"
    return f"pip install 'ospace[{extra}]'"

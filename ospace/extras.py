"""Packages that only some of ospace needs: ``pip install 'ospace[visual]'``."""

from __future__ import annotations

import importlib.util

from ospace.exceptions import OspaceError

_TITLES = {"matplotlib": "Matplotlib", "meshcat": "MeshCat", "jinja2": "Jinja"}


def require(module: str, what: str) -> None:
    """Raise `OspaceError` where a module of the extra ``visual`` is not installed, before any work is done.

    Parameters
    ----------
    module : str
        As it is imported.
    what : str
        That needs it, as ``"a plot"``.
    """
    if importlib.util.find_spec(module) is None:
        raise OspaceError(f"{what} needs {_TITLES.get(module, module)}: pip install 'ospace[visual]'")


def require_scene(what: str) -> None:
    """Likewise for all that a page with a scene is made with."""
    for module in ("meshcat", "jinja2"):
        require(module, what)

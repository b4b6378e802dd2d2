"""Writes the pages of the API reference: every public name once, at the first module that offers it."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterator
from pathlib import Path

MODULES = (
    "ospace",
    "ospace.models",
    "ospace.analysis",
    "ospace.control",
    "ospace.simulation",
    "ospace.scenario",
    "ospace.scenario.log",
    "ospace.scenario.series",
    "ospace.visual",
)


def public() -> Iterator[tuple[str, str, object]]:
    """Yield module, name and value of each public name of `MODULES`."""
    seen: set[int] = set()
    for module in map(importlib.import_module, MODULES):
        own = getattr(module, "__all__", None)
        for name in own or [name for name in vars(module) if name[0] != "_"]:
            value = getattr(module, name)
            home = getattr(value, "__module__", "")
            if home.startswith("ospace" if own else module.__name__) and callable(value) and id(value) not in seen:
                seen.add(id(value))
                yield module.__name__, name, value


def write(folder: Path) -> None:
    """Write ``index.md`` and a page a module into ``folder``."""
    folder.mkdir(exist_ok=True)
    names: dict[str, list[tuple[str, object]]] = {module: [] for module in MODULES}
    for module, name, value in public():
        names[module].append((name, value))
    for module, offered in names.items():
        lines = [module, "=" * len(module), "", f".. automodule:: {module}", "   :no-members:", "   :no-index:", ""]
        lines += [f".. currentmodule:: {module}", "", ".. autosummary::", ""]
        lines += [f"   {name}" for name, _ in offered] + [""]
        for name, value in sorted(offered, key=lambda one: (inspect.isclass(one[1]), one[0])):
            is_class = inspect.isclass(value)
            lines += [f".. autoclass:: {name}", "   :members:"] if is_class else [f".. autofunction:: {name}"]
            lines += [""]
        _replace(folder / f"{module}.rst", "\n".join(lines))
    _replace(
        folder / "index.md",
        "# Reference\n\nEvery public name, at the module it is imported from. SI units; six-vectors are linear first,\n"
        "in inertial axes at the point named ({doc}`../conventions`).\n\n```{toctree}\n"
        + "\n".join(MODULES)
        + "\n```\n",
    )


def _replace(file: Path, text: str) -> None:
    """Write where the text is new, so that a second build reads only what changed."""
    if not file.exists() or file.read_text() != text:
        file.write_text(text)

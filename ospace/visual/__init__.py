"""Seeing it: scenes, animations, plots and reports, for a browser."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ospace.visual.scene import Scene as Scene

__all__ = ["Scene"]


def __getattr__(name: str) -> Any:
    if name != "Scene":
        raise AttributeError(f"module 'ospace.visual' has no attribute '{name}'")
    from ospace.extras import require_scene

    require_scene("a scene")
    from ospace.visual.scene import Scene

    return Scene

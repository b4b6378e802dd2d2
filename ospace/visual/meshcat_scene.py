"""A meshcat scene without a server: the commands that make it, kept by path, and handed on to whoever listens."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from typing import Any

import umsgpack
from meshcat.animation import Animation
from meshcat.commands import SetAnimation, SetObject, SetProperty, SetTransform
from meshcat.path import Path

from ospace.kernels.tree import Floats


def component(name: str) -> str:
    """Return a name as one component of a path, whatever it is made of; ``link name`` is none of JavaScript's own."""
    return name.replace("%", "%25").replace("/", "%2F").replace("<", "%3C")


class MeshcatScene:
    """Meshcat's commands, the last of each kind by path; a page that is opened later gets them all, in order."""

    def __init__(self) -> None:
        self._commands: dict[tuple[str, str, str], bytes] = {}
        self._listeners: list[Callable[[bytes], None]] = []
        self._lock = threading.Lock()

    def set_object(self, path: str, geometry: Any, material: Any = None) -> None:
        """Put meshcat's geometry or object at `path`; what is translucent casts no shadow."""
        self._send(SetObject(geometry, material, _path(path)), path)
        if material is not None and material.opacity < 1.0:
            self.set_property(f"{path}/<object>", "castShadow", False)
            self.set_property(f"{path}/<object>", "receiveShadow", False)

    def set_transform(self, path: str, T: Floats) -> None:
        """Place what is at `path` in what is above it; T (4, 4), m."""
        self._send(SetTransform(T, _path(path)), path)

    def set_property(self, path: str, name: str, value: Any) -> None:
        """Set a property of what is at `path`."""
        self._send(SetProperty(name, value, _path(path)), path, name)

    def set_animation(self, animation: Animation) -> None:
        """Give the animation, which replaces the one before."""
        self._send(SetAnimation(animation), "")

    def commands(self) -> Iterator[bytes]:
        """Yield what makes the scene, as meshcat's viewer takes it: the animation last."""
        with self._lock:
            kept = dict(self._commands)
        yield from (content for (kind, *_), content in kept.items() if kind != "set_animation")
        yield from (content for (kind, *_), content in kept.items() if kind == "set_animation")

    def listen(self, listener: Callable[[bytes], None]) -> None:
        """Call `listener` with each command from now on."""
        self._listeners.append(listener)

    def forget(self, listener: Callable[[bytes], None]) -> None:
        """Stop calling `listener`."""
        self._listeners.remove(listener)

    def _send(self, command: Any, path: str, name: str = "") -> None:
        lowered = command.lower()
        single = lowered["type"] == "set_animation"  # three.js keeps keys in single precision
        content = umsgpack.packb(lowered, force_float_precision="single" if single else "double")
        with self._lock:
            self._commands[lowered["type"], path, name] = content
            self._notify(content)

    def _notify(self, content: bytes) -> None:
        for listener in self._listeners:
            listener(content)


def _path(path: str) -> Path:
    return Path(tuple(path.strip("/").split("/")))

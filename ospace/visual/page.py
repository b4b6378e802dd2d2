"""The page that shows a scene: one HTML file with all that it needs."""

from __future__ import annotations

import base64
import gzip
import html
import struct
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import meshcat

from ospace.visual.meshcat_scene import MeshcatScene

_WEB = Path(__file__).with_name("web")
_MESHCAT = Path(meshcat.__file__).with_name("viewer") / "dist" / "main.min.js"


@dataclass(frozen=True)
class Layer:
    """A group of nodes that can be switched on and off.

    Attributes
    ----------
    name, title, legend : str
    paths : list of str
        Nodes of the scene that belong to it.
    shown : bool
        True if it is visible at first.
    """

    name: str
    title: str
    legend: str
    paths: list[str]
    shown: bool


@dataclass(frozen=True)
class Label:
    """A name that follows a node of the scene, and is shown with its layer.

    Attributes
    ----------
    text : str
    path : str
        The node.
    layer : str
        Name of the layer.
    hint : str
        Shown to whoever points at the name.
    """

    text: str
    path: str
    layer: str
    hint: str = ""


@dataclass(frozen=True)
class Content:
    """Content of a page.

    Attributes
    ----------
    scene : MeshcatScene
    title, heading : str
    background : str
    layers : sequence of Layer
    labels : sequence of Label
    notes : sequence of str
        Remarks on the picture for the user.
    hints : mapping of path to str
        Shown to whoever points at what stands below a node.
    """

    scene: MeshcatScene
    title: str
    heading: str
    background: str
    layers: Sequence[Layer]
    labels: Sequence[Label]
    notes: Sequence[str] = ()
    hints: Mapping[str, str] = field(default_factory=dict)


def render(content: Content, *, live: str = "", template: str = "page.html", **more: Any) -> str:
    """Return the page; a live one gets the scene through a socket of the host `live`.

    Names in it come from files of anywhere: whatever they are made of is shown as text.
    """
    data = {
        "layers": [asdict(layer) for layer in content.layers],
        "labels": [asdict(label) for label in content.labels],
        "hints": list(content.hints.items()),
        "live": bool(live),
        "commands": "" if live else _packed(content.scene),
    }
    texts = {"style": own_text("page.css"), "script": own_text("page.js"), "meshcat": _viewer()}
    return str(_templates().get_template(template).render(content=content, data=data, live=live, **texts, **more))


def frame(page: str, height: int = 600) -> str:
    """Return a page within a page, for a notebook."""
    return (
        f'<iframe srcdoc="{html.escape(page)}" title="ospace scene" sandbox="allow-scripts" '
        f'style="width: 100%; height: {height}px; border: 0"></iframe>'
    )


def _packed(scene: MeshcatScene) -> str:
    """Return the commands, each behind its length, compressed, as letters."""
    content = b"".join(struct.pack("<I", len(command)) + command for command in scene.commands())
    return base64.b64encode(gzip.compress(content, 6, mtime=0)).decode()


@cache
def _templates() -> Any:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    return Environment(
        loader=FileSystemLoader(_WEB), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )


def own_text(name: str) -> Any:
    """Return a style or script of ours, which goes into the page as it is."""
    from markupsafe import Markup

    return Markup((_WEB / name).read_text(encoding="utf-8"))


@cache
def _viewer() -> Any:
    from markupsafe import Markup

    return Markup(_MESHCAT.read_text(encoding="utf-8").replace("</script", "<\\/script"))

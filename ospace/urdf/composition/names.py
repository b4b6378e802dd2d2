"""A prefix before all names of a part, also where elements of other programs speak of its links and joints."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from lxml import etree

from ospace.urdf.numbers import NumberError, number
from ospace.urdf.parse import SCHEMA

_NAMES = {"link": "name", "joint": "name", "parent": "link", "child": "link", "mimic": "joint"}
"""Elements of URDF, and their attribute that holds the name of a link or joint."""
_DECLARING = {"actuator", "sensor", "gpio"}  # elements inside a foreign one that bear a name of their own
_WORDS = {
    "type",
    "filename",
    "class",
    "plugin",
    "hardwareinterface",
    "role",
}  # attributes and elements that name no part
_OF_OTHERS = {"param", "plugin", "command_interface", "state_interface", "property", "arg"}
"""Elements whose name is not one of the robot."""
Look = tuple[str, tuple[tuple[str, str], ...]]
"""An element of a material, <color> or <texture>, with its attributes."""
_SEPARATOR = re.compile(r"([\s,;]+)")


def declared(root: etree._Element) -> Iterator[tuple[str, str]]:
    """Return what stands below <robot> under a name, which no other part may bear: links, joints, transmissions, ….

    Returns
    -------
    iterator of (str, str)
        Tag and name.
    """
    for element in root.iterchildren(etree.Element):
        if element.tag != "material" and element.get("name"):
            yield _local(element), str(element.get("name"))


def foreign(root: etree._Element) -> Iterator[etree._Element]:
    """Return the elements that are not of URDF, each the outermost.

    Returns
    -------
    iterator of etree._Element
    """
    for element in root.iterchildren(etree.Element):
        if str(element.tag) in SCHEMA[str(root.tag)][1]:
            yield from foreign(element)
        else:
            yield element


def add_prefix(root: etree._Element, prefix: str) -> None:
    """Put `prefix` before the names of links, joints, and what else is declared, wherever they stand."""
    names = {name for _, name in declared(root)}
    for outer in foreign(root):
        names |= {str(part.get("name")) for part in outer.iter(etree.Element) if _local(part) in _DECLARING}
    strange = list(foreign(root))
    inside = {part for outer in strange for part in outer.iter(etree.Element)}
    for element in root.iter(etree.Element):
        key = _NAMES.get(str(element.tag))
        if element not in inside and key is not None and key in element.attrib:
            element.set(key, prefix + str(element.get(key)))
    for element in inside:
        _add_prefix_to_references(element, prefix, names)


def _add_prefix_to_references(element: etree._Element, prefix: str, names: set[str]) -> None:
    """Prefix attributes and text that are names, or lists of names, and nothing else."""
    tag = _local(element)
    for key, value in element.attrib.items():
        local = etree.QName(key).localname.lower()
        if local not in _WORDS and not (local == "name" and tag in _OF_OTHERS):
            element.set(
                key, _prefixed(str(value), prefix, names, may_be_number=local in ("name", "link", "joint", "reference"))
            )
    if element.text and not len(element) and tag.lower() not in _WORDS:
        element.text = _prefixed(element.text, prefix, names, may_be_number=False)


def _prefixed(text: str, prefix: str, names: set[str], *, may_be_number: bool) -> str:
    pieces = _SEPARATOR.split(text)
    words = [word for word in pieces[::2] if word]
    if not words or any(word not in names or (_is_number(word) and not may_be_number) for word in words):
        return text
    pieces[::2] = [prefix + word if word else word for word in pieces[::2]]
    return "".join(pieces)


def _is_number(word: str) -> bool:
    try:
        number(word)
    except NumberError:
        return False
    return True


def rename_materials(root: etree._Element, prefix: str, taken: dict[str, frozenset[Look]]) -> None:
    """Keep materials of a part apart from those of others, which `taken` has by name, and add its own.

    Each name gets the prefix. Where it is taken by another material all the same, it gets a number; where by the same
    one, the definition below <robot>, of which one may stand in a file, is left out.
    """
    used = [element for element in root.iter("material") if _is_urdf(element)]
    looks: dict[str, set[Look]] = {}
    for element in used:
        parts = element.iterchildren(etree.Element)
        own = {(str(part.tag), tuple(sorted((str(k), str(v)) for k, v in part.attrib.items()))) for part in parts}
        looks.setdefault(str(element.get("name", "")), set()).update(own)
    renamed: dict[str, str] = {}
    for name, definitions in looks.items():
        if name:
            renamed[name] = _free_name(prefix + name, frozenset(definitions), taken)
    shared = {name for name in renamed.values() if name in taken}
    taken.update({renamed[name]: frozenset(looks[name]) for name in renamed})
    for element in used:
        new = renamed.get(str(element.get("name", "")))
        if new is None:
            continue
        if new in shared and element.getparent() is root:
            cut(element)
        else:
            element.set("name", new)


def _free_name(name: str, definitions: frozenset[Look], taken: Mapping[str, frozenset[Look]]) -> str:
    choices = (name if k == 1 else f"{name}_{k}" for k in range(1, len(taken) + 2))
    return next(choice for choice in choices if taken.get(choice, definitions) == definitions)


def cut(element: etree._Element) -> None:
    """Take an element out; text behind it stays, space does not."""
    above, text = element.getparent(), element.tail or ""
    assert above is not None
    if text.strip():
        before = element.getprevious()
        if before is not None:
            before.tail = (before.tail or "") + text
        else:
            above.text = (above.text or "") + text
    above.remove(element)


def _is_urdf(material: etree._Element) -> bool:
    above = material.getparent()
    return above is not None and above.tag in ("robot", "visual")


def _local(element: etree._Element) -> str:
    return etree.QName(element).localname

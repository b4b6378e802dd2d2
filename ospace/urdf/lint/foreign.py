"""Parts of a URDF that speak of dynamics in words that ospace does not use, as other programs write them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lxml import etree

_DYNAMICS = {
    "spring",
    "stiffness",
    "bushing",
    "damper",
    "damping",
    "tendon",
    "muscle",
    "rotor",
    "armature",
    "reduction",
    "gear",
    "gearbox",
    "gearratio",
    "backlash",
    "friction",
    "stiction",
    "coulomb",
    "viscous",
    "mass",
    "density",
    "slosh",
    "inertia",
    "inertial",
    "mimic",
}
_COUPLINGS = {"loop", "constraint", "equality", "coupling", "weld"}  # in <gazebo> these are settings of a solver
_RATIOS = {"reduction", "gear", "gearbox", "gearratio"}  # of which 1 changes nothing, as 0 does of all others
_NO_DYNAMICS = {"implicit", "reference"}  # implicitSpringDamper chooses an integrator, springReference an angle
_OF_CONTACTS = {"inertia"}  # stiffness and damping of <contact> are those of its surface; inertia_scaling is not
_SURFACES = {
    "surface",
    "collision",
    "contact",
    "sensor",
    "visual",
}  # friction and stiffness there are those of contacts
_SEEN_WITHIN = 7  # letters of a word that is seen in a name without gaps as well, as in motorinertia
_MOST = 5


def describe_dynamics(element: etree._Element, *, of_robot: bool, ratios: bool = True) -> str:
    """Name the dynamics that an element which ospace does not read describes.

    Parameters
    ----------
    element : etree._Element
    of_robot : bool
        Whether it describes the robot, rather than set up another program: then a loop or constraint counts as well.
    ratios : bool
        Whether ratios of gears count, which alone change nothing of a robot.

    Returns
    -------
    str
        Elements and attributes with their values; empty where there is none.
    """
    tag = _local(element)
    if tag == "sensor":
        return ""
    words = _OF_CONTACTS if tag == "contact" else _DYNAMICS | (_COUPLINGS if of_robot else set())
    named = list(dict.fromkeys(_named(element, words if ratios else words - _RATIOS)))
    return ", ".join(named[:_MOST]) + (f" and {len(named) - _MOST} more" if len(named) > _MOST else "")


def is_dynamics_name(name: str) -> bool:
    """Return whether the name of an attribute or element is one of dynamics.

    Returns
    -------
    bool
    """
    return bool(_found(name, _DYNAMICS | _COUPLINGS))


def foreign_joints(root: etree._Element) -> dict[str, str]:
    """Name the joints that are not read, by the links that hang from them.

    Returns
    -------
    dict of str to str
    """
    found: dict[str, str] = {}
    for element in root.iter(etree.Element):
        if element.tag == "joint" or "joint" not in _local(element).lower():
            continue
        child = next((part for part in element.iterchildren(etree.Element) if _local(part) == "child"), None)
        name = "" if child is None else child.get("link") or " ".join((child.text or "").split())
        if name:
            prefix = f"{element.prefix}:" if element.prefix else ""
            kind = f" of type '{element.get('type')}'" if element.get("type") else ""
            found.setdefault(name, f"<{prefix}{_local(element)}> '{element.get('name', '')}'{kind}")
    return found


def _named(element: etree._Element, words: set[str]) -> Iterator[str]:
    if (loop := _joint(element)) is not None:
        yield loop
        return
    for key, value in element.attrib.items():
        name = etree.QName(key).localname
        if _matters(name, value, words):
            yield f"{name}='{value}'"
    name = str(element.get("name", "")) if _local(element) == "param" else _local(element)
    value = (element.get("value") or element.text or "").strip()
    if _matters(name, value, words):
        yield f"<{name}> {value}".rstrip()
        return
    for child in element.iterchildren(etree.Element):
        if _local(child) not in _SURFACES:
            yield from _named(child, words)


def _joint(element: etree._Element) -> str | None:
    """Name a joint between two links that is not in the tree: it would close a loop."""
    if _local(element) != "joint":
        return None
    ends = {_local(child): child for child in element.iterchildren(etree.Element)}
    if not {"parent", "child"} <= ends.keys():
        return None
    parent, child = (" ".join((ends[end].text or ends[end].get("link") or "").split()) for end in ("parent", "child"))
    return f"the joint '{element.get('name', '')}' that closes a loop from '{parent}' to '{child}'"


def _matters(name: str, value: str, words: set[str]) -> bool:
    named = _found(name, words)
    if not named or _words(name) & _NO_DYNAMICS:
        return False
    try:
        number = float(value)
    except ValueError:
        return value.strip().lower() != "false"
    return number not in (0.0, 1.0 if named & _RATIOS else 0.0)


def _found(name: str, words: set[str]) -> set[str]:
    """Return those of the words that a name is made of."""
    return _words(name) & words | {word for word in words if len(word) >= _SEEN_WITHIN and word in name.lower()}


def _words(name: str) -> set[str]:
    """Split rotorInertia, rotor_inertia and rotor-inertia alike."""
    return {word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+", name)}


def _local(element: etree._Element) -> str:
    return etree.QName(element).localname

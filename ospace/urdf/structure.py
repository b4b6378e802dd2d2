"""Whether the links and joints of a URDF make one tree, and each link's own inertia makes sense."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from lxml import etree

from ospace.exceptions import UrdfError
from ospace.urdf.findings import Finding, of_body

_WITH_AXIS = ("revolute", "continuous", "prismatic", "planar")
_XACRO = "http://www.ros.org/wiki/xacro"


def check(path: Path, root: etree._Element) -> None:
    """Raise `UrdfError` where the file is no URDF, or its links no tree: Pinocchio would drop some, or hang."""
    if root.tag != "robot":
        raise UrdfError(path, f"the root element is <{root.tag!s}>, not <robot>: this is no URDF")
    for element in root.iter():
        if str(element.tag).startswith(f"{{{_XACRO}}}") or any("${" in str(value) for value in element.attrib.values()):
            raise UrdfError(path, "is an unexpanded xacro: expand it first (xacro robot.xacro > robot.urdf)")
    if not root.get("name"):
        raise UrdfError(path, "<robot> has no name: give it one, as in <robot name='chaser'>")
    if root.find("link") is None:
        raise UrdfError(path, "<robot> has no <link>: a robot needs at least its base")
    parent_of: dict[str, str] = {}
    for joint in root.iterfind("joint"):
        parent, child = (_linked(joint, end) for end in ("parent", "child"))
        if child in parent_of:
            raise UrdfError(path, f"link '{child}' is the child of two joints: '{joint.get('name')}' is the second")
        parent_of[child] = parent
        axis = joint.find("axis")
        if axis is not None and joint.get("type") in _WITH_AXIS and _numbers(axis.get("xyz", "")) == [0.0, 0.0, 0.0]:
            raise UrdfError(path, f"joint '{joint.get('name')}' has an axis of no length: give it a direction")
    for link in parent_of:
        seen = {link}
        while link in parent_of:
            link = parent_of[link]
            if link in seen:
                raise UrdfError(path, f"link '{link}' hangs from itself: the joints make a loop, a URDF is a tree")
            seen.add(link)


def of_links(root: etree._Element) -> Iterator[Finding]:
    """Look at each link's own inertia, before fixed joints merge it with its neighbours."""
    fixed = [joint for joint in root.iterfind("joint") if joint.get("type") == "fixed"]
    welded = {_linked(joint, end) for joint in fixed for end in ("parent", "child")}
    for link in root.iterfind("link"):
        mass, tensor = link.find("inertial/mass"), link.find("inertial/inertia")
        if mass is None or tensor is None:
            continue
        value = _numbers(mass.get("value", ""))
        xx, yy, zz, xy, xz, yz = (_numbers(tensor.get(f"i{key}", "")) for key in ("xx", "yy", "zz", "xy", "xz", "yz"))
        if all(len(numbers) == 1 for numbers in (value, xx, yy, zz, xy, xz, yz)):
            matrix = np.array([[xx[0], xy[0], xz[0]], [xy[0], yy[0], yz[0]], [xz[0], yz[0], zz[0]]])
            name = str(link.get("name"))
            yield from of_body(name, value[0], np.zeros(3), matrix, merged=name in welded)


def _linked(joint: etree._Element, end: str) -> str:
    element = joint.find(end)
    return "" if element is None else str(element.get("link"))


def _numbers(text: str) -> list[float]:
    """Return the numbers in `text`; none where one cannot be read, which Pinocchio's parser tells by itself."""
    try:
        numbers = [float(word) for word in text.split()]
    except ValueError:
        return []
    return numbers if np.isfinite(numbers).all() else []

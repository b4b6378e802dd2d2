"""Links and joints as the elements of a file, comments and all: branches are removed, the rest is mounted elsewhere."""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pinocchio as pin
from lxml import etree

from ospace.exceptions import OspaceError, closest, printable
from ospace.urdf.bodies import placement, quaternion_to_rpy
from ospace.urdf.composition.names import cut, foreign
from ospace.urdf.description import Description, Pose, Triple

WORLD = "world"
_FIXED = ("fixed", "floating")  # joints by which a stand may hold an arm: it is fixed to the robot in their place
_INDENT = "\n  "


class Links:
    """The tree of links below <robot>, which stays a tree as it is edited.

    Attributes
    ----------
    root : etree._Element
        The element <robot>.
    links, joints : dict of str to etree._Element
        By name; without joints that close a loop.
    base : str
        The link that is the child of no joint.
    weightless : set of str
        Links without mass and inertia.
    """

    def __init__(self, root: etree._Element, description: Description) -> None:
        self.root = root
        self.links = {str(link.get("name")): link for link in root.iterchildren("link")}
        joints = {str(joint.get("name")): joint for joint in root.iterchildren("joint")}
        self.joints = {joint.name: joints.pop(joint.name) for joint in description.joints}
        self.closing = joints
        self.base = description.root
        self.weightless = {link.name for link in description.links if link.weightless}

    def below(self, link: str) -> Iterator[etree._Element]:
        """Return the joints that leave a link."""
        return (joint for joint in self.joints.values() if end(joint, "parent") == link)

    def branch(self, link: str) -> set[str]:
        """Return a link and all that it carries."""
        children = defaultdict[str, list[str]](list)
        for joint in self.joints.values():
            children[end(joint, "parent")].append(end(joint, "child"))
        branch, waiting = set[str](), [link]
        while waiting:
            name = waiting.pop()
            branch.add(name)
            waiting += children[name]
        return branch

    def moves(self, link: str) -> bool:
        """Return whether a joint moves something in the branch of a link."""
        branch = self.branch(link)
        return any(joint.get("type") not in _FIXED for joint in self.joints.values() if end(joint, "parent") in branch)

    def take_out(self, links: set[str]) -> None:
        """Take links out, with the joints at either end of them, and what other programs have for these."""
        every = self.joints | self.closing
        joints = {name for name, joint in every.items() if links & {end(joint, "parent"), end(joint, "child")}}
        for name, joint in every.items():
            mimic = joint.find("mimic")
            if name not in joints and mimic is not None and mimic.get("joint") in joints:
                leader = mimic.get("joint")
                raise OspaceError(
                    printable(f"joint '{name}' mimics '{leader}', which would be removed: remove both or none")
                )
        for name in links:
            cut(self.links.pop(name))
        for name in joints:
            cut(every.pop(name))
            self.joints.pop(name, None)
            self.closing.pop(name, None)
        if self.base in links:
            carried = {end(joint, "child") for joint in self.joints.values()}
            self.base = next(name for name in self.links if name not in carried)
        _forget(self.root, (links | joints) - self.links.keys() - every.keys())


def remove_branch(tree: Links, name: str) -> list[str]:
    """Remove a link with all that it carries; where only the rest would have no mass, the link is a stand.

    Of a stand goes all that is fixed to it and does not move, and the one arm that it carries stays.

    Returns
    -------
    list of str
        Names of links that were removed.

    Raises
    ------
    OspaceError
        There is no such link, or it is not clear what would stay.
    """
    if name not in tree.links:
        raise OspaceError(printable(f"there is no link '{name}' to remove{closest(name, tree.links)}"))
    gone = tree.branch(name)
    if tree.links.keys() - gone <= tree.weightless:
        arms = [
            joint for joint in tree.below(name) if joint.get("type") not in _FIXED or tree.moves(end(joint, "child"))
        ]
        if len(arms) != 1:
            what = "nothing" if not arms else "the parts " + ", ".join(f"'{end(arm, 'child')}'" for arm in arms)
            raise OspaceError(printable(f"without link '{name}' there would be {what}: a part is one tree of links"))
        if arms[0].get("type") not in _FIXED:
            raise OspaceError(
                printable(
                    f"link '{name}' carries the moving joint '{arms[0].get('name')}', which would hang on nothing"
                )
            )
        gone = set(tree.links) - tree.branch(end(arms[0], "child"))
    names = [link for link in tree.links if link in gone]
    tree.take_out(gone)
    return names


def drop_world(tree: Links, description: Description, *, is_base: bool) -> list[tuple[etree._Element, Pose]] | None:
    """Take out a root link called ``world`` that is only a frame.

    The robot that all stands on keeps it, unless one link alone is fixed to it.

    Returns
    -------
    list of (joint, Pose), or None
        Joints that left it, which now lack a parent, and their poses; None where nothing was taken out.
    """
    link = tree.links.get(WORLD)
    leaving = [*tree.below(WORLD), *(joint for joint in tree.closing.values() if end(joint, "parent") == WORLD)]
    if link is None or tree.base != WORLD or not leaving or list(link.iterchildren("visual", "collision")):
        return None
    if not description.link[WORLD].weightless:
        return None
    if is_base:
        if len(leaving) > 1 or leaving[0].get("type") != "fixed":
            return None
        tree.take_out({WORLD})
        return []
    cut(tree.links.pop(WORLD))
    _forget(tree.root, {WORLD} - tree.joints.keys())
    return [(joint, description.joint[str(joint.get("name"))].pose) for joint in leaving]


def mount(
    root: etree._Element,
    base: str,
    leaving: list[tuple[etree._Element, Pose]] | None,
    on: str,
    at: Triple,
    rpy: Triple,
) -> None:
    """Put a part on the link `on`: by the joints that left its world, or else its base by a fixed joint of its own."""
    if leaving is None:
        name, taken = f"{base}_mount", {joint.get("name") for joint in root.iterchildren("joint")}
        while name in taken:
            name += "_"
        joint = etree.Element("joint", {"name": name, "type": "fixed"})
        joint.text = joint.tail = _INDENT
        for tag, link in (("parent", on), ("child", base)):
            joint.append(etree.Element(tag, {"link": link}))
        root.append(joint)
        leaving = [(joint, Pose())]
    for joint, pose in leaving:
        parent = joint.find("parent")
        assert parent is not None  # or the part would not be a tree
        parent.set("link", on)
        _set_origin(joint, pose, at, rpy)


def _set_origin(joint: etree._Element, pose: Pose, at: Triple, rpy: Triple) -> None:
    if (*at, *rpy) == (0.0,) * 6:
        return  # where it is, digit by digit
    if (*pose.xyz, *pose.rpy) != (0.0,) * 6:
        (R, p), (turn, shift) = placement(Pose(at, rpy)), placement(pose)
        x, y, z = (R @ shift + p).tolist()
        at, rpy = (x, y, z), quaternion_to_rpy(tuple(pin.Quaternion(R @ turn).coeffs().tolist()))
    origin = joint.find("origin")
    if origin is None:
        origin = etree.Element("origin")
        joint.insert(0, origin)
    origin.attrib.pop("quat_xyzw", None)
    origin.set("xyz", _joined(at))
    origin.set("rpy", _joined(rpy))


def move_meshes(root: etree._Element, folder: Path, out: Path) -> None:
    """Write paths of meshes and textures, which are relative to `folder`, relative to `out`; packages stay."""
    here, there = os.path.realpath(folder), os.path.realpath(out)
    for element in root.iter("mesh", "texture"):
        name = str(element.get("filename", ""))
        scheme, _, rest = name.partition("://") if "://" in name else ("", "", name)
        if not rest or scheme not in ("", "file"):
            continue
        file = Path(here, rest)
        path = os.path.relpath(os.path.join(os.path.realpath(file.parent), file.name), there)
        try:
            element.set("filename", path if path != os.path.normpath(rest) else rest)
        except ValueError:  # control characters, or bytes that are no letters
            raise OspaceError(printable(f"{path}: XML cannot hold this name: rename the file or its folder")) from None


def end(joint: etree._Element, which: str) -> str:
    """Return the name of the link at an end of a joint, ``parent`` or ``child``."""
    element = joint.find(which)
    return "" if element is None else str(element.get("link", ""))


def _forget(root: etree._Element, gone: Iterable[str]) -> None:
    """Take out what elements of other programs have for links and joints that are gone."""
    gone = set(gone)
    for outer in list(foreign(root)):
        if outer.get("reference") in gone:
            cut(outer)
            continue
        joints = [part for part in outer.iter(etree.Element) if _local(part) in ("joint", "link") and part.get("name")]
        left = [part for part in joints if part.get("name") not in gone]
        if joints and not left:
            cut(outer)
            continue
        for part in joints:
            if part not in left and part is not outer:
                cut(part)


def _joined(values: Triple) -> str:
    return " ".join(repr(float(np.float64(value)) + 0.0).removesuffix(".0") for value in values)


def _local(element: etree._Element) -> str:
    return etree.QName(element).localname

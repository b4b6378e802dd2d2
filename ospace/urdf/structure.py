"""Whether links and joints make one tree of a size that can be handled, and in which order they stand in it."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from lxml import etree

from ospace.exceptions import closest
from ospace.urdf.description import Description, Joint, Link
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.source import Limits, line_of

LONGEST_CHAIN = 2000
"""Joints between the base and a link; the recursions of Pinocchio's reader overflow the stack near 3,700."""

DOF = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6}
_BASE_DOF = 6
_WORLD = "world"


def check_size(path: Path, root: etree._Element, limits: Limits) -> None:
    """Count links and joints, before anything is made of them.

    Raises
    ------
    UrdfError
        There are no links, or more links or joints than `limits.links`.
    """
    links = 0
    for links, link in enumerate(root.iterfind("link"), 1):
        if links > limits.links:
            reason = f"has more than {limits.links} links: merge some, or raise the limit (--max-links)"
            raise UrdfError(path, reason, "too-many-links", line_of(link))
    if not links:
        raise UrdfError(path, "<robot> has no <link>: a robot needs at least its base", "no-links", line_of(root))
    for joints, joint in enumerate(root.iterfind("joint"), 1):
        if joints > limits.links:
            reason = f"has more than {limits.links} joints, more than a tree of so many links has"
            raise UrdfError(path, reason, "too-many-links", line_of(joint))


def order_joints(path: Path, description: Description, limits: Limits) -> Description:
    """Order the joints from the base outward.

    Returns
    -------
    Description
        The same links, and each joint behind those between it and the base.

    Raises
    ------
    UrdfError
        Links and joints do not form a tree, or its chains are too long.
    """
    _check_names(path, "link", description.links)
    _check_names(path, "joint", description.joints)
    parent_joint = _parent_joints(path, description)
    roots = [link for link in description.links if link.name not in parent_joint]
    _check_loops(path, parent_joint)
    if len(roots) != 1:
        names = " and ".join(link.subject for link in roots[:3]) + (", …" if len(roots) > 3 else "")
        reason = f"has {len(roots)} root links, {names}: join them, by a fixed joint where nothing moves"
        raise UrdfError(path, reason, "two-roots", roots[1].line)
    below: dict[str, list[Joint]] = {link.name: [] for link in description.links}
    for joint in description.joints:
        below[joint.parent].append(joint)
    joints: list[Joint] = []
    waiting = [(joint, 1) for joint in reversed(below[roots[0].name])]
    while waiting:
        joint, depth = waiting.pop()
        if depth > LONGEST_CHAIN:
            reason = f"has a chain of more than {LONGEST_CHAIN} joints: merge links that are fixed to each other"
            raise UrdfError(path, reason, "too-many-links", joint.line)
        joints.append(joint)
        waiting += [(next_joint, depth + 1) for next_joint in reversed(below[joint.child])]
    return replace(description, joints=tuple(joints))


def check_dof(path: Path, description: Description, limits: Limits) -> None:
    """Check that Pinocchio's working memory for the robot, 64 nv³ bytes, is there.

    Raises
    ------
    UrdfError
        The degrees of freedom exceed `limits.dof`, or what the memory of the machine holds.
    """
    nv = _BASE_DOF + sum(DOF.get(joint.kind, 0) for joint in description.joints)
    if nv > limits.dof:
        reason = (
            f"has {nv} degrees of freedom, at most {limits.dof} are taken: fix some, or raise the limit (--max-dof)"
        )
        raise UrdfError(path, reason, "too-many-dof")
    needed, there = 64 * nv**3, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        reason = f"has {nv} degrees of freedom: Pinocchio takes {needed:.2g} bytes, the machine has {there:.2g}"
        raise UrdfError(path, reason, "too-many-dof")


def with_floating_base(description: Description) -> tuple[Description, list[Finding]]:
    """Take a massless root, with what is fixed to it, for the world where all else hangs on one floating joint of it.

    The file's own floating joint is then the base's, and what stands before it is left out. A root link called
    'world' to which the robot is fixed stays; that the base floats all the same is a finding.

    Returns
    -------
    Description
    list of Finding
    """
    root = description.link[description.root]
    ground, leaving = {root.name}, []
    for joint in description.joints:
        if joint.parent in ground and joint.kind == "fixed":
            ground.add(joint.child)
        elif joint.parent in ground:
            leaving.append(joint)
    massless = all(description.link[name].weightless for name in ground)
    if massless and [joint.kind for joint in leaving] == ["floating"]:
        (floating,) = leaving
        message = f"floats on the massless root {root.subject}: taken as the base's own six degrees of freedom"
        inner = replace(
            description,
            links=tuple(link for link in description.links if link.name not in ground),
            joints=tuple(joint for joint in description.joints if joint.child not in ground and joint is not floating),
        )
        return inner, [make_finding("floating-root", floating.subject, message, line=floating.line)]
    bolted = next((joint for joint in description.joints if joint.parent == root.name and joint.kind == "fixed"), None)
    if root.name == _WORLD and bolted is not None:
        message = f"'{bolted.child}' is fixed to the world in the file; here it floats"
        return description, [make_finding("fixed-base", bolted.subject, message, line=bolted.line)]
    return description, []


def _check_names(path: Path, what: str, parts: Iterable[Link] | Iterable[Joint]) -> None:
    seen: dict[str, int | None] = {}
    for part in parts:
        if not part.name.strip():
            raise UrdfError(path, f"has an unnamed {what}: give it a name", "unnamed", part.line)
        if part.name in seen:
            first = f" (line {seen[part.name]})" if seen[part.name] else ""
            reason = f"{what} '{part.name}' is not unique{first}: rename one"
            raise UrdfError(path, reason, "duplicate-name", part.line)
        seen[part.name] = part.line


def _parent_joints(path: Path, description: Description) -> dict[str, Joint]:
    """Return the joint above each link."""
    above: dict[str, Joint] = {}
    for joint in description.joints:
        for end, link in (("parent", joint.parent), ("child", joint.child)):
            if not link:
                raise UrdfError(path, f"{joint.subject} has no <{end} link=…>", "joint-ends", joint.line)
            if link not in description.link:
                near = closest(link, description.link)
                reason = f"{end} link '{link}' of {joint.subject} is not found{near}"
                raise UrdfError(path, reason, "unknown-link", joint.line)
        if joint.child in above:
            first = above[joint.child].subject
            reason = f"link '{joint.child}' is the child of two joints: {joint.subject} is the second, after {first}"
            raise UrdfError(path, reason, "second-parent", joint.line)
        above[joint.child] = joint
    return above


def _check_loops(path: Path, above: dict[str, Joint]) -> None:
    sound: set[str] = set()
    for link in above:
        way: dict[str, None] = {}
        while link in above and link not in sound:
            if link in way:
                reason = f"link '{link}' hangs from itself: the joints make a loop, a URDF is a tree"
                raise UrdfError(path, reason, "loop", above[link].line)
            way[link] = None
            link = above[link].parent
        sound.update(way)

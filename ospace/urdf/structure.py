"""Checks of a robot's structure: its size can be handled, and one base floats freely."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from lxml import etree

from ospace.urdf.description import Description, Joint
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.source import Limits, line_of

DOF = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6}
_BASE_DOF = 6
_WORLD = "world"
_NAMED = 5  # bodies that a message names


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
            reason = f"has more than {limits.links} links: merge some, or raise the limit (limits=Limits(links=N))"
            raise UrdfError(path, reason, "too-many-links", line_of(link))
    if not links:
        raise UrdfError(path, "<robot> has no <link>: a robot needs at least its base", "no-links", line_of(root))
    for joints, joint in enumerate(root.iterfind("joint"), 1):
        if joints > limits.links:
            reason = f"has more than {limits.links} joints, more than a tree of so many links has"
            raise UrdfError(path, reason, "too-many-links", line_of(joint))


def check_dof(path: Path, description: Description, limits: Limits) -> None:
    """Check that Pinocchio's working memory for the robot, 64 nv³ bytes, is there.

    Raises
    ------
    UrdfError
        The degrees of freedom exceed `limits.dof`, or what the memory of the machine holds.
    """
    nv = _BASE_DOF + sum(DOF.get(joint.kind, 0) for joint in description.joints)
    if nv > limits.dof:
        most = f"at most {limits.dof} are taken: fix some, or raise the limit (limits=Limits(dof=N))"
        reason = f"has {nv} degrees of freedom, {most}"
        raise UrdfError(path, reason, "too-many-dof")
    needed, there = 64 * nv**3, os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        reason = f"has {nv} degrees of freedom: Pinocchio takes {needed:.2g} bytes, the machine has {there:.2g}"
        raise UrdfError(path, reason, "too-many-dof")


def check_base(path: Path, description: Description) -> None:
    """Check that what stands on a root without mass is one body that may float freely.

    Raises
    ------
    UrdfError
        There are several, or the one slides in a plane.
    """
    ground, leaving = _ground(description)
    if not all(description.link[name].weightless for name in ground):
        return
    floating = [joint for joint in leaving if joint.kind == "floating"]
    root = description.link[description.root].subject
    if len(floating) > 1:
        names = ", ".join(f"'{joint.child}'" for joint in floating[:_NAMED]) + (", …" if len(floating) > _NAMED else "")
        reason = f"holds {len(floating)} free bodies, {names}, each on a floating joint of {root}, which has no mass: "
        reason += f"read one alone, as root='{floating[0].child}'"
        raise UrdfError(path, reason, "several-bodies", floating[1].line)
    for joint in leaving:
        if joint.kind == "planar":
            reason = f"{joint.subject} lets '{joint.child}' slide in a plane of {root}, which has no mass: the base of "
            reason += "ospace floats freely, make the joint floating"
            raise UrdfError(path, reason, "planar-base", joint.line)


def _ground(description: Description) -> tuple[set[str], list[Joint]]:
    """Return the root with what is fixed to it, and the joints that lead from there."""
    ground, leaving = {description.root}, []
    for joint in description.joints:
        if joint.parent in ground and joint.kind == "fixed":
            ground.add(joint.child)
        elif joint.parent in ground:
            leaving.append(joint)
    return ground, leaving


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
    ground, leaving = _ground(description)
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

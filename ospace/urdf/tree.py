"""From links and joints to one tree: its root, the joints from there outward, and what closes loops or is left out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ospace.exceptions import OspaceError, closest, printable
from ospace.urdf.description import Description, Joint, Link
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, make_finding

LONGEST_CHAIN = 2000
"""Joints between the base and a link; the recursions of Pinocchio's reader overflow the stack near 3,700."""
_NAMED = 5  # links or joints that a message names


@dataclass(frozen=True)
class Tree:
    """A tree of links.

    Attributes
    ----------
    description : Description
        Its links, and each joint behind those between it and the root.
    left_out : frozenset of str
        Links and joints of the file that are not in it, by the name that findings use.
    findings : tuple of Finding
        On what is left out.
    """

    description: Description
    left_out: frozenset[str]
    findings: tuple[Finding, ...]


def span(
    path: Path, description: Description, *, root: str | None = None, foreign: Mapping[str, str] | None = None
) -> Tree:
    """Order links and joints as a tree; a joint to a link that another joint carries already is left out.

    Parameters
    ----------
    path : Path
    description : Description
    root : str, optional
        Link to start from, with what hangs from it; else the one link that hangs from none.
    foreign : mapping of str to str, optional
        For links that hang from a joint which is not read, what to say of that joint.

    Returns
    -------
    Tree

    Raises
    ------
    UrdfError
        Links and joints do not form a tree, or its chains are too long.
    OspaceError
        There is no link `root`.
    """
    _check_names(path, "link", description.links)
    _check_names(path, "joint", description.joints)
    for joint in description.joints:
        _check_ends(path, description, joint)
    if root is not None and root not in description.link:
        raise OspaceError(f"{path}: there is no link '{root}' to be the root{closest(root, description.link)}")
    children = {joint.child for joint in description.joints}
    roots = [link for link in description.links if link.name not in children]
    starts = [link.name for link in roots] if root is None else [root]
    carrying = _carrying_joints(description, starts)
    _check_parallel(path, description, carrying)
    if root is None:
        _check_cycles(path, description, {*starts, *carrying})
        _check_one_root(path, roots, foreign or {})
    links = tuple(link for link in description.links if link.name in carrying or link.name in starts)
    there = {link.name for link in links}
    closing = [
        joint for joint in description.joints if joint.parent in there and carrying.get(joint.child) is not joint
    ]
    tree = replace(description, links=links, joints=_outward(path, description, carrying, starts[0]))
    kept = set(_subjects(tree))
    left_out = [subject for subject in _subjects(description) if subject not in kept]
    findings = [_open_loop(joint, carrying) for joint in closing]
    if root is not None:
        open_joints = {printable(joint.subject) for joint in closing}
        findings += _leave_out(root, [subject for subject in left_out if subject not in open_joints])
    return Tree(tree, frozenset(left_out), tuple(findings))


def _subjects(description: Description) -> Iterator[str]:
    yield from (printable(link.subject) for link in description.links)
    yield from (printable(joint.subject) for joint in description.joints)


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


def _check_ends(path: Path, description: Description, joint: Joint) -> None:
    for end, link in (("parent", joint.parent), ("child", joint.child)):
        if not link:
            raise UrdfError(path, f"{joint.subject} has no <{end} link=…>", "joint-ends", joint.line)
        if link not in description.link:
            near = closest(link, description.link)
            reason = f"{end} link '{link}' of {joint.subject} is not found{near}"
            raise UrdfError(path, reason, "unknown-link", joint.line)


def _carrying_joints(description: Description, starts: Sequence[str]) -> dict[str, Joint]:
    """Choose for each link that can be reached the joint that carries it: the first in the file that leads there."""
    below: dict[str, list[Joint]] = {link.name: [] for link in description.links}
    first: dict[str, Joint] = {}
    for joint in description.joints:
        below[joint.parent].append(joint)
        first.setdefault(joint.child, joint)
    carrying: dict[str, Joint] = {}
    passed_over: list[Joint] = []  # one is taken where no first joint leads on
    reached, waiting = set(starts), list(starts)
    while waiting:
        for joint in below[waiting.pop()]:
            if joint.child in reached:
                continue
            if first[joint.child] is not joint:
                passed_over.append(joint)
                continue
            reached.add(joint.child)
            carrying[joint.child] = joint
            waiting.append(joint.child)
        while passed_over and not waiting:
            joint = passed_over.pop(0)
            if joint.child not in reached:
                reached.add(joint.child)
                carrying[joint.child] = joint
                waiting.append(joint.child)
    return carrying


def _check_parallel(path: Path, description: Description, carrying: Mapping[str, Joint]) -> None:
    """Refuse a second joint between the same two links: nothing says which one is meant."""
    for joint in description.joints:
        first = carrying.get(joint.child)
        if first is not None and first is not joint and first.parent == joint.parent:
            reason = f"link '{joint.child}' is the child of two joints of link '{joint.parent}', "
            reason += f"{first.subject} and {joint.subject}: remove one"
            raise UrdfError(path, reason, "second-parent", joint.line)


def _check_cycles(path: Path, description: Description, reached: set[str]) -> None:
    lost = {joint.child: joint for joint in description.joints if joint.child not in reached}
    for joint in description.joints:
        if joint.parent == joint.child:
            lost = {joint.child: joint} | lost
    if not lost:
        return
    link, way = next(iter(lost)), dict[str, None]()
    while link in lost and link not in way:
        way[link] = None
        link = lost[link].parent
    reason = f"link '{link}' hangs from itself: a URDF is a tree. Cut the loop, or choose the root (root=LINK)"
    raise UrdfError(path, reason, "loop", lost[link].line)


def _check_one_root(path: Path, roots: Sequence[Link], foreign: Mapping[str, str]) -> None:
    if len(roots) == 1:
        return
    for link in roots:
        if link.name in foreign:
            reason = f"{link.subject} hangs from {foreign[link.name]}, which ospace does not know: "
            reason += "write it as joints of URDF"
            raise UrdfError(path, reason, "two-roots", link.line)
    names = " and ".join(link.subject for link in roots[:3]) + (", …" if len(roots) > 3 else "")
    reason = f"has {len(roots)} root links, {names}: join them, by a fixed joint where nothing moves, or read one "
    reason += f"alone: root='{roots[0].name}'"
    raise UrdfError(path, reason, "two-roots", roots[1].line)


def _outward(path: Path, description: Description, carrying: Mapping[str, Joint], start: str) -> tuple[Joint, ...]:
    below: dict[str, list[Joint]] = {link.name: [] for link in description.links}
    for joint in description.joints:
        if carrying.get(joint.child) is joint:
            below[joint.parent].append(joint)
    joints: list[Joint] = []
    waiting = [(joint, 1) for joint in reversed(below[start])]
    while waiting:
        joint, depth = waiting.pop()
        if depth > LONGEST_CHAIN:
            reason = f"has a chain of more than {LONGEST_CHAIN} joints: merge links that are fixed to each other"
            raise UrdfError(path, reason, "too-many-links", joint.line)
        joints.append(joint)
        waiting += [(next_joint, depth + 1) for next_joint in reversed(below[joint.child])]
    return tuple(joints)


def _open_loop(joint: Joint, carrying: Mapping[str, Joint]) -> Finding:
    """Name the loop that a joint closes: from its parent to its child through the tree."""
    up, down = (list(_way_up(link, carrying)) for link in (joint.parent, joint.child))
    common = next(link for link in up if link in set(down))
    loop = [*up[: up.index(common) + 1], *reversed(down[: down.index(common)])]
    named = " – ".join(f"'{link}'" for link in loop[:_NAMED]) + (
        f" – … ({len(loop)} links)" if len(loop) > _NAMED else ""
    )
    message = f"closes the loop {named}: it is left out, and the loop is open here"
    return make_finding("loop-open", joint.subject, message, line=joint.line)


def _way_up(link: str, carrying: Mapping[str, Joint]) -> Iterator[str]:
    yield link
    while link in carrying:
        link = carrying[link].parent
        yield link


def _leave_out(root: str, names: Sequence[str]) -> Iterator[Finding]:
    if names:
        more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
        message = f"is read as the root; left out are {', '.join(names[:_NAMED])}{more}"
        yield make_finding("root-given", f"link '{root}'", message)

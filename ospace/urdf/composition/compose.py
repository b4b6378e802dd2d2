"""From a bus, arms and payloads to the URDF of one robot; nothing that their files hold is lost on the way."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from lxml import etree

from ospace.exceptions import OspaceError, closest, printable
from ospace.files import replacing
from ospace.kernels.tree import Floats
from ospace.urdf import encoding, reader, source, structure, xacro
from ospace.urdf.bodies import Body, bodies_of
from ospace.urdf.composition.names import Look, add_prefix, declared, rename_materials
from ospace.urdf.composition.parts import Composition, Part, PlacedPart
from ospace.urdf.composition.simple_body import is_simple_body, simple_body
from ospace.urdf.composition.tree import WORLD, Links, drop_world, mount, move_meshes, remove_branch
from ospace.urdf.description import ZERO, Description, Pose
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, by_severity
from ospace.urdf.lint.foreign import foreign_joints
from ospace.urdf.parse import has_quaternions, parse
from ospace.urdf.source import Limits
from ospace.urdf.tree import span


class _Loaded(NamedTuple):
    """A part's file with comments, what it says, the tree of its links, the folder of its meshes, and a note."""

    root: etree._Element
    description: Description
    tree: Description
    folder: Path
    note: str = ""
    warnings: tuple[Finding, ...] = ()


def compose(
    bus: str | os.PathLike[str] | Part,
    *parts: str | os.PathLike[str] | Part,
    payloads: Iterable[tuple[str, str]] = (),
    out: str | os.PathLike[str] | None = None,
    package_dirs: Sequence[str | os.PathLike[str]] = (),
    limits: Limits | None = None,
) -> Composition:
    """Put arms and payloads on a bus, and write the robot as one URDF.

    A root link ``world`` of a part is left out where it is only a frame. Meshes stay where they are: relative paths
    become relative to the folder of `out`. A comment says where each part comes from.

    Parameters
    ----------
    bus : path-like or Part
        The part whose root is the base: a URDF, a body in a few words, or a mesh with its mass.
    parts : path-like or Part
        What is fixed to it, or to a part that stands before.
    payloads : iterable of (str, str)
        A link, and a body that is fixed at its origin: mass, principal moments and centre of mass, as
        ``"5kg,0.1x0.1x0.1kgm2,0x0x0.2m"``, or any other body.
    out : path-like, optional
        Where to write it; nothing is written without it. A file that is there is replaced.
    package_dirs : sequence of path-like
        Folders in which ``package://`` names of meshes are looked up, and ``$(find package)`` of a xacro.
    limits : ospace.Limits, optional
        How large each part, and the robot, may be.

    Returns
    -------
    Composition

    Raises
    ------
    UrdfError
        A part cannot be read.
    OspaceError
        Parts share names, a link to mount on or to remove is not there, a body makes no sense, or `out` is a part.
    """
    given = [one if isinstance(one, Part) else Part(one) for one in (bus, *parts)]
    given += _payloads(payloads)
    first = given[0]
    if first.on is not None or (first.at, first.rpy) != (ZERO, ZERO):
        raise OspaceError(
            f"{os.fspath(first.source)}: is the first part, which stands on nothing: leave out at, rpy and on"
        )
    path, limits = Path("composed.urdf" if out is None else out), limits or Limits()
    _check_out(out, given)
    folders = [Path(folder) for folder in package_dirs]
    robot = _Robot(path, folders, limits)
    for part in given:
        robot.add(part)
    content = robot.content(path.stem)
    reading = reader.read_content(path, content, package_dirs=folders, limits=limits)
    mass, centre = _mass_centre(bodies_of(reading.description))
    if out is not None:
        try:
            with replacing(out) as file:
                file.write_bytes(content)
        except OSError as error:
            raise OspaceError(printable(f"{os.fspath(out)}: cannot be written: {error.strerror}")) from None
    findings = by_severity([*reading.findings, *robot.warnings])
    return Composition(content, tuple(robot.parts), findings, mass, centre, reading.description.root)


def _payloads(payloads: Iterable[tuple[str, str]]) -> Iterator[Part]:
    for k, payload in enumerate(payloads, 1):
        if not isinstance(payload, tuple | list) or [type(one) for one in payload] != [str, str]:
            raise OspaceError(f"payload {payload!r}: give a link and a body, as ('hand', '5kg,0.1kgm2')")
        link, text = payload
        name = "payload" if k == 1 else f"payload_{k}"
        yield Part(text if is_simple_body(text) else f"body:{text}", on=link, name=name)


def _check_out(out: str | os.PathLike[str] | None, parts: Iterable[Part]) -> None:
    for part in parts:
        if out is not None and part.file is not None and os.path.realpath(part.file) == os.path.realpath(out):
            raise OspaceError(printable(f"{os.fspath(out)}: is read as a part: give another name to write to"))


class _Robot:
    """The robot that grows part by part."""

    def __init__(self, out: Path, package_dirs: Sequence[Path], limits: Limits) -> None:
        self.folder, self.package_dirs, self.limits = out.parent, package_dirs, limits
        self.warnings: list[Finding] = []
        self.roots: list[etree._Element] = []
        self.parts: list[PlacedPart] = []
        self.declared: dict[tuple[str, str], Part] = {}
        self.materials: dict[str, frozenset[Look]] = {}
        self.base = ""

    def add(self, part: Part) -> None:
        """Cut a part to what stays of it, give it its names, and mount it."""
        is_base = not self.parts
        loaded = _body(part, "bus" if is_base else "body", self.limits) or _file(part, self.package_dirs, self.limits)
        root, tree = loaded.root, Links(loaded.root, loaded.tree)
        removed, leaving = self._cut(part, loaded, tree, is_base=is_base)
        mass = sum(link.inertial.mass for link in loaded.description.links if link.inertial and link.name in tree.links)
        move_meshes(root, loaded.folder, self.folder)
        if part.prefix:
            add_prefix(root, part.prefix)
        rename_materials(root, part.prefix, self.materials)
        on = "" if is_base else self._mount_link(part)
        if not is_base:
            mount(root, part.prefix + tree.base, leaving, on, part.at, part.rpy)
        self._declare(part, root)
        links, joints = (tuple(str(one.get("name")) for one in root.iterchildren(tag)) for tag in ("link", "joint"))
        moving = sum(joint.get("type") != "fixed" for joint in tree.joints.values())
        placed = PlacedPart(part, loaded.description.name, on, links, joints, moving, mass, tuple(removed), loaded.note)
        self.roots.append(root)
        self.parts.append(placed)
        self.warnings += [replace(one, subject=f"part '{placed.label}'") for one in loaded.warnings]

    def _cut(
        self, part: Part, loaded: _Loaded, tree: Links, *, is_base: bool
    ) -> tuple[list[str], list[tuple[etree._Element, Pose]] | None]:
        """Take out what is to be removed, and the world; return names of links, and joints that left the world."""
        try:
            removed = [name for branch in part.remove for name in remove_branch(tree, branch)]
        except OspaceError as error:
            raise OspaceError(printable(f"{os.fspath(part.source)}: {error}")) from None
        left = replace(
            loaded.tree,
            links=tuple(link for link in loaded.tree.links if link.name in tree.links),
            joints=tuple(joint for joint in loaded.tree.joints if joint.name in tree.joints),
        )
        structure.check_base(Path(part.source), left)
        floating = structure.with_floating_base(left)[0]
        ground = [name for name in tree.links if name not in floating.link]
        if ground and not is_base:  # what the part floats in; here it is fixed
            tree.take_out(set(ground))
            removed += ground
        leaving = drop_world(tree, loaded.description, is_base=is_base)
        removed += [] if leaving is None else [WORLD]
        if is_base:
            self.base = part.prefix + (floating.root if floating.root in tree.links else tree.base)
        return removed, leaving

    def _mount_link(self, part: Part) -> str:
        known = [name for placed in self.parts for name in placed.links]
        if part.on is None:
            return self.base
        if part.on not in known:
            where = f"{os.fspath(part.source)}: there is no link '{part.on}' to put it on among the parts before it"
            raise OspaceError(printable(f"{where}{closest(part.on, known)}"))
        return part.on

    def _declare(self, part: Part, root: etree._Element) -> None:
        """Raise `OspaceError` where names of a part are those of another."""
        names = list(declared(root))
        twice = [key for key in names if key in self.declared]
        if twice:
            tag, name = twice[0]
            first, second = (os.fspath(one.source) for one in (self.declared[twice[0]], part))
            more = f", and {len(twice) - 1} more names" if len(twice) > 1 else ""
            remedy = "another prefix" if part.prefix else "a prefix"
            stem = re.sub(r"\W+", "_", Path(second).stem) if not is_simple_body(second) else "second"
            raise OspaceError(
                printable(
                    f"{tag} '{name}' is in both {first} and {second}{more}: give the second {remedy}, such as "
                    f"prefix='{stem}_'"
                )
            )
        self.declared.update(dict.fromkeys(names, part))

    def content(self, name: str) -> bytes:
        """Write all parts into the <robot> of the first."""
        whole = self.roots[0]
        _unite_versions(self.roots, [part.part for part in self.parts])
        whole.set("name", printable(name))  # of a file, which may have letters that XML cannot hold
        for root, part in zip(self.roots, self.parts, strict=True):
            start = etree.Comment(f" {part.comment} ")
            start.tail = "\n  "
            children = [start, *_outside(root, preceding=True), *root, *_outside(root, preceding=False)]
            if root is whole:
                text = (root.text or "").strip()
                whole.text = f"{text}\n  "
                for k, child in enumerate(children):
                    whole.insert(k, child)
            else:
                whole[-1].tail = f"{(whole[-1].tail or '').rstrip()}\n\n  "
                start.tail = f"{(root.text or '').strip()}\n  "
                whole.extend(children)
        whole[-1].tail = f"{(whole[-1].tail or '').rstrip()}\n"
        etree.cleanup_namespaces(whole, keep_ns_prefixes=[prefix for prefix in whole.nsmap if prefix])
        return bytes(etree.tostring(whole, encoding="utf-8", xml_declaration=True)) + b"\n"


def _outside(root: etree._Element, *, preceding: bool) -> Sequence[etree._Element]:
    """Return the comments before or behind <robot>, as licences are, in their order."""
    comments = [one for one in root.itersiblings(preceding=preceding) if isinstance(one, etree._Comment)]
    for comment in comments:
        comment.tail = "\n  "
    return comments[::-1] if preceding else comments


def _body(part: Part, name: str, limits: Limits) -> _Loaded | None:
    """Make a body of a few words; None where they are none."""
    text = os.fspath(part.source)
    if not is_simple_body(text):
        return None
    body = simple_body(text, part.name or name)
    return _Loaded(*_parsed(Path(text), body.urdf, limits), Path(), body.note)


def _file(part: Part, package_dirs: Sequence[Path], limits: Limits) -> _Loaded:
    path = Path(part.source)
    text = xacro.read(path, package_dirs=package_dirs, arguments=part.xacro_args, limits=limits)
    try:
        return _Loaded(*_parsed(path, text.content, limits), path.parent, warnings=tuple(text.findings()))
    except UrdfError as error:
        raise text.locate_error(path, error) from None


def _parsed(path: Path, content: bytes, limits: Limits) -> tuple[etree._Element, Description, Description]:
    """Return the file as XML, what it says, and the tree of its links."""
    root = source.parse(path, encoding.decode(path, content).content, limits, comments=True)
    source.check_format(path, root)
    structure.check_size(path, root, limits)
    description, _ = parse(root, path.stem)
    return root, description, span(path, description, foreign=foreign_joints(root)).description


def _unite_versions(roots: Sequence[etree._Element], parts: Sequence[Part]) -> None:
    """Declare the newest version of URDF that a part has; raises `OspaceError` where that would change another part."""
    newest = max((str(root.get("version")) for root in roots if has_quaternions(root)), default="")
    if not newest:
        return
    for root, part in zip(roots, parts, strict=True):
        if not has_quaternions(root) and root.find(".//origin[@quat_xyzw]") is not None:
            raise OspaceError(
                printable(
                    f"{os.fspath(part.source)}: has quat_xyzw, which its version of URDF does not use, and "
                    f"version {newest} of another part does: write rpy, or version='{newest}' if it is meant"
                )
            )
    roots[0].set("version", newest)


def _mass_centre(bodies: Sequence[Body]) -> tuple[float, Floats]:
    """Compute mass (kg) and centre of mass (m) of the bodies in the frame of the first, joints at zero."""
    frames: list[tuple[Floats, Floats]] = []
    for body in bodies:
        R, p = frames[body.parent] if body.parent >= 0 else (np.eye(3), np.zeros(3))
        frames.append((R @ body.rotation, R @ body.translation + p))
    mass = sum(body.mass for body in bodies)
    moment = sum((body.mass * (R @ body.centre + p) for body, (R, p) in zip(bodies, frames, strict=True)), np.zeros(3))
    return mass, moment / mass if mass > 0.0 else np.zeros(3)

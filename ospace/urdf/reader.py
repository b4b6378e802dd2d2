"""From a URDF file to a Pinocchio model with a free-flying base that is what the file says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pinocchio as pin
from lxml import etree

from ospace.exceptions import printable
from ospace.urdf import encoding, parity, source, structure, tree, xacro
from ospace.urdf.bodies import bodies_of
from ospace.urdf.build import build, build_original
from ospace.urdf.coupling import couple, followings
from ospace.urdf.description import Description
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint import inertia, joints, meshes, mimicry, plausibility, scale
from ospace.urdf.lint.findings import Finding, any_error, by_severity, make_finding
from ospace.urdf.lint.foreign import foreign_joints
from ospace.urdf.parse import parse
from ospace.urdf.source import Limits

_NO_INERTIAL = {"inertial-unreadable", "number-range", "two-orientations", "inertia-asymmetric"}


@dataclass(frozen=True)
class Reading:
    """Content of a URDF.

    Attributes
    ----------
    description : Description
        Links, joints and shapes, as the file has them.
    findings : tuple of Finding
    model : pin.Model or None
        None where a finding is an error.
    """

    description: Description
    findings: tuple[Finding, ...]
    model: pin.Model | None


def read(
    path: Path,
    *,
    package_dirs: Sequence[Path] = (),
    xacro_args: Mapping[str, str] | None = None,
    limits: Limits | None = None,
    free_mimic: bool = False,
    root: str | None = None,
) -> Reading:
    """Read the URDF or xacro at `path`.

    Parameters
    ----------
    path : Path
    package_dirs : sequence of Path
        Folders in which ``package://`` names of meshes are looked up, and ``$(find package)`` of a xacro.
    xacro_args : mapping of str to str, optional
        Values of the <xacro:arg> of a xacro.
    limits : Limits, optional
    free_mimic : bool
        Take joints that mimic others as independent, with a warning; else they follow these.
    root : str, optional
        Link to read as the base, with what hangs from it; else the one that hangs from none.

    Returns
    -------
    Reading
        Description, findings, and the model unless a finding is an error. Lines of a xacro are those of the files that
        it is made of.

    Raises
    ------
    UrdfError
        The file cannot be read, is not a URDF, or its links do not form a tree.
    """
    text = xacro.read(path, package_dirs=package_dirs, arguments=xacro_args, limits=limits)
    try:
        reading = read_content(
            path, text.content, package_dirs=package_dirs, limits=limits, free_mimic=free_mimic, root=root
        )
    except UrdfError as error:
        raise text.locate_error(path, error) from None
    findings = [*map(text.locate, reading.findings), *text.findings()]
    return replace(reading, description=text.locate_parts(reading.description), findings=by_severity(findings))


def read_content(
    path: Path,
    content: bytes,
    *,
    package_dirs: Sequence[Path] = (),
    limits: Limits | None = None,
    free_mimic: bool = False,
    root: str | None = None,
) -> Reading:
    """Read `content` as that of the URDF at `path`; parameters and errors are those of `read`.

    Returns
    -------
    Reading

    Raises
    ------
    UrdfError
        The content is not a URDF, or its links do not form a tree.
    """
    limits = limits or Limits()
    text = encoding.decode(path, content)
    file = source.parse(path, text.content, limits)
    of_format = source.check_format(path, file)
    structure.check_size(path, file, limits)
    description, findings = parse(file, printable(path.stem))
    findings += of_format
    if text.is_declared_late:
        findings.append(make_finding("declaration-late", "file", "blank lines stand before <?xml …?>", line=1))
    spanned = tree.span(path, description, root=root, foreign=foreign_joints(file))
    described = spanned.description
    findings = [finding for finding in findings if finding.subject not in spanned.left_out]
    structure.check_base(path, described)
    description, of_base = structure.with_floating_base(described)
    structure.check_dof(path, description, limits)
    bodies, followers = bodies_of(description), {} if free_mimic else followings(description)
    findings += [*spanned.findings, *of_base]
    findings += joints.check_joints(description)
    findings += mimicry.check_mimicry(description, free_mimic=free_mimic)
    # A link whose <inertial> cannot be read seems massless here: what follows from that is not reported.
    if not any(finding.code in _NO_INERTIAL for finding in findings):
        findings += inertia.check_bodies(bodies, followers)
    findings += plausibility.check_links(description)
    findings += scale.check_scale(description, bodies)
    findings += meshes.check_meshes(description, path, package_dirs)
    if any_error(findings):
        return Reading(description, by_severity(findings), None)
    model, built = build(path, description)
    parity.check_built(path, bodies, model)
    content = _without(file, described) if spanned.left_out else text.content
    original, errors = build_original(content, described, has_free_flyer=description.root != described.root)
    built += parity.check_original(bodies, original, errors, findings)
    if followers:
        model = couple(model, followers)
    findings += built
    return Reading(description, by_severity(findings), None if any_error(built) else model)


def _without(file: etree._Element, described: Description) -> bytes:
    """Return the file as it stands, but for links and joints that are not in the tree."""
    for tag, names in (("link", described.link), ("joint", described.joint)):
        for element in file.findall(tag):
            if element.get("name") not in names:
                file.remove(element)
    return etree.tostring(file, encoding="utf-8")

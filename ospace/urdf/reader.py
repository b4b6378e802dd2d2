"""From a URDF file to a Pinocchio model with a free-flying base that is what the file says."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin

from ospace.exceptions import printable
from ospace.urdf import parity, source, structure
from ospace.urdf.bodies import bodies_of
from ospace.urdf.build import as_it_stands, build
from ospace.urdf.description import Description
from ospace.urdf.lint import inertia, joints, meshes, plausibility
from ospace.urdf.lint.findings import Finding, any_error, gravest_first
from ospace.urdf.parse import parse
from ospace.urdf.source import Limits

_NO_INERTIAL = {"inertial-unreadable", "number-range", "two-orientations", "inertia-asymmetric"}


@dataclass(frozen=True)
class Reading:
    """What a URDF holds.

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
    path: Path, *, package_dirs: Sequence[Path] = (), limits: Limits | None = None, free_mimic: bool = False
) -> Reading:
    """Read the URDF at `path`.

    Parameters
    ----------
    path : Path
    package_dirs : sequence of Path
        Folders in which ``package://`` names of meshes are looked up.
    limits : Limits, optional
    free_mimic : bool
        Take joints that mimic others as independent, with a warning; else they are an error.

    Raises
    ------
    UrdfError
        The file cannot be read, is no URDF, or its links are no tree.
    """
    limits = limits or Limits()
    content = source.content_of(path, limits)
    return of_content(path, content, package_dirs=package_dirs, limits=limits, free_mimic=free_mimic)


def of_content(
    path: Path,
    content: bytes,
    *,
    package_dirs: Sequence[Path] = (),
    limits: Limits | None = None,
    free_mimic: bool = False,
) -> Reading:
    """Read what stands in the URDF at `path`, or would; as `read` does otherwise."""
    limits = limits or Limits()
    root = source.parse(path, content, limits)
    source.check_format(path, root)
    structure.check_size(path, root, limits)
    description, findings = parse(root, printable(path.stem))
    whole = structure.ordered(path, description, limits)
    description, of_base = structure.with_floating_base(whole)
    structure.check_dof(path, description, limits)
    bodies = bodies_of(description)
    findings += of_base
    findings += joints.of_joints(description, free_mimic=free_mimic)
    # A link whose <inertial> cannot be read seems massless here: what follows from that is not to be told.
    if not any(finding.code in _NO_INERTIAL for finding in findings):
        findings += inertia.of_description(bodies)
    findings += plausibility.of_links(description)
    findings += plausibility.of_bodies(bodies)
    findings += meshes.of_shapes(description, path, package_dirs)
    if any_error(findings):
        return Reading(description, gravest_first(findings), None)
    model, said = build(path, description)
    parity.prove(path, bodies, model)
    original, errors = as_it_stands(content, whole, has_free_flyer=description.root != whole.root)
    said += parity.of_original(bodies, original, errors, findings)
    findings += said
    return Reading(description, gravest_first(findings), None if any_error(said) else model)

"""Files of a robot's meshes, and findings on those that cannot be drawn. Nothing else is opened."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from ospace.exceptions import OspaceError
from ospace.files import open_regular
from ospace.urdf.description import Description, Link, Shape
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.rules import Severity

MOST = 1000  # files that are looked for
_STL_HEADER, _STL_FACET = 84, 50  # bytes
_MANIFEST = "package.xml"
_MANIFEST_SIZE = 100_000  # bytes of it that are read


class MeshError(OspaceError):
    """The mesh cannot be used; `code` is that of the finding."""

    def __init__(self, code: str, reason: str) -> None:
        super().__init__(reason)
        self.code = code


def locate(filename: str, urdf: Path, package_dirs: Sequence[Path]) -> Path:
    """Return the file that a <mesh> names, within the file's own folder, its package, and the folders given.

    Parameters
    ----------
    filename : str
        A path beside the URDF, or an address of the scheme ``file``, ``package`` or ``model``.
    urdf : Path
    package_dirs : sequence of Path
        Folders of packages, or packages themselves.

    Returns
    -------
    Path

    Raises
    ------
    MeshError
        The file is missing, elsewhere, or not whole.
    """
    scheme, _, rest = filename.partition("://") if "://" in filename else ("", "", filename)
    if not rest:
        raise MeshError("mesh-missing", "<mesh> has no filename")
    packages = _packages_of(urdf)
    if scheme in ("package", "model"):
        rest = rest.lstrip("/")  # a third slash is common, and leads nowhere else
        package, _, inside = rest.partition("/")
        choices = [folder / rest for folder in package_dirs]
        choices += [folder / inside for folder in package_dirs if folder.name == package]
        choices += [folder / inside for folder in packages if package in (folder.name, _name_in_manifest(folder))]
        if not choices:
            if os.path.normpath(inside).startswith(".."):
                raise MeshError("mesh-outside", f"'{filename}' climbs out of its package")
            raise MeshError("mesh-not-looked-up", f"'{filename}' is in a package")
    elif scheme in ("", "file"):
        choices = [urdf.parent / rest]
    else:
        raise MeshError("mesh-remote", f"'{filename}' is an address, which is not fetched")
    allowed = [os.path.realpath(folder) for folder in (urdf.parent, *packages, *package_dirs)]
    inside_allowed = [
        choice
        for choice in choices
        if any(os.path.commonpath([folder, os.path.realpath(choice)]) == folder for folder in allowed)
    ]
    if not inside_allowed:
        raise MeshError("mesh-outside", f"'{filename}' lies outside the file's package and the folders given")
    there = [choice for choice in inside_allowed if os.path.lexists(choice)]
    if not there:
        raise MeshError("mesh-missing", f"'{filename}' is not there")
    _check_whole(there[0], filename)
    return there[0]


def _packages_of(urdf: Path) -> tuple[Path, ...]:
    """Return the packages that a file lies in: that of its name, and where this is a link, that of what it leads to.

    The package is the nearest folder upward with a package.xml, else the folder above the file's own. The user's home,
    and what holds it, is none: a robot in ~/robots/ does not open what else is there.
    """
    home = Path(os.path.realpath(os.path.expanduser("~")))
    packages = dict[Path, None]()
    for own in (Path(os.path.realpath(urdf.parent)), Path(os.path.realpath(urdf)).parent):
        package = next((folder for folder in (own, *own.parents) if (folder / _MANIFEST).is_file()), own.parent)
        if not home.is_relative_to(package):
            packages[package] = None
    return tuple(packages)


def _name_in_manifest(package: Path) -> str:
    """Return the name in a package.xml; its folder may bear another, as that of a branch."""
    try:
        with open(package / _MANIFEST, encoding="utf-8", errors="replace") as file:
            named = re.search(r"<name>\s*([^<\s]+)\s*</name>", file.read(_MANIFEST_SIZE))
    except OSError:
        return ""
    return named[1] if named else ""


def check_meshes(description: Description, urdf: Path, package_dirs: Sequence[Path]) -> Iterator[Finding]:
    """Look for the meshes of all links, and check their scales.

    Returns
    -------
    iterator of Finding
    """
    not_looked_up: dict[str, Shape] = {}
    looked_for: set[str] = set()
    for link in description.links:
        reported: set[str] = set()
        scaled: set[tuple[str, tuple[float, ...]]] = set()
        for shape in link.shapes:
            if shape.kind != "mesh":
                continue
            if (shape.filename, shape.size) not in scaled:
                scaled.add((shape.filename, shape.size))
                yield from _check_scale(link, shape)
            if shape.filename in reported:
                continue
            reported.add(shape.filename)
            looked_for.add(shape.filename)
            try:
                if len(looked_for) > MOST:
                    raise MeshError("mesh-not-looked-up", "there are too many")
                locate(shape.filename, urdf, package_dirs)
            except MeshError as error:
                if error.code == "mesh-not-looked-up":
                    not_looked_up.setdefault(shape.filename, shape)
                else:
                    yield make_finding(error.code, link.subject, str(error), line=shape.line, value=shape.filename)
    if not_looked_up:
        first = next(iter(not_looked_up))
        message = f"{len(not_looked_up)} meshes were not looked for, the first '{first}'"
        yield make_finding("mesh-not-looked-up", "file", message, line=not_looked_up[first].line, value=first)


def _check_scale(link: Link, shape: Shape) -> Iterator[Finding]:
    if min(shape.size) <= 0.0:
        scale = " ".join(f"{factor:g}" for factor in shape.size)
        flat = 0.0 in shape.size
        message = f"'{shape.filename}' has the scale {scale}: it is " + ("flat" if flat else "mirrored")
        severity: Severity = "warning" if flat else "info"
        yield make_finding("mesh-scale", link.subject, message, severity=severity, line=shape.line, value=scale)


def _check_whole(path: Path, filename: str) -> None:
    try:
        with open_regular(path) as file:
            status = os.fstat(file.fileno())
            start = file.read(_STL_HEADER)
    except OSError as error:
        raise MeshError("mesh-unreadable", f"'{filename}' cannot be read: {error.strerror}") from None
    if not start:
        raise MeshError("mesh-unreadable", f"'{filename}' is empty")
    if path.suffix.lower() == ".stl" and not start.lstrip().startswith(b"solid"):
        whole = _STL_HEADER + _STL_FACET * int.from_bytes(start[-4:], "little")
        if len(start) < _STL_HEADER or status.st_size < whole:
            raise MeshError("mesh-unreadable", f"'{filename}' is cut off: it has {status.st_size} bytes")

"""From a xacro to the text of a URDF: the library xacro expands it, in a process of its own with bounds."""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from ospace.exceptions import OspaceError, printable
from ospace.urdf import source
from ospace.urdf.description import Description, Inertial, Limit, Mimic, SourceLine
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.source import Limits

_CHILD = Path(__file__).with_name("xacro_process.py")
_LIBRARIES = ("xacro", "yaml")
_WITHIN_PACKAGE = {"urdf", "xacro", "robots", "robot", "models", "model"}
"""Usual names of the folder of a package that holds its robots."""
_HARMLESS = ("redefining global symbol", "Using ", "macro names must not contain prefix")
"""Beginnings of warnings of xacro that say nothing of the robot."""
_RAISED = ", ".join(f"limits=Limits({name}=N)" for name in ("seconds", "memory", "bytes"))


@dataclass(frozen=True)
class Expanded:
    """The text of a URDF, and where each line of it comes from.

    Attributes
    ----------
    content : bytes
        Of the file itself where it is not a xacro.
    files : tuple of Path
        The xacro and those that it includes; empty where it is not one.
    origins : mapping of int to (int, int)
        For the line of each element in `content`, the number of its file and its line there.
    warnings : tuple of str
        Of xacro.
    """

    content: bytes
    files: tuple[Path, ...] = ()
    origins: Mapping[int, tuple[int, int]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def findings(self) -> Iterator[Finding]:
        """Report what xacro warned of."""
        for warning in dict.fromkeys(self.warnings):
            mild = warning.startswith(_HARMLESS)
            yield make_finding("xacro-warning", "file", f"xacro says: {warning}", severity="info" if mild else None)

    def line(self, line: int | None) -> int | None:
        """Return the line that a line of `content` comes from; one of a file that is included knows its name."""
        if not self.files or line is None:
            return line
        number, source = self.origins.get(line, (0, 0))
        if not source:
            return None
        return SourceLine(source, printable(self.files[number].name)) if number else source

    def locate(self, finding: Finding) -> Finding:
        """Return the finding with the file and line that its element comes from."""
        line = self.line(finding.line)
        return replace(finding, line=None if line is None else int(line), file=getattr(line, "file", None))

    def locate_error(self, path: Path, error: UrdfError) -> UrdfError:
        """Return the refusal with the file and line that its element comes from."""
        number, _ = self.origins.get(error.line or 0, (0, 0))
        line = self.line(error.line)
        return UrdfError(self.files[number] if number else path, error.reason, error.code, line and int(line))

    def locate_parts(self, description: Description) -> Description:
        """Return the description with the lines that its parts come from."""
        if not self.files:
            return description
        return replace(
            description,
            links=tuple(map(self._locate_part, description.links)),
            joints=tuple(map(self._locate_part, description.joints)),
        )

    def _locate_part(self, part: Any) -> Any:
        """Return a part with its line, and those of its own parts."""
        changed: dict[str, Any] = {}
        for part_field in fields(part):
            value = getattr(part, part_field.name)
            if part_field.name == "line":
                changed["line"] = self.line(value)
            elif isinstance(value, Inertial | Limit | Mimic):
                changed[part_field.name] = self._locate_part(value)
            elif part_field.name == "shapes":
                changed["shapes"] = tuple(map(self._locate_part, value))
        return replace(part, **changed)


def read(
    path: Path,
    *,
    package_dirs: Sequence[Path] = (),
    arguments: Mapping[str, str] | None = None,
    limits: Limits | None = None,
) -> Expanded:
    """Read a URDF, or expand a xacro, which a name that ends in .xacro tells.

    Files in the xacro's own package and in `package_dirs` are read, and no others; environment variables are not there.

    Parameters
    ----------
    path : Path
    package_dirs : sequence of Path
        Folders that hold packages, or are one, for ``$(find package)``.
    arguments : mapping of str to str, optional
        Values of its <xacro:arg>.
    limits : Limits, optional

    Returns
    -------
    Expanded

    Raises
    ------
    UrdfError
        The file cannot be read, or not be expanded: code xacro-failed, xacro-package, xacro-outside or xacro-exhausted.
    OspaceError
        There are arguments, and the file is not a xacro.
    """
    limits, arguments = limits or Limits(), dict(arguments or {})
    content = source.read_file(path, limits)
    if path.suffix.lower() != ".xacro":
        if arguments:
            raise OspaceError(f"{path}: is not a xacro and takes no argument '{next(iter(arguments))}'")
        return Expanded(content)
    for name, value in arguments.items():
        if not isinstance(name, str) or not isinstance(value, str):
            raise OspaceError(f"argument {name!r}={value!r} of a xacro: give names and values as text")
    return _expand(path, package_dirs, arguments, limits)


def own_package(path: Path) -> Path:
    """Return the folder of the package that a file lies in.

    Returns
    -------
    Path
        The nearest folder above that has a package.xml; without one the folder of the file, or the one above where it
        bears the usual name of a package's folder of robots, as urdf.
    """
    folder = Path(os.path.abspath(path)).parent
    for above in (folder, *folder.parents):
        if (above / "package.xml").is_file():
            return above
    for above in (folder, *folder.parents[:2]):
        if above.name in _WITHIN_PACKAGE and above.parent != Path(above.anchor):
            return above.parent
    return folder


def _expand(path: Path, package_dirs: Sequence[Path], arguments: Mapping[str, str], limits: Limits) -> Expanded:
    missing = [name for name in _LIBRARIES if importlib.util.find_spec(name) is None]
    if missing:
        raise OspaceError(f"{path}: to expand it needs the package xacro: pip install xacro")
    folders = [os.path.realpath(folder) for folder in (own_package(path), *package_dirs)]
    request = {
        "path": os.path.abspath(path),
        "folders": [*folders, os.path.realpath(path)],
        "package_dirs": folders[1:],
        "arguments": dict(arguments),
        "libraries": sorted({_site_of(name) for name in _LIBRARIES}),
        "bytes": limits.bytes,
        "seconds": limits.seconds,
        "memory": limits.memory,
    }
    answer, content = _ask(path, request, limits)
    if "error" in answer:
        macros = "".join(f", in macro '{name}'" for name in answer["macros"])
        where = Path(answer["path"]) if answer["path"] and answer["path"] != request["path"] else path
        raise UrdfError(where, f"{answer['error']}{macros}", answer["code"], answer["line"])
    files = tuple(map(Path, answer["files"]))
    origins = {line: (number, start) for line, (number, start) in answer["lines"]}
    return Expanded(content, files, origins, tuple(answer["warnings"]))


def _site_of(library: str) -> str:
    spec = importlib.util.find_spec(library)
    assert spec is not None
    assert spec.origin is not None
    return str(Path(spec.origin).parent.parent)


def _ask(path: Path, request: Mapping[str, object], limits: Limits) -> tuple[dict[str, Any], bytes]:
    """Let a process answer; its answer goes to a file, whose size the operating system bounds."""
    with tempfile.TemporaryFile() as out:
        try:
            done = subprocess.run(
                [sys.executable, "-I", "-S", "-X", "utf8", str(_CHILD)],
                input=json.dumps(request).encode(),
                stdout=out,
                stderr=subprocess.DEVNULL,
                env={},
                cwd=path.absolute().parent,
                timeout=limits.seconds,
                start_new_session=True,  # Ctrl-C is for this process, which ends the other
                check=False,
            )
        except subprocess.TimeoutExpired:
            reason = f"takes more than {limits.seconds} s to expand (limits=Limits(seconds=N))"
            raise UrdfError(path, reason, "xacro-exhausted") from None
        except OSError as error:
            raise UrdfError(path, f"cannot be expanded: {error.strerror}", "xacro-failed") from None
        out.seek(0)
        head, _, content = out.read().partition(b"\n")
    if done.returncode != 0:
        reason = f"takes more time, memory or output to expand than it may (status {done.returncode})"
        raise UrdfError(path, f"{reason}: {_RAISED}", "xacro-exhausted")
    return json.loads(head), content

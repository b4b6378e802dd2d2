"""From a URDF file to a Pinocchio model with a free-flying base."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pinocchio as pin
from lxml import etree

from ospace.exceptions import UrdfError
from ospace.urdf import findings, structure
from ospace.urdf.findings import Finding

MAX_BYTES = 20_000_000


@dataclass(frozen=True)
class Reading:
    """What a URDF holds: Pinocchio's model, and what is odd about the file."""

    model: pin.Model
    findings: tuple[Finding, ...]


def read(path: Path) -> Reading:
    """Read the URDF at `path`.

    Raises
    ------
    UrdfError
        No such file, no regular file, too large, no XML, no URDF, or rejected by Pinocchio.
    """
    root = _parse(path, _bytes_of(path))
    structure.check(path, root)
    joints = {str(joint.get("name")): joint for joint in root.iterfind("joint")}
    mimics = [
        findings.mimic(name, str(tag.get("joint")))
        for name, joint in joints.items()
        if (tag := joint.find("mimic")) is not None
    ]
    model, errors = _build(path, etree.tostring(root, encoding="unicode"), _unused_name(joints))
    return Reading(model, (*findings.of_parser(errors), *structure.of_links(root), *mimics))


def _bytes_of(path: Path) -> bytes:
    try:
        if path.exists() and not path.is_file():
            raise UrdfError(path, "is not a regular file: give a URDF file")
        size = path.stat().st_size
        if size > MAX_BYTES:
            raise UrdfError(path, f"has {size} bytes; at most {MAX_BYTES} are read")
        return path.read_bytes()
    except FileNotFoundError:
        raise UrdfError(path, "no such file") from None
    except (OSError, ValueError) as error:
        raise UrdfError(path, f"cannot be read: {error}") from None


def _parse(path: Path, content: bytes) -> etree._Element:
    parser = etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True, remove_pis=True)
    try:
        return etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise UrdfError(path, f"is no well-formed XML: {error.msg}") from None


def _unused_name(joints: dict[str, etree._Element]) -> str:
    """Name for the free-flyer that no joint of the file bears: one that does would be welded to the base."""
    name = "root_joint"
    while name in joints:
        name += "_"
    return name


def _build(path: Path, text: str, root_joint: str) -> tuple[pin.Model, list[str]]:
    """Return Pinocchio's model, and the errors that its parser wrote but did not raise."""
    model, reason = None, ""
    with _captured_stderr() as said:
        try:
            model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer(), root_joint)
        except (ValueError, RuntimeError) as error:
            reason = " ".join(str(error).split())
    errors = [" ".join(line.split()).removeprefix("Error: ") for line in said if line.strip().startswith("Error")]
    if model is None:
        raise UrdfError(path, f"Pinocchio rejects it: {'; '.join(errors) or reason}")
    return model, errors


@contextmanager
def _captured_stderr() -> Iterator[list[str]]:
    """Catch what C++ writes to file descriptor 2; its lines are in the yielded list afterwards."""
    said: list[str] = []
    sys.stderr.flush()
    with tempfile.TemporaryFile() as catch:
        kept = os.dup(2)
        os.dup2(catch.fileno(), 2)
        try:
            yield said
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            catch.seek(0)
            said += catch.read().decode(errors="replace").splitlines()

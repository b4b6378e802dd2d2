"""A repaired copy of a URDF, for what has one right repair; every other byte stays as it is.

Elements are found in the tree that lxml makes, and edited in the bytes of the file: expat tells where each one starts
and ends.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from xml.parsers import expat

import numpy as np
from lxml import etree

from ospace.exceptions import OspaceError, printable
from ospace.files import replacing
from ospace.kernels.tree import Floats
from ospace.urdf import encoding, reader, source, xacro
from ospace.urdf.lint.inertia import ROUNDED, classify_tensor
from ospace.urdf.no_limit import stands_for_none
from ospace.urdf.numbers import NumberError, has_space_around, numbers, without_space_around, words
from ospace.urdf.parse import LIMITS, OFF_UNIT, SCHEMA, TENSOR, TOO_SHORT, has_quaternions
from ospace.urdf.source import Limits, line_of

_UNLIMITED = "1e9"  # no robot gets there, and every reader can read it
_NUMERIC = (
    "link/inertial/*",
    "link/visual/origin",
    "link/visual/geometry/*",
    "link/collision/origin",
    "link/collision/geometry/*",
    "joint/*",
    "link/visual/material/color",
    "material/color",
)
_ORIGINS = ("joint/origin", "link/inertial/origin", "link/visual/origin", "link/collision/origin")
_NO_NUMBERS = {"link", "joint", "filename", "name"}  # attributes that hold words
_ATTRIBUTE = re.compile(rb"""\s*([^\s=/>]+)\s*=\s*("[^"]*"|'[^']*')""")


@dataclass(frozen=True)
class Change:
    """One repair: of which finding, where, and from what to what."""

    code: str
    subject: str
    line: int | None
    what: str

    def __str__(self) -> str:
        where = "" if self.line is None else f", line {self.line}"
        return printable(f"{self.code}: {self.subject}{where}: {self.what}")


@dataclass(frozen=True)
class _Edit:
    """New attributes of an element, or text before its end tag."""

    element: etree._Element
    attributes: dict[str, str]
    text: str = ""


def write(
    path: Path,
    out: Path,
    limits: Limits | None = None,
    *,
    package_dirs: Sequence[Path] = (),
    xacro_args: Mapping[str, str] | None = None,
    root: str | None = None,
) -> list[Change]:
    """Write a repaired copy of `path` to `out`, and nothing where there is nothing to repair.

    Of a xacro what it expands to is written, whether or not there is something to repair.

    Returns
    -------
    list of Change

    Raises
    ------
    UrdfError
        The file cannot be read, is not a URDF, or its links do not form a tree.
    OspaceError
        `out` exists, or cannot be written.
    """
    _refuse_to_overwrite(out)
    text = xacro.read(path, package_dirs=package_dirs, arguments=xacro_args, limits=limits)
    content, changes = repair_content(path, text.content, limits)
    reader.read_content(path, content, limits=limits, root=root)  # nothing is written that could not be read again
    if changes or text.files:
        try:
            with replacing(out) as part:
                part.write_bytes(content)
                _refuse_to_overwrite(out)  # what another has written meanwhile
        except OSError as error:
            raise OspaceError(f"{out}: cannot be written: {error.strerror}") from None
    return changes


def _refuse_to_overwrite(out: Path) -> None:
    if os.path.lexists(out):
        raise OspaceError(printable(f"{out}: exists already, and nothing is overwritten: give another name"))


def repair_content(path: Path, content: bytes, limits: Limits | None = None) -> tuple[bytes, list[Change]]:
    """Repair `content`, that of the URDF at `path`.

    Returns
    -------
    bytes
        Content of the repaired copy.
    list of Change

    Raises
    ------
    UrdfError
        The content is not a URDF.
    """
    limits = limits or Limits()
    text = encoding.decode(path, content)
    root = source.parse(path, text.content, limits)
    source.check_format(path, root)
    edits = [*_spaces(root), *_axes(root), *_quaternions(root), *_limits(root), *_tensors(root)]
    changes = [change for _, change in edits]
    if text.is_declared_late:
        changes.append(Change("declaration-late", "file", 1, "the blank lines before <?xml …?> go"))
    return text.restored(_edited(text.content, root, [edit for edit, _ in edits])), changes


# -- what is repaired --------------------------------------------------------------------------------------------------


def _spaces(root: etree._Element) -> Iterator[tuple[_Edit, Change]]:
    for where in _NUMERIC:
        for element in root.iterfind(where):
            tag = str(element.tag)
            for key in SCHEMA[tag][0] if tag in SCHEMA else ():
                text = element.get(key, "")
                if key not in _NO_NUMBERS and has_space_around(text) and _read(text, len(words(text))):
                    plain = without_space_around(text)
                    what = f"{key} of <{tag}> '{text}' becomes '{plain}'"
                    yield _Edit(element, {key: plain}), _change("number-spaces", element, what)


def _axes(root: etree._Element) -> Iterator[tuple[_Edit, Change]]:
    for joint in root.iterfind("joint"):
        axis = joint.find("axis")
        values = None if axis is None else _read(axis.get("xyz", ""), 3)
        if axis is None or values is None or joint.get("type") in ("fixed", "floating"):
            continue
        length = math.hypot(*values)
        if length >= TOO_SHORT and abs(length - 1.0) > OFF_UNIT:
            text = " ".join(_plain(value / length) for value in values)
            what = f"its axis '{axis.get('xyz')}' becomes '{text}'"
            yield _Edit(axis, {"xyz": text}), _change("axis-not-unit", axis, what)


def _quaternions(root: etree._Element) -> Iterator[tuple[_Edit, Change]]:
    for where in _ORIGINS if has_quaternions(root) else ():
        for origin in root.iterfind(where):
            values = _read(origin.get("quat_xyzw", ""), 4)
            length = 0.0 if values is None else math.hypot(*values)
            if values is not None and length >= TOO_SHORT and abs(length - 1.0) > OFF_UNIT:
                text = " ".join(_plain(value / length) for value in values)
                what = f"quat_xyzw '{origin.get('quat_xyzw')}' becomes '{text}'"
                yield _Edit(origin, {"quat_xyzw": text}), _change("quaternion-not-unit", origin, what)


def _limits(root: etree._Element) -> Iterator[tuple[_Edit, Change]]:
    for joint in root.iterfind("joint"):
        kind, limit = joint.get("type"), joint.find("limit")
        if limit is None and kind in ("revolute", "prismatic", "continuous"):
            ends = "" if kind == "continuous" else f'lower="-{_UNLIMITED}" upper="{_UNLIMITED}" '
            text = f'<limit {ends}effort="{_UNLIMITED}" velocity="{_UNLIMITED}"/>'
            yield _Edit(joint, {}, text), _change("limits-missing", joint, f"gets {text}")
        if limit is not None and kind in ("revolute", "prismatic", "continuous"):
            none = {key: limit.get(key, "") for key in LIMITS if stands_for_none(limit.get(key, ""), key, kind)}
            if none:
                written = {key: f"-{_UNLIMITED}" if key == "lower" else _UNLIMITED for key in none}
                what = ", ".join(f"{key} '{none[key]}' becomes '{text}'" for key, text in written.items())
                yield _Edit(limit, written), _change("limits-none", limit, what)
            missing = [key for key in ("effort", "velocity") if key not in limit.attrib]
            if missing:
                what = " and ".join(f'{key}="{_UNLIMITED}"' for key in missing)
                edit = _Edit(limit, dict.fromkeys(missing, _UNLIMITED))
                yield edit, _change("effort-missing", limit, f"<limit> gets {what}")


def _tensors(root: etree._Element) -> Iterator[tuple[_Edit, Change]]:
    for inertial in root.iterfind("link/inertial"):
        element, mass = inertial.find("inertia"), inertial.find("mass")
        if element is None or mass is None:
            continue
        read = [_read(element.get(key, ""), 1) for key in TENSOR] + [_read(mass.get("value", ""), 1)]
        values = [value[0] for value in read if value is not None]
        if len(values) < len(read) or values[-1] < 0.0:
            continue
        xx, xy, xz, yy, yz, zz, kilograms = values
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        code, share = classify_tensor(kilograms, tensor)
        if code == "planar-tensor" or (code and share <= ROUNDED):
            repaired = _disc(tensor) if code == "planar-tensor" else _nearest(tensor)
            nearest = dict(zip(TENSOR, repaired[np.triu_indices(3)].tolist(), strict=True))
            now = dict(zip(TENSOR, values, strict=False))
            changed = {key: _plain(nearest[key]) for key in TENSOR if nearest[key] != now[key]}
            what = ", ".join(f"{key} '{element.get(key)}' becomes '{text}'" for key, text in changed.items())
            yield _Edit(element, changed), _change(code, element, what)


def _disc(tensor: Floats) -> Floats:
    """Return the tensor of a flat body of which the largest moment alone is known: half of it about the other axes."""
    moments = np.diag(tensor)
    largest = moments.max()
    return np.diag(np.where(moments == largest, largest, 0.5 * largest))


def _nearest(tensor: Floats) -> Floats:
    """Return the tensor of the nearest distribution of mass: its second moments, Σ = ½ tr(I) 1 − I, not negative."""
    moments, axes = np.linalg.eigh(0.5 * np.trace(tensor) * np.eye(3) - tensor)
    sigma = axes * np.maximum(moments, 0.0) @ axes.T
    return np.asarray(np.trace(sigma) * np.eye(3) - sigma)


def _read(text: str, count: int) -> tuple[float, ...] | None:
    try:
        return numbers(text, count) or None
    except NumberError:
        return None


def _plain(value: float) -> str:
    return repr(value + 0.0).removesuffix(".0")


def _change(code: str, element: etree._Element, what: str) -> Change:
    part = next(item for item in (element, *element.iterancestors()) if item.tag in ("link", "joint", "material"))
    return Change(code, f"{part.tag!s} '{part.get('name', '')}'", line_of(element), what)


# -- in the bytes of the file ------------------------------------------------------------------------------------


def _edited(content: bytes, root: etree._Element, edits: list[_Edit]) -> bytes:
    starts, ends = _places(content)
    number = {element: k for k, element in enumerate(root.iter(etree.Element))}
    cuts: dict[tuple[int, int], bytes] = {}
    for edit in edits:
        k = number[edit.element]
        if edit.text:
            cuts[ends[k], ends[k]] = edit.text.encode()
        cuts |= _cuts_in_tag(content, starts[k], edit)
    # An axis may both lose white space and be divided by its length: the later edit of the same place holds.
    ordered = sorted(cuts)
    pieces = [content[: ordered[0][0]]] if ordered else [content]
    for (start, end), (following, _) in pairwise([*ordered, (len(content), 0)]):
        pieces += [cuts[start, end], content[end:following]]
    return b"".join(pieces)


def _cuts_in_tag(content: bytes, start: int, edit: _Edit) -> dict[tuple[int, int], bytes]:
    cuts = {}
    left = dict(edit.attributes)
    at = start + 1 + len(str(edit.element.tag).encode())
    while (match := _ATTRIBUTE.match(content, at)) is not None:
        value = left.pop(match[1].decode(), None)
        if value is not None:
            cuts[match.start(2) + 1, match.end(2) - 1] = value.encode()
        at = match.end()
    if left:
        cuts[at, at] = "".join(f' {key}="{value}"' for key, value in left.items()).encode()
    return cuts


def _places(content: bytes) -> tuple[list[int], list[int]]:
    """Return where each element's start tag and end tag begin, in the order of the start tags."""
    starts: list[int] = []
    ends: list[int] = []
    waiting: list[int] = []
    parser = expat.ParserCreate("utf-8")

    def start(name: str, attributes: dict[str, str]) -> None:
        waiting.append(len(starts))
        starts.append(parser.CurrentByteIndex)
        ends.append(-1)

    def end(name: str) -> None:
        ends[waiting.pop()] = parser.CurrentByteIndex

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(content, True)
    return starts, ends

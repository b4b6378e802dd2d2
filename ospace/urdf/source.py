"""From a path to an XML tree: what is opened, how much of it is read, and what is not even parsed."""

from __future__ import annotations

import os
import re
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from lxml import etree

from ospace.urdf.errors import UrdfError

_XACRO = "http://www.ros.org/wiki/xacro"
_XACRO_VALUE = re.compile(r"\$\{|\$\((find|arg|env|optenv|anon|eval|dirname)\b")
EXTENSIONS = {"gazebo", "sensor", "transmission", "ros2_control", "contact"}
"""Elements of other programs, which may hold anything."""
_LAST_LINE = 65535  # libxml2 counts no further
_UNEXPANDED = "is an unexpanded xacro: expand it first (xacro robot.xacro > robot.urdf)"
_FORMATS = {
    "sdf": "an SDF file",
    "mujoco": "an MJCF file of MuJoCo",
    "mujocoinclude": "an MJCF file of MuJoCo",
    "html": "an HTML page",
    "collada": "a COLLADA mesh",
}
_MAGIC = {
    b"\x1f\x8b": "is compressed with gzip",
    b"PK\x03\x04": "is a zip archive",
    b"BZh": "is compressed with bzip2",
    b"\xfd7zXZ": "is compressed with xz",
    b"\xff\xfe": "is UTF-16 text",
    b"\xfe\xff": "is UTF-16 text",
    b"<\x00": "is UTF-16 text",
    b"\x00<": "is UTF-16 text",
}


_DEEPEST, _LONGEST = 256, 10_000_000  # libxml2's own bounds on depth and on the characters of one text


@dataclass(frozen=True)
class Limits:
    """How large a file, and the robot in it, may be.

    Attributes
    ----------
    bytes : int
        Size of the file.
    depth : int
        Nesting of XML elements.
    attributes : int
        Attributes of one element.
    text : int
        Characters of one attribute.
    nodes : int
        Elements, attributes, comments and processing instructions of the file.
    links : int
    dof : int
        Degrees of freedom, the base's six included.
    seconds : int
        Time to expand a xacro.
    memory : int
        Bytes of memory to expand a xacro.
    """

    bytes: int = 20_000_000
    depth: int = 100
    attributes: int = 64
    text: int = 10_000
    nodes: int = 200_000
    links: int = 2000
    dof: int = 150
    seconds: int = 30
    memory: int = 1_000_000_000


def read_file(path: Path, limits: Limits) -> bytes:
    """Read the file: regular, not too large, UTF-8 text.

    Returns
    -------
    bytes

    Raises
    ------
    UrdfError
        The file is missing, not a regular file, larger than `limits.bytes`, not UTF-8 text, or cannot be read.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)  # a FIFO would wait for its writer
        with open(descriptor, "rb") as file:
            status = os.fstat(descriptor)
            if not stat.S_ISREG(status.st_mode):
                raise UrdfError(path, "is not a regular file: give a URDF file", "no-regular-file")
            if status.st_size > limits.bytes:
                reason = f"has {status.st_size} bytes; at most {limits.bytes} are read (--max-bytes)"
                raise UrdfError(path, reason, "too-large")
            content = file.read(status.st_size)
    except FileNotFoundError:
        raise UrdfError(path, "no such file", "no-file") from None
    except IsADirectoryError:
        raise UrdfError(path, "is not a regular file but a folder: give a URDF file", "no-regular-file") from None
    except (OSError, ValueError) as error:
        if os.path.exists(path) and not os.path.isfile(path):  # a socket or a device, which cannot even be opened
            raise UrdfError(path, "is not a regular file: give a URDF file", "no-regular-file") from None
        raise UrdfError(path, f"cannot be read: {error}", "unreadable-file") from None
    _check_text(path, content)
    return content


def _check_text(path: Path, content: bytes) -> None:
    for magic, what in _MAGIC.items():
        if content.startswith(magic):
            raise UrdfError(path, f"{what}: give a URDF in UTF-8", "not-text")
    where = content.find(b"\0")
    if where >= 0:
        raise UrdfError(path, "has a NUL byte: it is not text", "not-text", content.count(b"\n", 0, where) + 1)
    try:
        content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        reason = f"has the byte 0x{content[error.start]:02x}, which is not UTF-8: convert the file"
        raise UrdfError(path, reason, "not-text", line) from None


def parse(path: Path, content: bytes, limits: Limits) -> etree._Element:
    """Parse the content; no entity is expanded, and nothing else is opened.

    Returns
    -------
    etree._Element
        The root, without comments; each element knows the line in which its tag starts.

    Raises
    ------
    UrdfError
        The content is not well-formed XML, has a document type, or exceeds a limit.
    """
    scan = _Scan(path, limits)
    scan.run(content)
    parser = etree.XMLParser(
        encoding="utf-8",
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=limits.depth > _DEEPEST or limits.text > _LONGEST,  # past what libxml2 allows otherwise
        remove_comments=True,
        remove_pis=True,
    )
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise UrdfError(path, f"is not well-formed XML: {error.msg}", "not-xml", error.lineno or None) from None
    for element, line in zip(root.iter(etree.Element), scan.lines, strict=True):
        # libxml2's own is the line in which the tag ends. lxml can set it, which its stubs do not know.
        element.sourceline = min(line, _LAST_LINE)  # type: ignore[misc]
    return root


class _Scan:
    """One pass of expat over the file, which builds nothing: limits are looked at before memory is taken."""

    def __init__(self, path: Path, limits: Limits) -> None:
        self.path, self.limits = path, limits
        self.depth = self.nodes = 0
        self.root = ""
        self.lines: list[int] = []
        # The encoding is given: one that the file declares could hide what is looked for here.
        self.parser = expat.ParserCreate("utf-8")
        self.parser.StartDoctypeDeclHandler = self._doctype
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CommentHandler = self._node
        self.parser.ProcessingInstructionHandler = self._node

    def run(self, content: bytes) -> None:
        try:
            self.parser.Parse(content, True)
        except expat.ExpatError as error:
            if self.root.lower() in _FORMATS:  # as HTML, which need not be well-formed XML
                self._refuse_format(self.root)
            reason = expat.errors.messages[error.code]
            raise UrdfError(self.path, f"is not well-formed XML: {reason}", "not-xml", error.lineno) from None

    def _refuse(self, reason: str, code: str) -> NoReturn:
        raise UrdfError(self.path, reason, code, self.parser.CurrentLineNumber)

    def _refuse_format(self, root: str) -> NoReturn:
        self._refuse(_not_urdf(root), "not-urdf")

    def _doctype(self, name: str, *arguments: object) -> None:
        if name.lower() in _FORMATS:
            self._refuse_format(name)
        self._refuse("has a document type declaration, which a URDF does not have: remove it", "doctype")

    def _node(self, *arguments: object) -> None:
        self.nodes += 1
        if self.nodes > self.limits.nodes:
            reason = f"has more than {self.limits.nodes} elements, attributes and comments (--max-nodes)"
            self._refuse(reason, "too-many-nodes")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self.root = self.root or name
        self.lines.append(self.parser.CurrentLineNumber)
        self.depth += 1
        if self.depth > self.limits.depth:
            self._refuse(f"nests elements more than {self.limits.depth} deep (--max-depth)", "too-deep")
        if len(attributes) > self.limits.attributes:
            most = self.limits.attributes
            reason = f"<{name}> has {len(attributes)} attributes; at most {most} are read (--max-attributes)"
            self._refuse(reason, "too-many-attributes")
        if attributes and max(map(len, attributes.values())) > self.limits.text:
            reason = f"<{name}> has an attribute of more than {self.limits.text} characters (--max-text)"
            self._refuse(reason, "too-long-attribute")
        if name.startswith("xacro:"):
            self._refuse(_UNEXPANDED, "xacro")
        self.nodes += len(attributes)
        self._node()

    def _end(self, name: str) -> None:
        self.depth -= 1


def check_format(path: Path, root: etree._Element) -> None:
    """Refuse a tree that is not a URDF, and name what it is instead.

    Raises
    ------
    UrdfError
        The root is not <robot>, a <robot> stands inside it, or xacro is left to be expanded.
    """
    if root.tag != "robot":
        name = etree.QName(root)
        reason = _not_urdf(name.localname)
        if name.localname == "robot":
            reason = f"<robot> lies in the namespace '{name.namespace}', and URDF in none: remove xmlns=…"
        raise UrdfError(path, reason, "not-urdf", line_of(root))
    parts = [part for part in root.iterchildren(etree.Element) if part.tag not in EXTENSIONS]
    for element in [root, *(element for part in parts for element in part.iter(etree.Element))]:
        if element is not root and element.tag == "robot":
            raise UrdfError(path, "a <robot> stands inside <robot>: keep one", "second-robot", line_of(element))
        unexpanded = any(_XACRO_VALUE.search(value) for value in element.attrib.values() if "$" in value)
        if unexpanded or str(element.tag).startswith(f"{{{_XACRO}}}"):
            raise UrdfError(path, _UNEXPANDED, "xacro", line_of(element))


def _not_urdf(root: str) -> str:
    return f"the root element is <{root}>, not <robot>: this is {_FORMATS.get(root.lower(), 'not a URDF')}"


def line_of(element: etree._Element) -> int | None:
    """Return the line of the file in which the element starts.

    Returns
    -------
    int or None
        None beyond what libxml2 counts.
    """
    line = element.sourceline
    return line if line is not None and line < _LAST_LINE else None

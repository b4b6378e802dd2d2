"""From a path to an XML tree: what is opened, how much of it is read, and what is not even parsed."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from lxml import etree

from ospace.files import open_regular
from ospace.urdf.errors import UrdfError
from ospace.urdf.lint.findings import Finding, make_finding

_XACRO = "http://www.ros.org/wiki/xacro"
_XACRO_VALUE = re.compile(r"\$\{|\$\((find|arg|env|optenv|anon|eval|dirname)\b")
EXTENSIONS = {"gazebo", "sensor", "transmission", "ros2_control", "contact"}
"""Elements of other programs, which may hold anything."""
DRAWN = {"visual", "collision", "material"}
"""Elements of which neither link nor joint nor inertial can come."""
_LAST_LINE = 65535  # libxml2 counts no further
_LEFT_OVER = (
    "is left over from a xacro: expand the file with its macros, as is done where its name ends in .xacro, or delete it"
)
_UNDECLARED = "undeclared"  # the namespace of all prefixes that are not declared
_MOST_PREFIXES = 5  # that a message names
_FORMATS = {
    "sdf": "an SDF file",
    "mujoco": "an MJCF file of MuJoCo",
    "mujocoinclude": "an MJCF file of MuJoCo",
    "html": "an HTML page",
    "collada": "a COLLADA mesh",
}
_DEEPEST, _LONGEST = 256, 10_000_000  # libxml2's own bounds on depth and on the characters of one text


@dataclass(frozen=True)
class Limits:
    """Largest size of a file, and of the robot in it.

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
    """Read the file: regular, and not too large.

    Returns
    -------
    bytes

    Raises
    ------
    UrdfError
        The file is missing, not a regular file, larger than `limits.bytes`, or cannot be read.
    """
    try:
        with open_regular(path) as file:
            size = os.fstat(file.fileno()).st_size
            if size > limits.bytes:
                reason = f"has {size} bytes; at most {limits.bytes} are read (limits=Limits(bytes=N))"
                raise UrdfError(path, reason, "too-large")
            return file.read(size)
    except FileNotFoundError:
        raise UrdfError(path, "no such file", "no-file") from None
    except IsADirectoryError:
        raise UrdfError(path, "is not a regular file but a folder: give a URDF file", "no-regular-file") from None
    except (OSError, ValueError) as error:
        if os.path.exists(path) and not os.path.isfile(path):
            raise UrdfError(path, "is not a regular file: give a URDF file", "no-regular-file") from None
        raise UrdfError(
            path, f"cannot be read: {getattr(error, 'strerror', None) or error}", "unreadable-file"
        ) from None


def parse(path: Path, content: bytes, limits: Limits, *, comments: bool = False) -> etree._Element:
    """Parse the content; no entity is expanded, and nothing else is opened.

    Returns
    -------
    etree._Element
        The root, with comments and processing instructions where `comments` asks for them; each element knows the line
        in which its tag starts.

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
        remove_comments=not comments,
        remove_pis=not comments,
        recover=True,  # from prefixes that are not declared, and nothing else
    )
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise UrdfError(path, f"is not well-formed XML: {error.msg}", "not-xml", error.lineno or None) from None
    for problem in parser.error_log:
        if problem.type != etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE:
            raise UrdfError(path, f"is not well-formed XML: {problem.message}", "not-xml", problem.line or None)
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
            reason = f"has more than {self.limits.nodes} elements, attributes and comments (limits=Limits(nodes=N))"
            self._refuse(reason, "too-many-nodes")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        self.root = self.root or name.rpartition(":")[2]
        self.lines.append(self.parser.CurrentLineNumber)
        self.depth += 1
        if self.depth > self.limits.depth:
            self._refuse(f"nests elements more than {self.limits.depth} deep (limits=Limits(depth=N))", "too-deep")
        if len(attributes) > self.limits.attributes:
            most = self.limits.attributes
            reason = f"<{name}> has {len(attributes)} attributes; at most {most} are read (limits=Limits(attributes=N))"
            self._refuse(reason, "too-many-attributes")
        if attributes and max(map(len, attributes.values())) > self.limits.text:
            reason = f"<{name}> has an attribute of more than {self.limits.text} characters (limits=Limits(text=N))"
            self._refuse(reason, "too-long-attribute")
        self.nodes += len(attributes)
        self._node()

    def _end(self, name: str) -> None:
        self.depth -= 1


def check_format(path: Path, root: etree._Element) -> list[Finding]:
    """Refuse a tree that is not a URDF, and name what it is instead; leave out namespaces that say nothing.

    Elements in the default namespace of <robot> lose it, those of a prefix that is not declared get a namespace.

    Returns
    -------
    list of Finding
        On the namespaces.

    Raises
    ------
    UrdfError
        The root is not <robot>, a <robot> stands inside it, or a xacro is left to be expanded where links, joints or
        inertials could come of it.
    """
    findings = [*_with_declared_prefixes(root), *_without_default_namespace(root)]
    if root.tag != "robot":
        name = etree.QName(root)
        reason = _not_urdf(name.localname)
        if name.localname == "robot":
            reason = f"<robot> has the prefix '{root.prefix}', and URDF has none: remove it"
        raise UrdfError(path, reason, "not-urdf", line_of(root))
    for element in (root, *_of_robot(root)):
        if element is not root and element.tag == "robot":
            raise UrdfError(path, "a <robot> stands inside <robot>: keep one", "second-robot", line_of(element))
        if left := left_of_xacro(element):
            raise UrdfError(path, f"{left} {_LEFT_OVER}", "xacro", line_of(element))
    return findings


def _of_robot(root: etree._Element) -> Iterator[etree._Element]:
    """Return the elements below <robot> of which a link, joint or inertial could come."""
    waiting = [*root.iterchildren(etree.Element)][::-1]
    while waiting:
        element = waiting.pop()
        if element.tag not in EXTENSIONS | DRAWN:
            yield element
            waiting += [*element.iterchildren(etree.Element)][::-1]


def left_of_xacro(element: etree._Element) -> str:
    """Name what of an element itself is left of a xacro.

    Returns
    -------
    str
        Empty where nothing is.
    """
    if str(element.tag).startswith(f"{{{_XACRO}}}"):
        name = element.get("name")
        return f"<xacro:{etree.QName(element).localname}>" + (f" '{name}'" if name else "")
    for key, value in element.attrib.items():
        if "$" in value and _XACRO_VALUE.search(value):
            return f"{etree.QName(key).localname}='{value}' of <{etree.QName(element).localname}>"
    return ""


def _without_default_namespace(root: etree._Element) -> Iterator[Finding]:
    default = root.nsmap.get(None)
    if default is None or root.prefix is not None or etree.QName(root).localname != "robot":
        return
    for element in root.iter(etree.Element):
        if element.prefix is None and etree.QName(element).namespace == default:
            element.tag = etree.QName(element).localname
    message = f"<robot> has the default namespace '{default}', which is ignored"
    yield make_finding("default-namespace", "file", message, line=line_of(root), value=default)


def _with_declared_prefixes(root: etree._Element) -> Iterator[Finding]:
    first: dict[str, etree._Element] = {}
    for element in root.iter(etree.Element):
        for name in (str(element.tag), *map(str, element.attrib)):
            prefix, colon, local = name.partition(":")
            if name.startswith("{") or not colon:
                continue
            if prefix != "xacro":  # of which left_of_xacro tells
                first.setdefault(prefix, element)
            declared = f"{{{_XACRO if prefix == 'xacro' else _UNDECLARED}}}{local}"
            if name == element.tag:
                element.tag = declared
            else:
                element.attrib[declared] = element.attrib.pop(name)
    if first:
        named = ", ".join(f"'{prefix}'" for prefix in list(first)[:_MOST_PREFIXES])
        message = f"the prefix {named} is not declared: its elements are taken for those of another program"
        yield make_finding("undeclared-prefix", "file", message, line=line_of(next(iter(first.values()))))


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

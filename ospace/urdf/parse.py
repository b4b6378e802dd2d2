"""From XML elements to a `Description`; what does not say what it seems to becomes a finding."""

from __future__ import annotations

import difflib
import math
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Literal, cast

from lxml import etree

from ospace.exceptions import closest
from ospace.urdf.bodies import quaternion_to_rpy
from ospace.urdf.description import ZERO, Colour, Description, Inertial, Joint, Limit, Link, Mimic, Pose, Shape, Triple
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.foreign import describe_dynamics, is_dynamics_name
from ospace.urdf.lint.rules import Severity
from ospace.urdf.no_limit import NEVER_REACHED, POSITION, stands_for_none
from ospace.urdf.numbers import (
    LARGEST,
    LIGHTEST,
    SMALLEST,
    NumberError,
    RangeError,
    has_space_around,
    number,
    numbers,
    words,
)
from ospace.urdf.source import EXTENSIONS, left_of_xacro, line_of

KINDS = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
_BALL = "three revolute joints whose axes meet, on links without mass between them, make one"
_COMPOSED = {
    "ball": _BALL,
    "spherical": _BALL,
    "gimbal": _BALL,
    "universal": "two revolute joints whose axes meet, on a link without mass between them, make one",
    "revolute2": "two revolute joints, on a link between them, make one",
    "cylindrical": "a revolute and a prismatic joint along one axis, on a link without mass between them, make one",
    "screw": "a prismatic joint that mimics a revolute one, on a link without mass between them, makes one",
    "helical": "a prismatic joint that mimics a revolute one, on a link without mass between them, makes one",
    "rpy": _BALL,
}
"""Joints of other formats, and which of URDF's make one."""
_OTHER_NAMES = {"hinge": "revolute", "pin": "revolute", "slider": "prismatic", "weld": "fixed", "free": "floating"}
TOO_SHORT, OFF_UNIT = 1e-6, 1e-3
"""Length of an axis or quaternion below which it has no direction, and how far from one it may be without a word."""
TENSOR = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
LIMITS = {"lower": -math.inf, "upper": math.inf, "effort": math.inf, "velocity": math.inf}
_TRANSPOSED = {"iyx": "ixy", "izx": "ixz", "izy": "iyz"}
_SYMMETRIC = 1e-6  # of the tensor's largest number: products may differ by that much in digits that were lost
_VERSIONS = ("1.0", "1.1", "1.2")
SCHEMA: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "robot": (("name", "version"), ("link", "joint", "material")),
    "link": (("name",), ("inertial", "visual", "collision")),
    "inertial": (("name",), ("origin", "mass", "inertia")),
    "mass": (("value",), ()),
    "inertia": (TENSOR, ()),
    "visual": (("name",), ("origin", "geometry", "material")),
    "collision": (("name", "group"), ("origin", "geometry")),
    "geometry": ((), ("box", "cylinder", "capsule", "sphere", "mesh")),
    "box": (("size",), ()),
    "cylinder": (("radius", "length"), ()),
    "capsule": (("radius", "length"), ()),
    "sphere": (("radius",), ()),
    "mesh": (("filename", "scale"), ()),
    "material": (("name",), ("color", "texture")),
    "color": (("rgba",), ()),
    "texture": (("filename",), ()),
    "joint": (
        ("name", "type"),
        ("origin", "parent", "child", "axis", "calibration", "dynamics", "limit", "mimic", "safety_controller"),
    ),
    "origin": (("xyz", "rpy", "quat_xyzw"), ()),
    "parent": (("link",), ()),
    "child": (("link",), ()),
    "axis": (("xyz",), ()),
    "calibration": (("rising", "falling", "reference_position"), ()),
    "dynamics": (("damping", "friction"), ()),
    "limit": (("lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"), ()),
    "mimic": (("joint", "multiplier", "offset"), ()),
    "safety_controller": (("soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"), ()),
}
"""Attributes and elements that each element of URDF may have."""
_DRAWN = {"visual", "collision", "geometry", "material"}
_BODIES = {"link", "joint", "inertial"}  # with one of these that is not read, the robot is another
_DYNAMIC = {
    name
    for part in ("inertial", "joint")
    for tag in (part, *SCHEMA[part][1])
    for name in (tag, *SCHEMA[tag][0])
    if name not in ("name", "type")
}
_PHYSICAL = {"inertial", "origin", "mass", "inertia", "axis", "limit", "dynamics", "mimic", "parent", "child"}
"""Elements that place, weigh, move or limit a body: what is not used of them is a warning at least."""
_PLACING = {"pose", "transform", "placement", "frame", "offset", "center_of_mass", "com", "scale", "unit", "units"}
"""Names under which other formats place, weigh or scale a body."""
_REPEATED = {"unknown-attribute", "unknown-element", "dynamics-not-used", "value-not-used", "stray-text"}
"""Findings that stand once, with their number, where they say the same."""
_LISTED, _SHOWN = 200, 40  # findings of one kind, characters of a text
_SHORT = 4  # characters
_SLIP = 2  # characters by which a misspelt name may be longer or shorter
_SEVERAL = {"link", "joint", "material", "visual", "collision"}


def parse(root: etree._Element, file_name: str) -> tuple[Description, list[Finding]]:
    """Read links and joints below <robot>.

    Parameters
    ----------
    root : etree._Element
        The element <robot>.
    file_name : str
        Name of the robot where <robot> has none.

    Returns
    -------
    Description
    list of Finding
        Where one is an error, the value in its place does not matter.
    """
    parser = _Parser(root)
    name = parser.name(root, file_name)
    parser.version(root)
    parser.check_element(root, deep=False)
    for element in root.iterfind("material"):
        parser.material(element)
    links = tuple(parser.link(element) for element in root.iterfind("link"))
    joints = tuple(parser.joint(element) for element in root.iterfind("joint"))
    return Description(name, links, joints), parser.listed()


def has_quaternions(root: etree._Element) -> bool:
    """Return whether the declared version of URDF has quaternions, as 1.1 and all later ones do.

    Returns
    -------
    bool
    """
    return root.get("version", _VERSIONS[0]) != _VERSIONS[0]


class _Parser:
    """Gathers findings on the way; where one is an error, the value in its place does not matter."""

    def __init__(self, root: etree._Element) -> None:
        self.named = {tag: {element.get("name") for element in root.iterfind(tag)} for tag in ("link", "joint")}
        self.findings: list[Finding] = []
        self.count: Counter[str] = Counter()
        self.distinct: Counter[str] = Counter()
        self.known: dict[tuple[str, str], int] = {}
        self.repeats: Counter[int] = Counter()
        self.errors = 0
        self.colours: dict[str, Colour] = {}
        self.quaternions = True
        self.subject = "file"
        self.code = ""

    def name(self, root: etree._Element, file_name: str) -> str:
        """Return the name of the robot, that of the file where <robot> has none."""
        name = root.get("name", "")
        if name.strip():
            return name
        self._report("no-robot-name", f"<robot> has no name, taken as '{file_name}'", root)
        return file_name

    def version(self, root: etree._Element) -> None:
        """Note whether this version of URDF has quaternions."""
        version = root.get("version", _VERSIONS[0])
        self.quaternions = has_quaternions(root)
        if version not in _VERSIONS:
            message = f"version '{version}' of <robot> is unknown, read as {_VERSIONS[-1]}"
            self._report("unknown-version", message, root, version)

    # -- links -----------------------------------------------------------------------------------------------

    def link(self, element: etree._Element) -> Link:
        name = element.get("name", "")
        self.subject, self.code = f"link '{name}'", "inertial-unreadable"
        self.check_element(element)
        inertial = element.find("inertial")
        shapes = tuple(self._shapes(element))
        self.code = "inertial-unreadable"
        return Link(line_of(element), name, None if inertial is None else self._inertial(inertial), shapes)

    def _inertial(self, element: etree._Element) -> Inertial | None:
        mass, inertia = element.find("mass"), element.find("inertia")
        if mass is None or inertia is None:
            missing = " and ".join(f"<{tag}>" for tag in ("mass", "inertia") if element.find(tag) is None)
            self._report(self.code, f"<inertial> has no {missing}", element)
            return None
        before = self.errors
        tensor = [self._scalar(inertia, key, largest=LARGEST, smallest=SMALLEST) for key in TENSOR]
        self._transposed(inertia, dict(zip(TENSOR, tensor, strict=True)))
        pose, value = self._pose(element), self._scalar(mass, "value", largest=LARGEST, smallest=LIGHTEST)
        if self.errors > before:
            return None
        xx, xy, xz, yy, yz, zz = tensor
        return Inertial(line_of(element), pose, value, (xx, xy, xz, yy, yz, zz))

    def _transposed(self, inertia: etree._Element, tensor: dict[str, float]) -> None:
        """Compare products that are written a second time, with their indices swapped."""
        for key, of in _TRANSPOSED.items():
            if key not in inertia.attrib:
                continue
            value, text = self._scalar(inertia, key), inertia.get(key)
            if math.isnan(value - tensor[of]):
                continue
            if abs(value - tensor[of]) > _SYMMETRIC * max(map(abs, tensor.values())):
                message = f"{key}='{text}' of <inertia> is not {of}='{inertia.get(of)}': the tensor is not symmetric"
                self._report("inertia-asymmetric", message, inertia, text)
            else:
                message = f"<inertia> has '{key}' as well, which equals '{of}'"
                self._report("unknown-attribute", message, inertia, key, "info")

    def _shapes(self, link: etree._Element) -> Iterator[Shape]:
        self.code = "visual-unreadable"
        for element in link.iterchildren("visual", "collision"):
            if self._left_of_xacro(element):
                continue
            before = self.count[self.code]
            material = element.find("material")
            colour = None if material is None else self._colour(material)
            shape = self._shape(element)
            if shape is not None and shape.kind != "mesh" and min(shape.size) < 0.0:
                self._report(self.code, f"<{shape.kind}> has a negative size", element, " ".join(map(str, shape.size)))
            if shape is not None and self.count[self.code] == before:
                yield shape if colour is None else replace(shape, colour=colour)

    def _left_of_xacro(self, element: etree._Element) -> bool:
        """Report an element that cannot be drawn as xacro has not finished it."""
        left = next(filter(None, map(left_of_xacro, element.iter(etree.Element))), "")
        if left:
            self._report("xacro-left-over", f"{left} in <{_tag(element)}> is left over from a xacro", element, left)
        return bool(left)

    def _shape(self, element: etree._Element) -> Shape | None:
        role = cast(Literal["visual", "collision"], element.tag)
        child = next(element.iterfind("geometry/*"), None)
        if child is None:
            self._report(self.code, f"<{role}> has no shape in a <geometry>", element)
            return None
        pose, line = self._pose(element), line_of(child)
        if child.tag == "mesh":
            scale = self._vector(child, "scale", (1.0, 1.0, 1.0))
            return Shape(line, role, pose, "mesh", scale, child.get("filename", ""))
        if child.tag == "box":
            return Shape(line, role, pose, "box", self._vector(child, "size", None))
        if child.tag == "sphere":
            return Shape(line, role, pose, "sphere", (self._scalar(child, "radius", largest=LARGEST),))
        if child.tag in ("cylinder", "capsule"):
            kind = cast(Literal["cylinder", "capsule"], child.tag)
            radius, length = (self._scalar(child, key, largest=LARGEST) for key in ("radius", "length"))
            return Shape(line, role, pose, kind, (radius, length))
        self._report(self.code, f"<{role}> has the unknown shape <{_tag(child)}>", child)
        return None

    def material(self, element: etree._Element) -> None:
        """Look at a material that stands below <robot>."""
        self.subject, self.code = f"material '{element.get('name', '')}'", "visual-unreadable"
        if not self._left_of_xacro(element):
            self.check_element(element)
            self._colour(element)

    def _colour(self, material: etree._Element) -> Colour | None:
        """Return the colour of a material: its own, or that of the first of its name that has one."""
        name, colour = material.get("name", ""), material.find("color")
        if colour is None:
            return self.colours.get(name)
        before = self.count[self.code]
        red, green, blue, opacity = self._numbers(colour, "rgba", 4)
        if self.count[self.code] > before:
            return None
        own = (red, green, blue, opacity)
        if name:
            self.colours.setdefault(name, own)
        return own

    # -- joints ----------------------------------------------------------------------------------------------

    def joint(self, element: etree._Element) -> Joint:
        name, kind = element.get("name", ""), element.get("type", "")
        self.subject, self.code = f"joint '{name}'", "number-unreadable"
        self.check_element(element)
        if kind not in KINDS:
            self._report("joint-type", _describe_kind(kind), element, kind)
        self._check_unused_numbers(element)
        ends = [element.find(end) for end in ("parent", "child")]
        parent, child = ("" if end is None else end.get("link", "") for end in ends)
        return Joint(
            line_of(element),
            name,
            kind,
            parent,
            child,
            self._pose(element),
            self._axis(element, kind),
            self._limit(element, kind),
            *self._dynamics(element, kind),
            self._mimic(element),
        )

    def _axis(self, joint: etree._Element, kind: str) -> Triple:
        axis = joint.find("axis")
        if axis is None or kind in ("fixed", "floating"):
            return (1.0, 0.0, 0.0)
        before, text = self.errors, axis.get("xyz", "")
        values = self._vector(axis, "xyz", None)
        if self.errors > before:
            return values
        length = math.hypot(*values)
        if length < TOO_SHORT:
            self._report("axis-zero", f"its axis '{text}' has no length", axis, text)
            return values
        if abs(length - 1.0) > OFF_UNIT:
            self._report("axis-not-unit", f"its axis '{text}' has length {length:.6g}", axis, text)
        return values if length == 1.0 else (values[0] / length, values[1] / length, values[2] / length)

    def _limit(self, joint: etree._Element, kind: str) -> Limit | None:
        limit = joint.find("limit")
        if limit is None or kind == "fixed":
            return None
        if kind in ("floating", "planar"):
            self._report("value-not-used", f"<limit> of a {kind} joint is not used", limit)
            return None
        none = [key for key in LIMITS if key in limit.attrib and stands_for_none(limit.get(key, ""), key, kind)]
        if none:
            text = ", ".join(f"{key}='{limit.get(key)}'" for key in none)
            message = f"{text} of <limit> {'stands' if len(none) == 1 else 'stand'} for no limit, read as unlimited"
            self._report("limits-none", message, limit, limit.get(none[0]))
        lower, upper, effort, velocity = (
            default if key in none else self._scalar(limit, key, 0.0 if key in POSITION else default)
            for key, default in LIMITS.items()
        )
        unused = [key for key in ("acceleration", "deceleration", "jerk") if key in limit.attrib]
        if kind == "continuous":
            if any(0.0 < abs(limit) < NEVER_REACHED for limit in (lower, upper)):  # exporters write zero for none
                unused += [key for key in POSITION if key in limit.attrib and key not in none]
            lower, upper = -math.inf, math.inf
        if unused:
            message = f"{', '.join(unused)} of <limit> {'is' if len(unused) == 1 else 'are'} not used"
            self._report("value-not-used", f"{message} with a {kind} joint", limit)
        missing = [key for key in ("effort", "velocity") if key not in limit.attrib]
        if missing:
            self._report("effort-missing", f"<limit> has no {' and no '.join(missing)}, read as unlimited", limit)
        return Limit(line_of(limit), *map(_or_none, (lower, upper, effort, velocity)))

    def _dynamics(self, joint: etree._Element, kind: str) -> tuple[float, float]:
        dynamics = joint.find("dynamics")
        if dynamics is None:
            return 0.0, 0.0
        damping, friction = (self._scalar(dynamics, key, 0.0) for key in ("damping", "friction"))
        if kind in ("floating", "planar") and (damping or friction):
            self._report("value-not-used", f"<dynamics> of a {kind} joint is not used", dynamics)
        return damping, friction

    def _check_unused_numbers(self, joint: etree._Element) -> None:
        """Report numbers that ospace does not need and other readers may reject."""
        for element in joint.iterchildren("safety_controller", "calibration"):
            for key in SCHEMA[_tag(element)][0]:
                try:
                    number(element.get(key, "0"))
                except NumberError as error:
                    message = f"{key}='{element.get(key)}' of <{_tag(element)}>, which is not used, {error}"
                    self._report(self.code, message, element, element.get(key), "warning")

    def _mimic(self, joint: etree._Element) -> Mimic | None:
        mimic = joint.find("mimic")
        if mimic is None:
            return None
        multiplier, offset = self._scalar(mimic, "multiplier", 1.0), self._scalar(mimic, "offset", 0.0)
        return Mimic(line_of(mimic), mimic.get("joint", ""), multiplier, offset)

    # -- values ----------------------------------------------------------------------------------------------

    def _pose(self, above: etree._Element) -> Pose:
        origin = above.find("origin")
        if origin is None:
            return Pose()
        return Pose(self._vector(origin, "xyz", ZERO), self._orientation(origin))

    def _orientation(self, origin: etree._Element) -> Triple:
        """Return roll, pitch and yaw, which URDF 1.1 and later may write as a quaternion."""
        text = origin.get("quat_xyzw")
        rpy = self._vector(origin, "rpy", ZERO)
        if text is None:
            return rpy
        if "rpy" in origin.attrib:
            message = f"<origin> has two orientations, rpy='{origin.get('rpy')}' and quat_xyzw='{text}'"
            self._report("two-orientations", message, origin, text)
            return rpy
        quaternion = self._tuple(origin, "quat_xyzw", 4)
        if quaternion is None:
            return rpy
        length = math.hypot(*quaternion)
        if length < TOO_SHORT:
            self._report(self.code, f"quat_xyzw='{text}' of <origin> has no length", origin, text)
            return rpy
        if not self.quaternions:
            message = f"quat_xyzw='{text}' of <origin> is not used: the file is URDF 1.0, which has none"
            self._report("quaternion-ignored", message, origin, text)
            return rpy
        if abs(length - 1.0) > OFF_UNIT:
            self._report("quaternion-not-unit", f"quat_xyzw='{text}' of <origin> has length {length:.6g}", origin, text)
        return quaternion_to_rpy(quaternion)

    def _scalar(
        self,
        element: etree._Element,
        key: str,
        default: float | None = None,
        *,
        largest: float = math.inf,
        smallest: float = 0.0,
    ) -> float:
        text = element.get(key)
        if text is None:
            if default is None:
                self._report(self.code, f"<{_tag(element)}> has no {key}", element)
            return 0.0 if default is None else default
        if has_space_around(text) and words(text):
            message = f"{key}='{text}' of <{_tag(element)}> has white space around the number"
            self._report("number-spaces", message, element, text)
        try:
            return number(text, largest, smallest)
        except NumberError as error:
            self._unreadable(element, key, text, error)
            return math.nan  # which compares with nothing, so that no further finding follows from it

    def _vector(self, element: etree._Element, key: str, default: Triple | None) -> Triple:
        if default is not None and key not in element.attrib:
            return default
        x, y, z = self._numbers(element, key, 3)
        return (x, y, z)

    def _numbers(self, element: etree._Element, key: str, count: int) -> tuple[float, ...]:
        return self._tuple(element, key, count) or (0.0,) * count

    def _tuple(self, element: etree._Element, key: str, count: int) -> tuple[float, ...] | None:
        """Read so many numbers; None, and a finding, where they are not there or cannot be read."""
        text = element.get(key)
        if text is None:
            self._report(self.code, f"<{_tag(element)}> has no {key}", element)
            return None
        if has_space_around(text) and words(text):
            message = f"{key}='{text}' of <{_tag(element)}> has white space around the numbers"
            self._report("number-spaces", message, element, text, "info")
        try:
            return numbers(text, count, LARGEST)
        except NumberError as error:
            self._unreadable(element, key, text, error)
            return None

    def _unreadable(self, element: etree._Element, key: str, text: str, error: NumberError) -> None:
        out_of_range = isinstance(error, RangeError) and self.code != "visual-unreadable"
        code = "number-range" if out_of_range else self.code
        self._report(code, f"{key}='{text}' of <{_tag(element)}> {error}", element, text)

    # -- what is not read ------------------------------------------------------------------------------------

    def check_element(self, element: etree._Element, *, deep: bool = True) -> None:
        """Name what stands in an element, and in those below it if `deep`, and is not read or stands twice."""
        tag = _tag(element)
        attributes, children = SCHEMA[tag]
        for key in map(str, element.attrib):
            self._check_attribute(element, key, attributes)
        self._check_text(element)
        seen: set[str] = set()
        for child in element.iterchildren(etree.Element):
            name = _tag(child)
            if name not in children:
                self._check_foreign(element, child)
                continue
            if name in seen and name not in _SEVERAL:
                message = f"<{tag}> has a second <{name}>"
                self._report("duplicate-element", message, child, severity="warning" if tag in _DRAWN else None)
            seen.add(name)
            if deep:
                self.check_element(child)

    def _check_attribute(self, element: etree._Element, key: str, known: Iterable[str]) -> None:
        tag, name = _tag(element), etree.QName(key).localname
        if key in known or (tag == "inertia" and key in _TRANSPOSED):
            return
        if key == name or tag in _PHYSICAL or is_dynamics_name(name):
            self._unknown("unknown-attribute", f"<{tag}> has the unknown attribute '{name}'", name, tag, element)

    def _check_text(self, element: etree._Element) -> None:
        for text in (element.text, *(child.tail for child in element)):
            if text and (stray := " ".join(text.split())):
                shown = stray if len(stray) <= _SHOWN else stray[:_SHOWN] + "…"
                self._report("stray-text", f"<{_tag(element)}> has the text '{shown}'", element, shown)

    def _check_foreign(self, above: etree._Element, element: etree._Element) -> None:
        name, tag = _tag(element), _tag(above)
        what = f"<{tag}> has the unknown element <{_local(element)}>"
        if name in EXTENSIONS:
            self._report_dynamics(element, of_robot=False)
        elif _local(element) == "include":
            self._report("unknown-element", f"{what}: no other file is included", element, name, "error")
        elif any(map(self._defines_body, element.iter(etree.Element))):
            parts = "" if _local(element).lower() in _BODIES else " with links, joints or inertials in it"
            self._report("unknown-element", f"{what}{parts}, which is not read", element, name, "error")
        elif (
            tag not in _DRAWN
            and not self._near("unknown-element", name, tag)
            and self._report_dynamics(element, of_robot=True)
        ):
            return
        elif (
            tag in _PHYSICAL
            or not (tag == "geometry" or name.startswith("{"))  # shapes are looked at where read
            or (tag not in _DRAWN and _local(element).lower() in _DYNAMIC | _PLACING)
        ):
            self._unknown("unknown-element", what, _local(element), tag, element)

    def _defines_body(self, element: etree._Element) -> bool:
        """Return whether an element adds a link, joint or inertial to the robot, and does not only name one of it.

        Groups of an SRDF and springs name links and joints. What has no parts and the name of one that is read names
        that; a joint is nothing without its ends.
        """
        tag = _local(element).lower()
        if tag not in _BODIES or tag == "inertial":
            return tag in _BODIES
        if any(True for _ in element.iterchildren(etree.Element)):
            return True
        name = element.get("name") or element.get(tag) or " ".join((element.text or "").split())
        if tag == "joint" and name and "type" not in element.attrib:
            return False
        return name not in self.named[tag]

    def _report_dynamics(self, element: etree._Element, *, of_robot: bool) -> bool:
        """Report what of dynamics stands in an element that is not read, if anything does."""
        named = describe_dynamics(element, of_robot=of_robot)
        if named and not describe_dynamics(element, of_robot=of_robot, ratios=False):
            tag = _local(element)
            message = f"the ratio of a gear in <{tag}> is not used, nor is there an inertia of a rotor to it"
            self._report("dynamics-not-used", message, element, tag, "info")
        elif named:
            whose = f" '{element.get('name')}'" if element.get("name") else ""
            message = f"{named} of <{_local(element)}>{whose} is not used"
            if named == f"<{_local(element)}>":
                message = f"{named}{whose} is not used"
            if "loop" in named.lower():
                message += ": its loop is open here"
            self._report("dynamics-not-used", message, element, _local(element))
        return bool(named)

    def _unknown(self, code: str, what: str, name: str, tag: str, element: etree._Element) -> None:
        """Take a name that URDF has elsewhere, or that is near to one it has here, for a slip; others are foreign."""
        near = self._near(code, name, tag)
        message = f"{what}; did you mean '{near}'?" if near else what
        grave = near or tag in _PHYSICAL or name.lower() in _DYNAMIC | _PLACING or is_dynamics_name(name)
        self._report(code, message, element, name, None if grave else "info")

    def _near(self, code: str, name: str, tag: str) -> str:
        """Return what of <tag> is misspelt as `name`, if anything; letters enough of a long name are in any other."""
        if self.count[code] >= _LISTED:
            return ""
        known = SCHEMA[tag][0 if code == "unknown-attribute" else 1]
        cutoff = 0.6 if len(name) <= _SHORT else 0.75
        near = difflib.get_close_matches(name[:100].lower(), known, n=1, cutoff=cutoff)
        return near[0] if near and abs(len(near[0]) - len(name)) <= _SLIP else ""

    def _report(
        self,
        code: str,
        message: str,
        element: etree._Element,
        value: str | None = None,
        severity: Severity | None = None,
    ) -> None:
        finding = make_finding(code, self.subject, message, line=line_of(element), value=value, severity=severity)
        self.errors += finding.severity == "error"
        self.count[code] += 1
        known = self.known.get((finding.severity, message)) if code in _REPEATED else None
        if known is not None:
            self.repeats[known] += 1
            return
        self.distinct[code] += 1
        if self.distinct[code] <= _LISTED:
            self.known[finding.severity, message] = len(self.findings)
            self.findings.append(finding)

    def listed(self) -> list[Finding]:
        """Return the findings; what is the same in several places stands once, with their number."""
        once = list(self.findings)
        for k, more in self.repeats.items():
            once[k] = replace(once[k], message=f"{once[k].message}, here and in {more} more")
        return [*once, *self._omitted()]

    def _omitted(self) -> Iterator[Finding]:
        """Say how many findings of a kind are left out."""
        for code, count in self.distinct.items():
            if count > _LISTED:
                yield make_finding(code, "file", f"{count - _LISTED} more of this kind are not listed")


def _or_none(limit: float) -> float:
    """Take the largest number there is for no limit, as Pinocchio does."""
    return math.copysign(math.inf, limit) if abs(limit) == sys.float_info.max else limit


def _describe_kind(kind: str) -> str:
    """Say what to do with a type of joint that URDF does not have."""
    if not kind:
        return "has no type"
    word = kind.lower().replace("_joint", "").replace("-", "")
    if word in _COMPOSED:
        return f"is a {kind} joint, which neither URDF nor ospace has: {_COMPOSED[word]}"
    return f"type '{kind}' is unknown{closest(_OTHER_NAMES.get(word, word), KINDS)}"


def _tag(element: etree._Element) -> str:
    return str(element.tag)


def _local(element: etree._Element) -> str:
    return etree.QName(element).localname

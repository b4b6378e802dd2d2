"""Files that are odd in one way each, made by code, with the exit status and the codes that they must have."""

from __future__ import annotations

import bz2
import gzip
import lzma
import re
from dataclasses import dataclass, field

LIMIT = '<limit lower="-1" upper="1" effort="10" velocity="1"/>'
AXIS = '<axis xyz="0 1 0"/>'


def inertial(mass="2", moments=("0.02", "0.03", "0.04"), products=("0", "0", "0"), origin="0.1 0 0.05"):
    (xx, yy, zz), (xy, xz, yz) = moments, products
    return (
        f'<inertial><origin xyz="{origin}"/><mass value="{mass}"/>'
        f'<inertia ixx="{xx}" ixy="{xy}" ixz="{xz}" iyy="{yy}" iyz="{yz}" izz="{zz}"/></inertial>'
    )


def link(name, content=None, more=""):
    return f'<link name="{name}">{inertial() if content is None else content}{more}</link>'


def joint(name="hinge", kind="revolute", parent="base", child="arm", more=AXIS + LIMIT, origin="0.3 0 0"):
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{origin}"/><parent link="{parent}"/>'
        f'<child link="{child}"/>{more}</joint>'
    )


def robot(*parts, name="made"):
    return f'<?xml version="1.0"?>\n<robot name="{name}">\n{"".join(parts)}\n</robot>\n'


ARM = robot(link("base"), link("arm"), joint())
HAND = joint("wrist", "continuous", "arm", "hand", AXIS)
BOX = '<{0}><geometry><box size="0.4 0.3 0.2"/></geometry></{0}>'


@dataclass(frozen=True)
class Variant:
    """A file, and what must be said of it: the exit status, and exactly these codes of errors and warnings."""

    name: str
    content: bytes
    status: int
    codes: frozenset[str]
    infos: frozenset[str] = frozenset()
    options: tuple[str, ...] = field(default=())


VARIANTS: list[Variant] = []


def variant(name, content, status, *codes, infos=(), options=()):
    content = content if isinstance(content, bytes) else content.encode()
    VARIANTS.append(Variant(name, content, status, frozenset(codes), frozenset(infos), tuple(options)))


# -- files -------------------------------------------------------------------------------------------------------

variant("sound", ARM, 0)
variant("sound with a byte order mark", b"\xef\xbb\xbf" + ARM.encode(), 0)
variant("sound with Windows line ends", ARM.replace("\n", "\r\n"), 0)
variant("declared otherwise", ARM.replace("?>", ' encoding="UTF-16"?>', 1), 0)
variant("empty", "", 2, "not-xml")
variant("blank", " \n\n", 2, "not-xml")
variant("words", "a robot of two links", 2, "not-xml")
variant("NUL byte", ARM.replace("arm", "a\0m"), 2, "not-text")
variant("UTF-16 with mark", ARM.encode("utf-16"), 2, "not-text")
variant("UTF-16 little", ARM.encode("utf-16-le"), 2, "not-text")
variant("UTF-16 big", ARM.encode("utf-16-be"), 2, "not-text")
variant("UTF-32", ARM.encode("utf-32"), 2, "not-text")
variant("Latin-1", ARM.replace("arm", "bras d'à côté").encode("latin-1"), 2, "not-text")
variant("gzip", gzip.compress(ARM.encode()), 2, "not-text")
variant("bzip2", bz2.compress(ARM.encode()), 2, "not-text")
variant("xz", lzma.compress(ARM.encode()), 2, "not-text")
variant("zip", b"PK\x03\x04" + bytes(range(256)), 2, "not-text")
variant("program", b"\x7fELF\x02\x01\x01" + b"\0" * 57, 2, "not-text")
for share in (1, 2, 4, 6, 8, 9):
    variant(f"cut after {share} tenths", ARM[: len(ARM) * share // 10], 2, "not-xml")
variant("cut at the last letter", ARM.rstrip()[:-1], 2, "not-xml")
variant("two documents", ARM.rstrip() + ARM[ARM.index("<robot") :], 2, "not-xml")
variant("text behind", ARM + "x", 2, "not-xml")
variant("undefined entity", ARM.replace("0.02", "&mass;"), 2, "not-xml")
variant("attribute twice", ARM.replace('value="2"', 'value="2" value="3"', 1), 2, "not-xml")
variant("no quotes", ARM.replace('value="2"', "value=2"), 2, "not-xml")
variant("undefined prefix", ARM.replace("</robot>", "<a:b/></robot>"), 2, "not-xml")
variant("control character", ARM.replace("0.02", "\x01"), 2, "not-xml")
for name, doctype in {
    "bare": "<!DOCTYPE robot>",
    "entity": "<!DOCTYPE robot [<!ENTITY m '2'>]>",
    "file entity": '<!DOCTYPE robot [<!ENTITY m SYSTEM "file:///etc/hostname">]>',
    "network entity": '<!DOCTYPE robot [<!ENTITY m SYSTEM "http://192.0.2.1/m">]>',
    "external": '<!DOCTYPE robot SYSTEM "robot.dtd">',
    "public": '<!DOCTYPE robot PUBLIC "-//r//EN" "http://192.0.2.1/robot.dtd">',
    "parameter entity": '<!DOCTYPE robot [<!ENTITY % p SYSTEM "file:///etc/hostname"> %p;]>',
}.items():
    variant(f"document type: {name}", ARM.replace("<robot", doctype + "<robot", 1), 2, "doctype")
variant("document type in a comment", ARM.replace("<robot", "<!-- <!DOCTYPE robot> --><robot", 1), 0)
variant(
    "XInclude",
    ARM.replace("</robot>", '<i:include xmlns:i="http://www.w3.org/2001/XInclude" href="/etc/hostname"/></robot>'),
    0,
)
variant("style sheet", ARM.replace("<robot", '<?xml-stylesheet href="http://192.0.2.1/s.xsl"?><robot', 1), 0)
variant("101 deep", ARM.replace("</robot>", "<a>" * 100 + "</a>" * 100 + "</robot>"), 2, "too-deep")
variant("99 deep", ARM.replace("</robot>", "<a>" * 98 + "</a>" * 98 + "</robot>"), 0)
variant(
    "65 attributes",
    ARM.replace("<link", "<link " + "".join(f'a{k}="" ' for k in range(64)), 1),
    2,
    "too-many-attributes",
)
variant("long attribute", ARM.replace('"arm"', f'"{"a" * 10_001}"'), 2, "too-long-attribute")
variant("long name", ARM.replace('"arm"', f'"{"a" * 9_999}"'), 0)

# -- other formats -----------------------------------------------------------------------------------------------

variant("SDF", '<sdf version="1.6"><model name="m"><link name="base"/></model></sdf>', 2, "not-urdf")
variant("MJCF", '<mujoco model="m"><worldbody/></mujoco>', 2, "not-urdf")
variant("HTML", "<!DOCTYPE html><html><head><meta charset=utf-8></head><body>404</body></html>", 2, "not-urdf")
variant("XHTML", "<html><body><p>404 Not Found</p></body></html>", 2, "not-urdf")
variant("COLLADA", '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"/>', 2, "not-urdf")
variant("capital robot", ARM.replace("robot", "Robot"), 2, "not-urdf")
variant("robot in a namespace", ARM.replace("<robot", '<robot xmlns="http://example.org/r"'), 2, "not-urdf")
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
variant("xacro macro", ARM.replace("<robot", f"<robot {XACRO}").replace("</robot>", "<xacro:arm/></robot>"), 2, "xacro")
variant("xacro without namespace", ARM.replace("</robot>", "<xacro:arm/></robot>"), 2, "xacro")
variant("xacro property", ARM.replace('value="2"', 'value="${m}"'), 2, "xacro")
variant("xacro argument", ARM.replace('value="2"', 'value="$(arg m)"'), 2, "xacro")
variant("expanded xacro", ARM.replace("<robot", f"<robot {XACRO}"), 0)
variant("robot in robot", ARM.replace("</robot>", '<robot name="b"/></robot>'), 2, "second-robot")
variant("no name", ARM.replace('<robot name="made">', "<robot>"), 2, "no-robot-name")
variant("blank name", ARM.replace('"made"', '" "'), 2, "no-robot-name")
variant(
    "extensions", ARM.replace("</robot>", "<gazebo><link/><joint/></gazebo><transmission/><ros2_control/></robot>"), 0
)
variant("xacro in an extension", ARM.replace("</robot>", '<gazebo a="${x}"><robot/></gazebo></robot>'), 0)
variant(
    "sphere of 1e200 m",
    ARM.replace("</link>", '<visual><geometry><sphere radius="1e200"/></geometry></visual></link>', 1),
    0,
    "visual-unreadable",
)
variant(
    "largest numbers for no limits",
    ARM.replace('"10"', '"1.7976931348623157e308"').replace('upper="1"', 'upper="1.7976931348623157e+308"'),
    0,
)
variant("sensor in a link", ARM.replace("</link>", '<sensor name="s"><link/></sensor></link>'), 0)

# -- structure ---------------------------------------------------------------------------------------------------

variant("no link", robot(), 2, "no-links")
variant("joint alone", robot(joint()), 2, "no-links")
variant("link without name", robot(link("base"), "<link/>"), 2, "unnamed")
variant("joint without name", ARM.replace('name="hinge" ', ""), 2, "unnamed")
variant("two links of a name", robot(link("base"), link("base")), 2, "duplicate-name")
variant(
    "two joints of a name",
    robot(link("base"), link("arm"), link("hand"), joint(), joint(child="hand")),
    2,
    "duplicate-name",
)
variant("no parent", ARM.replace('<parent link="base"/>', ""), 2, "joint-ends")
variant("no child", ARM.replace('<child link="arm"/>', ""), 2, "joint-ends")
variant("blank child", ARM.replace('<child link="arm"/>', '<child link=""/>'), 2, "joint-ends")
variant("unknown child", ARM.replace('<child link="arm"/>', '<child link="amr"/>'), 2, "unknown-link")
variant("unknown parent", ARM.replace('<parent link="base"/>', '<parent link="bus"/>'), 2, "unknown-link")
variant("two roots", robot(link("base"), link("arm")), 2, "two-roots")
variant("island", robot(link("base"), link("a"), link("b"), joint(parent="a", child="b")), 2, "two-roots")
variant("second parent", robot(link("base"), link("arm"), joint(), joint("second")), 2, "second-parent")
variant("own parent", robot(link("base"), link("arm"), joint(parent="arm")), 2, "loop")
variant(
    "two links that hang from each other",
    robot(link("a"), link("b"), joint("ab", "fixed", "a", "b", ""), joint("ba", "fixed", "b", "a", "")),
    2,
    "loop",
)
variant(
    "loop beside the base",
    robot(link("base"), link("a"), link("b"), joint("ab", "fixed", "a", "b", ""), joint("ba", "fixed", "b", "a", "")),
    2,
    "loop",
)
for reserved in ("root_joint", "universe", "world_joint", "base"):
    variant(f"joint called {reserved}", ARM.replace("hinge", reserved), 0)
for reserved in ("root_joint", "universe", "world"):
    variant(f"link called {reserved}", ARM.replace('"arm"', f'"{reserved}"'), 0)
    variant(f"base called {reserved}", ARM.replace('"base"', f'"{reserved}"'), 0)
ODD_NAMES = (
    "an arm",
    "arm/left",
    "ärm",
    "机器人",
    "😀",
    "&lt;arm&gt;",
    "&quot;",
    "&#10;arm",
    "arm\u202e",
    "..",
    "%s{}",
)
for odd in ODD_NAMES:
    variant(f"link called {odd!r}", ARM.replace('"arm"', f'"{odd}"'), 0)
    variant(f"joint called {odd!r}", ARM.replace('"hinge"', f'"{odd}"'), 0)
CHAIN = [
    link("l0"),
    *(
        part
        for k in range(1, 150)
        for part in (link(f"l{k}"), joint(f"j{k}", "continuous", f"l{k - 1}", f"l{k}", AXIS, "0.01 0 0"))
    ),
]
variant("155 degrees of freedom", robot(*CHAIN), 2, "too-many-dof")
variant("2001 links", robot(*(link(f"l{k}", "") for k in range(2001))), 2, "too-many-links")
variant(
    "3 links where 2 are allowed",
    robot(link("a"), link("b"), link("c")),
    2,
    "too-many-links",
    options=("--max-links", "2"),
)
variant("7 degrees where 6 are allowed", ARM, 2, "too-many-dof", options=("--max-dof", "6"))
variant("bytes", ARM, 2, "too-large", options=("--max-bytes", str(len(ARM) - 1)))
variant("bytes that are just allowed", ARM, 0, options=("--max-bytes", str(len(ARM))))

# -- numbers -----------------------------------------------------------------------------------------------------

NO_NUMBERS = (
    "",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "1e400",
    "-1e400",
    "0x10",
    "1,5",
    "12 kg",
    "1 2",
    "1_000",
    "one",
    "1e",
    "--1",
    "1.2.3",
    "٣",
    "1d3",
    "1.0f",
    "+",
    ".",
    "infinity",
)
for text in NO_NUMBERS:
    variant(f"mass {text!r}", ARM.replace('value="2"', f'value="{text}"', 1), 1, "inertial-unreadable")
for text in NO_NUMBERS[1:]:
    variant(f"axis {text!r}", ARM.replace("0 1 0", f"0 {text} 0"), 1, "number-unreadable")
for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"):
    variant(f"{key} nan", re.sub(f'{key}="[^"]*"', f'{key}="nan"', ARM, count=1), 1, "inertial-unreadable")
    variant(f"{key} missing", re.sub(f' {key}="[^"]*"', "", ARM, count=1), 1, "inertial-unreadable")
for text in ("1e13", "-1e13", "1e300", "1e-400"):
    variant(f"mass {text}", ARM.replace('value="2"', f'value="{text}"', 1), 1, "number-range")
    variant(f"origin {text}", ARM.replace("0.3 0 0", f"{text} 0 0"), 1, "number-range")
for text in ("0 0", "0 0 0 0", "", "0;0;0", "0,3 0 0", "nan 0 0"):
    variant(f"origin {text!r}", ARM.replace("0.3 0 0", text), 1, "number-unreadable")
variant("lower limit nan", ARM.replace('lower="-1"', 'lower="nan"'), 1, "number-unreadable")
variant("effort in words", ARM.replace('effort="10"', 'effort="10 Nm"'), 1, "number-unreadable")
variant("damping inf", ARM.replace("</joint>", '<dynamics damping="inf"/></joint>'), 1, "number-unreadable")
variant("rpy of two", ARM.replace('xyz="0.3 0 0"', 'xyz="0.3 0 0" rpy="0 0"'), 1, "number-unreadable")
variant("centre of mass in words", ARM.replace("0.1 0 0.05", "middle", 1), 1, "inertial-unreadable")
variant("trailing space in a tensor", ARM.replace('"0.02"', '"0.02 "', 1), 0, "number-spaces")
variant("leading tab in a mass", ARM.replace('value="2"', 'value="\t2"', 1), 0, "number-spaces")
variant("line end in a limit", ARM.replace('lower="-1"', 'lower="-1\n"'), 0, "number-spaces")
variant("space around an origin", ARM.replace('"0.3 0 0"', '" 0.3 0 0 "'), 0, infos=["number-spaces"])
variant("many spaces between", ARM.replace('"0.3 0 0"', '"0.3   0\t0"'), 0)
variant("signs and exponents", ARM.replace('"0.3 0 0"', '"+3.E-1 -0 .0e5"'), 0)

# -- elements ----------------------------------------------------------------------------------------------------

variant("two inertials", ARM.replace("</link>", inertial() + "</link>", 1), 1, "duplicate-element")
variant("two masses", ARM.replace("</inertial>", '<mass value="2"/></inertial>', 1), 1, "duplicate-element")
for element in ('<origin xyz="0 0 0"/>', AXIS, LIMIT, '<child link="base"/>', '<parent link="arm"/>'):
    variant(f"second {element[:7]} in a joint", ARM.replace("</joint>", element + "</joint>"), 1, "duplicate-element")
variant("misspelt inertial", ARM.replace("inertial>", "inertail>", 2), 1, "unknown-element", "massless-base")
variant("misspelt axis", ARM.replace("<axis", "<axes"), 0, "unknown-element")
variant("misspelt xyz", ARM.replace('xyz="0.3 0 0"', 'xzy="0.3 0 0"'), 0, "unknown-attribute")
variant("foreign element", ARM.replace("</link>", "<self_filter/></link>", 1), 0, infos=["unknown-element"])
variant("element of a namespace", ARM.replace("</link>", '<d:x xmlns:d="http://example.org/d"/></link>', 1), 0)
variant("no mass", ARM.replace('<mass value="2"/>', "", 1), 1, "inertial-unreadable")
variant("mass as text", ARM.replace('<mass value="2"/>', "<mass>2</mass>", 1), 1, "inertial-unreadable")
variant("no inertia", re.sub("<inertia .*?/>", "", ARM, count=1), 1, "inertial-unreadable")
variant("empty inertial", robot(link("base", "<inertial/>")), 1, "inertial-unreadable")
for shape in (
    "<geometry/>",
    "<geometry><cone/></geometry>",
    '<geometry><box size="1 1"/></geometry>',
    '<geometry><sphere radius="-1"/></geometry>',
    '<geometry><cylinder radius="1"/></geometry>',
    "",
):
    variant(f"visual {shape}", ARM.replace("</link>", f"<visual>{shape}</visual></link>", 1), 0, "visual-unreadable")
variant(
    "colour in words",
    ARM.replace("</robot>", '<material name="m"><color rgba="red"/></material></robot>'),
    0,
    "visual-unreadable",
)

# -- inertia -----------------------------------------------------------------------------------------------------


def with_arm(content, more=""):
    return robot(link("base"), link("arm", content, more), joint())


variant("massless base", robot(link("base", ""), link("arm"), joint()), 1, "massless-base")
variant("massless robot", robot(link("base", "")), 1, "massless-base")
variant("zero mass of the base", robot(link("base", inertial("0", ("0", "0", "0")))), 1, "massless-base")
variant(
    "base whose mass is fixed to it", robot(link("base", ""), link("bus"), joint("weld", "fixed", "base", "bus", "")), 0
)
variant("massless arm", robot(link("base"), link("arm", ""), joint()), 1, "massless-subtree")
variant("massless hand", robot(link("base"), link("arm"), link("hand", ""), joint(), HAND), 1, "massless-subtree")
variant(
    "massless arm with a hand",
    robot(link("base"), link("arm", ""), link("hand"), joint(), HAND.replace(AXIS, '<axis xyz="1 0 0"/>')),
    0,
    infos=["massless-link"],
)
for mass in ("-1", "-1e-9"):
    variant(f"mass {mass}", with_arm(inertial(mass)), 1, "negative-mass")
variant("negative mass of the base", robot(link("base", inertial("-1"))), 1, "negative-mass")
variant(
    "negative mass that is fixed to the base",
    robot(link("base"), link("arm", inertial("-1")), joint(kind="fixed", more="")),
    1,
    "negative-mass",
    "inertia-indefinite",
)
variant("negative moment", with_arm(inertial(moments=("-0.02", "0.03", "0.04"))), 1, "inertia-indefinite")
variant("large products", with_arm(inertial(products=("0.1", "0", "0"))), 1, "inertia-indefinite")
variant(
    "negative moment at rounding level", with_arm(inertial(moments=("-1e-7", "0.04", "0.04"))), 1, "inertia-indefinite"
)
variant(
    "negative moment that is fixed to a sound base",
    robot(link("base"), link("arm", inertial(moments=("-0.0001", "0.03", "0.03"))), joint(kind="fixed", more="")),
    0,
    "inertia-indefinite",
)
variant(
    "negative moment that spoils its body",
    robot(link("base"), link("arm", inertial("2e-9", ("-0.1", "0.03", "0.03"))), joint(kind="fixed", more="")),
    1,
    "inertia-indefinite",
)
variant("triangle", with_arm(inertial(moments=("0.02", "0.02", "0.05"))), 0, "inertia-triangle")
variant(
    "negative moment beside one that dwarfs it",
    with_arm(inertial(moments=("1e9", "0.03", "0.04"), products=("0", "0", "0.1"))),
    1,
    "inertia-indefinite",
    "units-inertia",
)
variant(
    "moment that dwarfs the others",
    with_arm(inertial(moments=("1e5", "0.03", "0.04"))),
    1,
    "inertia-triangle",
    "units-inertia",
)
variant("triangle at rounding level", with_arm(inertial(moments=("0.02", "0.02", "0.0400001"))), 0, "inertia-rounding")
variant("triangle to the last digit", with_arm(inertial(moments=("0.02", "0.02", "0.04"))), 0)
variant("identity", with_arm(inertial(moments=("1", "1", "1"))), 0, "inertia-identity")
variant(
    "tensor without mass",
    robot(link("base"), link("arm", inertial("0")), link("hand"), joint(), HAND),
    0,
    "inertia-without-mass",
    infos=["massless-link"],
)
variant("point mass", with_arm(inertial(moments=("0", "0", "0"))), 0, infos=["point-mass"])
variant("rod", with_arm(inertial(moments=("0", "0.1", "0.1"))), 0)
variant(
    "tensor about the origin",
    with_arm(inertial("1", ("0.01", "0.26", "0.26"), origin="0.5 0 0")),
    0,
    infos=["inertia-about-origin"],
)
variant(
    "point mass alone", robot(link("base", inertial(moments=("0", "0", "0")))), 1, "massless-base", infos=["point-mass"]
)
variant(
    "point mass on its axis",
    with_arm(inertial(moments=("0", "0", "0"), origin="0 0 0")),
    1,
    "singular-inertia",
    infos=["point-mass"],
)
variant(
    "two joints about one axis",
    robot(
        link("base"), link("arm", ""), link("hand"), joint(), joint("wrist", "continuous", "arm", "hand", AXIS, "0 0 0")
    ),
    1,
    "singular-inertia",
    infos=["massless-link"],
)

# -- joints and base ---------------------------------------------------------------------------------------------

for kind in ("ball", "Revolute", "", "hinge", "spherical"):
    variant(f"type {kind!r}", ARM.replace('"revolute"', f'"{kind}"'), 1, "joint-type")
variant("no type", ARM.replace(' type="revolute"', ""), 1, "joint-type")
for kind in ("revolute", "continuous", "prismatic"):
    variant(f"{kind}: no axis given", ARM.replace('"revolute"', f'"{kind}"').replace(AXIS, ""), 0)
    for text in ("0 0 0", "-0 0 0", "1e-9 0 0"):
        odd = ARM.replace('"revolute"', f'"{kind}"').replace("0 1 0", text)
        variant(f"{kind}: axis {text}", odd, 1, "axis-zero")
    for text in ("0 2 0", "1 1 1", "0 1e-3 0", "0 -1000 0"):
        odd = ARM.replace('"revolute"', f'"{kind}"').replace("0 1 0", text)
        variant(f"{kind}: axis {text}", odd, 0, "axis-not-unit")
    rounded = ARM.replace('"revolute"', f'"{kind}"').replace("0 1 0", "0 0.707 0.707")
    variant(f"{kind}: axis of three digits", rounded, 0)
variant("planar about z", ARM.replace('"revolute"', '"planar"').replace("0 1 0", "0 0 1"), 0)
variant("planar about y", ARM.replace('"revolute"', '"planar"'), 1, "planar-axis")
variant("planar without axis", ARM.replace('"revolute"', '"planar"').replace(AXIS, ""), 1, "planar-axis")
variant("floating between bodies", ARM.replace('"revolute"', '"floating"'), 0)
for kind in ("revolute", "prismatic"):
    variant(f"{kind} without limits", ARM.replace('"revolute"', f'"{kind}"').replace(LIMIT, ""), 0, "limits-missing")
variant("continuous without limits", ARM.replace('"revolute"', '"continuous"').replace(LIMIT, ""), 0)
variant("reversed limits", ARM.replace('lower="-1" upper="1"', 'lower="1" upper="-1"'), 0, "limits-reversed")
variant("no room", ARM.replace('lower="-1" upper="1"', 'lower="0" upper="0"'), 0, "limits-zero")
variant("no lower and upper", ARM.replace('lower="-1" upper="1" ', ""), 0, "limits-zero")
variant("no effort", ARM.replace(' effort="10"', ""), 0, "effort-missing")
variant("no velocity", ARM.replace(' velocity="1"', ""), 0, "effort-missing")
variant("zero effort", ARM.replace('effort="10"', 'effort="0"'), 0, infos=["effort-zero"])
variant("negative effort", ARM.replace('effort="10"', 'effort="-10"'), 1, "effort-negative")
variant("negative velocity", ARM.replace('velocity="1"', 'velocity="-1"'), 1, "effort-negative")
variant("negative damping", ARM.replace("</joint>", '<dynamics damping="-1"/></joint>'), 0, "damping-negative")
variant("negative friction", ARM.replace("</joint>", '<dynamics friction="-1"/></joint>'), 1, "friction-negative")
variant("degrees", ARM.replace('lower="-1" upper="1"', 'lower="-180" upper="180"'), 0, "units-angle")
MIMIC = robot(
    link("base"),
    link("arm"),
    link("hand"),
    joint(),
    joint("follow", child="hand", more=AXIS + LIMIT + '<mimic joint="hinge" multiplier="-1"/>'),
)
variant("mimic", MIMIC, 1, "mimic")
variant("mimic that is freed", MIMIC, 0, "mimic-freed", options=["--free-mimic"])
variant(
    "mimic of a joint that is not there", MIMIC.replace('mimic joint="hinge"', 'mimic joint="hnge"'), 1, "mimic-unknown"
)
variant("mimic of itself", MIMIC.replace('mimic joint="hinge"', 'mimic joint="follow"'), 1, "mimic-unknown")
variant("mimic without number", MIMIC.replace('"-1"/></joint>', '"x"/></joint>'), 1, "number-unreadable", "mimic")
variant(
    "world with a fixed base",
    robot('<link name="world"/>', link("base"), joint("weld", "fixed", "world", "base", "")),
    0,
    "fixed-base",
)
variant(
    "world with a floating base",
    robot('<link name="world"/>', link("base"), joint("free", "floating", "world", "base", "")),
    0,
    infos=["floating-root"],
)
variant("world with a hinge", robot('<link name="world"/>', link("arm"), joint(parent="world")), 1, "massless-base")
variant(
    "world with two floating robots",
    robot(
        '<link name="world"/>',
        link("a"),
        link("b"),
        joint("fa", "floating", "world", "a", ""),
        joint("fb", "floating", "world", "b", ""),
    ),
    1,
    "massless-base",
)
variant("heavy root on a floating joint", robot(link("base"), link("arm"), joint(kind="floating", more="")), 0)

# -- plausibility ------------------------------------------------------------------------------------------------

SHAPE = BOX.format("collision")
variant("box that fits", with_arm(None, SHAPE), 0)
variant(
    "tensor in kg mm²",
    with_arm(inertial(moments=("2e4", "3e4", "4e4"), origin="0 0 0"), SHAPE),
    0,
    "gyration-large",
    "units-inertia",
)
variant(
    "tensor too large for its box",
    with_arm(inertial(moments=("2", "3", "4"), origin="0 0 0"), SHAPE),
    0,
    "gyration-large",
)
variant(
    "tensor too small for its box",
    with_arm(inertial(moments=("2e-6", "3e-6", "4e-6"), origin="0 0 0"), SHAPE),
    0,
    "gyration-small",
)
variant(
    "mass in grams", with_arm(inertial("2000", ("20", "30", "40"), origin="0 0 0"), SHAPE), 0, "density", "mass-ratio"
)
variant("mass of nothing", with_arm(inertial("0.001", ("1e-5", "1e-5", "1e-5"), origin="0 0 0"), SHAPE), 0, "density")
variant("centre of mass in mm", robot(link("base", inertial(origin="110 0 0"))), 0, "units-length", "base-condition")
variant("centre of mass outside", with_arm(inertial(origin="2 0 0"), SHAPE), 0, "centre-outside")
variant("joint in mm", ARM.replace("0.3 0 0", "300 0 0"), 0, "units-length", "base-condition")
variant(
    "box in mm",
    with_arm(None, BOX.format("visual").replace("0.4 0.3 0.2", "400 300 200")),
    0,
    "units-length",
    "density",
    "gyration-small",
)
variant("tensor in g mm²", with_arm(inertial(moments=("2e5", "3e5", "4e5"))), 0, "units-inertia")
variant(
    "light base",
    robot(link("base", inertial("0.001", ("1e-5", "1e-5", "1e-5"))), link("arm"), joint()),
    0,
    "mass-ratio",
)
variant(
    "heavy base",
    robot(
        link("base", inertial("3e6", ("3e4", "3e4", "3e4"))),
        link("arm", inertial("0.2", ("2e-3", "3e-3", "4e-3"))),
        joint(),
    ),
    0,
    "mass-ratio",
)

# -- meshes ------------------------------------------------------------------------------------------------------


def mesh(filename, more=""):
    shape = f'<visual><geometry><mesh filename="{filename}"{more}/></geometry></visual>'
    return with_arm(None, shape)


variant("mesh that is missing", mesh("no_such.stl"), 0, "mesh-missing")
variant("mesh without a name", mesh(""), 0, "mesh-missing")
variant("mesh outside", mesh("/etc/hostname"), 0, "mesh-outside")
variant("mesh above", mesh("../../../../../../etc/hostname"), 0, "mesh-outside")
variant("mesh by a URI of a file", mesh("file:///etc/hostname"), 0, "mesh-outside")
variant("mesh in a package", mesh("package://arm/arm.stl"), 0, infos=["mesh-not-looked-up"])
variant(
    "mesh in a package that goes up",
    mesh("package://../../etc/hostname"),
    0,
    "mesh-outside",
    options=["--package-dir", "."],
)
variant(
    "mesh in a package that is missing",
    mesh("package://arm/arm.stl"),
    0,
    "mesh-missing",
    options=["--package-dir", "."],
)
for scheme in ("http", "https", "ftp", "data"):
    variant(f"mesh by {scheme}", mesh(f"{scheme}://192.0.2.1/arm.stl"), 0, "mesh-remote")
variant("mesh that is a folder", mesh("."), 0, "mesh-unreadable")
for scale in ("0 0 0", "1 1 -1", "0 1 1"):
    variant(f"scale {scale}", mesh("no_such.stl", f' scale="{scale}"'), 0, "mesh-missing", "mesh-scale")
variant("scale in words", mesh("no_such.stl", ' scale="big"'), 0, "visual-unreadable")

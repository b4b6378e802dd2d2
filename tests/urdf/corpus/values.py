"""Numbers that are none, and elements that are not where they belong."""

from __future__ import annotations

import re

from urdf.corpus.parts import ARM, AXIS, LIMIT, inertial, link, robot, variant

BOX_SHAPE = '<geometry><box size="0.4 0.3 0.2"/></geometry>'
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
for text in ("1e13", "-1e13", "1e300", "1e-400", "1e-200"):
    variant(f"mass {text}", ARM.replace('value="2"', f'value="{text}"', 1), 1, "number-range")
    if text != "1e-200":  # a length: products of it that vanish do no harm
        variant(f"origin {text}", ARM.replace("0.3 0 0", f"{text} 0 0"), 1, "number-range")
for text in ("0 0", "0 0 0 0", "", "0;0;0", "0,3 0 0", "nan 0 0"):
    variant(f"origin {text!r}", ARM.replace("0.3 0 0", text), 1, "number-unreadable")
variant("mass of an atom", ARM.replace('value="2"', 'value="1e-26"', 1), 1, "number-range")
variant("lower limit nan", ARM.replace('lower="-1"', 'lower="nan"'), 1, "number-unreadable")
variant("effort in words", ARM.replace('effort="10"', 'effort="10 Nm"'), 1, "number-unreadable")
variant("damping inf", ARM.replace("</joint>", '<dynamics damping="inf"/></joint>'), 1, "number-unreadable")
variant("rpy of two", ARM.replace('xyz="0.3 0 0"', 'xyz="0.3 0 0" rpy="0 0"'), 1, "number-unreadable")
variant("centre of mass in words", ARM.replace("0.1 0 0.05", "middle", 1), 1, "inertial-unreadable")
variant("trailing space in a tensor", ARM.replace('"0.02"', '"0.02 "', 1), 0, "number-spaces")
variant("leading tab in a mass", ARM.replace('value="2"', 'value="\t2"', 1), 0, "number-spaces")
variant("line end in a limit", ARM.replace('lower="-1"', 'lower="-1\n"'), 0, "number-spaces")
variant("space around an origin", ARM.replace('"0.3 0 0"', '" 0.3 0 0 "'), 0, infos=["number-spaces"])
variant("many spaces between", ARM.replace('"0.3 0 0"', '"0.3   0  0"'), 0)
variant("tab between, which Pinocchio refuses", ARM.replace('"0.3 0 0"', '"0.3 0\t0"'), 0, infos=["original-rejected"])
variant("signs and exponents", ARM.replace('"0.3 0 0"', '"+3.E-1 -0 .0e5"'), 0)

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
variant("mass as text", ARM.replace('<mass value="2"/>', "<mass>2</mass>", 1), 1, "inertial-unreadable", "stray-text")
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

HELD = link("held", "")
for name, element in {
    "capitalised link": "<Link name='held'/>",
    "link in capitals": "<LINK name='held'/>",
    "capitalised joint": "<Joint name='j' type='fixed'/>",
    "link in a group": f"<group>{HELD}</group>",
    "joint in a group of a group": "<group><group><joint/></group></group>",
    "link of a namespace": "<u:link xmlns:u='http://example.org/u' name='held'/>",
    "include": "<include filename='arm.urdf'/>",
    "inertial of the robot": inertial(),
}.items():
    variant(f"{name}, below robot", ARM.replace("</robot>", f"{element}</robot>"), 1, "unknown-element")
SRDF = (
    "<group name='g'><link name='arm'/><joint name='hinge'/><joint name='virtual'/>"
    "<chain base_link='base' tip_link='arm'/></group>"
)
for name, element in {
    "group of an SRDF": SRDF,
    "state of a group": "<group_state name='home' group='g'><joint name='hinge' value='0'/></group_state>",
    "end effector": "<end_effector name='e' parent_link='arm' group='g'/>",
    "joint named in text": "<plan><joint>hinge</joint><link>arm</link></plan>",
    "link with a setting": "<gains><link name='arm' damping_of_contact='0'/></gains>",
}.items():
    variant(f"{name} adds nothing", ARM.replace("</robot>", f"{element}</robot>"), 0, infos=["unknown-element"])
variant(
    "joint of a namespace adds nothing",
    ARM.replace("</robot>", "<u:plan xmlns:u='http://example.org/u'><u:joint name='hinge'/></u:plan></robot>"),
    0,
)
variant(
    "spring that names a joint",
    ARM.replace(
        "</robot>",
        "<force_element><spring stiffness='2'><joint name='hinge'/></spring></force_element></robot>",
    ),
    0,
    "dynamics-not-used",
)
variant(
    "link of a group with an inertial",
    ARM.replace("</robot>", f"<group>{link('arm')}</group></robot>"),
    1,
    "unknown-element",
)
for name, element in {
    "link": HELD,
    "joint": "<joint name='j' type='fixed'/>",
    "second, capitalised": "<Inertial/>",
}.items():
    variant(f"{name} in a link", ARM.replace("</link>", f"{element}</link>", 1), 1, "unknown-element")
variant("inertial in a joint", ARM.replace("</joint>", f"{inertial()}</joint>"), 1, "unknown-element")
variant(
    "inertial in a visual",
    ARM.replace("</link>", f"<visual>{inertial()}{BOX_SHAPE}</visual></link>", 1),
    1,
    "unknown-element",
)
variant("origin as text", ARM.replace('<origin xyz="0.3 0 0"/>', "<origin>0 0 1</origin>"), 0, "stray-text")
variant(
    "origin of elements",
    ARM.replace('<origin xyz="0.3 0 0"/>', "<origin><xyz>0 0 1</xyz></origin>"),
    0,
    "unknown-element",
)
variant("text in the robot", ARM.replace("</robot>", "-->\n</robot>"), 0, "stray-text")
variant("text behind an inertial", ARM.replace("</link>", "2 kg</link>", 1), 0, "stray-text")
variant("mass of a link", ARM.replace('<link name="arm"', '<link name="arm" mass="50"'), 0, "unknown-attribute")
variant("axis of a joint", ARM.replace('type="revolute"', 'type="revolute" axis="0 0 1"'), 0, "unknown-attribute")
variant("colour of a link", ARM.replace('<link name="arm"', '<link name="arm" hue="1"'), 0, infos=["unknown-attribute"])
variant(
    "misspelt xyz of a visual",
    ARM.replace("</link>", f"<visual><origin xzy='0 0 1'/>{BOX_SHAPE}</visual></link>", 1),
    0,
    "unknown-attribute",
)
variant(
    "two geometries",
    ARM.replace("</link>", f"<visual>{BOX_SHAPE}{BOX_SHAPE}</visual></link>", 1),
    0,
    "duplicate-element",
)
variant(
    "element of another program below robot",
    ARM.replace("</robot>", "<mujoco><compiler/></mujoco></robot>"),
    0,
    infos=["unknown-element"],
)

for space in ("\u00a0", "\u2009", "\u3000", "\x85"):
    variant(f"{space!r} between", ARM.replace("0.3 0 0", f"0.3{space}0 0"), 1, "number-unreadable")
    variant(f"{space!r} behind", ARM.replace("0.3 0 0", f"0.3 0 0{space}"), 1, "number-unreadable")
    variant(f"{space!r} in a mass", ARM.replace('value="2"', f'value="2{space}"', 1), 1, "inertial-unreadable")

variant("lengths of rounding", ARM.replace("0.3 0 0", "0.3 1e-120 -1e-300"), 0)
variant("mass of a virus", ARM.replace('value="2"', 'value="1e-18"', 1), 1, "number-range")
variant("blank mass", ARM.replace('value="2"', 'value="  "', 1), 1, "inertial-unreadable")

V12 = ARM.replace('name="made"', 'name="made" version="1.2"')
TURNED = 'xyz="0.3 0 0" quat_xyzw="{}"'
for text, codes in (
    ("0 0 0 1", []),
    ("0 0.6 0 -0.8", []),
    ("0.707 0 0 0.707", []),
    ("0.7 0 0 0.7", ["quaternion-not-unit"]),
    ("0 0 2 0", ["quaternion-not-unit"]),
):
    for place, old in (("joint", 'xyz="0.3 0 0"'), ("inertial", 'xyz="0.1 0 0.05"')):
        turned = V12.replace(old, f'{old} quat_xyzw="{text}"', 1)
        variant(f"quaternion {text} of {place}", turned, 0, *codes)
for role in ("visual", "collision"):
    for text, codes in (("0 0 0.6 0.8", []), ("0 0 0 0", ["visual-unreadable"]), ("0 0 1", ["visual-unreadable"])):
        shape = f'<{role}><origin quat_xyzw="{text}"/>{BOX_SHAPE}</{role}>'
        variant(f"quaternion {text} of {role}", V12.replace("</link>", shape + "</link>", 1), 0, *codes)
for text in ("0 0 0 0", "0 0 1e-9 0", "0 0 1", "0 0 0 1 0", "", "x 0 0 1", "nan 0 0 1", "0,0,0,1"):
    turned = V12.replace('xyz="0.3 0 0"', TURNED.format(text))
    variant(f"quaternion {text!r} of a joint", turned, 1, "number-unreadable")
    turned = V12.replace('xyz="0.1 0 0.05"', f'xyz="0.1 0 0.05" quat_xyzw="{text}"', 1)
    variant(f"quaternion {text!r} of an inertial", turned, 1, "inertial-unreadable")
variant(
    "quaternion, spaces around", V12.replace('xyz="0.3 0 0"', TURNED.format(" 0 0 0 1 ")), 0, infos=["number-spaces"]
)
variant(
    "quaternion of nothing, spaces around",
    V12.replace('xyz="0.3 0 0"', TURNED.format(" 0 0 0 0")),
    1,
    "number-unreadable",
    infos=["number-spaces"],
)
for version in ("1.0", "1.1", "1.2"):
    declared = ARM.replace('name="made"', f'name="made" version="{version}"')
    variant(f"version {version}", declared, 0)
    both = declared.replace('xyz="0.3 0 0"', TURNED.format("0 0 0 1") + ' rpy="0 0 0"')
    variant(f"two orientations in version {version}", both, 1, "two-orientations")
for version in ("1.3", "2.0", "", "1", "x", "1.10", "1.2 "):
    odd = ARM.replace('name="made"', f'name="made" version="{version}"')
    variant(f"version {version!r}", odd, 0, "unknown-version")
variant(
    "version 1.0 with a quaternion", ARM.replace('xyz="0.3 0 0"', TURNED.format("0 0 1 0")), 0, "quaternion-ignored"
)
for role in ("visual", "inertial"):
    both = '<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>'
    turned = V12.replace('<origin xyz="0.1 0 0.05"/>', both, 1)
    if role == "visual":
        turned = V12.replace("</link>", f"<visual>{both}{BOX_SHAPE}</visual></link>", 1)
    variant(f"two orientations in an {role}", turned, 1, "two-orientations")

for old, new in {
    'xyz="0.3 0 0"': 'xyz="0.3 0 0" quat="0 0 0 1"',
    'xyz="0 1 0"': 'xyz="0 1 0" frame="world"',
    'value="2"': 'value="2" unit="g"',
    'izz="0.04"': 'izz="0.04" scale="0.5"',
    'effort="10"': 'effort="10" continuous_effort="5"',
    '<parent link="base"': '<parent link="base" offset="1"',
    '<child link="arm"': '<child link="arm" offset="1"',
    '<joint name="hinge"': '<joint name="hinge" armature="1"',
}.items():
    variant(f"{new} is not known", ARM.replace(old, new, 1), 0, "unknown-attribute")
variant(
    "stiffness in dynamics",
    ARM.replace("</joint>", '<dynamics damping="1" spring_stiffness="3"/></joint>'),
    0,
    "unknown-attribute",
)
MORE = '<origin xyz="0.3 0 0"{}>{}</origin>'
foreign = MORE.format(' u:quat="1" xmlns:u="http://example.org/u"', "")
for name, origin, code in (
    ("attribute of a namespace", foreign, "unknown-attribute"),
    ("element", MORE.format("", "<turned/>"), "unknown-element"),
):
    variant(f"{name} in an origin", ARM.replace('<origin xyz="0.3 0 0"/>', origin), 0, code)
variant("element in an inertial", ARM.replace("</inertial>", "<fuel/></inertial>", 1), 0, "unknown-element")
variant("gains in a joint", ARM.replace("</joint>", '<controller_gains kp="1"/></joint>'), 0, infos=["unknown-element"])
TWICE = ARM.replace('ixy="0"', 'ixy="0.001" iyx="{}"', 1)
variant("product twice", TWICE.format("0.001"), 0, infos=["unknown-attribute"])
variant("product twice, rounded", TWICE.format("0.00100000001"), 0, infos=["unknown-attribute"])
variant("product twice, of other sign", TWICE.format("-0.001"), 1, "inertia-asymmetric")
variant("product twice, no number", TWICE.format("x"), 1, "inertial-unreadable")

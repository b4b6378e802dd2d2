"""Files that are not text, XML or URDF."""

from __future__ import annotations

import bz2
import gzip
import lzma

from urdf.corpus.parts import ARM, variant

variant("sound", ARM, 0)
variant("sound with a byte order mark", b"\xef\xbb\xbf" + ARM.encode(), 0)
variant("sound with Windows line ends", ARM.replace("\n", "\r\n"), 0)
variant("declared otherwise", ARM.replace("?>", ' encoding="UTF-16"?>', 1), 0)
variant("empty", "", 2, "not-xml")
variant("blank", " \n\n", 2, "not-xml")
variant("words", "a robot of two links", 2, "not-xml")
variant("NUL byte", ARM.replace("arm", "a\0m"), 2, "not-text")
variant("UTF-16 with mark", ARM.encode("utf-16"), 0)
variant("UTF-16 little", ARM.encode("utf-16-le"), 2, "not-text")
variant("UTF-16 big", ARM.encode("utf-16-be"), 2, "not-text")
variant("UTF-32", ARM.encode("utf-32"), 2, "not-text")
variant("Latin-1", ARM.replace("arm", "bras d'à côté").encode("latin-1"), 2, "not-text")
variant("gzip", gzip.compress(ARM.encode(), mtime=0), 2, "not-text")
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
variant("undeclared prefix", ARM.replace("</robot>", "<a:b/></robot>"), 0, infos=["undeclared-prefix"])
for name, part in {
    "element of an extension": "<gazebo><sensor:camera name='eye'><hfov>50</hfov></sensor:camera></gazebo>",
    "attribute": "<gazebo sensor:name='eye'/>",
    "several": "<gazebo><a:a/><b:b/><c:c/><d:d/><e:e/><f:f/></gazebo>",
}.items():
    variant(f"undeclared prefix: {name}", ARM.replace("</robot>", f"{part}</robot>"), 0, infos=["undeclared-prefix"])
variant(
    "undeclared prefix: link",
    ARM.replace("</robot>", "<a:link name='b'/></robot>"),
    1,
    "unknown-element",
    infos=["undeclared-prefix"],
)
variant(
    "undeclared prefix: attribute of an axis",
    ARM.replace("<axis ", "<axis a:frame='b' "),
    0,
    "unknown-attribute",
    infos=["undeclared-prefix"],
)
variant("two prefixes", ARM.replace("</robot>", "<a:b:c/></robot>"), 2, "not-xml")
variant("prefixed robot", ARM.replace("robot", "r:robot"), 2, "not-urdf", infos=["undeclared-prefix"])
LETTERS = ARM.replace("<robot", "<!-- Ärmel -->\n<robot", 1).replace("arm", "ärmel")
for encoding in ("ISO-8859-1", "latin1", "windows-1252", "iso-8859-15", "cp850"):
    declared = LETTERS.replace("?>", f' encoding="{encoding}"?>', 1)
    variant(f"declared {encoding}", declared.encode(encoding), 0)
for encoding, letters in {"windows-1251": "рука", "Shift_JIS": "腕", "GB2312": "机器人", "KOI8-R": "рука"}.items():
    declared = ARM.replace("arm", letters).replace("?>", f" encoding='{encoding}' standalone='yes' ?>", 1)
    variant(f"declared {encoding}", declared.encode(encoding), 0)
    variant(f"declared {encoding}, without it", ARM.replace("arm", letters).encode(encoding), 2, "not-text")
variant("declared US-ASCII", LETTERS.replace("?>", " encoding='us-ascii'?>", 1).encode("latin-1"), 2, "not-text")
for encoding in ("UTF-7", "utf-16", "rot13", "no-such", "unicode_escape", "hz", "idna", "cp037"):
    declared = LETTERS.replace("?>", f" encoding='{encoding}'?>", 1)
    variant(f"declared {encoding}", declared.encode("latin-1"), 2, "not-text")
variant("UTF-16 big with mark", LETTERS.encode("utf-16-be").join([b"\xfe\xff", b""]), 0)
variant("UTF-16, declared", LETTERS.replace("?>", " encoding='UTF-16'?>", 1).encode("utf-16"), 0)
variant("UTF-16 cut off", LETTERS.encode("utf-16")[:-1], 2, "not-text")
variant("blank line before the declaration", "\n" + ARM, 0, "declaration-late")
variant("byte order mark and blanks before the declaration", "\ufeff \r\n" + ARM, 0, "declaration-late")
variant(
    "Latin-1, blank line",
    ("\n" + LETTERS.replace("?>", " encoding='latin1'?>", 1)).encode("latin1"),
    0,
    "declaration-late",
)
variant("comment before the declaration", "<!-- a -->" + ARM, 2, "not-xml")
variant("second declaration", ARM.replace("<robot", '<?xml version="1.0"?><robot', 1), 2, "not-xml")
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
    1,
    "unknown-element",
)
variant("style sheet", ARM.replace("<robot", '<?xml-stylesheet href="http://192.0.2.1/s.xsl"?><robot', 1), 0)
variant("101 deep", ARM.replace("</robot>", "<a>" * 100 + "</a>" * 100 + "</robot>"), 2, "too-deep")
variant("99 deep", ARM.replace("</robot>", "<a>" * 98 + "</a>" * 98 + "</robot>"), 0, infos=["unknown-element"])
variant(
    "65 attributes",
    ARM.replace("<link", "<link " + "".join(f'a{k}="" ' for k in range(64)), 1),
    2,
    "too-many-attributes",
)
variant("long attribute", ARM.replace('"arm"', f'"{"a" * 10_001}"'), 2, "too-long-attribute")
variant("long name", ARM.replace('"arm"', f'"{"a" * 9_999}"'), 0)

variant("SDF", '<sdf version="1.6"><model name="m"><link name="base"/></model></sdf>', 2, "not-urdf")
variant("MJCF", '<mujoco model="m"><worldbody/></mujoco>', 2, "not-urdf")
variant("HTML", "<!DOCTYPE html><html><head><meta charset=utf-8></head><body>404</body></html>", 2, "not-urdf")
variant("XHTML", "<html><body><p>404 Not Found</p></body></html>", 2, "not-urdf")
variant("COLLADA", '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"/>', 2, "not-urdf")
variant("capital robot", ARM.replace("robot", "Robot"), 2, "not-urdf")
NAMESPACE = ARM.replace("<robot", '<robot xmlns="http://example.org/r"')
variant("robot in a namespace", NAMESPACE, 0, "default-namespace")
variant(
    "robot in a namespace, unknown element",
    NAMESPACE.replace("</link>", "<visaul/></link>", 1),
    0,
    "default-namespace",
    "unknown-element",
)
variant(
    "robot in a namespace, a prefix not declared",
    NAMESPACE.replace("</robot>", "<s:a s:b='c'/></robot>"),
    0,
    "default-namespace",
    infos=["undeclared-prefix"],
)
variant(
    "robot in a namespace, a link in another",
    NAMESPACE.replace("</robot>", "<link xmlns='http://example.org/s' name='b'/></robot>"),
    1,
    "default-namespace",
    "unknown-element",
)
variant(
    "robot with a prefix",
    ARM.replace("<robot", "<a:robot xmlns:a='http://example.org/r'").replace("</robot", "</a:robot"),
    2,
    "not-urdf",
)
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
variant("xacro macro", ARM.replace("<robot", f"<robot {XACRO}").replace("</robot>", "<xacro:arm/></robot>"), 2, "xacro")
variant("xacro without namespace", ARM.replace("</robot>", "<xacro:arm/></robot>"), 2, "xacro")
variant("xacro property", ARM.replace('value="2"', 'value="${m}"'), 2, "xacro")
variant("xacro argument", ARM.replace('value="2"', 'value="$(arg m)"'), 2, "xacro")
DRAWN = "<visual>{}<geometry><box size='1 1 1'/></geometry></visual>"
for name, part in {
    "call in a visual": DRAWN.format("<xacro:silver/>"),
    "call in a collision": DRAWN.format("<xacro:silver/>").replace("visual", "collision"),
    "call in a shape": "<visual><geometry><xacro:hull/></geometry></visual>",
    "value in a visual": DRAWN.format("<origin xyz='0 0 ${height}'/>"),
    "mesh name": "<visual><geometry><mesh filename='$(find arm)/hand.stl'/></geometry></visual>",
    "colour": DRAWN.format("<material name='a'><color rgba='${red}'/></material>"),
}.items():
    variant(f"xacro left over: {name}", ARM.replace("</link>", part + "</link>", 1), 0, "xacro-left-over")
variant(
    "xacro left over: material",
    ARM.replace("</robot>", "<material name='a'><color rgba='${red}'/></material></robot>"),
    0,
    "xacro-left-over",
)
for name, part in {
    "call in a link": "<link name='b'><xacro:inertia/></link>",
    "call in a joint": "<joint name='b' type='fixed'><xacro:ends/></joint>",
    "call in an inertial": "<link name='b'><inertial><xacro:box/></inertial></link>",
    "condition": "<xacro:if value='1'><link name='b'/></xacro:if>",
    "name": "<link name='${prefix}b'/>",
    "element of another": "<group><xacro:arm/></group>",
}.items():
    variant(f"xacro left over: {name}", ARM.replace("</robot>", part + "</robot>"), 2, "xacro")
variant("xacro call in an extension", ARM.replace("</robot>", "<gazebo><xacro:a xmlns:xacro='x'/></gazebo></robot>"), 0)
variant("expanded xacro", ARM.replace("<robot", f"<robot {XACRO}"), 0)
variant("robot in robot", ARM.replace("</robot>", '<robot name="b"/></robot>'), 2, "second-robot")
variant("no name", ARM.replace('<robot name="made">', "<robot>"), 0, "no-robot-name")
variant("blank name", ARM.replace('"made"', '" "'), 0, "no-robot-name")
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

variant("dollar in a name", ARM.replace('"arm"', '"a$(b)"'), 0)

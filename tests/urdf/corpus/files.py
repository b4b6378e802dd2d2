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
variant("UTF-16 with mark", ARM.encode("utf-16"), 2, "not-text")
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
variant("robot in a namespace", ARM.replace("<robot", '<robot xmlns="http://example.org/r"'), 2, "not-urdf")
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
variant("xacro macro", ARM.replace("<robot", f"<robot {XACRO}").replace("</robot>", "<xacro:arm/></robot>"), 2, "xacro")
variant("xacro without namespace", ARM.replace("</robot>", "<xacro:arm/></robot>"), 2, "xacro")
variant("xacro property", ARM.replace('value="2"', 'value="${m}"'), 2, "xacro")
variant("xacro argument", ARM.replace('value="2"', 'value="$(arg m)"'), 2, "xacro")
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

variant("default namespace", ARM.replace("<robot", '<robot xmlns="http://example.org/urdf"'), 2, "not-urdf")
variant("dollar in a name", ARM.replace('"arm"', '"a$(b)"'), 0)

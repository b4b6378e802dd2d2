"""Xacros: what is expanded, and what is not; files of several folders are in test_xacro.py."""

from __future__ import annotations

from urdf.corpus.parts import ARM, variant

HEAD = '<robot name="made" xmlns:xacro="http://www.ros.org/wiki/xacro">'


def xacro(name, part, status, *codes, infos=(), options=()):
    """ARM with a part before its first link."""
    content = ARM.replace('<robot name="made">', HEAD + part)
    variant(f"xacro: {name}", content, status, *codes, infos=infos, options=options, file="robot.urdf.xacro")


xacro("nothing to expand", "", 0)
xacro("property", '<xacro:property name="mass" value="2"/><gazebo a="${mass}"/>', 0)
xacro("argument with a default", '<xacro:arg name="mass" default="2"/><gazebo a="$(arg mass)"/>', 0)
xacro("argument", '<xacro:arg name="mass" default=""/><gazebo a="$(arg mass)"/>', 0, options=["mass:=3"])
xacro("macro", '<xacro:macro name="m"><gazebo/></xacro:macro><xacro:m/>', 0)
xacro("no such macro", "<xacro:arm/>", 2, "xacro-failed")
xacro("argument without value", '<gazebo a="$(arg mass)"/>', 2, "xacro-failed")
xacro("environment variable", '<gazebo a="$(env HOME)"/>', 2, "xacro-failed")
xacro("environment variable with a default", '<gazebo a="$(optenv HOME there)"/>', 0)
xacro("property that is not there", '<gazebo a="${mass}"/>', 2, "xacro-failed")
xacro("division by zero", '<gazebo a="${1/0}"/>', 2, "xacro-failed")
xacro("file that is not there", '<xacro:include filename="hand.xacro"/>', 2, "xacro-failed")
xacro("file that need not be there", '<xacro:include filename="hand.xacro" optional="true"/>', 0)
xacro("pattern that no file has", '<xacro:include filename="hand*.xacro"/>', 0, "xacro-warning")
xacro("property called e", '<xacro:property name="e" value="1"/>', 0, infos=["xacro-warning"])
xacro("no such package", '<xacro:include filename="$(find gripper)/hand.xacro"/>', 2, "xacro-package")
xacro("package above", '<xacro:include filename="$(find ..)/hand.xacro"/>', 2, "xacro-package")
for name, part in {
    "file elsewhere": '<xacro:include filename="/etc/passwd"/>',
    "file above": '<xacro:include filename="../../../../../etc/passwd"/>',
    "pattern elsewhere": '<xacro:include filename="/etc/*.xacro"/>',
    "YAML elsewhere": """<gazebo a="${xacro.load_yaml('/etc/passwd')}"/>""",
    "classes": '<gazebo a="${().__class__}"/>',
    "classes in a function": '<gazebo a="${(lambda: ().__class__)()}"/>',
}.items():
    xacro(name, part, 2, "xacro-outside")
xacro("built-in function", '<gazebo a="${open}"/>', 2, "xacro-failed")
xacro("macro that calls itself", '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>', 2, "xacro-exhausted")
xacro("property of itself", '<xacro:property name="a" value="${a}"/><gazebo a="${a}"/>', 2, "xacro-failed")
xacro("file of itself", '<xacro:include filename="robot.urdf.xacro"/>', 2, "xacro-exhausted")
xacro("memory", """<gazebo a="${'x' * 10**10}"/>""", 2, "xacro-exhausted")
variant("xacro: cut off", ARM[:-20], 2, "xacro-failed", file="robot.xacro")
variant(
    "xacro: entities", "<!DOCTYPE robot [<!ENTITY a 'b'>]>" + ARM[ARM.index("<robot") :], 2, "doctype", file="r.xacro"
)
variant("xacro: unsound", ARM.replace('value="2"', 'value="-2"'), 1, "negative-mass", file="robot.xacro")

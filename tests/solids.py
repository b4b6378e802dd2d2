"""Robots of a few solids, written as URDFs: bodies with a shape each, on joints that slide or turn."""

from __future__ import annotations

import ospace

INERTIAL = '<inertial><mass value="{0}"/><inertia ixx="{1}" iyy="{1}" izz="{1}" ixy="0" ixz="0" iyz="0"/></inertial>'
BALL, BOX, ROD, WHEEL = (
    '<sphere radius="0.1"/>',
    '<box size="0.3 0.2 0.1"/>',
    '<cylinder radius="0.04" length="0.5"/>',
    '<cylinder radius="0.15" length="0.06"/>',
)


def link(name, shape="", mass=5.0, origin="0 0 0", rpy="0 0 0"):
    drawn = f'<collision><origin xyz="{origin}" rpy="{rpy}"/><geometry>{shape}</geometry></collision>' if shape else ""
    return f'<link name="{name}">{INERTIAL.format(mass, 0.02 * mass)}{drawn}</link>'


def joint(parent, child, kind="revolute", axis="0 0 1", origin="0 0 0", reach=3.0, velocity=1e3):
    limit = "" if kind in ("fixed", "continuous") else f'lower="{-reach}" upper="{reach}" '
    limit = "" if kind == "fixed" else f'<axis xyz="{axis}"/><limit {limit}effort="200" velocity="{velocity}"/>'
    name = f"{child}_joint"
    return (
        f'<joint name="{name}" type="{kind}"><origin xyz="{origin}"/><parent link="{parent}"/>'
        f'<child link="{child}"/>{limit}</joint>'
    )


def robot(folder, *parts, name="solids"):
    """Write a robot of a bus without a shape, 20 t, and these links and joints; read it."""
    path = folder / f"{name}.urdf"
    path.write_text(f'<robot name="{name}">{link("bus", mass=2e4)}{"".join(parts)}</robot>')
    return ospace.SpaceRobot.from_urdf(path)


def arm(folder, tool, other, *, name="arm", other_mass=5.0):
    """Write an arm of three joints that ends in `tool`, and another body that turns on a joint of its own."""
    return robot(
        folder,
        link("upper"),
        joint("bus", "upper", axis="0 0 1"),
        link("fore"),
        joint("upper", "fore", axis="0 1 0", origin="0.5 0 0"),
        link("tool", tool, 2.0),
        joint("fore", "tool", axis="1 0 0", origin="0.5 0 0"),
        link("other", other, other_mass),
        joint("bus", "other", "continuous", origin="0.78 0.61 0.1"),
        name=name,
    )


def body(folder, shape, name="debris", mass=50.0):
    """Write a body of one link, named as its robot is."""
    path = folder / f"{name}.urdf"
    path.write_text(f'<robot name="{name}">{link(f"{name}_body", shape, mass)}</robot>')
    return ospace.SpaceRobot.from_urdf(path)

"""What the files of the corpus are made of."""

from __future__ import annotations

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
HAND = joint("wrist", "continuous", "arm", "hand", AXIS + '<limit effort="10" velocity="1"/>')
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
    file: str = "robot.urdf"


VARIANTS: list[Variant] = []


def variant(name, content, status, *codes, infos=(), options=(), file="robot.urdf"):
    content = content if isinstance(content, bytes) else content.encode()
    VARIANTS.append(Variant(name, content, status, frozenset(codes), frozenset(infos), tuple(options), file))


def with_arm(content, more=""):
    return robot(link("base"), link("arm", content, more), joint())

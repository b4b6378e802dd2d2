"""The links and joints of a file, as the table and the document of ``ospace check URDF --frames``."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from ospace.cli.columns import Column, fit
from ospace.cli.console import buffered_console, buffered_text, plain, show_text

if TYPE_CHECKING:
    from ospace.urdf.description import Joint, Link
    from ospace.urdf.reader import Reading

_LIMITS = ("lower", "upper", "velocity", "effort")


def document(reading: Reading) -> str:
    """Return one JSON document: links and joints from the base outward, None for no limit.

    Returns
    -------
    str
    """
    robot = reading.description
    links = [{"name": link.name, "mass": _mass(link)} for link in robot.links]
    listed = {"robot": robot.name, "base": robot.root, "links": links, "joints": list(map(_as_dict, robot.joints))}
    return json.dumps(listed, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def table(reading: Reading, file: str) -> str:
    """Return a table of links, each with the joint that carries it, from the base outward.

    Returns
    -------
    str
    """
    from ospace.validation.report_text import number

    robot = reading.description
    console = buffered_console()
    joints = fit(_JOINT, [_row(joint) for joint in robot.joints], console.width, "  ")
    show_text(console, "link (mass kg)")
    for line in joints.heading:
        console.print(line)
    show_text(console, plain(f"{robot.root} ({_mass(robot.link[robot.root]):g}), the base"))
    for joint, lines in zip(robot.joints, joints.rows, strict=True):
        show_text(console, plain(f"{joint.child} ({_mass(robot.link[joint.child]):g}) on {joint.parent}"))
        for line in lines:
            console.print(line)
        if (mimic := joint.mimic) is not None:
            text = f"mimics {mimic.joint}: {mimic.multiplier:g} times its position, plus {mimic.offset:g}"
            show_text(console, plain(text), "    ", "      ")
    counts = [sum(one.severity == level for one in reading.findings) for level in ("error", "warning")]
    verdict = f"{number(counts[0], 'error')}, {number(counts[1], 'warning')}"
    counted = f"{number(len(robot.links), 'link')}, {number(len(robot.joints), 'joint')}"
    show_text(console, f"{counted}; limits in rad or m, rad/s or m/s, N m or N")
    show_text(console, plain(f"{'unsound' if reading.model is None else 'read'}: {file}: {verdict}"))
    return buffered_text(console)


_JOINT = (Column("joint"), Column("type"), *(Column(name, right=True) for name in ("lower", "upper", "rate", "effort")))


def _row(joint: Joint) -> tuple[str, ...]:
    limited = joint.kind not in ("fixed", "floating", "planar")
    numbers = [_number(value) if limited else "" for value in _limits(joint).values()]
    return plain(joint.name), joint.kind, *numbers


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.4g}"


def _limits(joint: Joint) -> dict[str, float | None]:
    return {key: _finite(getattr(joint.limit, key, None)) for key in _LIMITS}


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _as_dict(joint: Joint) -> dict[str, Any]:
    mimic = joint.mimic
    return {
        "name": joint.name,
        "type": joint.kind,
        "parent": joint.parent,
        "child": joint.child,
        "xyz": list(map(_finite, joint.pose.xyz)),
        "rpy": list(map(_finite, joint.pose.rpy)),
        "axis": list(map(_finite, joint.axis)),
        **_limits(joint),
        "mimic": mimic
        and {"joint": mimic.joint, "multiplier": _finite(mimic.multiplier), "offset": _finite(mimic.offset)},
    }


def _mass(link: Link) -> float:
    return 0.0 if link.inertial is None else link.inertial.mass

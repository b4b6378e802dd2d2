"""The links and joints of a file, as the table and the document of ``ospace check URDF --frames``."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from ospace.exceptions import printable

if TYPE_CHECKING:
    from ospace.urdf.description import Joint, Link
    from ospace.urdf.reader import Reading

_NAME = 29  # characters of a joint's name in its row
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
    lines = [
        "link (mass kg)",
        f"  {'joint':{_NAME}}  {'type':10}  {'lower':>7}  {'upper':>7}  {'rate':>6}  {'effort':>6}",
        f"{robot.root} ({_mass(robot.link[robot.root]):g}), the base",
    ]
    for joint in robot.joints:
        lines.append(f"{joint.child} ({_mass(robot.link[joint.child]):g}) on {joint.parent}")
        lines += _row(joint)
    counts = [sum(one.severity == level for one in reading.findings) for level in ("error", "warning")]
    verdict = f"{number(counts[0], 'error')}, {number(counts[1], 'warning')}"
    counted = f"{number(len(robot.links), 'link')}, {number(len(robot.joints), 'joint')}"
    lines.append(f"{counted}; limits in rad or m, rad/s or m/s, N m or N")
    lines.append(f"{'unsound' if reading.model is None else 'read'}: {file}: {verdict}")
    return "".join(f"{printable(line)}\n" for line in lines)


def _row(joint: Joint) -> list[str]:
    numbers = f"{joint.kind:10}"
    if joint.kind not in ("fixed", "floating", "planar"):
        lower, upper, rate, effort = (_number(value) for value in _limits(joint).values())
        numbers += f"  {lower:>7}  {upper:>7}  {rate:>6}  {effort:>6}"
    long = len(joint.name) > _NAME
    rows = [f"  {joint.name}", f"  {'':{_NAME}}  {numbers}"] if long else [f"  {joint.name:{_NAME}}  {numbers}"]
    mimic = joint.mimic
    if mimic is not None:
        rows.append(f"    mimics {mimic.joint}: {mimic.multiplier:g} times its position, plus {mimic.offset:g}")
    return [row.rstrip() for row in rows]


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

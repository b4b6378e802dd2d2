"""Findings on joints: limits, efforts, damping, planes."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ospace.urdf.bodies import plane_axes
from ospace.urdf.description import Description, Joint, Limit
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.no_limit import NEVER_REACHED

_LIMITED = ("revolute", "prismatic")
_TWO_TURNS = 4.0 * math.pi
_DEGREES, _TEN_TURNS = 0.5, 3600.0  # deg: what limits are rounded to, and beyond which none lie
_LONG = 100.0  # m: longer than any prismatic joint
_ROUNDING = 1e-9


def check_joints(description: Description) -> Iterator[Finding]:
    """Check limits, damping and friction of every joint, and the axis of planar ones.

    Returns
    -------
    iterator of Finding
    """
    for joint in description.joints:
        if joint.kind == "planar" and any(joint.axis) and math.dist(joint.axis, (0.0, 0.0, 1.0)) > _ROUNDING:
            x, y, axis = (" ".join(f"{value:.4g}" for value in column + 0.0) for column in plane_axes(joint.axis).T)
            message = f"its plane is normal to {axis}: its coordinates x and y are along {x} and {y}"
            yield make_finding("planar-axis", joint.subject, message, line=joint.line)
        for name, value in (("damping", joint.damping), ("friction", joint.friction)):
            if value < 0.0:
                message = f"{name} {value:g} is negative"
                yield make_finding(f"{name}-negative", joint.subject, message, line=joint.line, value=repr(value))
        yield from _check_limits(joint)


def _check_limits(joint: Joint) -> Iterator[Finding]:
    limit = joint.limit
    if limit is None:
        if joint.kind in _LIMITED:
            message = f"{joint.kind} joint without <limit>, read as unlimited"
            yield make_finding("limits-missing", joint.subject, message, line=joint.line)
        elif joint.kind == "continuous":
            message = "continuous joint without <limit>, its effort and velocity read as unlimited"
            yield make_finding("limits-missing", joint.subject, message, line=joint.line, severity="info")
        return
    text = f"{limit.lower:g} to {limit.upper:g}"
    if limit.lower > limit.upper:
        yield make_finding("limits-reversed", joint.subject, f"limits {text} are reversed", line=limit.line, value=text)
    elif limit.lower == limit.upper:
        message = f"limits {text} leave no room to move"
        yield make_finding("limits-zero", joint.subject, message, line=limit.line, value=text)
    yield from _check_zero(joint, limit)
    if joint.kind == "revolute" and _in_degrees(limit):
        message = f"limits {text} rad are more than two turns from zero: are they in degrees?"
        yield make_finding("units-angle", joint.subject, message, line=limit.line, value=text)
    if joint.kind == "prismatic" and any(_LONG < abs(x) < NEVER_REACHED for x in (limit.lower, limit.upper)):
        message = f"limits {text} m are more than {_LONG:g} m from zero: are they in millimetres?"
        yield make_finding("units-length", joint.subject, message, line=limit.line, value=text)
    sizes = {"effort": limit.effort, "velocity": limit.velocity}
    for code, what, named in (
        ("effort-zero", "is zero", [name for name in sizes if sizes[name] == 0.0]),
        ("effort-negative", "is negative", [name for name in sizes if sizes[name] < 0.0]),
    ):
        if named:
            drive = ": the joint has no drive" if code == "effort-zero" and "effort" in named else ""
            yield make_finding(code, joint.subject, f"limit of {' and '.join(named)} {what}{drive}", line=limit.line)


def _in_degrees(limit: Limit) -> bool:
    """Return whether limits are farther from zero than two turns in rad, and round numbers of degrees."""
    ends = [abs(x) for x in (limit.lower, limit.upper) if math.isfinite(x)]
    round_degrees = all(abs(math.remainder(x, _DEGREES)) <= _ROUNDING * x and x <= _TEN_TURNS for x in ends)
    return round_degrees and any(x > _TWO_TURNS for x in ends)


def _check_zero(joint: Joint, limit: Limit) -> Iterator[Finding]:
    excess = max(limit.lower, -limit.upper)
    if limit.lower <= limit.upper and excess > _ROUNDING:
        size = f"{excess:.3g} m" if joint.kind == "prismatic" else f"{excess:.3g} rad ({math.degrees(excess):.3g} deg)"
        message = f"zero lies {size} outside its limits {limit.lower:g} to {limit.upper:g}"
        yield make_finding("zero-outside-limits", joint.subject, message, line=limit.line, value=f"{excess:.6g}")

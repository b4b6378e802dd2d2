"""Findings on joints that mimic others."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ospace.exceptions import closest
from ospace.urdf.coupling import Following, followings, leaders_first
from ospace.urdf.description import Description, Joint
from ospace.urdf.lint.findings import Finding, make_finding

_TURNING, _SLIDING = ("revolute", "continuous"), ("prismatic",)
_ROUNDING = 1e-6  # rad or m: files round the limits that they multiply


def check_mimicry(description: Description, *, free_mimic: bool) -> Iterator[Finding]:
    """Check that each joint that mimics another can follow it, and how far its limits let it.

    Returns
    -------
    iterator of Finding
    """
    found = followings(description)
    _, without = leaders_first([joint.name for joint in description.joints], _parents(description), found)
    for joint in description.joints:
        if joint.mimic is None or joint.kind == "fixed":
            continue
        of = joint.mimic.joint
        if free_mimic:
            message = f"mimics '{of}' in the file and is an independent joint here: the coupling is not enforced"
            remedy = f"Keep to positions in which it follows '{of}', or make the joint fixed."
            yield make_finding("mimic-freed", joint.subject, message, remedy=remedy, line=joint.mimic.line, value=of)
        elif joint.name not in found:
            yield _unknown(description, joint, of)
        else:
            yield from _check_follower(description, joint, found[joint.name], ordered=joint.name not in without)


def _parents(description: Description) -> dict[str, str | None]:
    """Return the joint from whose link each joint hangs."""
    above = {joint.child: joint.name for joint in description.joints}
    return {joint.name: above.get(joint.parent) for joint in description.joints}


def _unknown(description: Description, joint: Joint, of: str) -> Finding:
    message = f"mimics '{of}', by way of which it mimics itself"
    if of not in description.joint or of == joint.name:
        movable = (other.name for other in description.joints if other.kind != "fixed")
        near = "" if of == joint.name else closest(of, movable)
        message = f"mimics '{of}', which is not another joint of the file{near}"
    elif _leader_at_the_end(description, joint) not in description.joint:
        message = f"mimics '{of}', which mimics a joint that is not in the file"
    line = joint.mimic.line if joint.mimic else joint.line
    return make_finding("mimic-unknown", joint.subject, message, line=line, value=of)


def _leader_at_the_end(description: Description, joint: Joint) -> str:
    name, passed = joint.name, set[str]()
    while name in description.joint and name not in passed and (mimic := description.joint[name].mimic):
        passed.add(name)
        name = mimic.joint
    return name


def _check_follower(description: Description, joint: Joint, one: Following, *, ordered: bool) -> Iterator[Finding]:
    leader, line = description.joint[one.leader], joint.mimic.line if joint.mimic else joint.line
    reason = ""
    if joint.kind not in _TURNING + _SLIDING:
        reason = f"is a {joint.kind} joint, which has no one position to follow another's"
    elif leader.kind not in _TURNING + _SLIDING:
        reason = f"mimics '{leader.name}', a {leader.kind} joint, which has no one position to follow"
    elif joint.kind in _SLIDING and leader.kind == "continuous":
        reason = f"slides as '{leader.name}' turns, whose angle is known but for full turns: make that one revolute"
    elif not ordered:
        reason = (
            f"mimics '{leader.name}', which hangs from it, or the other way round for another joint: let that one "
            f"mimic this one, by 1/multiplier"
        )
    if reason:
        yield make_finding("mimic-unfit", joint.subject, reason, line=line, value=leader.name)
        return
    law = f"{one.ratio:g} times '{leader.name}'" + (f" {one.offset:+g}" if one.offset else "")
    yield make_finding("mimic", joint.subject, f"follows {law}: one degree of freedom", line=line, value=leader.name)
    if leader.kind == "continuous" and not float(one.ratio).is_integer():
        message = f"jumps by {abs(one.ratio) % 1.0 * 360.0:.4g} deg where '{leader.name}' passes 180 deg"
        yield make_finding("mimic-jump", joint.subject, message, line=line, value=f"{one.ratio:g}")
    yield from _check_range(joint, leader, one, line)


def _check_range(joint: Joint, leader: Joint, one: Following, line: int | None) -> Iterator[Finding]:
    """Compare the range that the leader's limits let the follower have with the follower's own limits."""
    if joint.limit is None or leader.limit is None or "continuous" in (joint.kind, leader.kind):
        return
    ends = [one.ratio * end + one.offset for end in (leader.limit.lower, leader.limit.upper) if math.isfinite(end)]
    if len(ends) < 2 or joint.limit.lower > joint.limit.upper:
        return
    excess = max(joint.limit.lower - min(ends), max(ends) - joint.limit.upper)
    if excess > _ROUNDING:
        unit = "m" if joint.kind in _SLIDING else "rad"
        message = (
            f"'{leader.name}' within its limits takes it from {min(ends):.4g} to {max(ends):.4g} {unit}, its own "
            f"limits are {joint.limit.lower:g} to {joint.limit.upper:g}: those of '{leader.name}' count"
        )
        yield make_finding("mimic-limits", joint.subject, message, line=line, value=f"{excess:.4g}")

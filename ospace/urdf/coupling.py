"""Joints that mimic others: whom each follows in the end, and Pinocchio's model with the couplings in it.

Pinocchio takes a follower only where its leader has the smaller number and as many coordinates, and no follower for a
leader. So joints are added anew, leaders first, followers with the coordinates of their leaders, and a follower of a
follower follows the first leader: ratio and offset are multiplied up.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import pinocchio as pin

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.urdf.description import Description
from ospace.urdf.joint_axis import joint_axis

_PER_VELOCITY = (  # the same limits bear older names too, which come first
    "effortLimit",
    "velocityLimit",
    "friction",
    "armature",
    "rotorInertia",
    "rotorGearRatio",
    "damping",
    "lowerDryFrictionLimit",
    "upperDryFrictionLimit",
    "lowerEffortLimit",
    "upperEffortLimit",
    "lowerVelocityLimit",
    "upperVelocityLimit",
)
_PER_POSITION = ("lowerPositionLimit", "upperPositionLimit", "positionLimitMargin")
_DRY = ("lowerDryFrictionLimit", "upperDryFrictionLimit")
_UNBOUNDED = ("JointModelRUB", "JointModelRevoluteUnbounded")


@dataclass(frozen=True)
class Following:
    """A joint is at ratio · φ + offset where the joint called `leader`, which follows no other, is at φ; rad or m."""

    leader: str
    ratio: float
    offset: float


def followings(description: Description) -> dict[str, Following]:
    """Return whom each joint that mimics another follows in the end, but for those that follow none or themselves."""
    mimics = {joint.name: joint.mimic for joint in description.joints if joint.mimic and joint.kind != "fixed"}
    found: dict[str, Following] = {}
    for name in mimics:
        leader, ratio, offset, passed = name, 1.0, 0.0, set[str]()
        while (mimic := mimics.get(leader)) is not None and leader not in passed:
            passed.add(leader)
            leader, ratio, offset = mimic.joint, ratio * mimic.multiplier, offset + ratio * mimic.offset
        if leader in description.joint and leader not in passed:
            found[name] = Following(leader, ratio, offset)
    return found


def leaders_first(
    names: Sequence[str], parent: Mapping[str, str | None], followers: Mapping[str, Following]
) -> tuple[list[str], list[str]]:
    """Order joints depth first, each leader before its followers.

    Parameters
    ----------
    names : sequence of str
        The joints, in the order that is kept where it can be.
    parent : mapping of str to str or None
        The joint from whose link each hangs; None at the base.
    followers : mapping of str to Following

    Returns
    -------
    order : list of str
    without : list of str
        Followers for which there is no such order: the leader hangs from them, or two branches lead each other.
    """
    before: dict[str, dict[str, str]] = {}  # branches that come before another, and the follower for which they do
    without: list[str] = []
    for name, one in followers.items():
        own, led = _path(name, parent), _path(one.leader, parent)
        shared = next((k for k, (a, b) in enumerate(zip(own, led, strict=False)) if a != b), min(len(own), len(led)))
        if shared == len(own):
            without.append(name)
        elif shared < len(led):
            before.setdefault(own[shared], {})[led[shared]] = name
    below: dict[str | None, list[str]] = {}
    for name in names:
        below.setdefault(parent[name], []).append(name)
    order: list[str] = []
    waiting = _sorted(below.get(None, []), before, without)[::-1]
    while waiting:
        order.append(waiting.pop())
        waiting += _sorted(below.get(order[-1], []), before, without)[::-1]
    return order, [name for name in followers if name in without]


def _path(name: str, parent: Mapping[str, str | None]) -> list[str]:
    path, joint = [], name
    while joint is not None:
        path.append(joint)
        joint = parent[joint]  # type: ignore[assignment]
    return path[::-1]


def _sorted(siblings: list[str], before: Mapping[str, Mapping[str, str]], without: list[str]) -> list[str]:
    """Order branches; followers on one of those that lead each other go to `without`."""
    left, order = list(siblings), []
    while left:
        waits_for = {name: [other for other in before.get(name, ()) if other in left] for name in left}
        ready = next((name for name in left if not waits_for[name]), left[0])
        without += [before[ready][other] for other in waits_for[ready]]
        order.append(ready)
        left.remove(ready)
    return order


def couple(model: pin.Model, followers: Mapping[str, Following]) -> pin.Model:
    """Return the model with followers coupled to their leaders.

    Parameters
    ----------
    model : pin.Model
        With free joints. What damps a follower is felt by its leader: ratio² d, and |ratio| times the dry friction.
    followers : mapping of str to Following
        By the name of the joint.

    Raises
    ------
    OspaceError
        A leader hangs from its follower.
    """
    names = [str(name) for name in model.names]
    parent = {names[j]: names[model.parents[j]] if model.parents[j] > 1 else None for j in range(2, model.njoints)}
    order, without = leaders_first(names[2:], parent, followers)
    if without:
        leader = followers[without[0]].leader
        raise OspaceError(f"joint '{without[0]}' mimics '{leader}', which would hang from it: hold another link")
    old = {name: j for j, name in enumerate(names) if j > 1}
    coupled = pin.Model()
    coupled.name, coupled.gravity = model.name, model.gravity
    number = {0: 0}
    for j in [1, *(old[name] for name in order)]:
        joint = model.joints[j]
        if j > 1 and names[j] in followers:
            joint = _as_follower(joint, model.joints[old[followers[names[j]].leader]])
        k = coupled.addJoint(number[model.parents[j]], joint, model.jointPlacements[j], names[j])
        coupled.appendBodyToJoint(k, model.inertias[j], pin.SE3.Identity())
        number[j] = int(k)
        if joint.nq == model.joints[j].nq:
            copy_joint_numbers(model, j, coupled, k)
    copy_frames(model, coupled, number)
    for name, one in followers.items():
        pair = number[old[one.leader]], number[old[name]]
        coupled = pin.transformJointIntoMimic(coupled, *pair, one.ratio, one.offset)
    for name, one in followers.items():
        own, felt = model.idx_vs[old[name]], coupled.idx_vs[number[old[one.leader]]]
        coupled.damping[felt] += one.ratio**2 * model.damping[own]
        for friction in _DRY if hasattr(model, _DRY[0]) else ("friction",):
            getattr(coupled, friction)[felt] += abs(one.ratio) * getattr(model, friction)[own]
    return coupled


def _as_follower(joint: pin.JointModel, leader: pin.JointModel) -> pin.JointModel:
    """Return the joint with the coordinates of its leader: an angle, or its cosine and sine."""
    if joint.shortname().startswith("JointModelP"):
        return joint
    if leader.shortname().startswith(_UNBOUNDED):
        return _unbounded(joint_axis(joint))
    return pin.JointModelRevoluteUnaligned(joint_axis(joint))


def _unbounded(axis: Floats) -> pin.JointModel:
    """Return a joint that Pinocchio's bindings make of text alone."""
    xyz = " ".join(map(repr, map(float, axis)))
    return pin.buildModelFromXML(
        '<robot name="one"><link name="a"/><link name="b"/><joint name="j" type="continuous">'
        f'<parent link="a"/><child link="b"/><axis xyz="{xyz}"/></joint></robot>'
    ).joints[1]


def copy_frames(source: pin.Model, target: pin.Model, number: Mapping[int, int]) -> None:
    """Copy all frames of one model to another that has none, where `number` has the joints of both."""
    frame_number = {0: 0}
    for f, frame in list(enumerate(source.frames))[1:]:
        up = frame_number[frame.parentFrame]
        copy = pin.Frame(frame.name, number[frame.parentJoint], up, frame.placement, frame.type)
        frame_number[f] = int(target.addFrame(copy, False))


def copy_joint_numbers(source: pin.Model, j: int, target: pin.Model, k: int) -> None:
    """Copy limits, friction and drives of joint `j` of one model to joint `k`, of the same type, of another."""
    for names, first, at, count in (
        (_PER_VELOCITY, source.idx_vs[j], target.idx_vs[k], source.nvs[j]),
        (_PER_POSITION, source.idx_qs[j], target.idx_qs[k], source.nqs[j]),
    ):
        for name in names:
            if hasattr(source, name):
                numbers = getattr(target, name).copy()
                numbers[at : at + count] = getattr(source, name)[first : first + count]
                setattr(target, name, numbers)

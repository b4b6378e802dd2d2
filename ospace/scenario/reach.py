"""Places that a point can certainly not reach, known before anything is simulated.

Links hang together: the distance from a point p to the mass centre c_i of a link is at most the sum D(p, i) of the
lengths between the joints on the way, with the travel of those that slide. So the point stays within

    R(p) = Σ m_i D(p, i) / M

of the robot's mass centre, which moves evenly unless something pushes the base: by at most ½ F/M t² more if that is F.
A point of a target moves within its own R of the target's mass centre, which moves evenly too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.kernels.tree import Floats
from ospace.model.joint_positions import unit_of
from ospace.model.layout import Layout
from ospace.model.points import OperationalPoint
from ospace.model.state import State

_TURNING = ("JointModelR", "JointModelSpherical", "JointModelUniversal")


@dataclass(frozen=True, eq=False)
class Region:
    """A ball that moves evenly and grows.

    Attributes
    ----------
    centre, velocity : (3,)
        At time 0, inertial axes; m, m/s.
    radius : float
        At time 0, m.
    growth : float
        The radius is larger by ½ `growth` t² later, m/s².
    """

    centre: Floats
    velocity: Floats
    radius: float
    growth: float = 0.0

    def distance(self, other: Region, first: float, last: float, rows: tuple[int, ...] = (0, 1, 2)) -> float:
        """Return the least distance between two regions from one time to another (s), along some of the axes; m."""
        chosen = list(rows)
        apart, going = (other.centre - self.centre)[chosen], (other.velocity - self.velocity)[chosen]
        speed = float(going @ going)
        nearest = np.clip(-float(apart @ going) / speed, first, last) if speed else first
        grown = 0.5 * (self.growth + other.growth) * last**2 if self.growth + other.growth else 0.0
        return float(np.linalg.norm(apart + nearest * going)) - self.radius - other.radius - grown

    @classmethod
    def still(cls, place: Floats) -> Region:
        """Return a place."""
        return cls(place, np.zeros(3), 0.0)


def mass_centre(states: tuple[State, ...], force: float = 0.0) -> Region:
    """Return where the common mass centre of robots is that `force` (N) may push; they may hold each other or not."""
    total = sum(state.robot.total_mass for state in states)
    centre, velocity = np.zeros((2, 3))
    for state in states:
        data = state.robot.model.createData()
        share = state.robot.total_mass / total
        centre = centre + share * pin.centerOfMass(state.robot.model, data, state.q, state.v)
        velocity = velocity + share * data.vcom[0]
    return Region(centre, velocity, 0.0, force / total)


def reached(point: OperationalPoint, centre: Region) -> Region:
    """Return where a point of a robot may be whose mass centre is in `centre`."""
    return Region(centre.centre, centre.velocity, centre.radius + _spread(point), centre.growth)


def of_target(state: State, point: OperationalPoint) -> Region:
    """Return where a point of a target that moves by itself may be: its very place, where the target does not turn."""
    if not state.v[3:].any():
        return Region(state.placement(point).translation, state.base_twist[:3], 0.0)
    return reached(point, mass_centre((state,)))


def apart(a: OperationalPoint, b: OperationalPoint) -> float:
    """Return how far two points of a robot may be from each other at most, m."""
    if a.joint == b.joint:
        return float(np.linalg.norm(a.placement.translation - b.placement.translation))
    ends = sum(float(np.linalg.norm(one.placement.translation)) for one in (a, b))
    return ends + _between(a.robot, a.joint, b.joint)


def _spread(point: OperationalPoint) -> float:
    """Return R(p)."""
    robot, own = point.robot, point.placement.translation
    total = 0.0
    for j in range(1, robot.model.njoints):
        inertia = robot.model.inertias[j]
        if inertia.mass == 0.0:
            continue
        if j == point.joint:
            distance = float(np.linalg.norm(own - inertia.lever))
        else:
            distance = float(np.linalg.norm(own) + np.linalg.norm(inertia.lever)) + _between(robot, point.joint, j)
        total += inertia.mass * distance
    return total / robot.total_mass


def _between(robot: Layout, a: int, b: int) -> float:
    """Return the length of the way from one joint's frame to another's, m."""
    ways = set(robot.model.supports[a]) ^ set(robot.model.supports[b])
    return sum(_length(robot, j) for j in ways)


def _length(robot: Layout, j: int) -> float:
    """Return how far the frame of joint `j` may be from that of the joint before it, m."""
    model, joint = robot.model, (robot.free or robot).model.joints[j]
    offset = float(np.linalg.norm(model.jointPlacements[j].translation))
    if joint.shortname().startswith(_TURNING):
        return offset
    if unit_of(joint) != "m" or model.nvs[j] != 1:
        return math.inf
    k = model.idx_qs[j]
    return offset + max(abs(float(model.lowerPositionLimit[k])), abs(float(model.upperPositionLimit[k])))

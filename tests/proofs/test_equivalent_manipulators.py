"""The virtual manipulator (Vafa and Dubowsky) and the dynamically equivalent one (Liang, Xu and Bergerman).

A free-floating chain of bodies i = 0 … n moves about its mass centre like a chain on a fixed base there, whose first
joint is a passive ball. With M_i the mass of the bodies up to i and M that of all, l_i from the joint before body i to
its mass centre and r_i from there to the joint after it, all in the body,

    virtual manipulator:      body i has l_i M_{i−1}/M before its centre, r_i M_i/M behind it; its tip is the hand
    equivalent manipulator:   in that geometry the masses M² m_i/(M_{i−1} M_i), its inertias, and no mass of body 0
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from proven import row

import ospace
from ospace.validation.sampling import random_state

ROBOTS = ("planar_2r", "ets_vii", "chaser_7dof")


def equivalent(robot, hand):
    """The equivalent manipulator, base fixed, first joint a ball; and its frame at the hand."""
    model, masses = robot.model, [body.mass for body in robot.model.inertias[1:]]
    whole = sum(masses)
    dem = pin.Model()
    parent, before = 0, np.zeros(3)  # of the virtual link so far: from its joint to the next one
    carried = 0.0
    for j in range(1, model.njoints):
        body = model.inertias[j]
        joint = pin.JointModelSpherical() if j == 1 else model.joints[j]
        placement = pin.SE3(np.eye(3) if j == 1 else model.jointPlacements[j].rotation, before)
        parent = dem.addJoint(parent, joint, placement, model.names[j])
        to_centre = body.lever * carried / whole
        mass = whole**2 * body.mass / (carried * (carried + body.mass)) if j > 1 else 0.0
        dem.appendBodyToJoint(parent, pin.Inertia(mass, to_centre, body.inertia), pin.SE3.Identity())
        carried += body.mass
        end = model.jointPlacements[j + 1].translation if j + 1 < model.njoints else hand.placement.translation
        before = to_centre + (end - body.lever) * carried / whole
    tip = pin.Frame("tip", parent, 0, pin.SE3(hand.placement.rotation, before), pin.FrameType.OP_FRAME)
    return dem, dem.addFrame(tip)


class Both:
    """Random states of a chain, and the same joints and attitude of its equivalent manipulator."""

    def __init__(self, name):
        self.robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
        self.hand = self.robot.point("end_effector")
        self.dem, self.tip = equivalent(self.robot, self.hand)
        self.data = self.dem.createData()
        rng = np.random.default_rng(5)
        states = [random_state(self.robot, rng) for _ in range(20)]
        self.Q = np.array([state.q for state in states])
        self.many = ospace.operational_space_batch(
            self.robot,
            self.hand,
            self.Q,
            quantities=("generalized_inertia", "generalized_jacobian", "placement", "centre_of_mass"),
        )

    def reduced(self, q):
        """H and J at the tip of the equivalent manipulator, its passive ball at rest in momentum."""
        H = pin.crba(self.dem, self.data, q[3:])
        H = np.triu(H) + np.triu(H, 1).T
        J = pin.computeFrameJacobian(self.dem, self.data, q[3:], self.tip, pin.LOCAL_WORLD_ALIGNED)
        follows = -np.linalg.solve(H[:3, :3], H[:3, 3:])
        return H[3:, 3:] + H[3:, :3] @ follows, J[:, 3:] + J[:, :3] @ follows


@pytest.fixture(scope="module", params=ROBOTS)
def both(request):
    return Both(request.param)


def share(ours, other):
    return np.abs(ours - other).max() / np.abs(other).max()


def test_the_equivalent_manipulator_has_the_generalized_inertia(both):
    errors = [share(H, both.reduced(q)[0]) for H, q in zip(both.many.generalized_inertia, both.Q, strict=True)]
    row("H_DEM = H_m\\*, of the largest element").within(max(errors))


def test_the_equivalent_manipulator_has_the_generalized_jacobian(both):
    errors = [share(J, both.reduced(q)[1]) for J, q in zip(both.many.generalized_jacobian, both.Q, strict=True)]
    row("J_DEM = J_m\\* at the hand, of the largest element").within(max(errors))


def test_the_virtual_manipulator_ends_at_the_hand(both):
    """Its base stands at the mass centre, wherever joints and attitude are."""
    errors = []
    for q, placement, centre in zip(both.Q, both.many.placement[:, 0], both.many.centre_of_mass, strict=True):
        pin.framesForwardKinematics(both.dem, both.data, q[3:])
        errors.append(np.abs(both.data.oMf[both.tip].translation - (placement[:3] - centre)).max())
    row("the virtual manipulator's tip is the hand, m").within(max(errors))

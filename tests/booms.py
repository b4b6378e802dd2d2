"""Robots whose links differ by orders of magnitude: long booms that end in fingers of grams."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from ospace import SpaceRobot

FINGERS = {
    "finger": [pin.JointModelRZ()],
    "finger about any axis": [pin.JointModelRevoluteUnaligned(np.array([0.36, 0.48, 0.8]))],
    "sliding finger": [pin.JointModelPrismaticUnaligned(np.array([0.6, -0.64, 0.48]))],
    "two phalanges": [pin.JointModelRZ(), pin.JointModelRZ()],
}


def rod(length: float, mass: float) -> pin.Inertia:
    """A rod along x that begins at the origin."""
    across = mass * length**2 / 12.0
    along = mass * 0.05**2 / 2.0 if length > 0.1 else across / 4.0
    return pin.Inertia(mass, np.array([length / 2.0, 0.0, 0.0]), np.diag([along, across, across]))


def boom(reach: float, finger: str = "finger") -> SpaceRobot:
    """A bus of 1.5 t, an arm of seven joints with two booms of half the `reach` (m), two fingers of 10 g at its hand.

    Frames: base, arm_0 … arm_6, finger_0 (after the last phalanx), finger_1.
    """
    model = pin.Model()
    model.name = f"boom of {reach:g} m"
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia(1500.0, np.zeros(3), 1000.0 * np.eye(3)), pin.SE3.Identity())
    model.addBodyFrame("base", root, pin.SE3.Identity(), 0)
    parent, end = root, np.array([1.0, 0.0, 0.0])

    def add(name: str, joint: pin.JointModel, body: pin.Inertia) -> int:
        j = model.addJoint(parent, joint, pin.SE3(np.eye(3), end), f"joint of {name}")
        model.appendBodyToJoint(j, body, pin.SE3.Identity())
        model.addBodyFrame(name, j, pin.SE3.Identity(), 0)
        return j

    for k, axis in enumerate("ZYYYZXY"):
        length, mass = (reach / 2.0, 150.0) if k in (2, 3) else (0.4, 20.0)
        parent = add(f"arm_{k}", getattr(pin, f"JointModelR{axis}")(), rod(length, mass))
        end = np.array([length, 0.0, 0.0])
    hand = parent
    for f, side in enumerate((0.05, -0.05)):
        parent, end = hand, np.array([0.4, side, 0.0])
        for k, joint in enumerate(FINGERS[finger]):
            last = k == len(FINGERS[finger]) - 1
            parent = add(f"finger_{f}" if last else f"phalanx_{f}_{k}", joint, rod(0.03, 0.01))
            end = np.array([0.03, 0.0, 0.0])
    arm = model.idx_vs[hand] + 1
    model.armature = np.r_[np.zeros(6), np.full(arm - 6, 0.5), np.full(model.nv - arm, 1e-8)]
    return SpaceRobot.from_model(model)

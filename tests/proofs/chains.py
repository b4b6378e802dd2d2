"""Chains of bodies in the plane, and their dynamics by sums over bodies: barycentric vectors and D_ij."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

import ospace


class Planar(NamedTuple):
    """A base and links in the plane: masses (kg), moments (kg m²), and joints about the mass centres (m)."""

    masses: tuple[float, ...]
    moments: tuple[float, ...]
    inner: tuple[float, ...]
    """l_i, from the joint towards the base; nothing of the base."""
    outer: tuple[float, ...]
    """r_i, to the next joint, or to the tip."""

    def robot(self) -> ospace.SpaceRobot:
        """With joints joint_1 … about z, and the frame tip."""
        model = pin.Model()
        model.name = "planar_chain"
        parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        at = 0.0
        for k, (mass, moment) in enumerate(zip(self.masses, self.moments, strict=True)):
            if k > 0:
                placement = pin.SE3(np.eye(3), np.array([at, 0.0, 0.0]))
                parent = model.addJoint(parent, pin.JointModelRZ(), placement, f"joint_{k}")
            body = pin.Inertia(mass, np.array([self.inner[k], 0.0, 0.0]), np.diag([moment, moment, moment]))
            model.appendBodyToJoint(parent, body, pin.SE3.Identity())
            model.addBodyFrame(f"body_{k}", parent, pin.SE3.Identity(), 0)
            at = self.inner[k] + self.outer[k]
        tip = pin.SE3(np.eye(3), np.array([at, 0.0, 0.0]))
        model.addFrame(pin.Frame("tip", parent, 0, tip, pin.FrameType.OP_FRAME))
        return ospace.SpaceRobot.from_model(model)

    def barycentric(self) -> np.ndarray:
        """Row b: what e^{iθ_k} contributes to the mass centre of body b, and in the last row to the tip."""
        n = len(self.masses)
        places = np.zeros((n + 1, n))
        for b in range(1, n + 1):
            places[b, : min(b, n - 1) + 1] = self.outer[: min(b, n - 1) + 1]
            places[b, 1 : min(b, n - 1) + 1] += self.inner[1 : min(b, n - 1) + 1]
            if b < n:
                places[b, b] = self.inner[b]
        weights = np.array(self.masses) / sum(self.masses)
        return places - weights @ places[:n]

    def inertias(self, q: np.ndarray) -> np.ndarray:
        """D_i (n + 1, N) of joint angles (n, N)."""
        angles = np.vstack([np.zeros(q.shape[1]), np.cumsum(q, axis=0)])
        beta = self.barycentric()[:-1]
        d = (beta.T * self.masses) @ beta + np.diag(self.moments)
        return np.einsum("ij,ijk->ik", d, np.cos(angles[:, None] - angles[None, :]))

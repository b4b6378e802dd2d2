"""A URDF in MuJoCo, floating and without gravity, its answers in the coordinates of ospace."""

from __future__ import annotations

import site
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
from lxml import etree

from ospace import OperationalPoint, State

# MuJoCo enforces limits, mimics, friction and damping, and looks for meshes; ospace has none of these.
NOT_RIGID_BODIES = ("visual", "collision", "mimic", "dynamics", "limit", "mujoco")
FREE_JOINT = "free_joint_of_the_base"


def example_robot(path: str) -> Path:
    """A file of example-robot-data, whose wheel brings no Python module to ask."""
    robots = Path("cmeel.prefix/share/example-robot-data/robots")
    candidates = [Path(folder) / robots / path for folder in site.getsitepackages()]
    return next((file for file in candidates if file.is_file()), candidates[0])


def floating(urdf: Path) -> str:
    """The URDF on a free joint: MuJoCo takes the root for the world and drops its mass, unless it is called `world`."""
    robot = etree.parse(str(urdf), etree.XMLParser(remove_comments=True)).getroot()
    etree.strip_elements(robot, *NOT_RIGID_BODIES, with_tail=False)
    children = {joint.find("child").get("link") for joint in robot.iterfind("joint")}
    (root,) = {link.get("name") for link in robot.iterfind("link")} - children
    etree.SubElement(robot, "link", name="world")
    joint = etree.SubElement(robot, "joint", name=FREE_JOINT, type="floating")
    etree.SubElement(joint, "parent", link="world")
    etree.SubElement(joint, "child", link=root)
    options = etree.SubElement(robot, "mujoco")
    etree.SubElement(options, "compiler", fusestatic="false", balanceinertia="false")
    return etree.tostring(robot, encoding="unicode")


class MujocoRobot:
    """The robot of a URDF in MuJoCo.

    Its velocity is [v_b in inertial axes; ω_b in base axes; φ̇ in MuJoCo's order]. With P q̇ = ẋ = [v_b; ω_b; φ̇] of
    ospace, P orthogonal and Ṗ q̇ = 0, accelerations and forces map by P as well.
    """

    def __init__(self, urdf: Path) -> None:
        self.model = mujoco.MjModel.from_xml_string(floating(urdf))
        self.model.opt.gravity[:] = 0.0
        self.data = mujoco.MjData(self.model)

    def joint(self, name: str) -> int:
        return mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_JOINT, name)

    def body(self, link: str) -> int:
        return mujoco.mj_name2id(self.model, mujoco.mjtObj.mjOBJ_BODY, link)

    def link_of(self, joint: str) -> str:
        """Name of the link that the joint carries."""
        return self.model.body(self.model.jnt_bodyid[self.joint(joint)]).name

    def take(self, state: State) -> None:
        """Go to the state, nothing acting."""
        q, v, robot = state.q, state.v, state.robot
        mujoco.mj_resetData(self.model, self.data)
        free = self.joint(FREE_JOINT)
        self.data.qpos[self.model.jnt_qposadr[free] :][:7] = q[[0, 1, 2, 6, 3, 4, 5]]
        self.data.qvel[self.model.jnt_dofadr[free] :][:6] = np.r_[state.base_twist[:3], v[3:6]]
        for name, position in robot.joint_positions(q).items():
            joint = self.joint(name)
            self.data.qpos[self.model.jnt_qposadr[joint]] = position
            self.data.qvel[self.model.jnt_dofadr[joint]] = v[robot.model.idx_vs[robot.model.getJointId(name)]]
        mujoco.mj_forward(self.model, self.data)
        self.P = self._coordinates(state)

    def _coordinates(self, state: State) -> np.ndarray:
        pinocchio = state.robot.model
        P = np.zeros((self.model.nv, self.model.nv))
        base = self.model.jnt_dofadr[self.joint(FREE_JOINT)]
        P[:3, base : base + 3] = np.eye(3)
        P[3:6, base + 3 : base + 6] = self.data.xmat[self.body(self.link_of(FREE_JOINT))].reshape(3, 3)
        for name in state.robot.joint_names:
            P[pinocchio.idx_vs[pinocchio.getJointId(name)], self.model.jnt_dofadr[self.joint(name)]] = 1.0
        return P

    def inertia(self) -> np.ndarray:
        """H (nv, nv), column by column."""
        M = np.empty((self.model.nv, self.model.nv))
        for unit, column in zip(np.eye(self.model.nv), M, strict=True):
            mujoco.mj_mulM(self.model, self.data, column, unit)
        return self.P @ M @ self.P.T

    def bias(self) -> np.ndarray:
        """[c_b; c_m] (nv,)."""
        return self.P @ self.data.qfrc_bias

    def jacobian(self, points: list[OperationalPoint]) -> np.ndarray:
        """J_e (r, nv) at the origins of the links."""
        return self._stacked(mujoco.mj_jac, points) @ self.P.T

    def inertia_inverse(self, points: list[OperationalPoint]) -> np.ndarray:
        """J_e H⁻¹ J_eᵀ (r, r), by MuJoCo's factorization of H."""
        J = self._stacked(mujoco.mj_jac, points)
        response = np.empty_like(J)
        mujoco.mj_solveM(self.model, self.data, response, J)
        return J @ response.T

    def accelerations(self, points: list[OperationalPoint], forces: np.ndarray, F_e: np.ndarray) -> np.ndarray:
        """ẍ_e (r,) under [F_b; τ] `forces` (nv,) and F_e (r,) at the points, by forward dynamics."""
        self.data.qfrc_applied[:] = self.P.T @ forces
        for point, wrench in zip(points, F_e.reshape(-1, 6), strict=True):
            body = self.body(point.frame)
            mujoco.mj_applyFT(
                self.model, self.data, wrench[:3], wrench[3:], self.data.xpos[body], body, self.data.qfrc_applied
            )
        mujoco.mj_forward(self.model, self.data)
        J, J_dot = self._stacked(mujoco.mj_jac, points), self._stacked(mujoco.mj_jacDot, points)
        return J @ self.data.qacc + J_dot @ self.data.qvel

    def _stacked(self, jacobian: Callable[..., None], points: list[OperationalPoint]) -> np.ndarray:
        rows = np.empty((len(points), 2, 3, self.model.nv))
        for (linear, angular), point in zip(rows, points, strict=True):
            body = self.body(point.frame)
            jacobian(self.model, self.data, linear, angular, self.data.xpos[body], body)
        return rows.reshape(-1, self.model.nv)

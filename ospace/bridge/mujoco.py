"""MuJoCo's qpos and qvel for a robot, and MuJoCo as the plant of a controller.

    qpos = [x y z, w x y z, …],    qvel = [v_b in inertial axes, ω_b in base axes, …]

A model of your own may hold other bodies too, as a target or a station. ``pip install 'ospace[mujoco]'``.
"""

from __future__ import annotations

import math
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.bridge.coordinates import BaseCoordinates, base_link, check_joints, quaternion, wxyz
from ospace.checks import check_kind, checked_number, checked_vector
from ospace.dynamics.joint_friction import JointFriction
from ospace.exceptions import OspaceError, closest
from ospace.extras import require
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import unit_of
from ospace.model.robot import SpaceRobot
from ospace.simulation.actuation import CommandLike, as_command
from ospace.urdf.joint_axis import joint_axis

require("mujoco", "the bridge to MuJoCo")
import mujoco  # noqa: E402

FREE_JOINT = "free_joint_of_the_base"
_ROUNDING = 1e-9


class Coordinates(BaseCoordinates):
    """Conversions between ospace and a model of MuJoCo.

    Parameters
    ----------
    robot : SpaceRobot
        Without mimic joints; each joint has one degree of freedom.
    model : mujoco.MjModel
        Holds the robot, its joints of the same names, its base on a free joint. Other bodies keep their ``qpos0``.
    base : str, optional
        Name of the body that is the base; that of the base link without it.

    Attributes
    ----------
    body : int
        Number of the body that is the base.

    Raises
    ------
    OspaceError
        The model lacks a joint, or the base does not float: MuJoCo takes the root link of a URDF for the world.

    Examples
    --------
    >>> coordinates = mujoco.Coordinates(robot, model)
    >>> q, v = coordinates.import_state(data.qpos, data.qvel)
    >>> data.qfrc_applied[:] = coordinates.export_forces(q, command.torque)
    """

    def __init__(self, robot: SpaceRobot, model: mujoco.MjModel, base: str | None = None) -> None:
        check_joints(robot)
        check_kind(model, mujoco.MjModel, "compile one, or take model_of(robot)")
        joints = [_joint(model, robot, name) for name in robot.joint_names]
        free = _free_joint(model, base or base_link(robot))
        first_p, first_u = int(model.jnt_qposadr[free]), int(model.jnt_dofadr[free])
        self.body = int(model.jnt_bodyid[free])
        super().__init__(
            robot,
            (range(first_p, first_p + 7), range(first_u, first_u + 6)),
            ([int(model.jnt_qposadr[j]) for j in joints], [int(model.jnt_dofadr[j]) for j in joints]),
            model.qpos0,
            model.nv,
        )

    def _export_base(self, placement: pin.SE3, twist: Floats) -> tuple[Floats, Floats]:
        R = placement.rotation
        return np.r_[placement.translation, wxyz(R)], np.r_[R @ twist[:3], twist[3:]]

    def _import_base(self, position: Floats, velocity: Floats) -> tuple[pin.SE3, Floats]:
        R = quaternion(position[3:]).matrix()
        return pin.SE3(R, position[:3]), np.r_[R.T @ velocity[:3], velocity[3:]]

    def _base_map(self, placement: pin.SE3) -> Floats:
        T = np.eye(6)
        T[3:, 3:] = placement.rotation
        return T


class Plant:
    """MuJoCo as the plant of a controller: it holds each command for a time, without gravity.

    Forces are applied to joints and base, whatever actuators the model has. The positions of joints are MuJoCo's to
    bound; `model_of` makes no stops and no contacts.

    Parameters
    ----------
    robot : SpaceRobot
        As of `Coordinates`.
    model : mujoco.MjModel, optional
        Without gravity; `model_of(robot)` without it.
    base : str, optional
        Name of the body that is the base.

    Attributes
    ----------
    robot : SpaceRobot
    model : mujoco.MjModel
    data : mujoco.MjData
    coordinates : Coordinates

    Raises
    ------
    OspaceError
        MuJoCo's model has gravity, or does not hold the robot.

    Examples
    --------
    >>> plant = mujoco.Plant(robot)
    >>> plant.reset(robot.configuration({"joint_2": 1.0}))
    >>> while plant.time < 5.0:
    ...     plant.step(controller.update(plant.time, plant.q, plant.v), controller.period)
    """

    def __init__(self, robot: SpaceRobot, model: mujoco.MjModel | None = None, base: str | None = None) -> None:
        self.robot = robot
        self.model = model_of(robot) if model is None else model
        self.coordinates = Coordinates(robot, self.model, base)
        if np.any(self.model.opt.gravity):
            raise OspaceError(
                f"MuJoCo's model has gravity {self.model.opt.gravity.tolist()} m/s², ospace has none: set "
                f"model.opt.gravity[:] = 0"
            )
        self.data = mujoco.MjData(self.model)

    @property
    def time(self) -> float:
        """MuJoCo's time, s."""
        return float(self.data.time)

    @property
    def q(self) -> Floats:
        """Configuration (nq,), as `SpaceRobot.state` takes it; m, rad."""
        return self.coordinates.import_state(self.data.qpos, self.data.qvel)[0]

    @property
    def v(self) -> Floats:
        """Velocity (nv,): base twist in base axes, then joint rates; m/s, rad/s."""
        return self.coordinates.import_state(self.data.qpos, self.data.qvel)[1]

    def reset(self, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> None:
        """Begin at time zero with nothing acting; other bodies are where the model has them.

        Parameters
        ----------
        q : (nq,)
            As `SpaceRobot.state` takes it; m, rad.
        v : (nv,), optional
            Zero without it; m/s, rad/s.
        """
        positions, velocities = self.coordinates.export_state(q, v)
        mujoco.mj_resetData(self.model, self.data)
        self.data.qpos[:], self.data.qvel[:] = positions, velocities
        mujoco.mj_forward(self.model, self.data)

    def step(self, command: CommandLike | npt.ArrayLike | None, duration: float = 1e-3) -> None:
        """Go on under a command that is held.

        Parameters
        ----------
        command : Command, array or None
            As `ospace.Controller` returns it; or joint torques (n,), N m or N; nothing acts with None.
        duration : float
            A whole number of MuJoCo's steps, ``model.opt.timestep``; s.

        Raises
        ------
        OspaceError
            `duration` is no whole number of steps, a command makes no sense, or MuJoCo's state is no longer finite.

        Notes
        -----
        A wrench on the base keeps its direction in inertial axes, as in `ospace.simulate`: its torque goes to
        ``data.xfrc_applied`` of the base, all else to ``data.qfrc_applied``.
        """
        step = float(self.model.opt.timestep)
        duration = checked_number(duration, "duration")
        count = round(duration / step)
        if count < 1 or abs(duration / step - count) > _ROUNDING * count:
            raise OspaceError(f"duration {duration!r} s is no whole number of MuJoCo's steps of {step!r} s")
        forces = np.zeros(self.robot.nv)
        if command is not None:
            held = as_command(command, self.time)
            forces[6:] = checked_vector(held.torque, self.robot.n_joints, "torque")
            forces[:6] = checked_vector(held.base_wrench, 6, "base_wrench")
            forces[3:6] += checked_vector(held.wheel_torque, 3, "wheel_torque")
        self.data.xfrc_applied[self.coordinates.body, 3:] = forces[3:6]
        forces[3:6] = 0.0
        self.data.qfrc_applied[:] = self.coordinates.export_forces(self.q, forces)
        for _ in range(count):
            mujoco.mj_step(self.model, self.data)
        if (
            not (np.isfinite(self.data.qpos).all() and np.isfinite(self.data.qvel).all())
            or self.data.warning[mujoco.mjtWarning.mjWARN_BADQACC].number
        ):
            raise OspaceError(f"MuJoCo's state is no longer finite at {self.time:.6g} s: take a smaller step")

    def inertia(self) -> Floats:
        """Return H (nv, nv) as MuJoCo has it in this state, in the rates of `ospace.joint_space_dynamics`.

        Returns
        -------
        (nv, nv) array
            kg, kg m, kg m².
        """
        M = np.zeros((self.model.nv, self.model.nv))
        for row, unit in zip(M, np.eye(self.model.nv), strict=True):
            mujoco.mj_mulM(self.model, self.data, row, unit)
        return self.coordinates.import_inertia(self.q, M)


def model_of(robot: SpaceRobot, step: float = 1e-3) -> mujoco.MjModel:
    """Make MuJoCo's model of a robot: bodies, inertias, joints, drives' inertia, damping and friction; no shapes.

    Parameters
    ----------
    robot : SpaceRobot
        Joints of one degree of freedom, none that mimics another.
    step : float
        Of the Runge–Kutta integrator, s.

    Returns
    -------
    mujoco.MjModel
        Floating without gravity, contacts and stops; bodies of the links' names, sites where fixed links are.

    Raises
    ------
    OspaceError
        MuJoCo cannot hold the robot, as one with a moving link that has no mass.
    """
    try:
        return mujoco.MjModel.from_xml_string(mjcf(robot, step))
    except ValueError as error:
        raise OspaceError(f"MuJoCo refuses robot '{robot.name}': {error}") from None


def mjcf(robot: SpaceRobot, step: float = 1e-3) -> str:
    """Return what `model_of` compiles, to put into a scene of your own.

    Parameters
    ----------
    robot : SpaceRobot
    step : float
        s.

    Returns
    -------
    str
        MJCF.

    Raises
    ------
    OspaceError
        Joints have several degrees of freedom, mimic others, or are helical.
    """
    check_joints(robot)
    step = checked_number(step, "step")
    if not 0.0 < step < math.inf:
        raise OspaceError(f"step {step!r}: give a time above zero, s")
    root = ElementTree.Element("mujoco", model=robot.name)
    ElementTree.SubElement(root, "compiler", angle="radian", balanceinertia="false", autolimits="true")
    option = ElementTree.SubElement(root, "option", gravity="0 0 0", timestep=repr(step), integrator="RK4")
    ElementTree.SubElement(option, "flag", contact="disable")
    bodies = {0: ElementTree.SubElement(root, "worldbody")}
    friction = JointFriction.of(robot)
    model = robot.model
    for j in range(1, model.njoints):
        name = base_link(robot) if j == 1 else _link(robot, j)
        bodies[j] = body = ElementTree.SubElement(bodies[model.parents[j]], "body", name=name)
        if j == 1:
            ElementTree.SubElement(body, "freejoint", name=FREE_JOINT)
        else:
            body.attrib |= _placed(model.jointPlacements[j])
            k = model.idx_vs[j]
            ElementTree.SubElement(
                body,
                "joint",
                name=str(model.names[j]),
                type=_kind(robot, j),
                axis=_numbers(joint_axis(model.joints[j])),
                armature=repr(float(model.armature[k])),
                damping=repr(float(friction.damping[k - 6])),
                frictionloss=repr(float(friction.coulomb[:, k - 6].mean())),
            )
        inertia = model.inertias[j]
        if inertia.mass > 0.0:
            I = inertia.inertia
            six = _numbers([I[0, 0], I[1, 1], I[2, 2], I[0, 1], I[0, 2], I[1, 2]])
            ElementTree.SubElement(
                body, "inertial", pos=_numbers(inertia.lever), mass=repr(float(inertia.mass)), fullinertia=six
            )
        for frame in model.frames:
            if frame.parentJoint == j and frame.type == pin.FrameType.BODY and frame.name != name:
                ElementTree.SubElement(body, "site", _placed(frame.placement), name=frame.name)
    return ElementTree.tostring(root, encoding="unicode")


def _kind(robot: SpaceRobot, j: int) -> str:
    joint = robot.model.joints[j]
    if joint.shortname().startswith("JointModelH"):
        raise OspaceError(f"joint '{robot.model.names[j]}' is helical, which MuJoCo's joints are not")
    return "slide" if unit_of(joint) == "m" else "hinge"


def _link(robot: SpaceRobot, j: int) -> str:
    """Return the name of the link that a joint carries."""
    for frame in robot.model.frames:
        if frame.type == pin.FrameType.BODY and frame.parentJoint == j and frame.placement.isIdentity():
            return str(frame.name)
    return f"body of {robot.model.names[j]}"


def _placed(placement: pin.SE3) -> dict[str, str]:
    return {"pos": _numbers(placement.translation), "quat": _numbers(wxyz(placement.rotation))}


def _numbers(values: npt.ArrayLike) -> str:
    return " ".join(repr(float(value)) for value in np.asarray(values))


def _joint(model: mujoco.MjModel, robot: SpaceRobot, name: str) -> int:
    number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, name)
    if number < 0:
        names = [model.joint(k).name for k in range(model.njnt)]
        raise OspaceError(f"MuJoCo's model has no joint '{name}' of robot '{robot.name}'{closest(name, names)}")
    if int(model.jnt_type[number]) not in (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)):
        raise OspaceError(f"joint '{name}' has several degrees of freedom in MuJoCo's model, and one in ospace")
    return int(number)


def _free_joint(model: mujoco.MjModel, base: str) -> int:
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, base)
    if body < 0:
        names = [model.body(k).name for k in range(model.nbody)]
        raise OspaceError(
            f"MuJoCo's model has no body '{base}' that is the base{closest(base, names)} "
            f"From a URDF MuJoCo takes the root link for the world: take model_of(robot), or name the body with base="
        )
    first = int(model.body_jntadr[body])
    if first < 0 or int(model.jnt_type[first]) != int(mujoco.mjtJoint.mjJNT_FREE):
        raise OspaceError(f"body '{base}' of MuJoCo's model does not float: give it a <freejoint/>")
    return first

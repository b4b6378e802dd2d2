"""An arm of six joints on a bus that floats, and ways of its hand through singularities."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

import ospace
from ospace.control import Function
from ospace.kernels.minimum_jerk import minimum_jerk

LENGTHS, MASSES, AXES = (0.1, 0.45, 0.4, 0.1, 0.1, 0.08), (6.0, 10.0, 5.0, 1.5, 1.2, 0.6), "zyyyzy"
TORQUES, RATES = (120.0, 120.0, 120.0, 25.0, 25.0, 25.0), (2.5, 2.5, 2.5, 3.0, 3.0, 3.0)
ELBOW = 2


def arm(mass: float = 300.0, moment: float = 50.0) -> ospace.SpaceRobot:
    """Joints about z, y, y, y, z, y of the links, which point along z when all are zero; its frames: bus, tool."""
    model = pin.Model()
    model.name = "arm"
    bus = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(bus, pin.Inertia(mass, np.zeros(3), moment * np.eye(3)), pin.SE3.Identity())
    model.addFrame(pin.Frame("bus", bus, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    parent, at = bus, np.array([0.0, 0.0, 0.5])
    for k, (length, own, axis) in enumerate(zip(LENGTHS, MASSES, AXES, strict=True)):
        joint = pin.JointModelRZ() if axis == "z" else pin.JointModelRY()
        bounds = (np.array([value]) for value in (TORQUES[k], RATES[k], -3.0, 3.0))
        parent = model.addJoint(parent, joint, pin.SE3(np.eye(3), at), f"joint_{k}", *bounds)
        across = own * (length**2 / 12.0 + 0.04**2 / 4.0)
        spread = np.diag([across, across, own * 0.04**2 / 2.0])
        model.appendBodyToJoint(
            parent, pin.Inertia(own, np.array([0.0, 0.0, length / 2.0]), spread), pin.SE3.Identity()
        )
        at = np.array([0.0, 0.0, length])
    model.addFrame(pin.Frame("tool", parent, 0, pin.SE3(np.eye(3), at), pin.FrameType.BODY))
    return ospace.SpaceRobot.from_model(model)


def way_of_the_hand(robot, start, end, duration, step=1e-3):
    """The hand's motion while joints go from `start` to `end` at minimum jerk and the base, without momentum, answers.

    Returns the configuration at the start, and the motion as a reference.
    """
    point, model, way = robot.point("tool"), robot.model, np.subtract(end, start)

    def velocity(q, time):
        rates = way * minimum_jerk(time / duration)[1] / duration
        jacobian = ospace.generalized_jacobian(robot.state(q), point)
        base, R = jacobian.base_generalized_jacobian @ rates, robot.base_pose(q).rotation
        return np.r_[R.T @ base[:3], R.T @ base[3:], rates], jacobian.generalized_jacobian @ rates

    first = robot.configuration()
    first[7:] = start
    poses, speeds, q = [], [], first
    for k in range(round(duration / step) + 1):
        time = k * step
        v, speed = velocity(q, time)
        poses.append(robot.state(q).placement(point))
        speeds.append(speed)
        middle = pin.integrate(model, q, v * (0.5 * step))
        q = pin.integrate(model, q, velocity(middle, time + 0.5 * step)[0] * step)
    speeds = np.array(speeds)
    accelerations = np.gradient(speeds, step, axis=0, edge_order=2)

    def motion(time):
        k = min(round(time / step), len(poses) - 1)
        return poses[k], speeds[k], accelerations[k]

    return first, Function(motion)


def smallest_singular_value(robot, joints, *, floating=True):
    """σ_min of J_m* at the tool, or of J_m, in the configuration of these joint positions; with the sign of det."""
    q = robot.configuration()
    q[7:] = joints
    state, point = robot.state(q), robot.point("tool")
    if floating:
        J = ospace.generalized_jacobian(state, point).generalized_jacobian
    else:
        J = ospace.operational_space(state, point).jacobian[:, 6:]
    return np.sign(np.linalg.det(J)) * np.linalg.svd(J, compute_uv=False)[-1]

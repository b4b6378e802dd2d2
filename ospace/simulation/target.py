"""Targets: a robot like any other, often without joints; `simulate` lets it tumble."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from ospace.checks import checked_number, checked_vector, real_numbers
from ospace.exceptions import OspaceError
from ospace.model.joint_positions import Position
from ospace.model.robot import SpaceRobot
from ospace.model.state import State

_ROUNDING = 1e-9


def rigid_body(
    mass: float,
    inertia: npt.ArrayLike,
    mass_centre: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    name: str = "target",
    frames: Mapping[str, pin.SE3] | None = None,
) -> SpaceRobot:
    """Make a target of one rigid body, whose link is called `name`.

    Parameters
    ----------
    mass : float
        kg.
    inertia : (3, 3) or (3,)
        About the mass centre, axes of the body; or its principal moments, where these axes are principal; kg m².
    mass_centre : (3,)
        In the body's frame, m.
    name : str
    frames : mapping of str to pin.SE3, optional
        Further frames of the body, such as grapple fixtures, as seen from the body's frame.

    Returns
    -------
    SpaceRobot
        Without joints.

    Raises
    ------
    OspaceError
        Numbers or shapes make no sense, or no real body has that mass and inertia.
    """
    if not checked_number(mass, f"mass of '{name}'") > 0.0:
        raise OspaceError(f"mass of '{name}' is {mass!r}: give a mass above zero, kg")
    try:
        given = real_numbers(inertia)
    except (TypeError, ValueError):
        given = np.empty(0)
    I = np.diag(given) if given.shape == (3,) else given
    if I.shape != (3, 3) or not np.isfinite(I).all() or not np.allclose(I, I.T, rtol=1e-9, atol=0.0):
        raise OspaceError(
            f"inertia of '{name}' is {inertia!r}: give a symmetric (3, 3) matrix, or three moments, kg m²"
        )
    moments = np.linalg.eigvalsh(I)
    if moments[0] <= 0.0 or moments[2] > (moments[0] + moments[1]) * (1.0 + _ROUNDING):
        raise OspaceError(
            f"inertia of '{name}' has the principal moments {moments} kg m²: no body has these; "
            f"each must be above zero, and at most the sum of the other two"
        )
    centre = checked_vector(mass_centre, 3, "mass_centre", name)
    model = pin.Model()
    model.name = name
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia(float(mass), centre, 0.5 * (I + I.T)), pin.SE3.Identity())
    body = model.addBodyFrame(name, root, pin.SE3.Identity(), 0)
    for frame, placement in (frames or {}).items():
        if frame == name:
            raise OspaceError(f"frame '{frame}' bears the name of the body: give it another one")
        model.addFrame(pin.Frame(frame, root, body, placement, pin.FrameType.OP_FRAME))
    return SpaceRobot.from_model(model)


def tumbling(
    target: SpaceRobot,
    T_WB: pin.SE3,
    spin: npt.ArrayLike,
    drift: npt.ArrayLike = (0.0, 0.0, 0.0),
    joints: Mapping[str, Position] | None = None,
) -> State:
    """Return a target's state: it turns about its mass centre, which drifts; joints at rest.

    Parameters
    ----------
    target : SpaceRobot
    T_WB : pin.SE3
        Pose of its base in the inertial frame.
    spin : (3,)
        Angular velocity, inertial axes, rad/s.
    drift : (3,)
        Velocity of the mass centre, inertial axes, m/s.
    joints : mapping of joint name to position, optional
        As of `SpaceRobot.configuration`.

    Returns
    -------
    State
    """
    omega = checked_vector(spin, 3, "spin", target.name)
    velocity = checked_vector(drift, 3, "drift", target.name)
    q = target.configuration(joints, T_WB)
    beside = q.copy()
    beside[:3] = 0.0
    centre = pin.centerOfMass(target.model, target.model.createData(), beside)
    R_BW = T_WB.rotation.T
    v = np.zeros(target.nv)
    v[:3], v[3:6] = R_BW @ (velocity - np.cross(omega, centre)), R_BW @ omega
    return target.state(q, v)

"""Drake's q and v for a robot: the base as a quaternion joint of the world, angular part first, world axes.

    q = [w x y z, p_WB, …],    v = [ω_WB, v_WB, …],    both in world axes, p and v of the base link's frame

Drake itself is not imported: a finalized ``MultibodyPlant`` says where it keeps each number.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from ospace.bridge.coordinates import BaseCoordinates, base_link, check_joints, quaternion, wxyz
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot


class Coordinates(BaseCoordinates):
    """Conversions between ospace and a plant of Drake.

    Parameters
    ----------
    robot : SpaceRobot
        Without mimic joints; each joint has one degree of freedom.
    plant : pydrake.multibody.plant.MultibodyPlant
        Finalized; holds the robot, its base link not welded to the world.
    model_instance : optional
        The robot's, where names occur in several.

    Raises
    ------
    OspaceError
        The plant lacks a joint or the base link, or the base does not float by a quaternion joint.

    Examples
    --------
    >>> coordinates = drake.Coordinates(robot, plant)
    >>> plant.SetPositionsAndVelocities(context, np.concatenate(coordinates.export_state(q, v)))
    >>> H = coordinates.import_inertia(q, plant.CalcMassMatrix(context))
    """

    def __init__(self, robot: SpaceRobot, plant: Any, model_instance: Any = None) -> None:
        check_joints(robot)
        where = () if model_instance is None else (model_instance,)
        try:
            base = plant.GetBodyByName(base_link(robot), *where)
            joints = [plant.GetJointByName(name, *where) for name in robot.joint_names]
            floats = base.has_quaternion_dofs()
        except RuntimeError as error:
            raise OspaceError(f"Drake's plant does not hold robot '{robot.name}': {error}") from None
        if not floats:
            raise OspaceError(f"link '{base_link(robot)}' has no quaternion joint in Drake's plant: do not weld it")
        first_p, first_u = base.floating_positions_start(), base.floating_velocities_start_in_v()
        rest = np.zeros(plant.num_positions())
        super().__init__(
            robot,
            (range(first_p, first_p + 7), range(first_u, first_u + 6)),
            ([joint.position_start() for joint in joints], [joint.velocity_start() for joint in joints]),
            rest,
            plant.num_velocities(),
        )

    def _export_base(self, placement: pin.SE3, twist: Floats) -> tuple[Floats, Floats]:
        R = placement.rotation
        return np.r_[wxyz(R), placement.translation], np.r_[R @ twist[3:], R @ twist[:3]]

    def _import_base(self, position: Floats, velocity: Floats) -> tuple[pin.SE3, Floats]:
        R = quaternion(position[:4]).matrix()
        return pin.SE3(R, position[4:]), np.r_[R.T @ velocity[3:], R.T @ velocity[:3]]

    def _base_map(self, placement: pin.SE3) -> Floats:
        return np.roll(np.eye(6), 3, axis=1)

"""Memory of a run: records laid out before it starts, and made a `Trajectory` of when it ends."""

from __future__ import annotations

import numpy as np

from ospace.kernels.tree import Floats
from ospace.model.joint_positions import ROUNDING, BoundedCoordinates, norm_error, unit_of
from ospace.model.robot import SpaceRobot
from ospace.simulation.moving_frame import MovingFrame
from ospace.simulation.plant import Plant
from ospace.simulation.runge_kutta import IntegratedMotion
from ospace.simulation.trajectory import Excess, Trajectory


class Recorder:
    """Records the motion of a plant, at most `records` times."""

    def __init__(self, plant: Plant, frame: MovingFrame, records: int, start: float, integrator: str) -> None:
        self.plant, self.frame, self.start, self.integrator = plant, frame, start, integrator
        robot = plant.robot
        self.count = 0
        self._elapsed = np.empty(records)
        self._q, self._v = np.empty((records, robot.nq)), np.empty((records, robot.nv))
        self._torque = np.empty((records, robot.n_joints))
        self._base_wrench, self._momentum, self._impulse = np.empty((3, records, 6))
        self._wheel_torque, self._wheel_momentum, self._mass_centre = np.empty((3, records, 3))
        self._energy, self._work, self._dissipated = np.empty((3, records))

    def record(self, elapsed: float, motion: IntegratedMotion, wheel_momentum: Floats) -> None:
        """Take down one record, `elapsed` seconds after the start; it counts only when it is whole."""
        plant, k = self.plant, self.count
        self._momentum[k], self._mass_centre[k], self._energy[k] = plant.momentum(motion.q, motion.v)
        self._elapsed[k] = elapsed
        self._q[k], self._v[k] = motion.q, motion.v
        self._torque[k] = plant.torque
        self._base_wrench[k], self._wheel_torque[k] = plant.base_wrench, plant.wheel_torque
        self._wheel_momentum[k] = wheel_momentum
        self._work[k], self._dissipated[k], self._impulse[k] = motion.work, motion.dissipated, motion.impulse
        self.count = k + 1

    def trajectory(self, interrupted: bool = False) -> Trajectory:
        """Return what was taken down so far, in the user's frame."""
        taken = slice(0, self.count)
        robot = self.plant.robot
        q, v = self.frame.to_user_frame(self._elapsed[taken], self._q[taken], self._v[taken])
        return Trajectory(
            robot_name=robot.name,
            time=self.start + self._elapsed[taken],
            q=q,
            v=v,
            torque=self._torque[taken],
            base_wrench=self._base_wrench[taken],
            wheel_torque=self._wheel_torque[taken],
            wheel_momentum=self._wheel_momentum[taken],
            momentum=self._momentum[taken],
            mass_centre=self._mass_centre[taken],
            kinetic_energy=self._energy[taken],
            work=self._work[taken],
            dissipated=self._dissipated[taken],
            impulse=self._impulse[taken],
            rotation_drift=rotation_drift(robot, self._q[taken]),
            frame_velocity=self.frame.velocity,
            total_mass=robot.total_mass,
            largest_inertia=self.plant.largest_inertia(self._q[0]),
            integrator=self.integrator,
            outside_limits=outside_limits(robot, self.start + self._elapsed[taken], q),
            interrupted=interrupted,
        )


def rotation_drift(robot: SpaceRobot, Q: Floats) -> Floats:
    """Return how far quaternions and (cos, sin) pairs are from unit length, the worst of each row of `Q` (N, nq)."""
    return np.asarray(np.max([norm_error(robot.model, j, Q) for j in range(1, robot.model.njoints)], axis=0))


def outside_limits(robot: SpaceRobot, time: Floats, Q: Floats) -> dict[str, Excess]:
    """Return the joints that are beyond their limits in any row of `Q` (N, nq), and where they are farthest."""
    model, bounded = robot.model, BoundedCoordinates.of(robot.model)
    excess = bounded.excess(model, Q)
    found: dict[str, Excess] = {}
    for c in np.flatnonzero((excess > ROUNDING).any(axis=0)):
        j, k = int(bounded.joint[c]), int(np.argmax(excess[:, c]))
        name = str(model.names[j])
        if name not in found or excess[k, c] > found[name].amount:
            found[name] = Excess(float(excess[k, c]), unit_of(model.joints[j]), float(time[k]))
    return found

"""
A plane that the hand must not pass
===================================

A keep-out plane: the hand follows its reference, and stops at the plane that the reference passes.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

import ospace
from ospace.control import BaseAttitudeTask, Inequality, MinimumJerk, PositionTask, PostureTask
from ospace.model.points import OperationalPoint


@dataclass(frozen=True, kw_only=True, eq=False)
class KeepOut(Inequality):
    """A point stays on the side of a plane that its normal points to: y = nᵀ (x − p) ≥ 0."""

    point: OperationalPoint
    place: tuple[float, float, float]
    normal: tuple[float, float, float]

    def value(self, at):
        return self.normal @ (at.position(self.point) - self.place)

    def jacobian(self, at):
        return self.normal @ at.jacobian(self.point)[:3]

    def drift(self, at):
        return self.normal @ at.drift(self.point)[:3]


def main() -> None:
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    hand = robot.point("right_hand")
    start = robot.state(robot.configuration())
    here = start.placement(hand)
    there = pin.SE3(here.rotation, here.translation + [0.2, 0.1, 0.1])
    plane = KeepOut(
        name="plane",
        point=hand,
        place=here.translation + [0.1, 0.0, 0.0],
        normal=np.array([-1.0, 0.0, 0.0]),
    )
    tasks = [
        PositionTask(name="hand", point=hand, reference=MinimumJerk(here, there, 0.0, 3.0), stiffness=100.0),
        BaseAttitudeTask(name="base", robot=robot),
        PostureTask(name="posture"),
    ]
    controller = ospace.Controller(robot, tasks, inequalities=plane)
    run = ospace.simulate(robot, start.q, start.v, controller, duration=4.0)
    places = np.array(
        [robot.state(q, v).placement(hand).translation for q, v in zip(run.q[::50], run.v[::50], strict=True)]
    )
    command = controller.update(4.0, run.q[-1], run.v[-1])
    print(f"the hand was asked to move by {np.round(there.translation - here.translation, 3)} m")
    print(f"and moved by {np.round(places[-1] - here.translation, 3)} m")
    print(f"closest to the plane: {round(1e3 * (plane.place[0] - places[:, 0]).min(), 3) + 0.0} mm")
    print(f"status {command.status}, active limits: {', '.join(command.active_limits)}")


if __name__ == "__main__":
    main()

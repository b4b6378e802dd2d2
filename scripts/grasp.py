"""The paper's section 7 as a library user writes it: a floating robot grasps a tumbling target, head and base held."""

import numpy as np
import pinocchio as pin

import ospace
from ospace.control import BaseAttitudeTask, Function, OrientationTask, PoseTask
from ospace.scenario import Approach, FreeMotion
from ospace.simulation import grasp, tumbling


def main() -> None:
    chaser, target = (ospace.SpaceRobot.from_urdf(ospace.models.path(name)) for name in ("chaser_24dof", "target"))
    hand, head, fixture = chaser.point("right_hand"), chaser.point("head"), target.point("grapple")
    start = chaser.state(chaser.configuration())
    there = pin.SE3(np.eye(3), np.array([1.8, -0.35, 0.95]))
    free = FreeMotion(target, tumbling(target, there, np.radians([0.3, 0.5, -1.0])))
    way = Approach(start.placement(hand), np.zeros(6), free.frame(fixture), duration=8.0)
    tasks = [
        PoseTask(name="hand", point=hand, stiffness=100.0, reference=Function(way)),
        OrientationTask(name="head", point=head, stiffness=100.0),
        BaseAttitudeTask(name="base", robot=chaser, stiffness=100.0),
    ]
    run = ospace.simulate(chaser, start.q, start.v, ospace.Controller(chaser, tasks), duration=8.0)
    held = grasp(chaser.state(run.q[-1], run.v[-1]), hand, free.state(len(run) - 1), fixture)
    turned = pin.log3(chaser.base_pose(run.q[-1]).rotation)
    print(f"hand off by {held.position_error * 1e3:.2g} mm, {np.degrees(held.angle_error):.2g} deg at the grasp")
    print(f"base turned by {np.degrees(np.linalg.norm(turned)):.2g} deg")
    print(run.certificate())
    print(held.robot)


if __name__ == "__main__":
    main()

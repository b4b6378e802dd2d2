"""
Hands that keep apart
=====================

Clearance: both hands are sent to the place between them, and stop 3 cm apart.
"""

import pinocchio as pin

import ospace
from ospace.control import BaseAttitudeTask, Clearance, MinimumJerk, PositionTask, PostureTask


def main() -> None:
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    start = robot.state(robot.configuration())
    hands = [robot.point(name) for name in ("left_hand", "right_hand")]
    poses = [start.placement(hand) for hand in hands]
    middle = 0.5 * (poses[0].translation + poses[1].translation)
    tasks = [
        PositionTask(
            name=hand.frame,
            point=hand,
            reference=MinimumJerk(pose, pin.SE3(pose.rotation, middle), 0.0, 3.0),
            stiffness=100.0,
        )
        for hand, pose in zip(hands, poses, strict=True)
    ]
    tasks += [BaseAttitudeTask(name="base", robot=robot), PostureTask(name="posture")]
    clearance = Clearance(robot=robot, distance=0.03)
    controller = ospace.Controller(robot, tasks, inequalities=clearance)
    run = ospace.simulate(robot, start.q, start.v, controller, duration=5.0)
    command = controller.update(5.0, run.q[-1], run.v[-1])
    print(f"{len(clearance.watched)} pairs of links are watched")
    print(f"nearest: {' and '.join(command.nearest.links)}, {1e3 * command.nearest.distance:.1f} mm apart")
    print(f"status: {command.status}")
    print(f"active limits: {', '.join(command.active_limits)}")


if __name__ == "__main__":
    main()

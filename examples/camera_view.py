"""
A camera keeps the hand in view
===============================

A camera on the head keeps the hand in view, wherever the hand goes: an inequality about two points.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

import ospace
from ospace.control import BaseAttitudeTask, Inequality, MinimumJerk, PoseTask, PostureTask
from ospace.model.points import OperationalPoint


@dataclass(frozen=True, kw_only=True, eq=False)
class InView(Inequality):
    """A feature stays within a cone about an axis of a camera.

    With d from the camera to the feature, r = |d|, u = d/r, and the camera's axis n = R a, the value is the cosine of
    the angle between them less that of the cone's half angle; its rate follows from ṅ = ω × n and u̇ = (1 − u uᵀ) ḋ/r:

        y = nᵀ u − cos α,    ẏ = (n × u)ᵀ ω + nᵀ (1 − u uᵀ)(ẋ_feature − ẋ_camera)/r
    """

    unit = "1"
    camera: OperationalPoint
    feature: OperationalPoint
    axis: tuple[float, float, float]
    half_angle: float

    def value(self, at):
        n, u, _ = self._sight(at)
        return n @ u - np.cos(self.half_angle)

    def jacobian(self, at):
        n, u, r = self._sight(at)
        camera, feature = at.jacobian(self.camera), at.jacobian(self.feature)
        return np.cross(n, u) @ camera[3:] + (n - n @ u * u) @ (feature[:3] - camera[:3]) / r

    def _sight(self, at):
        d = at.position(self.feature) - at.position(self.camera)
        r = np.linalg.norm(d)
        return at.rotation(self.camera) @ self.axis, d / r, r


def main() -> None:
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    hand, head = robot.point("right_hand"), robot.point("head")
    start = robot.state(robot.configuration())
    here, camera = start.placement(hand), start.placement(head)
    there = pin.SE3(here.rotation, here.translation + [-0.1, 0.4, 0.2])
    ahead = here.translation - camera.translation
    view = InView(
        name="view",
        camera=head,
        feature=hand,
        axis=camera.rotation.T @ ahead / np.linalg.norm(ahead),
        half_angle=np.radians(5.0),
        deceleration=0.01,
    )
    tasks = [
        PoseTask(name="hand", point=hand, reference=MinimumJerk(here, there, 0.0, 4.0), stiffness=100.0),
        BaseAttitudeTask(name="base", robot=robot),
        PostureTask(name="posture"),
    ]
    for name, inequalities in (("without", ()), ("with", view)):
        controller = ospace.Controller(robot, tasks, inequalities=inequalities)
        run = ospace.simulate(robot, start.q, start.v, controller, duration=5.0)
        angles = [off_axis(robot.state(q, v), view) for q, v in zip(run.q[::50], run.v[::50], strict=True)]
        command = controller.update(5.0, run.q[-1], run.v[-1])
        off = np.linalg.norm(command.errors["hand"][:3])
        print(f"{name} the inequality: hand up to {max(angles):.3g} deg off the camera's axis")
        print(f"    at the end {off * 1e3:.2g} mm from its goal, {command.status}")


def off_axis(state, view) -> float:
    """Return the angle between the camera's axis and the line to the feature, deg."""
    camera = state.placement(view.camera)
    d = state.placement(view.feature).translation - camera.translation
    across = np.linalg.norm(np.cross(camera.rotation @ view.axis, d))
    return np.degrees(np.arctan2(across, camera.rotation @ view.axis @ d))


if __name__ == "__main__":
    main()

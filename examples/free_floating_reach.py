"""
What a reach does to a floating base
====================================

The hand goes 0.47 m along a straight line within 20 s, while nothing holds the base.
"""

import matplotlib.pyplot as plt
import numpy as np
import pinocchio as pin

import ospace
from ospace.control import MinimumJerk, PoseTask

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
hand = robot.point("end_effector")
start = robot.state(robot.configuration({"joint_2": 0.8, "joint_4": -1.2, "joint_6": 0.6}))
here = start.placement(hand)
there = pin.SE3(here.rotation, here.translation + [-0.3, 0.3, 0.2])
reference = MinimumJerk(here, there, 0.0, 20.0)
task = PoseTask(name="hand", point=hand, reference=reference, stiffness=100.0)
controller = ospace.Controller(robot, [task])
run = ospace.simulate(robot, start.q, start.v, controller, duration=20.0)
angles = np.degrees([pin.rpy.matrixToRpy(robot.base_pose(q).rotation) for q in run.q[::50]])
places = np.array([robot.state(q).placement(hand).translation for q in run.q[::50]])
print(f"hand moved by: {np.linalg.norm(places[-1] - places[0]):.4f} m")
print(f"hand off its goal by: {1e3 * np.linalg.norm(places[-1] - there.translation):.2g} mm")
print(f"base turned by: {np.abs(angles[-1]).max():.3f} deg about one axis")
print(f"base moved by: {1e3 * np.linalg.norm(run.q[-1, :3] - run.q[0, :3]):.1f} mm")
_, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
above.plot(run.time[::50], places - places[0], label=["x", "y", "z"])
below.plot(run.time[::50], angles, label=["roll", "pitch", "yaw"])
above.set_ylabel("hand from its start, m")
below.set(xlabel="time, s", ylabel="attitude of the base, deg")
above.legend()
below.legend()
plt.show()

"""
From where to take hold of a target
===================================

A contact gives the hand an impulse. How fast the base then turns depends on its direction, and on how the arm stands:
here for all directions in the plane of the hand's x and y.
"""

import matplotlib.pyplot as plt
import numpy as np

import ospace
from ospace import analysis

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
hand = robot.point("end_effector", "linear")
stands = {"stretched": {"joint_2": 0.2, "joint_4": -0.4}, "bent": {"joint_2": 0.8, "joint_4": -1.6, "joint_6": 0.6}}
angle = np.linspace(0.0, 2.0 * np.pi, 361)
_, axes = plt.subplots(subplot_kw={"projection": "polar"}, layout="constrained")
for name, joints in stands.items():
    state = robot.state(robot.configuration(joints))
    jumps = analysis.impulse_map(state, hand)
    directions = state.placement(hand).rotation[:, :2] @ [np.cos(angle), np.sin(angle)]
    turn = np.degrees(np.linalg.norm(jumps.base[3:] @ directions, axis=0))
    least = np.degrees(np.linalg.norm(jumps.base[3:] @ jumps.least_reaction))
    print(f"{name}, base turns by: {turn.min():.3g} to {turn.max():.3g} deg/s per N s in the plane")
    print(f"{name}, of all directions at least: {least:.2g} deg/s per N s, along {jumps.least_reaction.round(3)}")
    axes.plot(angle, turn, label=name)
axes.set_ylabel("turn of the base, deg/s per N s", labelpad=30)
axes.set_xlabel("direction of the impulse, from the hand's x")
axes.legend(loc="lower left")
plt.show()

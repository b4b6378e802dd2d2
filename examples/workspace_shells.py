"""
Where a floating arm can work by any path
=========================================

Distances from the mass centre at which a dynamic singularity may be met are the path-dependent workspace (PDW) of
Papadopoulos and Dubowsky. At all others every path is free of them: the path-independent workspace (PIW).
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Annulus

import ospace
from ospace import analysis

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
tip = robot.point("end_effector", "linear")
turn = (-np.pi, np.pi)
shells = analysis.workspaces(analysis.Arm(robot, tip, ranges={"joint_1": turn, "joint_2": turn}))

angles = np.linspace(-180.0, 180.0, 361)
first, second = np.meshgrid(np.radians(angles), np.radians(angles))
Q = robot.configurations({"joint_1": first.ravel(), "joint_2": second.ravel()})
J = ospace.operational_space_batch(robot, tip, Q, quantities=("generalized_jacobian",)).generalized_jacobian
determinant = np.linalg.det(J[:, :2]).reshape(361, 361)

_, (joints, place) = plt.subplots(1, 2, figsize=(8.0, 4.2), layout="constrained")
joints.contour(angles, angles, determinant, levels=[0.0])
print(f"reach: {shells.reach[0]:.4f} to {shells.reach[1]:.4f} m from the mass centre")
for name, radii, colour in (("PIW", shells.path_independent, "tab:green"), ("PDW", shells.path_dependent, "tab:red")):
    for inner, outer in radii:
        place.add_patch(Annulus((0.0, 0.0), outer, outer - inner, color=colour))
        print(f"{name}: {inner:.6f} to {outer:.6f} m")
joints.set(xlabel="joint 1, deg", ylabel="joint 2, deg", title="det J* = 0")
place.set(xlim=(-2.4, 2.4), ylim=(-2.4, 2.4), xlabel="x, m", ylabel="y, m", title="PIW green, PDW red")
plt.show()

"""
Singularities that a fixed base does not have
=============================================

The smallest singular value of J* over the joint angles of the planar arm of Papadopoulos and Dubowsky. On a fixed base
it is singular where joint 2 is straight or folded; on a floating one, along the white curves.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import ospace

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
tip = robot.point("end_effector", axes=(1, 1, 0, 0, 0, 0))
QUANTITIES = ("generalized_jacobian", "smallest_singular_value")


def over(first, second):
    """det J* and its smallest singular value at joint angles in deg."""
    Q = robot.configurations({"joint_1": np.radians(np.ravel(first)), "joint_2": np.radians(np.ravel(second))})
    many = ospace.operational_space_batch(robot, tip, Q, quantities=QUANTITIES)
    return np.linalg.det(many.generalized_jacobian), many.smallest_singular_value


angles = np.linspace(-180.0, 180.0, 361)
determinant, sigma = (one.reshape(361, 361) for one in over(*np.meshgrid(angles, angles)))
singular = brentq(lambda angle: over(-65.0, angle)[0][0], -30.0, 0.0)
print(f"configurations: {sigma.size}\nlargest sigma_min: {sigma.max():.4f} m per rad")
print(f"below 0.05 m per rad: {100.0 * (sigma < 0.05).mean():.1f} % of the configurations")
print(f"joint 1 at -65 deg: singular at joint 2 = {singular:.6f} deg")
figure, axes = plt.subplots(figsize=(5.0, 4.2), layout="constrained")
figure.colorbar(axes.pcolormesh(angles, angles, sigma, rasterized=True), label="σ_min of J*, m per rad")
axes.contour(angles, angles, determinant, levels=[0.0], colors="white")
axes.plot(-65.0, singular, "o", color="red")
axes.set(xlabel="joint 1, deg", ylabel="joint 2, deg", xticks=range(-180, 181, 90), yticks=range(-180, 181, 90))
plt.show()

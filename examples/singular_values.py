"""
How well a floating arm moves its hand, over its workspace
==========================================================

The smallest singular value of J* at 200 000 random configurations of an arm of seven joints, by where the hand then is.
It is small where there is a direction in which the hand hardly moves.
"""

import matplotlib.pyplot as plt
import numpy as np

import ospace

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
hand = robot.point("end_effector", "linear")
rng = np.random.default_rng(0)
lower, upper = robot.model.lowerPositionLimit[7:], robot.model.upperPositionLimit[7:]
angles = rng.uniform(lower, upper, (200_000, 7))
Q = robot.configurations(dict(zip(robot.joint_names, angles.T, strict=True)))
wanted = ("smallest_singular_value", "placement", "centre_of_mass")
many = ospace.operational_space_batch(robot, hand, Q, quantities=wanted)
sigma, (x, y, z) = many.smallest_singular_value, (many.placement[:, 0, :3] - many.centre_of_mass).T
print(f"configurations: {len(Q)}\nfarthest: {np.hypot(np.hypot(x, y), z).max():.3f} m from the mass centre")
print(f"sigma_min: {sigma.min():.2g} to {sigma.max():.3f} m per rad")
print(f"below 0.1 m per rad: {100.0 * (sigma < 0.1).mean():.1f} % of the configurations")
figure, axes = plt.subplots(layout="constrained")
cells = axes.hexbin(np.hypot(x, y), z, C=sigma, reduce_C_function=np.median, gridsize=60)
figure.colorbar(cells, label="median of σ_min, m per rad")
axes.set(xlabel="distance from the axis through the mass centre, m", ylabel="height above it, m", aspect="equal")
plt.show()

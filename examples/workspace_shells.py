"""
Where a floating arm can work by any path
=========================================

Distances from the mass centre at which a dynamic singularity may be met are the path-dependent workspace (PDW) of
Papadopoulos and Dubowsky. At all others every path is free of them: the path-independent workspace (PIW).
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Annulus, Circle

import ospace

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
tip = robot.point("end_effector", axes=(1, 1, 0, 0, 0, 0))


def over(first, second):
    """det J* and the tip's distance from the mass centre at joint angles in rad."""
    Q = robot.configurations({"joint_1": np.ravel(first), "joint_2": np.ravel(second)})
    wanted = ("generalized_jacobian", "placement", "centre_of_mass")
    many = ospace.operational_space_batch(robot, tip, Q, quantities=wanted)
    from_centre = many.placement[:, 0, :3] - many.centre_of_mass
    return np.linalg.det(many.generalized_jacobian), np.linalg.norm(from_centre, axis=1)


figure, (joints, place) = plt.subplots(1, 2, figsize=(8.0, 4.2), layout="constrained")
angles = np.linspace(-np.pi, np.pi, 721)
determinant, distance = (one.reshape(721, 721) for one in over(*np.meshgrid(angles, angles)))
curve = np.vstack(joints.contour(angles, angles, determinant, levels=[0.0]).allsegs[0])
radii = np.sort(over(*curve.T)[1])
place.add_patch(Circle((0.0, 0.0), distance.max(), color="tab:green"))
print(f"reach: {distance.max():.4f} m from the mass centre\nsingular configurations: {len(radii)}")
for shell in np.split(radii, np.flatnonzero(np.diff(radii) > 0.05) + 1):
    place.add_patch(Annulus((0.0, 0.0), shell[-1], np.ptp(shell), color="tab:red"))
    print(f"PDW: {shell[0]:.4f} to {shell[-1]:.4f} m")
joints.set(xlabel="joint 1, rad", ylabel="joint 2, rad", title="det J* = 0")
place.set(xlim=(-2.4, 2.4), ylim=(-2.4, 2.4), xlabel="x, m", ylabel="y, m", title="PIW green, PDW red")
plt.show()

"""Where a floating arm loses a direction that a fixed one has: the dynamic singularities of the planar 2R arm.

Papadopoulos and Dubowsky showed that the generalized Jacobian of a free-floating arm is singular in configurations in
which the arm on a fixed base is not, and that these depend on masses and inertias. This scans the joint angles of
`planar_2r` and prints, for each angle of joint 1, the angles of joint 2 at which σ_min of J_m* vanishes.
"""

from __future__ import annotations

import numpy as np

import ospace


def main() -> None:
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    tip = robot.point("end_effector", axes=(True, True, False, False, False, False))
    second = np.radians(np.arange(-179.875, 180.0, 0.25))
    print("joint 1, deg   joint 2 at a dynamic singularity, deg   (a fixed base: 0 and ±180)")
    for first in range(-90, 91, 5):
        q = np.array([robot.configuration({"joint_1": np.radians(first), "joint_2": angle}) for angle in second])
        J = ospace.operational_space_batch(robot, tip, q, quantities=["generalized_jacobian"]).generalized_jacobian
        determinant = np.linalg.det(J)
        crossings = np.flatnonzero(np.sign(determinant[1:]) != np.sign(determinant[:-1]))
        share = determinant[crossings] / (determinant[crossings] - determinant[crossings + 1])
        angles = np.degrees(second[crossings] + share * (second[1] - second[0]))
        print(f"{first:12d}   {'  '.join(f'{angle:8.2f}' for angle in angles)}")


if __name__ == "__main__":
    main()

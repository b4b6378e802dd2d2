"""Nanos and Papadopoulos: singularities of a planar arm of three joints, and rings that momentum does not close."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from chains import Planar
from proven import row
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root

import ospace
from ospace import analysis

ARM_3R = Planar((40.0, 4.0, 3.0, 2.0), (6.667, 0.333, 0.25, 0.15), (0.0, 0.5, 0.5, 0.4), (0.5, 0.5, 0.5, 0.4))
Z = np.array([0.0, 0.0, 1.0])
KEPT = np.r_[np.zeros(5), 2.0]


def test_the_determinant_of_three_joints():
    """S = a b D_2 s_1 + b c D_0 s_2 − a c D_1 s_12 does not know the third joint but through the D_i."""
    robot = ARM_3R.robot()
    tip = robot.point("tip", (1, 1, 0, 0, 0, 1))
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (3, 5000))
    Q = robot.configurations({f"joint_{k + 1}": q[k] for k in range(3)})
    J = ospace.operational_space_batch(robot, tip, Q, quantities=("generalized_jacobian",)).generalized_jacobian
    a, b, c, _ = ARM_3R.barycentric()[-1]
    D = ARM_3R.inertias(q)
    S = a * b * D[2] * np.sin(q[0]) + b * c * D[0] * np.sin(q[1]) - a * c * D[1] * np.sin(q[0] + q[1])
    row("planar 3R: det J\\* = S/D at 5000 configurations").within(np.abs(np.linalg.det(J) - S / D.sum(axis=0)).max())


def test_momentum_does_not_move_a_tip_at_the_mass_centre():
    """a + b e^{iq_1} + c e^{i(q_1+q_2)} = 0 by the law of cosines: no momentum then moves the tip while joints rest."""
    arm = Planar((40.0, 4.0, 3.0), (6.667, 0.333, 0.25), (0.0, 0.5, 0.5), (0.5, 0.5, 0.5))
    a, b, c = arm.barycentric()[-1]
    q_2 = np.arccos((a**2 - b**2 - c**2) / (2.0 * b * c))
    q_1 = np.pi - np.angle(b + c * np.exp(1j * q_2))
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    tip = robot.point("end_effector", (1, 1, 0, 0, 0, 0))

    def drift(x):
        """Of the tip, all joints at rest and the base spinning at 1 rad/s about the mass centre."""
        q = robot.configuration({"joint_1": x[0], "joint_2": x[1]})
        H_b = ospace.joint_space_dynamics(robot.state(q)).base_inertia
        spin = np.linalg.solve(H_b, np.r_[np.zeros(5), 10.0])
        return ospace.generalized_jacobian(robot.state(q, np.r_[spin, 0.0, 0.0]), tip).momentum_velocity

    found = root(drift, [q_1 + 0.05, q_2 - 0.05], tol=1e-15).x
    row("planar 2R: momentum-immune joint angles, deg").equals(*np.degrees(found))
    row("the same against the law of cosines, rad").within(np.abs(found - [q_1, q_2]).max())


def test_a_hand_rests_in_a_ring_that_momentum_does_not_close():
    """Angular momentum turns the base once round and more; joints hold the tip at 1 m from the mass centre."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    tip = robot.point("end_effector", (1, 1, 0, 0, 0, 0))

    def tips(Q):
        many = ospace.operational_space_batch(robot, tip, Q, quantities=("placement", "centre_of_mass"))
        return many.placement[:, 0, :3], many.centre_of_mass

    def distance(q_2):
        position, centre = tips(robot.configurations({"joint_1": [0.4], "joint_2": [q_2]}))
        return np.linalg.norm(position - centre) - 1.0

    def rates(_, x):
        """Of the joints and of the base's angle: J* φ̇ = −J_b H_b⁻¹ M_0."""
        q = robot.configuration({"joint_1": x[0], "joint_2": x[1]}, pin.SE3(pin.exp3(x[2] * Z), np.zeros(3)))
        resting = robot.state(q)
        by_momentum = np.linalg.solve(ospace.joint_space_dynamics(resting).base_inertia, KEPT)
        R = resting.T_WB.rotation.T
        moved = ospace.generalized_jacobian(robot.state(q, np.r_[R @ by_momentum[:3], R @ by_momentum[3:], 0, 0]), tip)
        phi = -np.linalg.solve(moved.generalized_jacobian, moved.momentum_velocity)
        return np.r_[phi, (moved.base_generalized_jacobian @ phi + by_momentum)[5]]

    times = np.linspace(0.0, 24.0, 321)
    start = [0.4, brentq(distance, 1.0, 3.0, xtol=1e-15), 0.0]
    held = solve_ivp(rates, times[[0, -1]], start, "DOP853", times, rtol=1e-11, atol=1e-11)
    poses = analysis.base_motion(robot, held.y[:2].T, KEPT, time=times)
    positions, _ = tips(np.column_stack([poses, held.y[:2].T]))
    row("planar 2R: turn of the base meanwhile, deg").equals(np.degrees(held.y[2, -1]))
    row("planar 2R: a tip at 1 m rests while momentum turns the base, m").within(np.abs(positions - positions[0]).max())

"""The planar arm of Papadopoulos and Dubowsky (1993) against its closed forms.

With barycentric lengths a, b, c of base and links, D_i = Σ_j d_ij cos(angle between bodies i and j), and
D = D_0 + D_1 + D_2, angular momentum is D_0 θ̇_0 + D_1 θ̇_1 + D_2 θ̇_2 of the absolute rates, and the tip stands at
a + b e^{iq_1} + c e^{i(q_1+q_2)} from the mass centre, in base axes.
"""

from __future__ import annotations

import math

import numpy as np
import pinocchio as pin
import pytest
from proven import row
from scipy.integrate import dblquad
from scipy.optimize import brentq, minimize_scalar

import ospace
from ospace import analysis

MASSES = m_0, m_1, m_2 = 40.0, 4.0, 3.0
I_0, I_1, I_2 = 6.667, 0.333, 0.25
r = 0.5  # r_0 = l_1 = r_1 = l_2 = r_2
M = sum(MASSES)
A, B, C = r * m_0 / M, r * (2 * m_0 + m_1) / M, r * (2 * m_0 + 2 * m_1 + m_2) / M
D_00 = I_0 + m_0 * (m_1 + m_2) / M * r**2
D_11 = I_1 + (m_0 * m_1 + m_1 * m_2 + 4.0 * m_0 * m_2) / M * r**2
D_22 = I_2 + m_2 * (m_0 + m_1) / M * r**2
D_01, D_02, D_12 = m_0 * (m_1 + 2 * m_2) / M * r**2, m_0 * m_2 / M * r**2, m_2 * (2 * m_0 + m_1) / M * r**2


def inertias(q_1, q_2):
    """D_0, D_1, D_2."""
    c_1, c_2, c_12 = np.cos(q_1), np.cos(q_2), np.cos(q_1 + q_2)
    return (
        D_00 + D_01 * c_1 + D_02 * c_12,
        D_01 * c_1 + D_11 + D_12 * c_2,
        D_02 * c_12 + D_12 * c_2 + D_22,
    )


def determinant(q_1, q_2):
    """Of J*, rows x and y of the tip: [b c D_0 s_2 + a b D_2 s_1 − a c D_1 s_12]/D."""
    D_0, D_1, D_2 = inertias(q_1, q_2)
    moments = B * C * D_0 * np.sin(q_2) + A * B * D_2 * np.sin(q_1) - A * C * D_1 * np.sin(q_1 + q_2)
    return moments / (D_0 + D_1 + D_2)


@pytest.fixture(scope="module")
def arm():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))


@pytest.fixture(scope="module")
def tip(arm):
    return arm.point("end_effector", (1, 1, 0, 0, 0, 0))


def jacobians(arm, tip, q_1, q_2):
    """J* of many configurations."""
    Q = arm.configurations({"joint_1": np.ravel(q_1), "joint_2": np.ravel(q_2)})
    return ospace.operational_space_batch(arm, tip, Q, quantities=("generalized_jacobian",)).generalized_jacobian


def turn_about_z(poses):
    first, last = (pin.XYZQUATToSE3(pose).rotation for pose in (poses[0], poses[-1]))
    return math.degrees(pin.log3(first.T @ last)[2])


def test_the_printed_jacobian(arm, tip):
    run = ospace.OperationalSpaceEvaluator(arm, tip, ("generalized_jacobian",))
    q = arm.configuration({"joint_1": math.radians(30.0), "joint_2": math.radians(60.0)})
    J = run.update(q, np.zeros(arm.nv)).generalized_jacobian
    row("J\\* at (30, 60) deg, base upright").equals(*J.ravel())


def test_the_determinant_on_180_by_180_configurations(arm, tip):
    angles = np.linspace(-np.pi, np.pi, 180, endpoint=False)
    q_1, q_2 = np.meshgrid(angles, angles)
    found = np.linalg.det(jacobians(arm, tip, q_1, q_2)).reshape(q_1.shape)
    row("det J\\* in closed form, 180² configurations").within(np.abs(found - determinant(q_1, q_2)).max())


def test_the_dynamic_singularity(arm, tip):
    first = math.radians(-65.0)

    def of_ours(q_2):
        return float(np.linalg.det(jacobians(arm, tip, [first], [q_2])[0]))

    root = brentq(of_ours, math.radians(-15.0), math.radians(-8.0), xtol=1e-15)
    row("dynamic singularity at joint 1 = −65 deg").equals(math.degrees(root))
    row("the same to all digits of the closed form").equals(math.degrees(root))
    exact = brentq(lambda q_2: determinant(first, q_2), math.radians(-15.0), math.radians(-8.0), xtol=1e-15)
    row("the same root against that of the closed form").within(abs(root - exact))


def test_barycentric_lengths_are_where_the_tip_stands_about_the_mass_centre(arm):
    """a, b, c by the batch's placements and mass centres at three configurations."""
    q_1, q_2 = np.array([0.0, 0.0, np.pi]), np.array([0.0, np.pi, 0.0])
    Q = arm.configurations({"joint_1": q_1, "joint_2": q_2})
    many = ospace.operational_space_batch(arm, arm.point("end_effector"), Q, quantities=("placement", "centre_of_mass"))
    x = (many.placement[:, 0, :3] - many.centre_of_mass)[:, 0]  # a + b + c, a + b − c, a − b − c
    row("barycentric lengths a, b, c").equals((x[0] + x[2]) / 2.0, (x[1] - x[2]) / 2.0, (x[0] - x[1]) / 2.0)


def test_radii_of_the_path_dependent_workspace(arm, tip):
    """Extremes of the tip's distance from the mass centre over all singular configurations."""

    def radius(q_1, q_2):
        Q = arm.configurations({"joint_1": [q_1], "joint_2": [q_2]})
        one = ospace.operational_space_batch(arm, tip, Q, quantities=("placement", "centre_of_mass"))
        return float(np.linalg.norm(one.placement[0, 0, :3] - one.centre_of_mass[0]))

    def branch(q_1, near):
        """The singular angle of joint 2 next to `near`."""
        return brentq(
            lambda q_2: float(np.linalg.det(jacobians(arm, tip, [q_1], [q_2])[0])), near - 0.6, near + 0.6, xtol=1e-14
        )

    def at(q_1, near):
        return radius(q_1, branch(q_1, near))

    def exact(q_1):
        """The radius where the closed form of det J* vanishes, joint 2 folded."""
        q_2 = brentq(lambda q_2: determinant(q_1, q_2), -np.pi - 0.6, -np.pi + 0.6, xtol=1e-14)
        return abs(A + B * np.exp(1j * q_1) + C * np.exp(1j * (q_1 + q_2)))

    ends = [at(0.0, np.pi), at(np.pi, 0.0), at(0.0, 0.0)]  # folded at the last joint, at the first, stretched
    inner = minimize_scalar(lambda q_1: -at(q_1, -np.pi), bounds=(0.5, 2.5), method="bounded", options={"xatol": 1e-7})
    row("radii of singular configurations (PDW)").equals(ends[0], -inner.fun, ends[1], ends[2])
    folded = minimize_scalar(lambda q_1: -exact(q_1), bounds=(0.5, 2.5), method="bounded", options={"xatol": 1e-7})
    assert inner.fun == pytest.approx(folded.fun, abs=1e-12)
    np.testing.assert_allclose(ends, [A + B - C, -A + B + C, A + B + C], rtol=0, atol=1e-14)


def test_the_search_for_workspaces_finds_these_radii(arm):
    turn = (-np.pi, np.pi)
    found = analysis.workspaces(
        analysis.Arm(arm, arm.point("end_effector", "linear"), ranges={"joint_1": turn, "joint_2": turn})
    )
    row("the same by `analysis.workspaces`, which searches").equals(*np.ravel(found.path_dependent))


def test_the_generalized_inertia(arm):
    angles = np.linspace(-np.pi, np.pi, 60, endpoint=False)
    q_1, q_2 = (one.ravel() for one in np.meshgrid(angles, angles))
    Q = arm.configurations({"joint_1": q_1, "joint_2": q_2})
    found = ospace.operational_space_batch(
        arm, arm.point("end_effector"), Q, quantities=("generalized_inertia",)
    ).generalized_inertia
    (_, D_1, D_2), D = inertias(q_1, q_2), sum(inertias(q_1, q_2))
    h_11 = D_11 + 2.0 * D_12 * np.cos(q_2) + D_22 - (D_1 + D_2) ** 2 / D
    h_12 = D_12 * np.cos(q_2) + D_22 - (D_1 + D_2) * D_2 / D
    exact = np.moveaxis(np.array([[h_11, h_12], [h_12, D_22 - D_2**2 / D]]), 2, 0)
    row("H_m\\* in closed form, 60² configurations").within(np.abs(found - exact).max())


def test_the_base_turns_while_joint_1_does(arm):
    """−∫ (D_1 + D_2)/D dq_1 at q_2 = 0 is elementary: D_1 + D_2 = e + g cos q_1, D = f + 2 g cos q_1."""
    g, e = D_01 + D_02, D_11 + 2.0 * D_12 + D_22
    f = D_00 + e
    root = math.sqrt(f**2 - 4.0 * g**2)
    whole = math.atan(math.sqrt((f - 2.0 * g) / (f + 2.0 * g)) * math.tan(math.pi / 4.0))
    exact = -(math.pi / 4.0 + (e - f / 2.0) * 2.0 / root * whole)
    turn = turn_about_z(analysis.base_motion(arm, [[0.0, 0.0], [np.pi / 2, 0.0]]))
    row("turn of the base, joint 1 from 0 to 90 deg").equals(turn)
    assert turn == pytest.approx(math.degrees(exact), abs=1e-9)


def test_a_closed_loop_of_the_joints_turns_the_base(arm):
    """Stokes' theorem: the integral over the disc of the curl of −[(D_1 + D_2) dq_1 + D_2 dq_2]/D."""

    def curl(q_1, q_2):
        _, D_1, D_2 = inertias(q_1, q_2)
        D, s_1, s_2, s_12 = sum(inertias(q_1, q_2)), np.sin(q_1), np.sin(q_2), np.sin(q_1 + q_2)
        by_1 = -2.0 * (D_01 * s_1 + D_02 * s_12), -D_02 * s_12  # of D and of D_2, by q_1
        by_2 = -2.0 * (D_02 * s_12 + D_12 * s_2), -D_02 * s_12 - 2.0 * D_12 * s_2  # of D and of D_1 + D_2, by q_2
        first = (by_2[1] * D - (D_1 + D_2) * by_2[0]) / D**2
        second = (by_1[1] * D - D_2 * by_1[0]) / D**2
        return first - second

    def polar(radius, angle):
        return curl(0.6 + radius * math.cos(angle), 1.0 + radius * math.sin(angle)) * radius

    exact, _ = dblquad(polar, 0.0, 2.0 * np.pi, 0.0, 0.5, epsabs=1e-13, epsrel=1e-12)
    at = np.linspace(0.0, 2.0 * np.pi, 801)
    poses = analysis.base_motion(arm, np.column_stack([0.6 + 0.5 * np.cos(at), 1.0 + 0.5 * np.sin(at)]))
    proven = row("turn after a loop of the joints, a circle of 0.5 rad about (0.6, 1.0) rad")
    proven.equals(turn_about_z(poses))
    assert f"{math.degrees(exact):.9f}" == "-2.628303218"
    row("the same loop against Stokes' theorem, deg").within(abs(turn_about_z(poses) - math.degrees(exact)))

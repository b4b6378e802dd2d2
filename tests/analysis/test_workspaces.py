"""Path-dependent and path-independent workspaces: the planar arm in closed form, and searches for what was missed."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import ospace
from ospace import OspaceError, analysis

TURN = (-np.pi, np.pi)
A, B, C = 20.0 / 47.0, 42.0 / 47.0, 45.5 / 47.0
"""Barycentric lengths of the arm of Papadopoulos and Dubowsky (1993), m: along its base, link 1 and link 2."""
MASSES, MOMENTS = (40.0, 4.0, 3.0), (6.667, 0.333, 0.25)


def planar(**options):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    return analysis.Arm(robot, robot.point("end_effector", "linear"), **options)


@pytest.fixture(scope="module")
def whole():
    """Return the workspaces of the arm whose joints turn all around."""
    return analysis.workspaces(planar(ranges={"joint_1": TURN, "joint_2": TURN}))


def determinant(s, e):
    """det J* of the arm up to a factor that has no zero, by its masses alone: joints at `s` and `e`, rad.

    Bodies at p_k from the mass centre, H = Σ I_k + m_k |p_k|²; the hand turns with the base by −(∂h/∂φ̇_j)/H.
    """
    u = [np.array([np.cos(t), np.sin(t)]) for t in (0.0, s, s + e)]
    across = [np.array([-one[1], one[0]]) for one in u]
    at = [0.0 * u[0], 0.5 * u[0] + 0.5 * u[1], 0.5 * u[0] + u[1] + 0.5 * u[2]]
    moved = [[0.0 * u[0], 0.5 * across[1], across[1] + 0.5 * across[2]], [0.0 * u[0], 0.0 * u[0], 0.5 * across[2]]]
    total, hand = sum(MASSES), 0.5 * u[0] + u[1] + u[2]
    centre = sum(m * p for m, p in zip(MASSES, at, strict=True)) / total
    centre_moved = [sum(m * d for m, d in zip(MASSES, ds, strict=True)) / total for ds in moved]
    H = sum(MOMENTS) + sum(m * (p - centre) @ (p - centre) for m, p in zip(MASSES, at, strict=True))
    rho, columns = hand - centre, []
    for j, (ds, c) in enumerate(zip(moved, centre_moved, strict=True)):
        h = sum(MOMENTS[1 + j :])
        h += sum(
            m * ((p - centre)[0] * (d - c)[1] - (p - centre)[1] * (d - c)[0])
            for m, p, d in zip(MASSES, at, ds, strict=True)
        )
        hand_moved = across[1] + across[2] if j == 0 else across[2]
        columns.append(hand_moved - c - h / H * np.array([-rho[1], rho[0]]))
    return columns[0][0] * columns[1][1] - columns[0][1] * columns[1][0]


def radius(s, e):
    x, y = A + B * np.cos(s) + C * np.cos(s + e), B * np.sin(s) + C * np.sin(s + e)
    return np.hypot(x, y)


def singular_postures(low, high):
    """Return roots (s, e) of the determinant, from a scan of s over a range."""
    e = np.linspace(-np.pi, np.pi, 181)
    found = []
    for s in np.linspace(low, high, 181):
        values = np.array([determinant(s, one) for one in e])
        for k in np.flatnonzero(values[:-1] * values[1:] < 0.0):
            found.append((s, brentq(lambda one, s=s: determinant(s, one), e[k], e[k + 1], xtol=1e-14)))
    return np.array(found)


def test_the_determinant_of_this_test_is_singular_where_the_paper_says():
    root = brentq(lambda e: determinant(np.deg2rad(-65.0), e), np.deg2rad(-20.0), 0.0, xtol=1e-15)
    assert np.rad2deg(root) == pytest.approx(-11.410803, abs=1e-6)


def test_the_shells_of_the_published_arm(whole):
    """Reach 0 to a + b + c; singular [a + b − c, .553677] and [b + c − a, a + b + c]."""
    assert whole.planar
    np.testing.assert_allclose(whole.reach, [0.0, A + B + C], atol=1e-9)
    inner, outer = whole.path_dependent
    np.testing.assert_allclose(inner, [0.351064, 0.553677], atol=5e-7)
    np.testing.assert_allclose(outer, [1.436170, 2.287234], atol=5e-7)
    np.testing.assert_allclose([inner[0], *outer], [A + B - C, B + C - A, A + B + C], atol=1e-9)
    np.testing.assert_allclose(whole.path_independent, [[0.0, inner[0]], [inner[1], outer[0]]], atol=1e-9)
    area = (inner[1] ** 2 - inner[0] ** 2 + outer[1] ** 2 - outer[0] ** 2) / (A + B + C) ** 2
    assert whole.singular_share == pytest.approx(area, abs=1e-9)


def test_the_one_end_without_a_closed_form_is_a_maximum_on_the_singular_curve(whole):
    roots = singular_postures(-np.pi, np.pi)
    of_all = radius(*roots.T)
    s, _ = roots[of_all < 1.0][np.argmax(of_all[of_all < 1.0])]

    def inner_radius(s):
        e = brentq(lambda one: determinant(s, one), np.pi - 0.6, np.pi + 0.6, xtol=1e-14)
        return -radius(s, e)

    best = minimize_scalar(inner_radius, bounds=(s - 0.05, s + 0.05), method="bounded", options={"xatol": 1e-9})
    assert whole.path_dependent[0][1] == pytest.approx(-best.fun, abs=1e-9)


def test_ends_of_shells_are_postures(whole):
    for (low, high), ends in zip(whole.path_dependent, whole.singular_postures, strict=True):
        np.testing.assert_allclose(radius(*ends.T), [low, high], atol=1e-9)
        assert max(abs(determinant(*end)) for end in ends) < 1e-8
    np.testing.assert_allclose(radius(*whole.postures.T), whole.reach, atol=1e-8)


def test_limits_of_joints_take_singular_postures_away():
    arm = planar()
    found = analysis.workspaces(arm)
    roots = singular_postures(arm.lower[0], arm.upper[0])
    inside = roots[np.abs(roots[:, 1]) < arm.upper[1]]
    (outer,) = found.path_dependent
    assert outer[0] - 1e-9 < radius(*inside.T).min() < outer[0] + 2e-3
    np.testing.assert_allclose(outer[1], A + B + C, atol=1e-9)
    assert (found.path_independent[0][1], len(found.path_independent)) == (outer[0], 1)


@pytest.mark.parametrize(("name", "axes"), [("ets_vii", "all"), ("planar_2r", "linear")])
def test_no_singular_posture_is_found_outside_the_path_dependent_workspace(name, axes):
    """By roots of det J* between random postures, a search of another kind."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    arm = analysis.Arm(robot, robot.point("end_effector", axes))
    found = analysis.workspaces(arm)
    rng = np.random.default_rng(11)
    one, other = arm.draw(rng, 4000), arm.draw(rng, 4000)
    other = np.clip(one + 0.2 * (other - one), arm.lower, arm.upper)

    def det(x):
        return np.linalg.det(arm.posture(x).J_m_star[:, list(arm.rows)])

    crossed = det(one) * det(other) < 0.0
    low, high = one[crossed], other[crossed]
    assert len(low) > 100
    for _ in range(50):
        middle = 0.5 * (low + high)
        same = (det(middle) * det(low) > 0.0)[:, None]
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    radii = np.linalg.norm(arm.posture(low).from_centre, axis=1)
    inside = np.zeros(len(radii), dtype=bool)
    for begin, end in found.path_dependent:
        inside |= (radii > begin - 1e-7) & (radii < end + 1e-7)
    assert inside.all()


def test_no_posture_of_a_sample_is_beyond_the_reach():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
    arm = analysis.Arm(robot, robot.point("end_effector"))
    found = analysis.workspaces(arm, starts=40)
    radii = np.linalg.norm(arm.posture(arm.draw(np.random.default_rng(5), 100_000)).from_centre, axis=1)
    assert found.reach[0] - 1e-9 < radii.min()
    assert radii.max() < found.reach[1] + 1e-9 < radii.max() + 0.1


def test_joints_that_never_lose_rank_have_no_singular_shell():
    arm = planar(joints=["joint_1"])
    found = analysis.workspaces(arm)
    assert (found.path_dependent, found.singular, found.singular_share) == ((), 0, 0.0)
    assert found.path_independent == (found.reach,)
    straight = planar(joints=["joint_1"], at=None).posture(np.linspace(*arm.lower, arm.upper[0], 200)[:, None])
    radii = np.linalg.norm(straight.from_centre, axis=1)
    np.testing.assert_allclose(found.reach, [radii.min(), radii.max()], atol=1e-3)


def test_a_seed_gives_the_same_workspaces():
    arm = planar()
    one, again = (analysis.workspaces(arm, seed=4, starts=60) for _ in range(2))
    assert (one.reach, one.path_dependent, one.singular) == (again.reach, again.path_dependent, again.singular)


@pytest.mark.parametrize("options", [{"starts": 0}, {"starts": 1.5}, {"seed": -1}, {"seed": True}])
def test_numbers_that_make_no_sense_are_refused(options):
    with pytest.raises(OspaceError, match=rf"{next(iter(options))} is .*: give a whole number from"):
        analysis.workspaces(planar(), **options)


def test_what_is_no_arm_is_refused():
    with pytest.raises(OspaceError, match=r"is not a Arm: make it with analysis\.Arm"):
        analysis.workspaces("planar_2r")

"""Reach along rays from the mass centre, the base level."""

from __future__ import annotations

import numpy as np
import pytest

import ospace
from ospace import OspaceError, analysis
from ospace.analysis.rays import lattice_directions

TURN = (-np.pi, np.pi)
A, B, C = 20.0 / 47.0, 42.0 / 47.0, 45.5 / 47.0
"""Barycentric lengths of the planar arm, m: from the mass centre to the hand along base, link 1 and link 2."""


@pytest.fixture(scope="module")
def planar():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    return analysis.Arm(robot, robot.point("end_effector", "linear"), ranges={"joint_1": TURN, "joint_2": TURN})


@pytest.fixture(scope="module")
def ets_vii():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("ets_vii"))
    return analysis.Arm(robot, robot.point("end_effector"))


def test_an_arm_in_a_plane_reaches_as_far_as_geometry_says(planar):
    """ρ = a x + b u + c w with u, w free: as far as a stretched arm b + c along the ray from a x."""
    angle = np.linspace(0.0, 2.0 * np.pi, 25)
    found = analysis.reach_along(planar, np.column_stack([2.0 * np.cos(angle), 2.0 * np.sin(angle), 0.0 * angle]))
    assert found.reached.all()
    far = A * np.cos(angle) + np.sqrt((B + C) ** 2 - (A * np.sin(angle)) ** 2)
    np.testing.assert_allclose(found.distance, far, atol=1e-9)
    rho = planar.posture(found.postures).from_centre
    np.testing.assert_allclose(rho, found.distance[:, None] * found.directions, atol=1e-8)


def test_rays_that_the_hand_never_comes_onto(planar):
    found = analysis.reach_along(planar, [[0.0, 0.0, 1.0], [1.0, 0.0, 1e-3]])
    assert not found.reached.any()
    np.testing.assert_array_equal(found.distance, 0.0)
    np.testing.assert_array_equal(found.postures, np.tile(planar.home, (2, 1)))


def test_directions_are_98_and_even():
    d = lattice_directions()
    assert d.shape == (98, 3)
    np.testing.assert_allclose(np.linalg.norm(d, axis=1), 1.0)
    np.testing.assert_allclose(d.sum(axis=0), 0.0, atol=1e-13)
    nearest = np.rad2deg(np.arccos(np.sort(d @ d.T, axis=1)[:, -2]))
    assert 15.0 < nearest.min() < nearest.max() < 25.0


def test_no_posture_of_a_sample_is_farther_along_a_ray(ets_vii):
    found = analysis.reach_along(ets_vii)
    assert found.reached.all()
    np.testing.assert_allclose(
        ets_vii.posture(found.postures).from_centre, found.distance[:, None] * found.directions, atol=1e-8
    )
    assert ((found.postures >= ets_vii.lower) & (found.postures <= ets_vii.upper)).all()
    rho = ets_vii.posture(ets_vii.draw(np.random.default_rng(7), 200_000)).from_centre
    radius = np.linalg.norm(rho, axis=1)
    near = (rho @ found.directions.T) / radius[:, None] > np.cos(0.01)
    assert near.sum() > 400
    for k in range(98):
        assert radius[near[:, k]].max(initial=0.0) < found.distance[k] + 0.02


def test_a_seed_gives_the_same_reach(ets_vii):
    one, again = (analysis.reach_along(ets_vii, [[1.0, 2.0, 3.0]], seed=3) for _ in range(2))
    np.testing.assert_array_equal(one.postures, again.postures)
    np.testing.assert_allclose(analysis.reach_along(ets_vii, [[1.0, 2.0, 3.0]]).distance, one.distance, rtol=2e-2)


@pytest.mark.parametrize("directions", [[[0.0, 0.0, 0.0]], [1.0, 0.0, 0.0], [[1.0, np.nan, 0.0]], "x"])
def test_directions_that_are_none_are_refused(planar, directions):
    with pytest.raises(OspaceError, match="directions"):
        analysis.reach_along(planar, directions)

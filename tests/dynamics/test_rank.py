"""Rows that depend on each other: reported, inverted on their range, refused on demand."""

import numpy as np
import pytest

import ospace
from ospace.validation.sampling import random_state


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture
def state(chaser):
    return random_state(chaser, np.random.default_rng(8))


@pytest.fixture
def demo(chaser):
    """The paper's three points; four torso joints stand between head and base, so two of 18 rows are too many."""
    return [chaser.point(name) for name in ("right_hand", "head", "base")]


def test_the_papers_demo_has_rank_16(state, demo):
    result = ospace.operational_space(state, demo)
    assert (len(result.inertia), result.rank) == (18, 16)
    assert np.linalg.matrix_rank(result.jacobian, tol=1e-10) == 16


@pytest.mark.parametrize("method", ["forward", "dense"])
def test_the_inertia_is_then_the_pseudo_inverse(state, demo, method):
    result = ospace.operational_space(state, demo, method)
    A, X = result.inertia_inverse, result.inertia
    for product, whole in ((A @ X @ A, A), (X @ A @ X, X), (A @ X, (A @ X).T), (X @ A, (X @ A).T)):
        assert np.abs(product - whole).max() <= 1e-8 * np.abs(whole).max()
    assert np.linalg.matrix_rank(X, tol=1e-9 * np.abs(X).max()) == 16


def test_strict_refuses_and_names_the_points(state, demo):
    with pytest.raises(ospace.DependentRowsError, match="rank 16") as caught:
        ospace.operational_space(state, demo, strict=True)
    assert set(caught.value.points) == {"head", "base"}
    assert (caught.value.rank, caught.value.rows) == (16, 18)


def test_the_rows_that_the_demo_means_are_independent(state, chaser):
    points = [chaser.point("right_hand"), chaser.point("head", "angular"), chaser.point("base", "angular")]
    result = ospace.operational_space(state, points, strict=True)
    assert result.rank == 12
    np.testing.assert_allclose(result.inertia @ result.inertia_inverse, np.eye(12), atol=1e-10)


def test_rows_of_a_point_given_twice_are_dependent(state, chaser):
    hand = chaser.point("right_hand")
    twice = ospace.operational_space(state, [hand, hand])
    assert twice.rank == 6
    with pytest.raises(ospace.DependentRowsError):
        ospace.operational_space(state, [hand, hand], strict=True)


def test_joint_torques_cannot_move_more_directions_than_there_are_joints():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    state = random_state(robot, np.random.default_rng(1))
    point = robot.point("end_effector")
    floating = ospace.free_floating(state, point)
    assert floating.rank == 2
    assert ospace.operational_space(state, point).rank == 6
    with pytest.raises(ospace.DependentRowsError, match="end_effector"):
        ospace.free_floating(state, point, strict=True)


def test_planar_arm_has_its_published_jacobian_and_dynamic_singularity():
    """Papadopoulos & Dubowsky: regular for a fixed base, singular when the base floats."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    point = robot.point("end_effector", (1, 1, 0, 0, 0, 0))

    def jacobians(degrees):
        q = robot.configuration(dict(zip(("joint_1", "joint_2"), np.radians(degrees), strict=True)))
        state = robot.state(q)
        J_e = ospace.operational_space(state, point).jacobian
        return ospace.generalized_jacobian(state, point).generalized_jacobian, J_e[:, 6:]

    floating, _ = jacobians((30.0, 60.0))
    np.testing.assert_allclose(floating, [[-0.78881, -0.8401], [0.243154, -0.108495]], atol=1e-5)
    floating, fixed = jacobians((-65.0, -11.41))
    assert abs(np.linalg.det(floating)) < 1e-5
    assert abs(np.linalg.det(fixed)) > 0.1

"""Exponential and logarithm of SO(3) against Pinocchio, and each as the other's inverse."""

import numpy as np
import pinocchio as pin
import pytest

from ospace.kernels.so3 import exponential, rodrigues, rotation_vector

AXES = [
    *np.eye(3),
    *-np.eye(3),
    np.array([0.6, -0.48, 0.64]),
    np.array([-0.48, 0.64, 0.6]),
    np.array([0.48, 0.6, -0.64]),
    np.array([-0.8, -0.6, 0.0]),
    np.array([0.0, 0.6, -0.8]),
]
ANGLES = [0.0, 1e-300, 1e-9, 0.99e-8, 1.01e-8, 1e-6, 1e-3, 0.142, 0.15, 0.2, 0.3, 0.5, 1.6, 2.9, 3.0]
HALF_TURN = [np.pi - d for d in (0.15, 0.14, 1e-3, 1e-6, 1e-9, 1e-12, 0.0)]


def matrix(columns):
    return np.array(columns).reshape(3, 3).T


def columns(R):
    return tuple(R.ravel(order="F"))


@pytest.mark.parametrize("angle", [*ANGLES, *HALF_TURN, 3.5, 6.0, 20.0])
def test_the_exponential_is_pinocchio_s(angle):
    for axis in AXES:
        R = matrix(exponential(tuple(angle * axis)))
        np.testing.assert_allclose(R, pin.exp3(angle * axis), rtol=0, atol=2e-15)
        np.testing.assert_allclose(R @ R.T, np.eye(3), rtol=0, atol=4e-15)


def test_a_small_rotation_keeps_its_vector():
    rho = np.array([3e-9, -2e-9, 5e-9])
    R = matrix(exponential(tuple(rho)))
    skew = 0.5 * (R - R.T)
    np.testing.assert_allclose([skew[2, 1], skew[0, 2], skew[1, 0]], rho, rtol=1e-15)


def test_up_to_the_second_order_where_the_series_is_taken():
    x, y, z = rho = np.array([6e-9, -3e-9, 2e-9])
    R = matrix(exponential(tuple(rho)))
    symmetric = 0.5 * (R + R.T)
    np.testing.assert_allclose(symmetric[np.tril_indices(3, -1)], np.array([x * y, x * z, y * z]) / 2.0, rtol=1e-6)


@pytest.mark.parametrize("angle", ANGLES)
def test_the_rotation_vector_is_pinocchio_s(angle):
    for axis in AXES:
        rho = rotation_vector(columns(pin.exp3(angle * axis)))
        np.testing.assert_allclose(rho, angle * axis, rtol=1e-14, atol=2e-15)


@pytest.mark.parametrize("angle", [0.142, 0.2])
def test_far_from_a_half_turn_its_formula_is_not_taken(angle):
    """It divides by 1 − cos θ and costs a digit there; that of small angles keeps the digits of the small vector."""
    rng = np.random.default_rng(9)
    for _ in range(50):
        axis = rng.normal(size=3)
        rho = axis / np.linalg.norm(axis) * angle
        np.testing.assert_allclose(rotation_vector(columns(pin.exp3(rho))), rho, rtol=0, atol=3e-16)


@pytest.mark.parametrize("angle", HALF_TURN)
def test_rotation_vector_near_a_half_turn(angle):
    """By exactly a half turn both signs of the axis are right; before it, one is."""
    for axis in AXES:
        R = matrix(exponential(tuple(angle * axis)))
        rho = np.array(rotation_vector(columns(R)))
        rho *= np.sign(rho @ axis) if np.pi - angle < 1e-14 else 1.0
        np.testing.assert_allclose(rho, angle * axis, rtol=0, atol=1e-14)


def test_exponential_and_rotation_vector_undo_each_other():
    rng = np.random.default_rng(4)
    for _ in range(200):
        axis = rng.normal(size=3)
        rho = axis / np.linalg.norm(axis) * rng.uniform(0.0, np.pi)
        np.testing.assert_allclose(rotation_vector(exponential(tuple(rho))), rho, rtol=0, atol=1e-13)


def test_the_formula_serves_many_vectors_at_once():
    vectors = np.random.default_rng(5).normal(size=(20, 3)) * np.logspace(-9, 0.6, 20)[:, None]
    theta = np.linalg.norm(vectors, axis=1)
    many = rodrigues(vectors.T, np.sin(theta) / theta, 2.0 * (np.sin(theta / 2.0) / theta) ** 2)
    one_by_one = [exponential(tuple(vector)) for vector in vectors]
    np.testing.assert_allclose(np.array(many).T, one_by_one, rtol=0.0, atol=1e-15)

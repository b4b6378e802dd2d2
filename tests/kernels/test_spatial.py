"""Spatial algebra against the matrices that it stands for."""

import numpy as np
import pytest

from ospace.kernels import spatial as sp


@pytest.fixture
def rng():
    return np.random.default_rng(3)


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation(rng):
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Q * np.sign(np.linalg.det(Q))


def positive(rng, n):
    A = rng.normal(size=(n, n))
    return A @ A.T + n * np.eye(n)


def lower(A):
    return tuple(A[np.tril_indices(len(A))])


def by_columns(A):
    return tuple(A.ravel(order="F"))


def six(rng):
    return rng.normal(size=6)


def shift(p):
    """X: a force at p to the origin."""
    return np.block([[np.eye(3), np.zeros((3, 3))], [skew(p), np.eye(3)]])


def full(lower_rows, n=6):
    A = np.zeros((n, n))
    A[np.tril_indices(n)] = lower_rows
    return A + np.tril(A, -1).T


def close(value, reference):
    np.testing.assert_allclose(np.asarray(value).ravel(), np.asarray(reference).ravel(), rtol=1e-13, atol=1e-13)


def test_products_of_vectors_and_3_by_3_matrices(rng):
    a, b, R, I = rng.normal(size=3), rng.normal(size=3), rotation(rng), positive(rng, 3)
    close(sp.cross(a, b), np.cross(a, b))
    close(sp.rotate(by_columns(R), a), R @ a)
    close(sp.rotate_sym3(by_columns(R), lower(I)), lower(R @ I @ R.T))
    close(sp.sym3_inverse(lower(I)), lower(np.linalg.inv(I)))
    close(sp.mat3_mul(by_columns(R), by_columns(I)), by_columns(R @ I))
    close(sp.mat3_transpose(by_columns(R)), by_columns(R.T))


def test_force_cross_is_the_dual_of_the_motion_cross(rng):
    v, f, m = (tuple(six(rng)) for _ in range(3))
    on_motions = np.block([[skew(v[3:]), skew(v[:3])], [np.zeros((3, 3)), skew(v[3:])]])
    close(sp.cross_force(v, f), -on_motions.T @ f)
    power = sp.dot6(sp.cross_force(v, f), m) + f @ on_motions @ m
    assert abs(power) < 1e-12


def test_operations_on_symmetric_6_by_6_matrices(rng):
    A, B, s, k = positive(rng, 6), positive(rng, 6), six(rng), 0.7
    close(sp.sym6_mul(lower(A), s), A @ s)
    close(sp.sym6_sub(lower(A), lower(B)), lower(A - B))
    close(sp.sym6_outer(s, k * s), lower(k * np.outer(s, s)))
    close(sp.sym6_to_mat(lower(A)), A)
    close(sp.sym6_inverse_and_pivot(lower(A))[0], lower(np.linalg.inv(A)))


@pytest.mark.parametrize("share", [1.0, 1e-3, 1e-8, 1e-12])
def test_the_inverse_keeps_digits_as_far_as_its_pivot_says(rng, share):
    """Two light directions among heavy ones: by cofactors all digits would go, as one divides by their product."""
    axes = np.linalg.qr(rng.normal(size=(6, 6)))[0]
    A = (axes * [1.0, 2.0, 3.0, 1.0, share, share]) @ axes.T
    exact = (axes / [1.0, 2.0, 3.0, 1.0, share, share]) @ axes.T
    inverse, pivot = sp.sym6_inverse_and_pivot(lower(A))
    error = np.abs(full(inverse) - exact).max() / np.abs(exact).max()
    np.testing.assert_allclose(pivot, 1.0 / (np.diag(A) * np.diag(exact)).max(), rtol=1e-2)
    assert error < 1e-14 / pivot


def test_the_inverse_of_a_rigid_body(rng):
    mass, centre, I = 3.0, rng.normal(size=3), positive(rng, 3)
    A = np.block(
        [[mass * np.eye(3), -mass * skew(centre)], [mass * skew(centre), I + mass * skew(centre) @ skew(centre).T]]
    )
    inverse, pivot = sp.inertia_inverse_and_pivot(lower(A))
    close(inverse, lower(np.linalg.inv(A)))
    np.testing.assert_allclose(pivot, 1.0 / (np.diag(A) * np.diag(np.linalg.inv(A))).max(), rtol=1e-12)
    rod = A - np.block([[np.zeros((3, 6))], [np.zeros((3, 3)), I]]) + np.diag([0.0, 0, 0, 1.0, 1.0, 0.0])
    with np.errstate(all="ignore"):
        assert not sp.inertia_inverse_and_pivot(tuple(map(np.float64, lower(rod))))[1] > 1e-15


@pytest.mark.parametrize("left", [0.0, -1e-17, -1.0])
@pytest.mark.parametrize("k", range(6))
def test_the_pivot_of_what_is_not_positive_is_not_above_zero(k, left):
    A = np.eye(6)
    A[k, k] = left
    with np.errstate(all="ignore"):
        assert not sp.sym6_inverse_and_pivot(tuple(map(np.float64, lower(A))))[1] > 0.0


def test_operations_on_full_6_by_6_matrices(rng):
    K, u, w, p = rng.normal(size=(6, 6)), six(rng), six(rng), rng.normal(size=3)
    flat = tuple(K.ravel())
    close(sp.mat6_mul(flat, u), K @ u)
    close(sp.mul_mat6(u, flat), u @ K)
    close(sp.mat6_add_outer(flat, u, w), K + np.outer(u, w))
    close(sp.mat6_transpose(flat), K.T)
    close(sp.motions_at(p, flat), shift(p).T @ K)
    close(sp.forces_from(p, flat), shift(p) @ K)


def test_motions_and_forces_seen_at_another_point(rng):
    p, v, f, a = (tuple(rng.normal(size=n)) for n in (3, 6, 6, 6))
    close(sp.motion_at(p, v), shift(p).T @ v)
    close(sp.force_from(p, f), shift(p) @ f)
    assert sp.dot6(f, sp.motion_at(p, v)) == pytest.approx(sp.dot6(sp.force_from(p, f), v))
    close(sp.classical(a, v), np.r_[np.array(a[:3]) - np.cross(v[:3], v[3:]), a[3:]])


def test_rigid_inertia_has_the_kinetic_energy_of_the_body(rng):
    c, m, I, v = tuple(rng.normal(size=3)), 2.5, positive(rng, 3), tuple(six(rng))
    moved = np.asarray(sp.motion_at(c, v))
    energy = m * moved[:3] @ moved[:3] + moved[3:] @ I @ moved[3:]
    h, c_x = sp.scale3(c, m), np.cross(c, np.eye(3), axisb=0).T
    body = sp.rigid_inertia(m, h, lower(I - m * c_x @ c_x))
    assert sp.dot6(v, sp.sym6_mul(body, v)) == pytest.approx(energy)
    assert np.linalg.eigvalsh(full(body))[0] > 0

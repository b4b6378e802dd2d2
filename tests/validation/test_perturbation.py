"""The perturbation of an inverse: that of finite differences, and unknown where rounding decides."""

from __future__ import annotations

import numpy as np
import pytest

from ospace.validation.perturbation import Factor, InversePerturbation, rank_is_decided

CUTOFF = 1e-12  # squares of singular values below it count as zero


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("rank", [3, 5, 6])
def test_the_perturbation_of_an_inverse_is_that_of_finite_differences(seed, rank):
    """The worst change of an element over all E of norm 1 is the nuclear norm of its derivative by E."""
    rng = np.random.default_rng(seed)
    scale = 10.0 ** rng.uniform(-1.0, 1.0, 6)
    J = rng.normal(size=(6, rank)) / scale[:, None]
    A = J * 10.0 ** rng.uniform(-1.0, 0.0, rank) @ J.T
    left, right = rng.normal(size=(4, 6)), rng.normal(size=(6, 2))

    def product(E):
        if rank == 6:
            return left @ np.linalg.inv(A * np.outer(scale, scale) + E) @ right
        eigenvalues, vectors = np.linalg.eigh(A + E / np.outer(scale, scale))
        kept = vectors[:, 6 - rank :]
        return left / scale @ (kept / eigenvalues[6 - rank :] @ kept.T) @ (right / scale[:, None])

    h, derivative = 1e-5 * float(np.linalg.eigvalsh(A)[6 - rank]) * float(scale.min()) ** 2, np.empty((4, 2, 6, 6))
    for k in range(6):
        for m in range(6):
            E = np.zeros((6, 6))
            E[k, m] += 0.5 * h
            E[m, k] += 0.5 * h
            derivative[:, :, k, m] = (product(E) - product(-E)) / (2.0 * h)
    worst = np.linalg.norm(derivative, "nuc", axis=(2, 3)).max()
    bound = InversePerturbation(A, rank, scale, off=1.0, unit=1e-30, decided=True).of(Factor(left), Factor(right))
    rounding = InversePerturbation(A, rank, scale, off=0.0, unit=1e-30, decided=True).of(Factor(left), Factor(right))
    assert 0.999 * worst <= bound - rounding <= 6.0 * worst


def test_where_rounding_decides_what_is_kept_nothing_is_known():
    A = np.diag([1.0, 1e-12, 0.0])
    assert InversePerturbation(A, 2, np.ones(3), off=1.0, unit=1e-15, decided=True).of() < np.inf
    assert InversePerturbation(A, 2, np.ones(3), off=1.0, unit=1e-12, decided=True).of() == np.inf
    assert InversePerturbation(A, 2, np.ones(3), off=1.0, unit=1e-15, decided=False).of() == np.inf


@pytest.mark.parametrize(
    ("value", "decided"), [(0.0, True), (1e-5, True), (1e-6, False), (1.0001e-6, False), (1.01e-6, True)]
)
def test_a_singular_value_near_the_cutoff_leaves_the_rank_open(value, decided):
    J, ones = np.diag([1.0, value]), np.ones(2)
    assert rank_is_decided(J, ones, ones, off=1.0, unit=1e-15) == decided

"""Findings on the sampled states: how near the dynamics come to singular."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.validation.sample import Sample

_SMALLEST, _LARGEST_CONDITION, _NEAREST = 1e-9, 1e6, 1e-6  # beyond these a warning
_RANK = 1e-9  # singular values below this share of the largest count as zero


class Extremes:
    """Gathers, over states, what `findings` tells."""

    def __init__(self, points: Sequence[OperationalPoint]) -> None:
        self.points = points
        self._eigenvalues: list[float] = []
        self._conditions: list[float] = []
        self._singular_values: list[list[Floats]] = [[] for _ in points]

    def add(self, sample: Sample) -> None:
        """Take one state into account."""
        scaled = sample.dense.H * np.outer(sample.force_scale, sample.force_scale)
        self._eigenvalues.append(float(np.linalg.eigvalsh(scaled)[0]))
        self._conditions.append(_condition_in_units_of_gyration(sample.dense.H[:6, :6]))
        J = sample.jacobians.generalized_jacobian * np.outer(sample.point_scale, sample.force_scale[6:])
        row = 0
        for point, values in zip(self.points, self._singular_values, strict=True):
            values.append(np.asarray(np.linalg.svd(J[row : row + point.n_rows], compute_uv=False), dtype=float))
            row += point.n_rows

    def findings(self, robot: str) -> Iterator[Finding]:
        """Tell what the states showed; nothing without a state."""
        if not self._eigenvalues:
            return
        subject, states = f"robot '{robot}'", f"over {len(self._eigenvalues)} states"
        smallest, condition = min(self._eigenvalues), max(self._conditions)
        yield make_finding(
            "smallest-inertia",
            subject,
            f"smallest eigenvalue of H {states}: {smallest:.4g} with unit diagonal",
            severity="warning" if smallest < _SMALLEST else None,
            value=f"{smallest:.4g}",
        )
        yield make_finding(
            "base-condition",
            subject,
            f"largest condition of H_b {states}: {condition:.4g}, lengths in radii of gyration",
            severity="warning" if condition > _LARGEST_CONDITION else None,
            value=f"{condition:.4g}",
        )
        for point, values in zip(self.points, self._singular_values, strict=True):
            if point.robot.n_joints:
                yield from _of_point(point, values, states)


def _of_point(point: OperationalPoint, values: Sequence[Floats], states: str) -> Iterator[Finding]:
    subject = f"point '{point.frame}'"
    largest = max(float(one[0]) for one in values)
    rank = max(int((one > _RANK * largest).sum()) for one in values)
    if rank < point.n_rows:
        message = f"its J* has rank {rank} at most {states}, of {point.n_rows} rows"
        yield make_finding("point-rank", subject, message, value=str(rank))
        return
    nearest = min(float(one[-1] / one[0]) for one in values)
    yield make_finding(
        "dynamic-singularity",
        subject,
        f"σ_min/σ_max of J* is at least {nearest:.4g} {states}",
        severity="warning" if nearest < _NEAREST else None,
        value=f"{nearest:.4g}",
    )


def _condition_in_units_of_gyration(H_b: Floats) -> float:
    gyration = np.sqrt(np.trace(H_b[3:, 3:]) / (2.0 * H_b[0, 0]))
    scale = np.r_[1.0, 1.0, 1.0, np.full(3, 1.0 / gyration)]
    eigenvalues = np.linalg.eigvalsh(H_b * np.outer(scale, scale))
    return float(eigenvalues[-1] / eigenvalues[0]) if eigenvalues[0] > 0.0 else np.inf

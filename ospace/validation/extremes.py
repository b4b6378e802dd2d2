"""Findings on the sampled states: how near the dynamics come to singular."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.validation.sample import Sample

_SMALLEST, _LARGEST_CONDITION, _NEAREST = 1e-9, 1e6, 1e-6  # beyond these a warning
_RANK = 1e-9  # singular values below this share of the largest count as zero


class Extremes:
    """Gathers, over states, what `findings` tells."""

    def __init__(self, robot: SpaceRobot, points: Sequence[OperationalPoint], length: float) -> None:
        """Take the robot, its points, and the `length` (m) in which metres are counted beside radians."""
        self.robot, self.points, self.length = robot, points, length
        self._eigenvalues: list[float] = []
        self._conditions: list[float] = []
        self._ranks: list[list[Floats]] = [[] for _ in points]
        self._nearest: list[tuple[float, Floats]] = [(np.inf, np.zeros(0)) for _ in points]

    def add(self, sample: Sample) -> None:
        """Take one state into account."""
        scaled = sample.dense.H * np.outer(sample.force_scale, sample.force_scale)
        self._eigenvalues.append(float(np.linalg.eigvalsh(scaled)[0]))
        self._conditions.append(_condition_in_units_of_gyration(sample.dense.H[:6, :6]))
        J = sample.jacobians.generalized_jacobian
        by_inertia = np.outer(sample.point_scale, sample.force_scale[6:])
        columns = np.where(self.robot.turning_rates, 1.0, self.length)
        row = 0
        for k, point in enumerate(self.points):
            rows = slice(row, row + point.n_rows)
            self._ranks[k].append(np.asarray(np.linalg.svd((J * by_inertia)[rows], compute_uv=False), dtype=float))
            in_lengths = np.where(np.flatnonzero(point.axes) < 3, 1.0 / self.length, 1.0)
            values = np.linalg.svd(in_lengths[:, None] * J[rows] * columns, compute_uv=False)
            share = float(values[-1] / values[0]) if values.size and values[0] > 0.0 else 0.0
            if share < self._nearest[k][0]:
                self._nearest[k] = share, sample.state.q
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
        if self.robot.n_joints:
            for point, values, nearest in zip(self.points, self._ranks, self._nearest, strict=True):
                yield self._of_point(point, values, nearest, states)

    def _of_point(
        self, point: OperationalPoint, values: Sequence[Floats], nearest: tuple[float, Floats], states: str
    ) -> Finding:
        subject = f"point '{point.frame}'"
        largest = max(float(one[0]) for one in values)
        rank = max(int((one > _RANK * largest).sum()) for one in values)
        if rank < point.n_rows:
            message = f"its J* has rank {rank} at most {states}, of {point.n_rows} rows"
            return make_finding("point-rank", subject, message, value=str(rank))
        share, q = nearest
        pose = {name: at for name, at in self.robot.joint_positions(q).items() if isinstance(at, float)}
        model = self.robot.model
        way = [model.names[j] for j in model.supports[point.joint] if model.names[j] in pose]
        there = ", ".join(f"{name}={pose[name]:.4g}" for name in way)
        return make_finding(
            "dynamic-singularity",
            subject,
            f"σ_min/σ_max of J* is at least {share:.4g} {states}, lengths over L = {self.length:.4g} m"
            + (f"; there {there}" if there else ""),
            severity="warning" if share < _NEAREST else None,
            value=f"{share:.4g}",
            pose=",".join(f"{name}={at:.6g}" for name, at in pose.items()) or None,
        )


def _condition_in_units_of_gyration(H_b: Floats) -> float:
    gyration = np.sqrt(np.trace(H_b[3:, 3:]) / (2.0 * H_b[0, 0]))
    scale = np.r_[1.0, 1.0, 1.0, np.full(3, 1.0 / gyration)]
    eigenvalues = np.linalg.eigvalsh(H_b * np.outer(scale, scale))
    return float(eigenvalues[-1] / eigenvalues[0]) if eigenvalues[0] > 0.0 else np.inf

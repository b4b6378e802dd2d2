"""A state on the kernels' tables, for kernels that run one at a time and interpreted."""

from __future__ import annotations

import numpy as np
import trees

from ospace.dynamics.dense import Dense
from ospace.dynamics.workspace import Workspace
from ospace.kernels.workspace import open_robot, open_work


class Laid:
    """A random tree of all joint types with a drive's inertia in each, three points, and the oracle of its state."""

    def __init__(self, seed: int) -> None:
        robot = trees.tree(seed, 8 + seed % 7)
        self.state = trees.state(robot, seed)
        tip = robot.leaf_links[-1]
        self.points = [robot.point(tip), robot.point("base"), robot.point("link_3")]
        self.run = Workspace(robot, self.points)
        self.run.load(self.state)
        self.robot, self.w = open_robot(self.run.memory), open_work(self.run.memory, 0.0)
        self.joints, self.nodes = self.robot.joints, self.robot.nodes
        self.dense = Dense(self.state, self.points)


def close(value: object, reference: object, digits: float = 1e-10) -> None:
    """Assert that both are the same to within that share of the largest element."""
    value, reference = np.asarray(value), np.asarray(reference)
    assert value.shape == reference.shape
    np.testing.assert_allclose(value, reference, rtol=0, atol=digits * np.abs(reference).max())


def full(lower_rows: np.ndarray) -> np.ndarray:
    """Return the (6, 6) matrix of its lower rows."""
    A = np.zeros((6, 6))
    A[np.tril_indices(6)] = lower_rows
    return A + np.tril(A, -1).T

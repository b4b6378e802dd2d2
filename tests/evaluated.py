"""Results of evaluator and batch beside the dense form."""

import numba
import numpy as np
import pinocchio as pin
import pytest

from ospace.dynamics import batch
from ospace.dynamics.dense import Dense

ALL = tuple(batch.QUANTITIES)


def close(value, reference, tolerance=1e-11):
    assert np.abs(value - reference).max(initial=0.0) <= tolerance * max(np.abs(reference).max(initial=0.0), 1e-9)


def agrees(result, state, points, tolerance=1e-11):
    dense = Dense(state, points)
    close(result.inertia_inverse, dense.Gamma_e_inv, tolerance)
    close(result.bias_acceleration, dense.mu, tolerance)


def draw_points(robot, rng, count):
    """Points on random links, the base and repeated links among them, with offsets and rows of all kinds."""
    names = ["base", *(f"link_{k}" for k in range(robot.model.njoints - 2))]
    axes = ["all", "linear", "angular", (True, False, True, False, False, True)]
    return [
        robot.point(
            names[rng.integers(len(names))],
            axes[rng.integers(4)],
            pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)),
        )
        for _ in range(count)
    ]


compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="about compiled kernels")


def broken(q, v, kind):
    q, v = q.copy(), v.copy()
    if kind == "nan":
        q[9] = np.nan
    elif kind == "infinite rate":
        v[8] = np.inf
    elif kind == "zero quaternion":
        q[3:7] = 0.0
    elif kind == "long quaternion":
        q[3:7] *= 1.1
    elif kind == "huge rate":
        v[8] = 1e200
    elif kind == "short":
        q = q[:-1]
    return q, v

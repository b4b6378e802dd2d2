"""Growth of the time of Γ_e⁻¹ and μ_e with the robot: chains and trees that are built in code."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ospace.benchmark.timing import Tick, Way, window_times
from ospace.dynamics.evaluator import OperationalSpaceEvaluator
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot

SIZES = (12, 24, 48, 96, 192, 384, 768, 1000)
SHAPES = {"chain": 1, "tree": 2}
"""Joints that hang from each link."""
LARGEST_DENSE = 192
"""Degrees of freedom up to which Pinocchio's way is timed: its `createData` takes 64 nv³ bytes."""


@dataclass(frozen=True)
class Scaling:
    """Times over degrees of freedom.

    Attributes
    ----------
    shape : "chain" or "tree"
    sizes : tuple of int
        Degrees of freedom, base included.
    ours : tuple of float
        Γ_e⁻¹ and μ_e of two points by the evaluator, µs.
    dense : tuple of float or None
        pin.crba and a Cholesky factorization of H, from which they would have to be solved, µs; None where its
        memory is too large.
    slope, dense_slope : float
        Exponents: least squares over the logarithms of all sizes, and of the dense times that there are.
    """

    shape: str
    sizes: tuple[int, ...]
    ours: tuple[float, ...]
    dense: tuple[float | None, ...]
    slope: float
    dense_slope: float


def robot_of(shape: str, nv: int) -> SpaceRobot:
    """Build a robot of equal links on a base: a chain, or a binary tree."""
    model, branches = pin.Model(), SHAPES[shape]
    model.name = f"{shape}_{nv}"
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base_joint")
    model.appendBodyToJoint(base, pin.Inertia.FromBox(500.0, 2.0, 2.0, 2.0), pin.SE3.Identity())
    model.addBodyFrame("base", base, pin.SE3.Identity(), 0)
    axes = (pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRZ())
    placement = pin.SE3(np.eye(3), np.array([0.1, 0.05, 0.3]))
    link = pin.Inertia.FromBox(5.0, 0.1, 0.1, 0.3)

    def grow(parent: int, joints: int) -> None:
        """Hang `joints` joints from `parent`, one on it and the rest in equal shares beyond that."""
        stack = [(parent, joints)]
        while stack:
            parent, joints = stack.pop()
            if joints > 0:
                k = model.njoints
                j = model.addJoint(parent, axes[k % 3], placement, f"joint_{k}")
                model.appendBodyToJoint(j, link, pin.SE3.Identity())
                model.addBodyFrame(f"link_{k}", j, pin.SE3.Identity(), 0)
                shares = [(joints - 1 + k) // branches for k in range(branches)]
                stack += [(j, share) for share in shares]

    grow(base, nv - 6)
    return SpaceRobot.from_model(model)


def measure(shape: str, *, seconds: float, sizes: Sequence[int] = SIZES, tick: Tick) -> Scaling:
    """Time all `sizes`, `seconds` for each."""
    ours, dense = [], []
    for nv in sizes:
        robot = robot_of(shape, nv)
        rng = np.random.default_rng(0)
        states = []
        for _ in range(8):
            q = robot.configuration()
            q[7:] = rng.uniform(-0.5, 0.5, robot.n_joints)
            states.append((q, rng.uniform(-0.1, 0.1, nv)))
        leaves = robot.leaf_links
        points = [robot.point(leaves[-1]), robot.point("base" if len(leaves) == 1 else leaves[0], "linear")]
        ways: list[Way] = [OperationalSpaceEvaluator(robot, points, ("inertia_inverse", "bias_force")).update]
        if nv <= LARGEST_DENSE:
            ways.append(_crba_and_cholesky(robot))
        times = np.median(window_times(ways, states, seconds=seconds, tick=tick), axis=0) * 1e6
        ours.append(float(times[0]))
        dense.append(float(times[1]) if len(times) > 1 else None)
    known = [(nv, time) for nv, time in zip(sizes, dense, strict=True) if time is not None]
    return Scaling(
        shape, tuple(sizes), tuple(ours), tuple(dense), _slope(sizes, ours), _slope(*zip(*known, strict=True))
    )


def _crba_and_cholesky(robot: SpaceRobot) -> Way:
    model, data = robot.model, robot.model.createData()

    def way(q: Floats, v: Floats) -> None:
        H = pin.crba(model, data, q, pin.Convention.WORLD)
        np.linalg.cholesky(H.T)  # of the lower triangle, which crba fills as the upper one

    return way


def _slope(sizes: Sequence[int], times: Sequence[float]) -> float:
    return float(np.polyfit(np.log(sizes), np.log(times), 1)[0])

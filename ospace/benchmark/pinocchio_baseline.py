"""The same quantities by ospace and by Pinocchio, as each is called at its fastest from Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ospace.benchmark.timing import Way
from ospace.dynamics.evaluator import OperationalSpaceEvaluator
from ospace.dynamics.operational_space import OperationalSpace, operational_space
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot

AGREEMENT = 1e-7
"""Tolerance of results, relative to the largest number: what is timed must be the same thing, no more."""

_INERTIAL = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class TimedComparison:
    """One quantity by two ways.

    Attributes
    ----------
    quantity, called : str
        What is computed, and what is called for it on Pinocchio's side.
    ours, theirs : callables of q, v
    results : callable of q, v
        Pairs of arrays, ours and theirs, that must agree.
    """

    quantity: str
    called: str
    ours: Way
    theirs: Way
    results: Callable[[Floats, Floats], Sequence[tuple[Floats, Floats]]]

    def check(self, states: Sequence[tuple[Floats, Floats]]) -> None:
        """Raise `OspaceError` where the two ways do not give the same numbers."""
        for q, v in states:
            for ours, theirs in self.results(q, v):
                error = np.abs(ours - theirs).max(initial=0.0) / max(np.abs(theirs).max(initial=0.0), 1e-300)
                if not error <= AGREEMENT:
                    raise OspaceError(
                        f"{self.quantity}: ospace and {self.called} differ by {error:.1e} (allowed {AGREEMENT:g}), so "
                        f"there is nothing to time; run 'ospace check' on this robot"
                    )


class Pinocchio:
    """Pinocchio's side for one robot and its points: its data, and what the calls need."""

    def __init__(self, robot: SpaceRobot, points: Sequence[OperationalPoint]) -> None:
        self.robot, self.points, self.model, self.data = robot, points, robot.model, robot.model.createData()
        frame, kind = pin.ReferenceFrame.LOCAL, pin.ContactType.CONTACT_6D
        # Pinocchio's own vectors: the bindings would copy lists at every call, which takes longer than EFPA
        self.constraints, self.constraint_data = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
        for point in points:
            one = pin.RigidConstraintModel(kind, robot.model, point.joint, point.placement, frame)
            self.constraints.append(one)
            self.constraint_data.append(one.createData())
        self.no_torque = np.zeros(robot.nv)

    def delassus(self, q: Floats, v: Floats) -> Floats:
        """Γ_e⁻¹ in the points' own axes, by EFPA in C++."""
        matrix: Floats = pin.computeDelassusMatrix(
            self.model, self.data, q, self.constraints, self.constraint_data, 0.0
        )
        return matrix

    def operational_space(self, q: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Γ_e⁻¹ and Γ_e; and accelerations when nothing acts, from which μ would follow."""
        mobility = self.delassus(q, v)
        inertia = np.asarray(np.linalg.inv(mobility), dtype=np.float64)
        pin.aba(self.model, self.data, q, v, self.no_torque)
        return mobility, inertia

    def jacobians(self, q: Floats, v: Floats) -> list[Floats]:
        """J_e of each point, columns of the base in base axes."""
        pin.computeJointJacobians(self.model, self.data, q)
        return [self._jacobian(point) for point in self.points]

    def generalized(self, q: Floats, v: Floats) -> tuple[Floats, Floats]:
        """J_m* of all points and H_m*, from crba."""
        H = pin.crba(self.model, self.data, q, pin.Convention.WORLD)
        H_b, H_bm = H[:6, :6], H[:6, 6:]
        H_b = np.triu(H_b) + np.triu(H_b, 1).T
        H_m = np.triu(H[6:, 6:]) + np.triu(H[6:, 6:], 1).T
        J_b_star = -np.linalg.solve(H_b, H_bm)
        J = np.vstack(self.jacobians(q, v))
        return J[:, 6:] + J[:, :6] @ J_b_star, H_m + H_bm.T @ J_b_star

    def by_hand(self, q: Floats, v: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Γ_e⁻¹, Γ_e, μ and μ_e as one writes them on Pinocchio: crba, nonLinearEffects, Jacobians and LAPACK."""
        model, data = self.model, self.data
        upper = pin.crba(model, data, q, pin.Convention.WORLD)
        H = np.triu(upper) + np.triu(upper, 1).T
        h = pin.nonLinearEffects(model, data, q, v)
        pin.forwardKinematics(model, data, q, v, self.no_torque)
        drift = np.concatenate([self._acceleration(point) for point in self.points])
        J = np.vstack(self.jacobians(q, v))
        X = np.linalg.solve(H, np.column_stack([J.T, h]))
        mobility, mu = J @ X[:, :-1], J @ X[:, -1] - drift
        inertia = np.asarray(np.linalg.inv(mobility), dtype=np.float64)
        return mobility, inertia, mu, inertia @ mu

    def _acceleration(self, point: OperationalPoint) -> Floats:
        a: Floats = pin.getFrameClassicalAcceleration(
            self.model, self.data, point.joint, point.placement, _INERTIAL
        ).vector
        return a

    def _jacobian(self, point: OperationalPoint) -> Floats:
        J: Floats = pin.getFrameJacobian(self.model, self.data, point.joint, point.placement, _INERTIAL)
        return J

    def axes(self) -> Floats:
        """Axes of the points in inertial ones, block by block: `delassus` answers in the former."""
        R = np.zeros((6 * len(self.points),) * 2)
        for e, point in enumerate(self.points):
            rotation = self.data.oMi[point.joint].rotation @ point.placement.rotation
            R[6 * e : 6 * e + 3, 6 * e : 6 * e + 3] = R[6 * e + 3 : 6 * e + 6, 6 * e + 3 : 6 * e + 6] = rotation
        return R

    def accelerations(self, q: Floats, v: Floats) -> Floats:
        """ẍ_e when nothing acts, inertial axes."""
        a = pin.aba(self.model, self.data, q, v, self.no_torque)
        pin.forwardKinematics(self.model, self.data, q, v, a)
        return np.concatenate([self._acceleration(point) for point in self.points])


def inverse_inertia(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> TimedComparison:
    """Γ_e⁻¹ alone."""
    run, peer = OperationalSpaceEvaluator(robot, points, ("inertia_inverse",)), Pinocchio(robot, points)

    def results(q: Floats, v: Floats) -> list[tuple[Floats, Floats]]:
        mobility, R = peer.delassus(q, v), peer.axes()
        return [(run.update(q, v).inertia_inverse, R @ mobility @ R.T)]

    return TimedComparison("Γ_e⁻¹", "pin.computeDelassusMatrix", run.update, peer.delassus, results)


def operational_space_terms(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> TimedComparison:
    """Γ_e⁻¹, Γ_e and μ_e."""
    run, peer = OperationalSpaceEvaluator(robot, points), Pinocchio(robot, points)

    def results(q: Floats, v: Floats) -> list[tuple[Floats, Floats]]:
        mobility, inertia = peer.operational_space(q, v)
        R = peer.axes()
        ours = run.update(q, v)
        bias_force = -R @ inertia @ R.T @ peer.accelerations(q, v)
        return [
            (ours.inertia_inverse, R @ mobility @ R.T),
            (ours.inertia, R @ inertia @ R.T),
            (ours.bias_force, bias_force),
        ]

    called = "pin.computeDelassusMatrix, np.linalg.inv, pin.aba"
    return TimedComparison("Γ_e⁻¹, Γ_e, μ, μ_e", called, run.update, peer.operational_space, results)


def jacobian(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> TimedComparison:
    """J_e."""
    run, peer = OperationalSpaceEvaluator(robot, points, ("jacobian",)), Pinocchio(robot, points)

    def results(q: Floats, v: Floats) -> list[tuple[Floats, Floats]]:
        return [(run.update(q, v).jacobian[:, 6:], np.vstack(peer.jacobians(q, v))[:, 6:])]

    return TimedComparison("J_e", "pin.computeJointJacobians, getFrameJacobian", run.update, peer.jacobians, results)


def generalized(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> TimedComparison:
    """J_m*, M_0 and H_m*."""
    run, peer = OperationalSpaceEvaluator(robot, points, ("generalized_inertia",)), Pinocchio(robot, points)

    def results(q: Floats, v: Floats) -> list[tuple[Floats, Floats]]:
        J_m_star, H_m_star = peer.generalized(q, v)
        ours = run.update(q, v)
        return [(ours.generalized_jacobian, J_m_star), (ours.generalized_inertia, H_m_star)]

    called = "pin.crba, computeJointJacobians, np.linalg.solve"
    return TimedComparison("J_m*, H_m*, M_0", called, run.update, peer.generalized, results)


def from_a_state(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> TimedComparison:
    """Γ_e⁻¹, Γ_e, μ and μ_e by `operational_space`, a new state each time."""
    peer = Pinocchio(robot, points)

    def ours(q: Floats, v: Floats) -> OperationalSpace:
        return operational_space(robot.state(q, v), points)

    def results(q: Floats, v: Floats) -> list[tuple[Floats, Floats]]:
        found, (mobility, inertia, mu, mu_e) = ours(q, v), peer.by_hand(q, v)
        return [
            (found.inertia_inverse, mobility),
            (found.inertia, inertia),
            (found.bias_acceleration, mu),
            (found.bias_force, mu_e),
        ]

    called = "pin.crba, nonLinearEffects, Jacobians, np.linalg"
    return TimedComparison("operational_space(state)", called, ours, peer.by_hand, results)


def read_only_input(robot: SpaceRobot, points: Sequence[OperationalPoint]) -> TimedComparison:
    """Γ_e⁻¹ of read-only arrays, as `State.q` is, against the same of writable ones: in one state."""
    run = OperationalSpaceEvaluator(robot, points, ("inertia_inverse",))
    writable = robot.configuration(), np.zeros(robot.nv)
    state = robot.state(*writable)
    read_only = state.q, state.v

    def results(q: Floats, v: Floats) -> list[tuple[Floats, Floats]]:
        given = robot.state(q, v)
        return [(run.update(given.q, given.v).inertia_inverse.copy(), run.update(q, v).inertia_inverse)]

    called = "the same of writable q, v: no Pinocchio"
    return TimedComparison(
        "Γ_e⁻¹ of read-only q, v",
        called,
        lambda q, v: run.update(*read_only),
        lambda q, v: run.update(*writable),
        results,
    )


COMPARISONS: tuple[Callable[[SpaceRobot, Sequence[OperationalPoint]], TimedComparison], ...] = (
    inverse_inertia,
    operational_space_terms,
    jacobian,
    generalized,
    from_a_state,
    read_only_input,
)
INVERTING = (operational_space_terms, from_a_state)
"""Those whose other side inverts Γ_e⁻¹, which takes independent rows."""


def spread_points(robot: SpaceRobot, count: int) -> list[OperationalPoint]:
    """Return points on `count` links: the outermost first, then the others from the last one inward."""
    model = robot.model
    leaves = [robot.point(name) for name in robot.leaf_links]
    moving = [point for point in leaves if point.joint > 1]
    taken = {point.joint for point in moving}
    inner: list[Any] = []
    for j in range(model.njoints - 1, 0, -1):
        frame = next((f for f in model.frames if f.parentJoint == j and f.type == pin.FrameType.BODY), None)
        if j not in taken and frame is not None:
            inner.append(robot.point(frame.name))
    distinct = list({point.joint: point for point in [*moving, *inner]}.values())
    if len(distinct) < count:
        raise OspaceError(f"robot '{robot.name}' has {len(distinct)} links to put points on, not {count}")
    return distinct[:count]

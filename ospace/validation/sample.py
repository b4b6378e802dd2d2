"""One state under random loads: recursions beside dense forms, with the scales and conditions of the state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ospace.dynamics import evaluator, workspace
from ospace.dynamics.dense import Dense
from ospace.dynamics.free_floating import FreeFloating, free_floating
from ospace.dynamics.generalized_jacobian import GeneralizedJacobian, generalized_jacobian
from ospace.dynamics.joint_space import (
    GeneralizedDynamics,
    JointSpaceDynamics,
    generalized_dynamics,
    joint_space_dynamics,
    momentum,
)
from ospace.dynamics.operational_space import OperationalSpace, operational_space
from ospace.exceptions import OspaceError
from ospace.kernels import evaluation
from ospace.kernels.spatial import diagonal
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.validation.dense_rates import DenseRates
from ospace.validation.perturbation import Factor, InversePerturbation, rank_is_decided

FACTOR = 16.0
_FEW_POINTS = 2  # of which the batch is run interpreted, where time grows with the cube of their number


class OfPoints(Protocol):
    """Γ_e⁻¹ as one of the ways in computed it."""

    @property
    def inertia_inverse(self) -> Any: ...


class Sample:
    """One state with random loads: results of the recursions beside the dense forms, each computed once."""

    def __init__(
        self, robot: SpaceRobot, state: State, points: Sequence[OperationalPoint], rng: np.random.Generator
    ) -> None:
        self.robot, self.state, self.points = robot, state, tuple(points)
        self.operational = operational_space(state, self.points)  # first: it refuses a joint without inertia
        self.dense = Dense(state, self.points)
        if not (np.diag(self.dense.H) > 0.0).all() or not (np.diag(self.dense.Gamma_e_inv) > 0.0).all():
            raise OspaceError("an inertia is not positive by Pinocchio: masses or lengths are too large or too small")
        self.load = rng.normal(size=robot.nv) * self.velocity_scale
        self._Gamma: dict[int, InversePerturbation] = {}  # by the results that it is of, which the sample holds
        self.F_e = rng.normal(size=len(self.dense.J_e)) * self.point_scale

    @cached_property
    def momentum(self) -> Floats:
        return momentum(self.state)

    @cached_property
    def joint_space(self) -> JointSpaceDynamics:
        return joint_space_dynamics(self.state)

    @cached_property
    def generalized(self) -> GeneralizedDynamics:
        return generalized_dynamics(self.state)

    @cached_property
    def jacobians(self) -> GeneralizedJacobian:
        return generalized_jacobian(self.state, self.points)

    @cached_property
    def floating(self) -> FreeFloating:
        return free_floating(self.state, self.points)

    @cached_property
    def evaluator(self) -> evaluator.OperationalSpaceEvaluator:
        """Everything that it offers, of links that the kernels place themselves."""
        run = evaluator.OperationalSpaceEvaluator(self.robot, self.points, evaluator.QUANTITIES)
        return run.update(self.state.q, self.state.v)

    batch: Any
    """Everything that the batch offers, of this state, by `AgreementTable.add_batch`."""

    @cached_property
    def rates(self) -> DenseRates:
        return DenseRates(self.state, self.points)

    @cached_property
    def forward(self) -> OperationalSpace:
        return operational_space(self.state, self.points, "forward")

    @cached_property
    def inverted(self) -> OperationalSpace:
        return operational_space(self.state, self.points, "inverted")

    @cached_property
    def each_point(self) -> list[Sample]:
        """The same state with each point alone."""
        return [Sample(self.robot, self.state, [point], np.random.default_rng(0)) for point in self.points]

    def with_few_points(self) -> Sample:
        """Return the same state with the first points alone."""
        if len(self.points) <= _FEW_POINTS:
            return self
        return Sample(self.robot, self.state, self.points[:_FEW_POINTS], np.random.default_rng(0))

    # -- scales and conditions -------------------------------------------------------------------------------

    @cached_property
    def unit(self) -> float:
        """Bound on rounding where nothing is inverted and nothing cancels."""
        return self.robot.nv * FACTOR * float(np.finfo(float).eps)

    @cached_property
    def velocity_scale(self) -> Floats:
        return np.asarray(np.sqrt(np.diag(self.dense.H)))

    @cached_property
    def force_scale(self) -> Floats:
        return 1.0 / self.velocity_scale

    @cached_property
    def point_scale(self) -> Floats:
        """Scale of velocities of the points; its inverse is that of forces."""
        return np.asarray(1.0 / np.sqrt(np.diag(self.dense.Gamma_e_inv)))

    @cached_property
    def speed(self) -> float:
        """Natural size of velocity products: the scaled speed times the fastest rate, from a frame beside the base."""
        v = self.dense.velocity.copy()
        v[:3] = 0.0
        return float(np.linalg.norm(self.velocity_scale * v) * np.abs(v).max())

    @cached_property
    def fastest(self) -> float:
        """The fastest rate, from a frame beside the base: natural size of rates of what has unit size."""
        return float(np.abs(self.state.v[3:]).max())

    @cached_property
    def lever(self) -> float:
        """The most by which terms that cancel exceed what is left of them at a joint: small last links on long ones.

        A link's inertia stands at its own origin, and cancels there in proportion to its size; forces and motions are
        carried to the base and back, and lose in proportion to the distance (`reach`).
        """
        return self._cancelled(0.0) + self.reach

    @cached_property
    def reach(self) -> float:
        """The same for forces and motions that are carried from the base: the distance over the radius of gyration."""
        return float(np.sqrt(self._cancelled(1.0)))

    def _cancelled(self, from_base: float) -> float:
        run = workspace.of(self.state)
        run.evaluate(evaluation.FLOATING_BASE)
        inertia, S = np.column_stack(diagonal(tuple(run.table("IC").T))), run.table("S")
        inertia[:, 3:] += from_base * inertia[:, :1] * np.square(run.table("r")).sum(axis=1, keepdims=True)
        terms = np.abs(S) * np.sqrt(np.abs(inertia))
        inertia_felt = np.diag(self.dense.H)[5 + self.state.robot.links.column[1:]]
        return float((terms[1:].sum(axis=1) ** 2 / inertia_felt).max(initial=1.0))

    @cached_property
    def point_lever(self) -> float:
        """The same at the points: how far they would move with the base's place, were they not beside their joints.

        A point that hardly moves while its link turns easily, as one on the axis of a light link, is the difference
        of the link's motion about the base and that motion's arm.
        """
        all_rows = [replace(point, axes=(True,) * 6) for point in self.points]
        mobility = np.diag(Dense(self.state, all_rows).Gamma_e_inv).reshape(-1, 6)
        arms = [np.linalg.norm(self.state.placement_about_base(point).translation) for point in self.points]
        swept = mobility[:, 3:].max(axis=1) * np.square(arms)
        linear = np.array([one.axes for one in self.points])
        linear[:, 3:] = False
        return float(np.where(linear, swept[:, None] / mobility, 1.0).max())

    @cached_property
    def condition_H_b(self) -> float:
        return condition(self.dense.H[:6, :6])

    @cached_property
    def condition_H(self) -> float:
        return condition(self.dense.H) + self.lever

    @cached_property
    def condition_minverse(self) -> float:
        """Of `pin.computeMinverse`, whose inertias stand about the base and cancel by the square of the distance."""
        return self.condition_H + self.reach**2

    @cached_property
    def condition_mobility(self) -> float:
        return self.condition_H + self.point_lever

    # -- products with an inverse ----------------------------------------------------------------------------

    def Gamma(self, by: OfPoints) -> InversePerturbation:
        """Return how far Γ_e may be off where it is the inverse of what one of the ways in computed."""
        if id(by) not in self._Gamma:
            condition, dense = self.reach + self.point_lever**0.5, self.dense
            self._Gamma[id(by)] = self._inverse(
                by.inertia_inverse, dense.Gamma_e_inv, dense.rank, dense.J_e, np.diag(dense.H), condition
            )
        return self._Gamma[id(by)]

    @cached_property
    def Lambda(self) -> InversePerturbation:
        """Bound on the error of Λ."""
        condition = self.condition_H_b * self.reach + self.point_lever**0.5
        value, dense = self.floating.floating_inertia_inverse, self.dense
        inertia = np.diag(dense.H_m_star)
        return self._inverse(value, dense.Lambda_inv, dense.floating_rank, dense.J_m_star, inertia, condition)

    def _inverse(
        self, value: Floats, A: Floats, rank: int, J: Floats, inertia: Floats, condition_J: float
    ) -> InversePerturbation:
        mobility, scale = np.diag(self.dense.Gamma_e_inv), self.point_scale
        off = self.factor(value, A, scale, scale, self.condition_mobility).off
        decided = rank_is_decided(J, mobility, inertia, off=condition_J, unit=self.unit)
        return InversePerturbation(A, rank, scale, off=off, unit=self.unit, decided=decided)

    def factor(
        self,
        value: Floats,
        reference: Floats,
        rows: Floats,
        columns: Floats | float,
        condition: float,
        natural: float = 1.0,
    ) -> Factor:
        """Return a scaled matrix, and how far it is off in this state: twice the difference of both sides.

        What that difference does to a product with an inverse is known to first order; the other half is for the
        second. It counts as no further off than its own row of the table allows. The condition there is that of the
        worst case; times the condition of an inverse it would leave no digit where there are plenty.
        """
        scale = rows[:, None] * columns
        scaled = scale * reference
        size = max(natural, float(np.abs(scaled).max(initial=0.0)))
        met = 2.0 * float(np.linalg.norm(scale * value - scaled)) / self.unit
        return Factor(scaled, min(size * condition, max(size, met)))


def condition(A: Floats) -> float:
    """Return the condition number of a symmetric positive definite matrix with its diagonal scaled to one."""
    if not A.size:
        return 1.0
    diagonal = np.diag(A)
    if not (diagonal > 0.0).all():
        return np.inf
    scale = 1.0 / np.sqrt(diagonal)
    eigenvalues = np.linalg.eigvalsh(A * np.outer(scale, scale))
    return float(eigenvalues[-1] / eigenvalues[0]) if eigenvalues[0] > 0.0 else np.inf

"""Agreement of recursion and oracle: one table of quantities, their equations, and how far both are apart.

**Error.** Metres and radians, kilograms and their squares do not add up, so both sides are brought to one scale first:
a force on coordinate i is divided by √H_ii, a velocity multiplied by it, and at the points √(Γ_e⁻¹)_ii takes the place
of 1/√H_ii. The error is the largest difference over the largest element; a quantity that happens to be small is
measured against a thousandth of its natural size instead (1 for what is inertia or Jacobian in that scale).

**Bound.** nv · FACTOR · ε · κ: machine epsilon, times the condition numbers of what is inverted on the way (each of
the matrix with unit diagonal, so that units do not count), times a small factor and the number of coordinates summed.
A state whose bound passes `UNDECIDED` leaves too few digits to tell agreement from chance: it cannot vouch for the
quantity, and the row says how many states could.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from ospace.dynamics.dense import Dense, solve
from ospace.dynamics.free_floating import FreeFloating, free_floating
from ospace.dynamics.generalized_jacobian import GeneralizedJacobian, generalized_jacobian
from ospace.dynamics.joint_space import (
    GeneralizedDynamics,
    JointSpaceDynamics,
    generalized_dynamics,
    inverse_dynamics,
    joint_space_dynamics,
    momentum,
)
from ospace.dynamics.operational_space import OperationalSpace, operational_space
from ospace.dynamics.ranges import RangeInverse, inverse_on_range
from ospace.kernels import composite
from ospace.kernels.tables import Floats
from ospace.points import OperationalPoint
from ospace.state import State

FACTOR = 16.0
UNDECIDED = 1e-4
SMALL = 1e-3

Verdict = Literal["agrees", "differs", "undecided"]


class Comparison(NamedTuple):
    """Both sides of one quantity in one state, the scales of rows and columns, and what conditions it."""

    value: Floats
    reference: Floats
    rows: Floats | float = 1.0
    columns: Floats | float = 1.0
    condition: float = 1.0
    floor: float = 1e-3
    """Scaled size below which the quantity counts as that large."""

    @property
    def error(self) -> float:
        """The scaled difference over the scaled size."""
        if not self.reference.size:
            return 0.0
        rows = np.asarray(self.rows)[..., None] if self.reference.ndim == 2 else np.asarray(self.rows)
        scale = rows * np.asarray(self.columns)
        size = np.abs(scale * self.reference).max()
        return float(np.abs(scale * (self.value - self.reference)).max() / max(size, self.floor))


@dataclass(frozen=True)
class Agreement:
    """One row of the table, over all states.

    Attributes
    ----------
    quantity, equation, computed_by, checked_against : str
    error, bound : float
        Of the state in which the error is the largest part of its bound.
    telling, states : int
        How many states could tell agreement from chance, of how many.
    """

    quantity: str
    equation: str
    computed_by: str
    checked_against: str
    error: float
    bound: float
    telling: int
    states: int

    @property
    def verdict(self) -> Verdict:
        """Return "differs" where the error passes the bound, "undecided" where no state could tell."""
        if not self.error <= self.bound:
            return "differs"
        return "agrees" if self.telling else "undecided"


class Sample:
    """One state with random loads: results of the recursions beside the dense forms, each computed once."""

    def __init__(self, state: State, points: Sequence[OperationalPoint], rng: np.random.Generator) -> None:
        self.state, self.points = state, tuple(points)
        self.dense = Dense(state, self.points)
        self.load = rng.normal(size=state.robot.nv) * self.velocity_scale
        self.F_e = rng.normal(size=len(self.dense.J_e)) * self.point_scale

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
    def operational(self) -> OperationalSpace:
        return operational_space(self.state, self.points)

    @cached_property
    def floating(self) -> FreeFloating:
        return free_floating(self.state, self.points)

    @cached_property
    def inverted(self) -> OperationalSpace:
        return operational_space(self.state, self.points, "inverted")

    @cached_property
    def each_point(self) -> list[Sample]:
        """The same state with each point alone."""
        return [Sample(self.state, [point], np.random.default_rng(0)) for point in self.points]

    # -- scales and conditions -------------------------------------------------------------------------------

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
    def lever(self) -> float:
        """The most by which terms that cancel exceed what is left of them at a joint: long arms, small last links.

        Inertias stand about the base, so a link's own small inertia about its joint is the difference of terms of
        its mass times its distance squared.
        """
        IC = composite.composite_inertia(self.state.robot.links, self.state.tree)[0]
        terms = np.abs(self.state.tree.S) * np.sqrt(IC[:, [0, 2, 5, 9, 14, 20]])
        return float((terms[1:].sum(axis=1) ** 2 / np.diag(self.dense.H)[6:]).max(initial=1.0))

    @cached_property
    def condition_H_b(self) -> float:
        return condition(self.dense.H[:6, :6])

    @cached_property
    def condition_H(self) -> float:
        return condition(self.dense.H) + self.lever

    @cached_property
    def Gamma_e(self) -> RangeInverse:
        J_e, mobility = self.dense.J_e, np.diag(self.dense.Gamma_e_inv)
        return inverse_on_range(self.dense.Gamma_e_inv, J_e, mobility, np.diag(self.dense.H))

    @cached_property
    def Lambda(self) -> RangeInverse:
        mobility, inertia = np.diag(self.dense.Gamma_e_inv), np.diag(self.dense.H_m_star)
        return inverse_on_range(self.dense.Lambda_inv, self.dense.J_m_star, mobility, inertia)

    @cached_property
    def condition_Gamma(self) -> float:
        return self._condition_of_inverse(self.dense.Gamma_e_inv, self.Gamma_e.rank)

    @cached_property
    def condition_Lambda(self) -> float:
        return self._condition_of_inverse(self.dense.Lambda_inv, self.Lambda.rank)

    def _condition_of_inverse(self, A: Floats, rank: int) -> float:
        """Condition of A⁻¹ = (J H⁻¹ Jᵀ)⁻¹ on its range: of `A`, scaled at full rank, else as it stands, times that of H."""
        if not rank:
            return 1.0
        full = rank == len(A)
        eigenvalues = np.linalg.eigvalsh(A * np.outer(self.point_scale, self.point_scale) if full else A)
        of_range = float(max(eigenvalues[-1], 1.0 if full else 0.0) / abs(eigenvalues[len(A) - rank]))
        return condition(self.dense.H) * of_range + self.lever


Compare = Callable[[Sample], Comparison]


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


# -- the rows of the table: each returns both sides and what scales and conditions them -------------------------


def link_velocities(s: Sample) -> Comparison:
    robot, tree = s.state.robot, s.state.tree
    at = s.state.placements[1:, 9:]
    v = tree.v[robot.link_of_joint[1:]]
    linear = v[:, :3] + np.cross(v[:, 3:], at) + s.state.base_twist[:3]
    value = np.hstack([linear, v[:, 3:]])
    return Comparison(value, s.dense.link_velocities, floor=SMALL * float(np.abs(s.dense.velocity).max()))


def momentum_(s: Sample) -> Comparison:
    natural = float(np.linalg.norm(s.velocity_scale * s.dense.velocity))
    return Comparison(momentum(s.state), s.dense.M_0, s.force_scale[:6], floor=SMALL * natural)


def base_inertia(s: Sample) -> Comparison:
    scale = s.force_scale[:6]
    return Comparison(s.joint_space.base_inertia, s.dense.H[:6, :6], scale, scale)


def coupling_inertia(s: Sample) -> Comparison:
    return Comparison(s.joint_space.coupling_inertia, s.dense.H[:6, 6:], s.force_scale[:6], s.force_scale[6:])


def manipulator_inertia(s: Sample) -> Comparison:
    scale = s.force_scale[6:]
    return Comparison(s.joint_space.manipulator_inertia, s.dense.H[6:, 6:], scale, scale, s.lever)


def base_bias(s: Sample) -> Comparison:
    return Comparison(s.joint_space.base_bias, s.dense.c[:6], s.force_scale[:6], floor=SMALL * s.speed)


def manipulator_bias(s: Sample) -> Comparison:
    scale = s.force_scale[6:]
    return Comparison(s.joint_space.manipulator_bias, s.dense.c[6:], scale, 1.0, s.lever, SMALL * s.speed)


def base_generalized_jacobian(s: Sample) -> Comparison:
    value = s.jacobians.base_generalized_jacobian
    return Comparison(value, s.dense.J_b_star, s.velocity_scale[:6], s.force_scale[6:], s.condition_H_b)


def generalized_jacobian_(s: Sample) -> Comparison:
    value = s.jacobians.generalized_jacobian
    return Comparison(value, s.dense.J_m_star, s.point_scale, s.force_scale[6:], s.condition_H_b)


def base_velocity(s: Sample) -> Comparison:
    value = s.jacobians.base_generalized_jacobian @ s.state.v[6:] + s.jacobians.base_momentum_velocity
    natural = float(np.linalg.norm(s.velocity_scale * s.dense.velocity))
    return Comparison(value, s.dense.velocity[:6], s.velocity_scale[:6], 1.0, s.condition_H_b, SMALL * natural)


def point_velocity(s: Sample) -> Comparison:
    value = s.jacobians.generalized_jacobian @ s.state.v[6:] + s.jacobians.momentum_velocity
    natural = float(np.linalg.norm(s.velocity_scale * s.dense.velocity))
    return Comparison(value, s.dense.J_e @ s.dense.velocity, s.point_scale, 1.0, s.condition_H_b, SMALL * natural)


def generalized_inertia(s: Sample) -> Comparison:
    scale = s.force_scale[6:]
    condition = s.condition_H_b + s.lever
    return Comparison(s.generalized.generalized_inertia, s.dense.H_m_star, scale, scale, condition)


def generalized_inertia_inverse(s: Sample) -> Comparison:
    n, scale = s.state.robot.n_joints, s.velocity_scale[6:]
    value = solve(s.generalized.generalized_inertia, np.eye(n)) if n else np.empty((0, 0))
    return Comparison(value, s.dense.H_inv[6:, 6:], scale, scale, s.condition_H)


def generalized_bias(s: Sample) -> Comparison:
    value = s.generalized.generalized_bias
    condition = s.condition_H_b + s.lever
    return Comparison(value, s.dense.c_m_star, s.force_scale[6:], 1.0, condition, SMALL * s.speed)


def jacobian(s: Sample) -> Comparison:
    return Comparison(s.operational.jacobian, s.dense.J_e, s.point_scale, s.force_scale)


def inertia_inverse(s: Sample) -> Comparison:
    scale = s.point_scale
    return Comparison(s.operational.inertia_inverse, s.dense.Gamma_e_inv, scale, scale, s.condition_H)


def inertia_inverse_by_minverse(s: Sample) -> Comparison:
    reference = s.dense.J_e @ s.dense.H_inv @ s.dense.J_e.T
    return Comparison(s.operational.inertia_inverse, reference, s.point_scale, s.point_scale, s.condition_H)


def inertia(s: Sample) -> Comparison:
    reference = s.Gamma_e.inverse
    scale = 1.0 / s.point_scale
    return Comparison(s.operational.inertia, reference, scale, scale, s.condition_Gamma)


def bias_acceleration(s: Sample) -> Comparison:
    value = s.operational.bias_acceleration
    return Comparison(value, s.dense.mu, s.point_scale, 1.0, s.condition_H, SMALL * s.speed)


def bias_force(s: Sample) -> Comparison:
    Gamma = s.Gamma_e.inverse
    J_e_plus = s.dense.response @ Gamma
    reference = J_e_plus.T @ s.dense.c - Gamma @ s.dense.drift
    return Comparison(s.operational.bias_force, reference, 1.0 / s.point_scale, 1.0, s.condition_Gamma, SMALL * s.speed)


def dynamically_consistent_inverse(s: Sample) -> Comparison:
    reference = s.dense.response @ s.Gamma_e.inverse
    value = s.operational.dynamically_consistent_inverse
    return Comparison(value, reference, s.velocity_scale, 1.0 / s.point_scale, s.condition_Gamma)


def null_space_projector(s: Sample) -> Comparison:
    Gamma = s.Gamma_e.inverse
    reference = np.eye(s.state.robot.nv) - s.dense.response @ Gamma @ s.dense.J_e
    value = s.operational.null_space_projector
    return Comparison(value, reference, s.velocity_scale, s.force_scale, s.condition_Gamma, 1.0)


def _worst_point(s: Sample, compare: Compare) -> Comparison:
    """Compare at each point by itself."""
    return max((compare(alone) for alone in s.each_point), key=lambda one: one.error / one.condition)


def inverted_inertia(s: Sample) -> Comparison:
    def at(one: Sample) -> Comparison:
        scale = 1.0 / one.point_scale
        return Comparison(one.inverted.inertia, one.Gamma_e.inverse, scale, scale, one.condition_Gamma)

    return _worst_point(s, at)


def inverted_bias_force(s: Sample) -> Comparison:
    def at(one: Sample) -> Comparison:
        reference = one.Gamma_e.inverse @ one.dense.mu
        value, scale = one.inverted.bias_force, 1.0 / one.point_scale
        return Comparison(value, reference, scale, 1.0, one.condition_Gamma, SMALL * s.speed)

    return _worst_point(s, at)


def floating_inertia_inverse(s: Sample) -> Comparison:
    scale = s.point_scale
    return Comparison(s.floating.floating_inertia_inverse, s.dense.Lambda_inv, scale, scale, s.condition_H)


def base_inertia_inverse(s: Sample) -> Comparison:
    scale = s.point_scale
    return Comparison(s.floating.base_inertia_inverse, s.dense.Lambda_b_inv, scale, scale, s.condition_H_b)


def floating_inertia(s: Sample) -> Comparison:
    reference = s.Lambda.inverse
    scale = 1.0 / s.point_scale
    return Comparison(s.floating.floating_inertia, reference, scale, scale, s.condition_Lambda)


def floating_bias(s: Sample) -> Comparison:
    value = s.floating.bias_acceleration
    return Comparison(value, s.dense.mu, s.point_scale, 1.0, s.condition_H, SMALL * s.speed)


def torque_map(s: Sample) -> Comparison:
    return Comparison(s.floating.torque_map, s.dense.torque_map, s.point_scale, s.velocity_scale[6:], s.condition_H)


def floating_consistent_inverse(s: Sample) -> Comparison:
    Lambda = s.Lambda.inverse
    reference = s.dense.torque_map.T @ Lambda
    value = s.floating.dynamically_consistent_inverse
    return Comparison(value, reference, s.velocity_scale[6:], 1.0 / s.point_scale, s.condition_Lambda)


def inertias_add_up(s: Sample) -> Comparison:
    value = s.floating.floating_inertia_inverse + s.floating.base_inertia_inverse
    return Comparison(value, s.operational.inertia_inverse, s.point_scale, s.point_scale, s.condition_H)


def biases_agree(s: Sample) -> Comparison:
    value = s.operational.inertia @ s.floating.bias_acceleration
    reference = s.operational.bias_force
    return Comparison(value, reference, 1.0 / s.point_scale, 1.0, s.condition_Gamma, SMALL * s.speed)


def motion_under_load(s: Sample) -> Comparison:
    now = s.operational
    value = now.response.T @ s.load + now.inertia_inverse @ s.F_e - now.bias_acceleration
    reference, _ = s.dense.accelerations_under(s.load, s.F_e)
    return Comparison(value, reference, s.point_scale, 1.0, s.condition_H, SMALL * s.speed)


def floating_motion_under_load(s: Sample) -> Comparison:
    load = np.r_[np.zeros(6), s.load[6:]]
    Gamma_inv = s.floating.floating_inertia_inverse + s.floating.base_inertia_inverse
    value = s.floating.torque_map @ load[6:] + Gamma_inv @ s.F_e - s.floating.bias_acceleration
    reference, _ = s.dense.accelerations_under(load, s.F_e)
    return Comparison(value, reference, s.point_scale, 1.0, s.condition_H, SMALL * s.speed)


def momentum_rate(s: Sample) -> Comparison:
    _, acceleration = s.dense.accelerations_under(s.load, s.F_e)
    v_b, P = s.state.base_twist[:3], s.dense.M_0[:3]
    moving = np.r_[np.zeros(3), np.cross(v_b, P)]
    value = inverse_dynamics(s.state, acceleration)[:6] - moving
    applied = s.load[:6].copy()
    for point, wrench in zip(s.points, s.dense.wrenches(s.F_e), strict=True):
        arm = s.state.placement_about_base(point).translation
        applied += np.r_[wrench[:3], wrench[3:] + np.cross(arm, wrench[:3])]
    natural = float(np.linalg.norm(s.velocity_scale * acceleration))
    return Comparison(value, applied - moving, s.force_scale[:6], 1.0, s.condition_H, SMALL * natural)


CRBA, RNEA, MINVERSE, ABA = "pin.crba", "pin.rnea", "pin.computeMinverse", "pin.aba"
TABLE: tuple[tuple[str, str, str, str, Compare], ...] = (
    ("link velocities v_i", "16", "outward recursion", "pin.forwardKinematics", link_velocities),
    ("momentum M_0", "1, 20, 25", "sum over links", "pin.computeCentroidalMomentum", momentum_),
    ("base inertia H_b", "21", "composite bodies", CRBA, base_inertia),
    ("coupling inertia H_bm", "21", "composite bodies", CRBA, coupling_inertia),
    ("manipulator inertia H_m", "21", "composite bodies", CRBA, manipulator_inertia),
    ("base bias c_b", "17-19", "composite forces", RNEA, base_bias),
    ("manipulator bias c_m", "17-19", "composite forces", RNEA, manipulator_bias),
    ("base generalized Jacobian J_b*", "3, 27, 28", "composite bodies", CRBA, base_generalized_jacobian),
    ("generalized Jacobian J_m*", "5, 29-31", "composite bodies", "crba, Jacobians", generalized_jacobian_),
    ("base velocity", "2, 26", "J_b* and momentum", "base twist", base_velocity),
    ("point velocity", "4", "J_m* and momentum", "Jacobians", point_velocity),
    ("generalized inertia H_m*", "7", "composite bodies", CRBA, generalized_inertia),
    ("its inverse", "7", "composite bodies", MINVERSE, generalized_inertia_inverse),
    ("generalized bias c_m*", "7", "composite forces", "crba, rnea", generalized_bias),
    ("point Jacobian J_e", "16, 29", "outward recursion", "Jacobians", jacobian),
    ("inertia of each point", "33, 34", "inverted chain", "dense (9)", inverted_inertia),
    ("bias force of each point", "35, 36", "inverted chain", "dense (10)", inverted_bias_force),
    ("inverse inertia, all blocks", "37-41", "forward chain", "crba, Jacobians (9)", inertia_inverse),
    ("inverse inertia, all blocks", "37-41", "forward chain", MINVERSE, inertia_inverse_by_minverse),
    ("operational inertia", "§6.2 step 5", "forward chain", "dense (9)", inertia),
    ("bias acceleration", "42-44", "forward chain", "crba, rnea, drift", bias_acceleration),
    ("bias force", "45", "forward chain", "dense (10)", bias_force),
    ("dynamically consistent inverse J_e+", "11", "response sweep", CRBA, dynamically_consistent_inverse),
    ("null-space projector 1 - J_e+ J_e", "11", "response sweep", CRBA, null_space_projector),
    ("floating inverse inertia", "12", "response sweep", "crba, Jacobians", floating_inertia_inverse),
    ("base inverse inertia", "12", "composite bodies", "crba, Jacobians", base_inertia_inverse),
    ("floating inertia", "12", "response sweep", "crba, Jacobians", floating_inertia),
    ("floating bias acceleration", "12", "composite forces", "crba, rnea, drift", floating_bias),
    ("torque map J_m* H_m*^-1", "12", "response sweep", "crba, Jacobians", torque_map),
    ("dynamically consistent inverse J_m*+", "13", "response sweep", "crba, Jacobians", floating_consistent_inverse),
    ("floating + base = operational", "12", "response, composite", "forward chain", inertias_add_up),
    ("inertia x floating bias = bias force", "12", "composite forces", "forward chain", biases_agree),
    ("motion under forces, free-flying", "8", "forward chain", ABA, motion_under_load),
    ("motion under forces, free-floating", "12", "response, composite", ABA, floating_motion_under_load),
    ("rate of momentum", "6, 20", "composite forces", "applied wrenches", momentum_rate),
)


class AgreementTable:
    """Collects the rows of the table over states: call `add` for each, then `rows`."""

    def __init__(self) -> None:
        self._seen: list[list[tuple[float, float]]] = [[] for _ in TABLE]

    def add(self, sample: Sample) -> None:
        """Compare every quantity in one more state."""
        unit = sample.state.robot.nv * FACTOR * float(np.finfo(float).eps)
        for seen, (*_, compare) in zip(self._seen, TABLE, strict=True):
            compared = compare(sample)
            seen.append((compared.error, unit * compared.condition))

    def rows(self) -> list[Agreement]:
        """Return the table."""
        return [summary(*texts, seen) for (*texts, _), seen in zip(TABLE, self._seen, strict=True)]


def summary(
    quantity: str, equation: str, computed_by: str, checked_against: str, seen: Sequence[tuple[float, float]]
) -> Agreement:
    """Sum up (error, bound) of every state in one row: the worst of those that can tell, or that differ all the same."""
    telling = [(error, bound) for error, bound in seen if bound <= UNDECIDED or not error <= bound]
    error, bound = max(telling or seen, key=lambda one: (not one[0] <= one[1], one[0] / one[1] if one[1] else 0.0))
    return Agreement(quantity, equation, computed_by, checked_against, error, bound, len(telling), len(seen))

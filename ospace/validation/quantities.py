"""The rows of the agreement table: each function returns both sides of one quantity, its scales and its condition."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np

from ospace import analysis
from ospace.dynamics.dense import solve
from ospace.dynamics.joint_space import inverse_dynamics
from ospace.kernels.tree import Floats
from ospace.validation.perturbation import Factor
from ospace.validation.sample import Sample


class Comparison(NamedTuple):
    """Both sides of one quantity in one state, the scales of rows and columns, and what conditions it."""

    value: Floats
    reference: Floats
    rows: Floats | float = 1.0
    columns: Floats | float = 1.0
    condition: float = 1.0
    natural: float = 1.0
    """Scaled size of the terms that the quantity is made of; it counts as no smaller."""

    @property
    def error(self) -> float:
        """The scaled difference over the scaled size."""
        return float(np.abs(self._scale * (self.value - self.reference)).max(initial=0.0) / self.size)

    @property
    def size(self) -> float:
        """The scaled size of the reference, or its natural one."""
        return float(np.abs(self._scale * self.reference).max(initial=self.natural))

    @property
    def _scale(self) -> Floats:
        rows = np.asarray(self.rows)[..., None] if self.reference.ndim == 2 else np.asarray(self.rows)
        return np.asarray(rows * np.asarray(self.columns))

    def off_by(self, units: float) -> Comparison:
        """Return the comparison of a scaled quantity that may be off by so many units of rounding."""
        return self._replace(condition=max(1.0, units / self.size))


Compare = Callable[[Sample, Any], Comparison]


class ComparedQuantity(NamedTuple):
    """One row of the table."""

    name: str
    equation: str
    computed_by: str
    checked_against: str
    compare: Callable[[Sample], Comparison]
    in_batch: bool = False
    """Whether it takes results of the batch, which there are for some states only."""

    def coupled(self) -> ComparedQuantity | None:
        """Return the row for a robot whose joints mimic others; None for what does not know these.

        There the composite bodies stand in for PV-OSIMr, and Pinocchio's crba and rnea for its aba.
        """
        if self.computed_by.endswith("chain") or self.checked_against == "pin.computeMinverse":
            return None
        by = self.computed_by.replace("PV-OSIMr and bodies", "coupled bodies").replace("PV-OSIMr", "coupled bodies")
        against = self.checked_against.replace("pin.aba", "crba, rnea").replace("PV-OSIMr", "coupled bodies")
        return self._replace(computed_by=by, checked_against=against)


class Way(NamedTuple):
    """A way in to a quantity: the algorithm with what runs it, and its results of a sample."""

    computed_by: str
    results: Callable[[Sample], Any] = lambda s: s
    in_batch: bool = False


def _ways(algorithm: str, state: str = "", evaluator: bool = True, batch: bool = True) -> list[Way]:
    """Return the ways in to an algorithm: a state, with the results that the sample has by that name; and others."""
    ways = [Way(f"{algorithm}, state", attrgetter(state) if state else lambda s: s)]
    ways += [Way(f"{algorithm}, evaluator", attrgetter("evaluator"))] * evaluator
    return ways + [Way(f"{algorithm}, batch", attrgetter("batch"), in_batch=True)] * batch


_BODIES = "composite bodies"
_FORWARD = [Way("forward chain", attrgetter("forward"))]
_OPERATIONAL = _ways("PV-OSIMr", "operational") + _FORWARD
_RESPONSE = _ways("PV-OSIMr", "operational", batch=False) + _FORWARD

TABLE: list[ComparedQuantity] = []

PIN_DERIVATIVES = "Pinocchio's derivatives"
"""What rates are checked against, of robots whose joints Pinocchio has right derivatives of."""


def quantity(name: str, equation: str, ways: str | Sequence[Way], checked_against: str) -> Callable[[Compare], Compare]:
    """Make a function rows of the table: one for each way in, called with a sample and the results of that way.

    A way in by its name alone takes the results that it needs from the sample.
    """

    def add(compare: Compare) -> Compare:
        for way in [Way(ways)] if isinstance(ways, str) else ways:
            compare_so = partial(_compare, compare, way.results)
            TABLE.append(ComparedQuantity(name, equation, way.computed_by, checked_against, compare_so, way.in_batch))
        return compare

    return add


def _compare(compare: Compare, results: Callable[[Sample], Any], sample: Sample) -> Comparison:
    return compare(sample, results(sample))


@quantity("link velocities v_i", "16", "kinematics, state", "pin.forwardKinematics")
def link_velocities(s: Sample, by: Any) -> Comparison:
    v = s.state.table("v")[s.state.robot.link_of_joint[1:]]
    linear = v[:, :3] + s.state.base_twist[:3]
    value = np.hstack([linear, v[:, 3:]])
    return Comparison(value, s.dense.link_velocities, natural=float(np.abs(s.dense.velocity).max()))


@quantity("momentum M_0", "1, 20, 25", _ways(_BODIES), "pin.computeCentroidalMomentum")
def momentum_(s: Sample, by: Any) -> Comparison:
    natural = float(np.linalg.norm(s.velocity_scale * s.dense.velocity))
    return Comparison(by.momentum, s.dense.M_0, s.force_scale[:6], natural=natural)


@quantity("base inertia H_b", "21", f"{_BODIES}, state", "pin.crba")
def base_inertia(s: Sample, by: Any) -> Comparison:
    scale = s.force_scale[:6]
    return Comparison(s.joint_space.base_inertia, s.dense.H[:6, :6], scale, scale)


@quantity("coupling inertia H_bm", "21", f"{_BODIES}, state", "pin.crba")
def coupling_inertia(s: Sample, by: Any) -> Comparison:
    rows, columns = s.force_scale[:6], s.force_scale[6:]
    return Comparison(s.joint_space.coupling_inertia, s.dense.H[:6, 6:], rows, columns, s.reach)


@quantity("manipulator inertia H_m", "21", f"{_BODIES}, state", "pin.crba")
def manipulator_inertia(s: Sample, by: Any) -> Comparison:
    scale = s.force_scale[6:]
    return Comparison(s.joint_space.manipulator_inertia, s.dense.H[6:, 6:], scale, scale, s.lever)


@quantity("base bias c_b", "17-19", f"{_BODIES}, state", "pin.rnea")
def base_bias(s: Sample, by: Any) -> Comparison:
    return Comparison(s.joint_space.base_bias, s.dense.c[:6], s.force_scale[:6], natural=s.speed)


@quantity("manipulator bias c_m", "17-19", f"{_BODIES}, state", "pin.rnea")
def manipulator_bias(s: Sample, by: Any) -> Comparison:
    scale = s.force_scale[6:]
    return Comparison(s.joint_space.manipulator_bias, s.dense.c[6:], scale, 1.0, s.lever, s.speed)


@quantity("base generalized Jacobian J_b*", "3, 27, 28", _ways(_BODIES, "jacobians", evaluator=False), "pin.crba")
def base_generalized_jacobian(s: Sample, by: Any) -> Comparison:
    value = by.base_generalized_jacobian
    condition = s.condition_H_b * s.reach
    return Comparison(value, s.dense.J_b_star, s.velocity_scale[:6], s.force_scale[6:], condition)


@quantity("generalized Jacobian J_m*", "5, 29-31", _ways(_BODIES, "jacobians"), "crba, Jacobians")
def generalized_jacobian_(s: Sample, by: Any) -> Comparison:
    value = by.generalized_jacobian
    condition = s.condition_H_b * (s.reach + s.point_lever**0.5)
    return Comparison(value, s.dense.J_m_star, s.point_scale, s.force_scale[6:], condition)


@quantity("singular values of J_m*", "5", _ways(_BODIES)[2:], "crba, Jacobians, SVD")
def singular_values(s: Sample, by: Any) -> Comparison:
    return _singular(s, by.singular_values, np.asarray(np.linalg.svd(s.dense.J_m_star, compute_uv=False)))


@quantity("smallest singular value of J_m*", "5", _ways(_BODIES)[2:], "crba, Jacobians, SVD")
def smallest_singular_value(s: Sample, by: Any) -> Comparison:
    smallest = np.asarray(np.linalg.svd(s.dense.J_m_star, compute_uv=False)[-1:])
    return _singular(s, np.full_like(smallest, by.smallest_singular_value), smallest)


def _singular(s: Sample, value: Floats, reference: Floats) -> Comparison:
    """Compare in plain units: they are off as the elements of J_m* are, by a share of the largest."""
    scale = np.outer(s.point_scale, s.force_scale[6:])
    natural = float(np.abs(scale * s.dense.J_m_star).max(initial=1.0) * np.linalg.norm(1.0 / scale))
    condition = s.condition_H_b * (s.reach + s.point_lever**0.5)
    return Comparison(value, reference, condition=condition, natural=natural or 1.0)


@quantity("centre of mass", "20", _ways(_BODIES)[2:], "pin.centerOfMass")
def centre_of_mass(s: Sample, by: Any) -> Comparison:
    """Compare by the distance from the origin, of which the last digits are rounded, and the size of the robot."""
    reference = s.dense.centre_of_mass
    return Comparison(by.centre_of_mass, reference, natural=max(1.0, float(np.abs(reference).max())))


@quantity("placements of the points", "14", _ways("kinematics")[2:], "pin.forwardKinematics")
def placements(s: Sample, by: Any) -> Comparison:
    """Compare positions as the centre of mass, and quaternions of the same sign."""
    reference, value = s.dense.placements, np.array(by.placement)
    value[:, 3:] *= np.sign((value[:, 3:] * reference[:, 3:]).sum(axis=1))[:, None]
    size = max(1.0, float(np.abs(reference[:, :3]).max()))
    return Comparison(value, reference, 1.0, np.r_[np.full(3, 1.0 / size), np.ones(4)], s.reach)


@quantity("base velocity", "2, 26", f"{_BODIES}, state", "base twist")
def base_velocity(s: Sample, by: Any) -> Comparison:
    value = s.jacobians.base_generalized_jacobian @ s.state.v[6:] + s.jacobians.base_momentum_velocity
    natural = float(np.linalg.norm(s.velocity_scale * s.dense.velocity))
    return Comparison(value, s.dense.velocity[:6], s.velocity_scale[:6], 1.0, s.condition_H_b, natural)


@quantity("point velocity", "4", f"{_BODIES}, state", "Jacobians")
def point_velocity(s: Sample, by: Any) -> Comparison:
    value = s.jacobians.generalized_jacobian @ s.state.v[6:] + s.jacobians.momentum_velocity
    natural = float(np.linalg.norm(s.velocity_scale * s.dense.velocity))
    return Comparison(
        value, s.dense.J_e @ s.dense.velocity, s.point_scale, 1.0, s.condition_H_b * s.point_lever**0.5, natural
    )


@quantity("generalized inertia H_m*", "7", _ways(_BODIES, "generalized"), "pin.crba")
def generalized_inertia(s: Sample, by: Any) -> Comparison:
    scale = s.force_scale[6:]
    condition = s.condition_H_b + s.lever
    return Comparison(by.generalized_inertia, s.dense.H_m_star, scale, scale, condition)


@quantity("its inverse", "7", f"{_BODIES}, state", "pin.computeMinverse")
def generalized_inertia_inverse(s: Sample, by: Any) -> Comparison:
    n, scale = s.state.robot.n_joints, s.velocity_scale[6:]
    value = solve(s.generalized.generalized_inertia, np.eye(n)) if n else np.empty((0, 0))
    return Comparison(value, s.dense.H_inv[6:, 6:], scale, scale, s.condition_minverse)


@quantity("generalized bias c_m*", "7", _ways(_BODIES, "generalized", batch=False), "crba, rnea")
def generalized_bias(s: Sample, by: Any) -> Comparison:
    value = by.generalized_bias
    condition = s.condition_H_b + s.lever
    return Comparison(value, s.dense.c_m_star, s.force_scale[6:], 1.0, condition, s.speed)


@quantity("point Jacobian J_e", "16, 29", _ways("kinematics", "operational", batch=False), "Jacobians")
def jacobian(s: Sample, by: Any) -> Comparison:
    return Comparison(by.jacobian, s.dense.J_e, s.point_scale, s.force_scale, s.reach + s.point_lever**0.5)


@quantity("inverse inertia, all blocks", "37-41", _OPERATIONAL, "crba, Jacobians (9)")
def inertia_inverse(s: Sample, by: Any) -> Comparison:
    scale = s.point_scale
    return Comparison(by.inertia_inverse, s.dense.Gamma_e_inv, scale, scale, s.condition_mobility)


@quantity("inverse inertia, lower rows", "37-41", _ways("PV-OSIMr")[2:], "crba, Jacobians (9)")
def inertia_inverse_packed(s: Sample, by: Any) -> Comparison:
    lower = np.tril_indices(len(s.dense.Gamma_e_inv))
    scale = np.outer(s.point_scale, s.point_scale)[lower]
    return Comparison(by.inertia_inverse_packed, s.dense.Gamma_e_inv[lower], scale, condition=s.condition_mobility)


@quantity("inverse inertia, all blocks", "37-41", "PV-OSIMr, state", "pin.computeMinverse")
def inertia_inverse_by_minverse(s: Sample, by: Any) -> Comparison:
    reference = s.dense.J_e @ s.dense.H_inv @ s.dense.J_e.T
    condition = s.condition_minverse + s.point_lever
    return Comparison(s.operational.inertia_inverse, reference, s.point_scale, s.point_scale, condition)


@quantity("operational inertia", "§6.2 step 5", _OPERATIONAL, "dense (9)")
def inertia(s: Sample, by: Any) -> Comparison:
    reference = s.dense.Gamma_e
    scale = 1.0 / s.point_scale
    return Comparison(by.inertia, reference, scale, scale).off_by(s.Gamma(by).of())


@quantity("bias acceleration", "42-44", _OPERATIONAL, "crba, rnea, drift")
def bias_acceleration(s: Sample, by: Any) -> Comparison:
    value = by.bias_acceleration
    return Comparison(value, s.dense.mu, s.point_scale, 1.0, s.condition_mobility, s.speed)


def _bias(s: Sample, value: Floats) -> Factor:
    return s.factor(value[:, None], s.dense.mu[:, None], s.point_scale, 1.0, s.condition_mobility, s.speed)


@quantity("bias force", "45", _OPERATIONAL, "dense (10)")
def bias_force(s: Sample, by: Any) -> Comparison:
    Gamma = s.dense.Gamma_e
    J_e_plus = s.dense.response @ Gamma
    reference = J_e_plus.T @ s.dense.c - Gamma @ s.dense.drift
    off = s.Gamma(by).of(right=_bias(s, by.bias_acceleration))
    return Comparison(by.bias_force, reference, 1.0 / s.point_scale, natural=s.speed).off_by(off)


@quantity("response H^-1 J_e^T", "38-43", _RESPONSE, "crba, Jacobians")
def response(s: Sample, by: Any) -> Comparison:
    return Comparison(by.response, s.dense.response, s.velocity_scale, s.point_scale, s.condition_mobility)


@quantity("dynamically consistent inverse J_e+", "11", _RESPONSE, "pin.crba")
def dynamically_consistent_inverse(s: Sample, by: Any) -> Comparison:
    reference = s.dense.response @ s.dense.Gamma_e
    value = by.dynamically_consistent_inverse
    return Comparison(value, reference, s.velocity_scale, 1.0 / s.point_scale).off_by(s.Gamma(by).of(_response(s, by)))


def _response(s: Sample, by: Any) -> Factor:
    value, reference = by.response, s.dense.response
    return s.factor(value, reference, s.velocity_scale, s.point_scale, s.condition_mobility)


@quantity("null-space projector 1 - J_e+ J_e", "11", _RESPONSE, "pin.crba")
def null_space_projector(s: Sample, by: Any) -> Comparison:
    Gamma = s.dense.Gamma_e
    reference = np.eye(s.state.robot.nv) - s.dense.response @ Gamma @ s.dense.J_e
    value = by.null_space_projector
    condition = s.reach + s.point_lever**0.5
    J_e = s.factor(by.jacobian, s.dense.J_e, s.point_scale, s.force_scale, condition)
    return Comparison(value, reference, s.velocity_scale, s.force_scale).off_by(s.Gamma(by).of(_response(s, by), J_e))


def _worst_point(s: Sample, compare: Callable[[Sample], Comparison]) -> Comparison:
    """Compare at each point by itself: a point that differs, or else the one that is least certain."""
    compared = [compare(alone) for alone in s.each_point]
    return max(compared, key=lambda one: (not one.error <= s.unit * one.condition, one.condition))


def _lost_by_the_inverted_chain(s: Sample) -> float:
    """Return by what terms exceed what is left of them: the chain adds up inertias about the base, not mobilities."""
    return s.lever + s.point_lever


@quantity("inertia of each point", "33, 34", "inverted chain", "dense (9)")
def inverted_inertia(s: Sample, by: Any) -> Comparison:
    def at(one: Sample) -> Comparison:
        scale = 1.0 / one.point_scale
        off = one.Gamma(one.operational).of(Factor(np.eye(len(scale)), _lost_by_the_inverted_chain(one)))
        return Comparison(one.inverted.inertia, one.dense.Gamma_e, scale, scale).off_by(off)

    return _worst_point(s, at)


@quantity("bias force of each point", "35, 36", "inverted chain", "dense (10)")
def inverted_bias_force(s: Sample, by: Any) -> Comparison:
    def at(one: Sample) -> Comparison:
        reference = one.dense.Gamma_e @ one.dense.mu
        mu = _bias(one, one.operational.bias_acceleration)
        size = max(one.speed, float(np.abs(mu.value).max()))
        off = one.Gamma(one.operational).of(right=mu._replace(off=mu.off + _lost_by_the_inverted_chain(one) * size))
        return Comparison(one.inverted.bias_force, reference, 1.0 / one.point_scale, natural=s.speed).off_by(off)

    return _worst_point(s, at)


@quantity("floating inverse inertia", "12", "PV-OSIMr, state", "crba, Jacobians")
def floating_inertia_inverse(s: Sample, by: Any) -> Comparison:
    scale = s.point_scale
    return Comparison(s.floating.floating_inertia_inverse, s.dense.Lambda_inv, scale, scale, s.condition_mobility)


@quantity("base inverse inertia", "12", f"{_BODIES}, state", "crba, Jacobians")
def base_inertia_inverse(s: Sample, by: Any) -> Comparison:
    scale = s.point_scale
    return Comparison(
        s.floating.base_inertia_inverse, s.dense.Lambda_b_inv, scale, scale, s.condition_H_b + s.point_lever
    )


@quantity("floating inertia", "12", "PV-OSIMr, state", "crba, Jacobians")
def floating_inertia(s: Sample, by: Any) -> Comparison:
    reference = s.dense.Lambda
    scale = 1.0 / s.point_scale
    return Comparison(s.floating.floating_inertia, reference, scale, scale).off_by(s.Lambda.of())


@quantity("floating bias acceleration", "12", f"{_BODIES}, state", "crba, rnea, drift")
def floating_bias(s: Sample, by: Any) -> Comparison:
    value = s.floating.bias_acceleration
    return Comparison(value, s.dense.mu, s.point_scale, 1.0, s.condition_mobility, s.speed)


@quantity("torque map J_m* H_m*^-1", "12", "PV-OSIMr, state", "crba, Jacobians")
def torque_map(s: Sample, by: Any) -> Comparison:
    return Comparison(
        s.floating.torque_map, s.dense.torque_map, s.point_scale, s.velocity_scale[6:], s.condition_mobility
    )


@quantity("dynamically consistent inverse J_m*+", "13", "PV-OSIMr, state", "crba, Jacobians")
def floating_consistent_inverse(s: Sample, by: Any) -> Comparison:
    Lambda = s.dense.Lambda
    reference = s.dense.torque_map.T @ Lambda
    value = s.floating.dynamically_consistent_inverse
    scale = s.velocity_scale[6:]
    response = s.factor(s.floating.torque_map.T, s.dense.torque_map.T, scale, s.point_scale, s.condition_mobility)
    return Comparison(value, reference, scale, 1.0 / s.point_scale).off_by(s.Lambda.of(response))


@quantity("floating + base = operational", "12", "PV-OSIMr and bodies, state", "PV-OSIMr")
def inertias_add_up(s: Sample, by: Any) -> Comparison:
    value = s.floating.floating_inertia_inverse + s.floating.base_inertia_inverse
    return Comparison(value, s.operational.inertia_inverse, s.point_scale, s.point_scale, s.condition_mobility)


@quantity("inertia x floating bias = bias force", "12", f"{_BODIES}, state", "PV-OSIMr")
def biases_agree(s: Sample, by: Any) -> Comparison:
    value = s.operational.inertia @ s.floating.bias_acceleration
    reference = s.operational.bias_force
    off = s.Gamma(s.operational).of(right=_bias(s, s.floating.bias_acceleration))
    return Comparison(value, reference, 1.0 / s.point_scale, natural=s.speed).off_by(off)


@quantity("motion under forces, free-flying", "8", "PV-OSIMr, state", "pin.aba")
def motion_under_load(s: Sample, by: Any) -> Comparison:
    now = s.operational
    value = now.response.T @ s.load + now.inertia_inverse @ s.F_e - now.bias_acceleration
    reference, _ = s.dense.accelerations_under(s.load, s.F_e)
    return Comparison(value, reference, s.point_scale, 1.0, s.condition_mobility, s.speed)


@quantity("motion under forces, free-floating", "12", "PV-OSIMr and bodies, state", "pin.aba")
def floating_motion_under_load(s: Sample, by: Any) -> Comparison:
    load = np.r_[np.zeros(6), s.load[6:]]
    Gamma_inv = s.floating.floating_inertia_inverse + s.floating.base_inertia_inverse
    value = s.floating.torque_map @ load[6:] + Gamma_inv @ s.F_e - s.floating.bias_acceleration
    reference, _ = s.dense.accelerations_under(load, s.F_e)
    return Comparison(value, reference, s.point_scale, 1.0, s.condition_mobility, s.speed)


@quantity("rate of momentum", "6, 20", f"{_BODIES}, state", "applied wrenches")
def momentum_rate(s: Sample, by: Any) -> Comparison:
    _, acceleration = s.dense.accelerations_under(s.load, s.F_e)
    v_b, P = s.state.base_twist[:3], s.dense.M_0[:3]
    moving = np.r_[np.zeros(3), np.cross(v_b, P)]
    value = inverse_dynamics(s.state, acceleration)[:6] - moving
    applied = s.load[:6].copy()
    for point, wrench in zip(s.points, s.dense.wrenches(s.F_e), strict=True):
        arm = s.state.placement_about_base(point).translation
        applied += np.r_[wrench[:3], wrench[3:] + np.cross(arm, wrench[:3])]
    natural = float(np.linalg.norm(s.velocity_scale * acceleration))
    return Comparison(value, applied - moving, s.force_scale[:6], 1.0, s.condition_H, natural)


@quantity("forces of a motion", "6, 17-19", f"{_BODIES}, state", "crba, rnea")
def forces_of_motion(s: Sample, by: Any) -> Comparison:
    _, acceleration = s.dense.accelerations_under(s.load, s.F_e)
    reference = s.dense.H @ acceleration + s.dense.c
    natural = s.speed + float(np.linalg.norm(s.velocity_scale * acceleration))
    return Comparison(inverse_dynamics(s.state, acceleration), reference, s.force_scale, 1.0, s.lever, natural)


@quantity("momentum of wheels K", "21", f"{_BODIES}, state", "pin.computeCentroidalMap")
def wheel_momentum(s: Sample, by: Any) -> Comparison:
    condition = s.condition_H_b * s.reach
    rows, columns = s.force_scale[3:6], s.force_scale[6:]
    return Comparison(analysis.wheel_momentum(s.state), s.dense.A_G[3:, 6:], rows, columns, condition)


@quantity("rate of J_m*", "5, 29-31", "tangent sweep, state", PIN_DERIVATIVES)
def generalized_jacobian_rate(s: Sample, by: Any) -> Comparison:
    value = analysis.generalized_jacobian_rate(s.state, s.points)
    condition = s.condition_H_b * (s.reach + s.point_lever**0.5)
    natural = _largest(s, s.rates.J_m_star_terms, s.force_scale[6:])
    return Comparison(value, s.rates.J_m_star_dot, s.point_scale, s.force_scale[6:], condition, natural)


@quantity("rate of the inverse inertia", "37-41", "tangent sweep, state", PIN_DERIVATIVES)
def inertia_inverse_rate(s: Sample, by: Any) -> Comparison:
    value = analysis.inertia_inverse_derivative(s.state, s.points, s.state.v)
    natural = _largest(s, s.rates.Gamma_e_inv_terms, s.point_scale)
    return Comparison(value, s.rates.Gamma_e_inv_dot, s.point_scale, s.point_scale, s.condition_mobility, natural)


@quantity("rate of the bias acceleration", "42-44", "tangent sweep, state", PIN_DERIVATIVES)
def bias_acceleration_rate(s: Sample, by: Any) -> Comparison:
    value = analysis.bias_acceleration_derivative(s.state, s.points, np.r_[s.state.v, s.state.v])
    natural = max(s.speed * s.fastest, _largest(s, s.rates.mu_terms, 1.0))
    return Comparison(value, s.rates.mu_dot, s.point_scale, 1.0, s.condition_mobility, natural)


def _largest(s: Sample, terms: Sequence[Floats], columns: Floats | float) -> float:
    """Return the scaled size of the largest of the terms that a rate is made of, or the fastest rate."""
    rows = s.point_scale if terms[0].ndim == 1 else s.point_scale[:, None]
    return max(s.fastest, *(float(np.abs(rows * term * columns).max(initial=0.0)) for term in terms))

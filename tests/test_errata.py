"""Errata of the paper in numbers: what is printed fails, the reading that ospace takes holds.

`Paper` computes the recursions without ospace's kernels, in the paper's own form: every link in its own frame, one
column a joint, NumPy matrices. References come from ospace's public functions and from Pinocchio.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.kernels.tree import path_to

FAILS, HOLDS, HOLDS_NUMERICALLY = 1e-3, 1e-10, 1e-6
ONE_COLUMN = ("revolute", "revolute about any axis", "prismatic", "prismatic along any axis")
STEP = 1e-5


def random_state(seed, joints=8, branching=0.5, far=False):
    """A moving robot of one-column joints without drive inertia, as the paper has it."""
    model = trees.tree(seed, joints, ONE_COLUMN, branching).model
    model.armature = np.zeros(model.nv)
    return trees.state(ospace.SpaceRobot.from_model(model), seed, far)


@pytest.fixture(params=range(3))
def branched(request):
    state = random_state(request.param)
    assert len(state.robot.leaf_links) > 1
    return state


@pytest.fixture(params=range(3))
def serial(request):
    return random_state(request.param, branching=0.0)


def apart(value, reference):
    return np.abs(value - reference).max() / np.abs(reference).max()


def assert_erratum(reference, printed, holds, tolerance=HOLDS):
    assert apart(holds, reference) <= tolerance
    assert apart(printed, reference) > FAILS


# -- the paper's recursions --------------------------------------------------------------------------------------


def wrench_transform(R, r):
    """(14): a wrench given in frame i, at i, becomes one in frame h, at h."""
    return np.block([[R, np.zeros((3, 3))], [pin.skew(r) @ R, R]])


def on_motions(v):
    """v ×̂ as printed below (17)."""
    return np.block([[pin.skew(v[3:]), pin.skew(v[:3])], [np.zeros((3, 3)), pin.skew(v[3:])]])


def on_forces(v):
    """Its dual."""
    return -on_motions(v).T


def rotation(R):
    return np.kron(np.eye(2), R)


class Paper:
    """The links of a state: X[i] takes wrenches from link i to its parent h; all else in the frame of link i."""

    def __init__(self, state):
        model = state.robot.model
        data = model.createData()
        pin.computeJointJacobians(model, data, state.q)
        joints = range(1, model.njoints)
        self.parent = [model.parents[j] - 1 for j in joints]
        self.X = [wrench_transform(data.liMi[j].rotation, data.liMi[j].translation) for j in joints]
        self.I = [model.inertias[j].matrix() for j in joints]
        self.S = [pin.getJointJacobian(model, data, j, pin.LOCAL)[:, j + 4] for j in joints]  # S[0] is not used
        self.to_inertial = [rotation(data.oMi[j].rotation) for j in joints]
        self.rate = state.v[5:]
        self.v = self.velocities(state.v[:6])
        self.c = [on_motions(v) @ S * rate for v, S, rate in zip(self.v, self.S, self.rate, strict=True)]
        self.outward = range(1, len(self.S))
        self.inward = self.outward[::-1]

    def velocities(self, base):
        """(16)."""
        v = [base]
        for i in range(1, len(self.S)):
            v.append(self.X[i].T @ v[self.parent[i]] + self.S[i] * self.rate[i])
        return v

    def path(self, i):
        """Links from the base, not included, out to link i."""
        return [*self.path(self.parent[i]), i] if i else []

    def to_base(self, i):
        """ᵢ⁰X."""
        return self.to_base(self.parent[i]) @ self.X[i] if i else np.eye(6)

    def forces(self, cross=on_forces):
        """(17)–(19) at zero spatial base acceleration and zero φ̈: wrench on the base, then joint torques."""
        a = [np.zeros(6)]
        for i in self.outward:
            a.append(self.X[i].T @ a[self.parent[i]] + self.c[i])
        f = [I @ a_i + cross(v) @ I @ v for I, a_i, v in zip(self.I, a, self.v, strict=True)]
        for i in self.inward:
            f[self.parent[i]] = f[self.parent[i]] + self.X[i] @ f[i]
        return np.r_[f[0], [self.S[i] @ f[i] for i in self.outward]]

    def composite(self):
        """(21)."""
        IC = list(self.I)
        for i in self.inward:
            IC[self.parent[i]] = IC[self.parent[i]] + self.X[i] @ IC[i] @ self.X[i].T
        return IC

    def articulated(self, cross=on_forces, all_children=True):
        """(38), (42): I^A, p^A, L (X within, as in (38)), β."""
        p = [cross(v) @ I @ v for I, v in zip(self.I, self.v, strict=True)]
        IA, pA, L, beta = list(self.I), list(p), list(self.X), np.ones(len(p))
        for i in self.inward:
            h, S, U = self.parent[i], self.S[i], IA[i] @ self.S[i]
            beta[i] = S @ U
            L[i] = self.X[i] @ (np.eye(6) - np.outer(U, S) / beta[i])
            I_across = L[i] @ IA[i] @ self.X[i].T
            p_across = self.X[i] @ pA[i] + L[i] @ IA[i] @ self.c[i] - self.X[i] @ U * (S @ pA[i]) / beta[i]
            IA[h] = (IA[h] if all_children else self.I[h]) + I_across
            pA[h] = (pA[h] if all_children else p[h]) + p_across
        return IA, pA, L, beta

    def block(self, L, beta, IA, i, j, start=None):
        """Λ_ij: (39) out to link `start`, the nearest common ancestor if none is given, then (40)."""
        shared = [k for k in self.path(i) if k in self.path(j)] if start is None else self.path(start)
        Lambda = np.linalg.inv(IA[0])
        for k in shared:
            Lambda = np.outer(self.S[k], self.S[k]) / beta[k] + L[k].T @ Lambda @ L[k]
        for k in self.path(i)[len(shared) :]:
            Lambda = L[k].T @ Lambda
        for k in self.path(j)[len(shared) :]:
            Lambda = Lambda @ L[k]
        return Lambda

    def classical(self, i, a):
        """ẍ of the origin of link i in inertial axes: (44) and what follows (36)."""
        v = self.v[i]
        return self.to_inertial[i] @ (a - np.r_[np.cross(v[:3], v[3:]), np.zeros(3)])

    def bias_acceleration(self, e, sign_of_a_0=-1.0, articulated_p=True, cross=on_forces, all_children=True):
        """(42)–(44): ẍ_e of link e while nothing acts."""
        IA, pA, _, beta = self.articulated(cross, all_children)
        a = sign_of_a_0 * np.linalg.solve(IA[0], pA[0])
        for i in self.path(e):
            p = pA[i] if articulated_p else cross(self.v[i]) @ self.I[i] @ self.v[i]
            a_h = self.X[i].T @ a
            b = -(self.S[i] @ (IA[i] @ (a_h + self.c[i]) + p)) / beta[i]
            a = a_h + self.c[i] + self.S[i] * b
        return self.classical(e, a)

    def inverted(self, e, cross=on_forces, factor_of_L=True, branches=True):
        """(33)–(36): Γ_e and μ_e at the origin of link e; `branches`: with what hangs off the path, by (38), (42)."""
        I = list(self.I)
        p = [cross(v) @ I_i @ v for I_i, v in zip(I, self.v, strict=True)]
        if branches:
            kept, self.X = self.X, [0.0 * X if i in self.path(e) else X for i, X in enumerate(self.X)]  # cut the path
            I, p, _, _ = self.articulated(cross)
            self.X = kept
        IA, pA = I[0], p[0]
        for i in self.path(e):
            X = np.linalg.inv(self.X[i])  # wrenches from h to i (15)
            IA, pA, S = X @ IA @ X.T, X @ pA, self.S[i]
            alpha = S @ IA @ S
            L = np.eye(6) - np.outer(S, S @ IA) / alpha
            carried = IA @ L @ self.c[i] if factor_of_L else L @ self.c[i]
            pA = p[i] + pA - carried - IA @ S * (S @ pA) / alpha
            IA = I[i] + IA @ L
        Gamma_e = self.to_inertial[e] @ IA @ self.to_inertial[e].T
        return Gamma_e, self.to_inertial[e] @ pA - Gamma_e @ self.classical(e, np.zeros(6))


def last_link(state):
    """Number of the link with the longest path, and its point."""
    lengths = [len(path_to(state.robot.links.parent, i)) for i in range(state.robot.n_joints + 1)]
    e = int(np.argmax(lengths))
    return e, state.robot.point(f"link_{e - 1}")


def twists_to_inertial(state):
    return rotation(state.T_WB.rotation)


# -- tables ------------------------------------------------------------------------------------------------------


def test_table_1_J_b_star_is_6_by_n(branched):
    _, point = last_link(branched)
    assert ospace.generalized_jacobian(branched, point).base_generalized_jacobian.shape == (6, branched.robot.n_joints)


def test_table_2_composite_inertia_is_6_by_6(branched):
    assert Paper(branched).composite()[0].shape == (6, 6)


def test_section_3_1_J_e_has_6_plus_n_columns(branched):
    _, point = last_link(branched)
    assert ospace.operational_space(branched, point).jacobian.shape == (6, 6 + branched.robot.n_joints)


# -- §4: transforms, cross operator ------------------------------------------------------------------------------


def test_14_X_is_the_transform_of_wrenches(branched):
    """A motion goes with Xᵀ from h to i; read as a transform of motions, X would take v_i to v_h."""
    model, data = branched.robot.model, branched.robot.model.createData()
    pin.forwardKinematics(model, data, branched.q, branched.v)
    paper = Paper(branched)
    reference = np.array([data.v[j].vector for j in range(1, model.njoints)])
    read_as_motion = [branched.v[:6]]
    for i in paper.outward:
        read_as_motion.append(np.linalg.inv(paper.X[i]) @ read_as_motion[paper.parent[i]] + paper.S[i] * paper.rate[i])
    assert_erratum(reference, printed=np.array(read_as_motion), holds=np.array(paper.v))


def test_17_19_cross_operator_on_forces_is_the_dual(branched):
    model = branched.robot.model
    reference = pin.rnea(model, model.createData(), branched.q, branched.v, np.zeros(model.nv))
    paper = Paper(branched)
    assert_erratum(reference, printed=paper.forces(on_motions), holds=paper.forces())


def test_35_cross_operator_on_forces_is_the_dual(serial):
    e, point = last_link(serial)
    paper = Paper(serial)
    reference = ospace.operational_space(serial, point, "dense").bias_force
    assert_erratum(reference, printed=paper.inverted(e, on_motions)[1], holds=paper.inverted(e)[1])


def test_42_cross_operator_on_forces_is_the_dual(branched):
    e, point = last_link(branched)
    paper = Paper(branched)
    reference = -ospace.operational_space(branched, point, "dense").bias_acceleration
    printed = paper.bias_acceleration(e, cross=on_motions)
    assert_erratum(reference, printed, holds=paper.bias_acceleration(e))


# -- §5: generalized Jacobians -----------------------------------------------------------------------------------


def columns_of_27(paper, transform):
    IC = paper.composite()
    return np.array(
        [-np.linalg.solve(IC[0], transform(paper.to_base(k)) @ IC[k] @ paper.S[k]) for k in paper.outward]
    ).T


def test_27_columns_take_the_wrench_transform_as_it_is(branched):
    _, point = last_link(branched)
    reference = twists_to_inertial(branched).T @ ospace.generalized_jacobian(branched, point).base_generalized_jacobian
    paper = Paper(branched)
    printed = columns_of_27(paper, np.transpose)
    assert_erratum(reference, printed, holds=columns_of_27(paper, np.asarray))


def test_28_to_inertial_axes_is_a_rotation(branched):
    """M_0 = ᴵX L_0 is the momentum about the base, not about the inertial origin."""
    paper = Paper(branched)
    L_0 = sum(paper.to_base(k) @ I @ v for k, (I, v) in enumerate(zip(paper.I, paper.v, strict=True)))
    shifted = wrench_transform(branched.T_WB.rotation, branched.T_WB.translation) @ L_0
    assert_erratum(ospace.momentum(branched), printed=shifted, holds=twists_to_inertial(branched) @ L_0)


def test_44_to_inertial_axes_is_a_rotation(branched):
    """ẍ_e is the acceleration of the point itself, not of the body where it passes the inertial origin."""
    e, point = last_link(branched)
    bias = Paper(branched).bias_acceleration(e)
    at_origin = np.linalg.inv(wrench_transform(np.eye(3), branched.placement(point).translation)).T @ bias
    reference = -ospace.operational_space(branched, point, "dense").bias_acceleration
    assert_erratum(reference, printed=at_origin, holds=bias)


def generalized_jacobian_by_30(paper, e, kinematic, wrench_to_base):
    """(30), (31): `kinematic` are the links whose columns move the point."""
    IC, to_e = paper.composite(), paper.to_base(e)
    columns = []
    for k in paper.outward:
        momentum = -to_e.T @ np.linalg.solve(IC[0], wrench_to_base(k) @ IC[k] @ paper.S[k])
        own = (np.linalg.inv(paper.to_base(k)) @ to_e).T @ paper.S[k] if k in kinematic else np.zeros(6)
        columns.append(paper.to_inertial[e] @ (momentum + own))
    return np.array(columns).T


def test_30_kinematic_part_runs_over_the_ancestors_alone(branched):
    e, point = last_link(branched)
    paper = Paper(branched)
    reference = ospace.generalized_jacobian(branched, point).generalized_jacobian
    printed = generalized_jacobian_by_30(paper, e, paper.outward, paper.to_base)
    assert_erratum(reference, printed, holds=generalized_jacobian_by_30(paper, e, paper.path(e), paper.to_base))


def test_30_momentum_part_lacks_the_transform_to_the_base(serial):
    e, point = last_link(serial)
    paper = Paper(serial)
    reference = ospace.generalized_jacobian(serial, point).generalized_jacobian
    printed = generalized_jacobian_by_30(paper, e, paper.path(e), lambda k: np.eye(6))
    assert_erratum(reference, printed, holds=generalized_jacobian_by_30(paper, e, paper.path(e), paper.to_base))


# -- §6: operational space ---------------------------------------------------------------------------------------


def test_section_6_1_holds_for_any_tree_with_its_branches(branched):
    e, point = last_link(branched)
    paper = Paper(branched)
    reference = ospace.operational_space(branched, point, "dense").inertia
    assert_erratum(reference, printed=paper.inverted(e, branches=False)[0], holds=paper.inverted(e)[0])
    assert apart(ospace.operational_space(branched, point, "inverted").inertia, reference) <= HOLDS


def test_35_lacks_a_factor_of_articulated_inertia(serial):
    e, point = last_link(serial)
    paper = Paper(serial)
    reference = ospace.operational_space(serial, point, "dense").bias_force
    assert_erratum(reference, printed=paper.inverted(e, factor_of_L=False)[1], holds=paper.inverted(e)[1])


def two_arms(seed):
    """A torso of two joints and two arms of two on it, and the numbers of both tips."""
    rng = np.random.default_rng(seed)
    model = pin.Model()
    for k, parent in enumerate((0, 1, 2, 3, 4, 3, 6)):
        joint = pin.JointModelFreeFlyer() if k == 0 else trees.JOINT_TYPES["revolute about any axis"](rng)
        model.addJoint(parent, joint, pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)), f"joint_{k}")
        model.appendBodyToJoint(k + 1, trees.inertia(rng, rng.uniform(1.0, 9.0)), pin.SE3.Identity())
        model.addBodyFrame(f"body_{k}", k + 1, pin.SE3.Identity(), 0)
    state = trees.state(ospace.SpaceRobot.from_model(model), seed)
    return state, 4, 6


@pytest.mark.parametrize("seed", range(3))
def test_40_starts_from_the_nearest_common_ancestor(seed):
    """Propagated from the base all along both paths, the joints that the paths share are missing."""
    state, i, j = two_arms(seed)
    points = [state.robot.point("body_4"), state.robot.point("body_6")]
    reference = ospace.operational_space(state, points, "dense").inertia_inverse[:6, 6:]
    paper = Paper(state)
    IA, _, L, beta = paper.articulated()
    to_i, to_j = paper.to_inertial[i], paper.to_inertial[j]
    printed = to_i @ paper.block(L, beta, IA, i, j, start=0) @ to_j.T
    assert_erratum(reference, printed, holds=to_i @ paper.block(L, beta, IA, i, j) @ to_j.T)


def test_42_sums_over_all_children(branched):
    e, point = last_link(branched)
    paper = Paper(branched)
    reference = -ospace.operational_space(branched, point, "dense").bias_acceleration
    assert_erratum(reference, paper.bias_acceleration(e, all_children=False), holds=paper.bias_acceleration(e))


def test_43_sign_of_the_base_acceleration(branched):
    e, point = last_link(branched)
    paper = Paper(branched)
    reference = -ospace.operational_space(branched, point, "dense").bias_acceleration
    assert_erratum(reference, paper.bias_acceleration(e, sign_of_a_0=1.0), holds=paper.bias_acceleration(e))


def test_43_takes_the_articulated_bias_force(branched):
    e = path_to(branched.robot.links.parent, last_link(branched)[0])[-2]  # at a link without children p and p^A are one
    point = branched.robot.point(f"link_{e - 1}")
    paper = Paper(branched)
    reference = -ospace.operational_space(branched, point, "dense").bias_acceleration
    assert_erratum(reference, paper.bias_acceleration(e, articulated_p=False), holds=paper.bias_acceleration(e))


def test_45_sign_of_the_bias_force(branched):
    e, point = last_link(branched)
    paper = Paper(branched)
    terms = ospace.operational_space(branched, point, "dense")
    acceleration = paper.bias_acceleration(e)
    printed = terms.inertia @ acceleration
    assert_erratum(terms.bias_force, printed, holds=-terms.inertia @ acceleration)
    printed = terms.inertia @ paper.bias_acceleration(e, sign_of_a_0=1.0, articulated_p=False)
    assert_erratum(terms.bias_force, printed, holds=-terms.inertia @ acceleration)


# -- §3.2, §2.2: momentum about a moving point -------------------------------------------------------------------


def generalized(state, point):
    """J_m* and J_b H_b⁻¹."""
    J_b = ospace.operational_space(state, point).jacobian[:, :6]
    H_b = ospace.joint_space_dynamics(state).base_inertia
    return ospace.generalized_jacobian(state, point).generalized_jacobian, J_b @ np.linalg.inv(H_b)


def at(state, time, acceleration=None):
    """The state a moment later; base and joints go on as they do, or accelerate (Pinocchio's coordinates)."""
    robot = state.robot
    a = np.zeros(robot.nv) if acceleration is None else acceleration
    return robot.state(pin.integrate(robot.model, state.q, time * state.v + 0.5 * time**2 * a), state.v + time * a)


def moving_point_term(state):
    """Ṁ_0 = [0; −v_b × P] of a robot on which nothing acts."""
    return np.r_[np.zeros(3), -np.cross(state.base_twist[:3], ospace.momentum(state)[:3])]


def test_12_drops_the_rate_of_momentum_about_the_moving_base(branched):
    _, point = last_link(branched)
    J_m_star, J_b_H_b_inv = generalized(branched, point)
    (J_after, B_after), (J_before, B_before) = (generalized(at(branched, t), point) for t in (STEP, -STEP))
    J_rate, B_rate = (J_after - J_before) / (2.0 * STEP), (B_after - B_before) / (2.0 * STEP)
    terms = ospace.generalized_dynamics(branched)
    printed = (
        J_m_star @ np.linalg.solve(terms.generalized_inertia, terms.generalized_bias)
        - J_rate @ branched.v[6:]
        - B_rate @ ospace.momentum(branched)
    )
    whole = printed - J_b_H_b_inv @ moving_point_term(branched)
    for mu in (
        ospace.operational_space(branched, point, "dense").bias_acceleration,
        ospace.free_floating(branched, point).bias_acceleration,
    ):
        assert_erratum(mu, printed, holds=whole, tolerance=HOLDS_NUMERICALLY)


def test_12_bias_wants_the_transposed_inverse():
    """With six joints and one point the printed product has the right shape, and is another number."""
    state = random_state(0, joints=6, branching=0.0)
    terms = ospace.free_floating(state, last_link(state)[1])
    c_m_star = ospace.generalized_dynamics(state).generalized_bias
    assert terms.rank == 6
    by_J_plus = terms.floating_inertia_inverse @ terms.dynamically_consistent_inverse
    by_J_plus_transposed = terms.floating_inertia_inverse @ terms.dynamically_consistent_inverse.T
    assert_erratum(
        terms.torque_map @ c_m_star,
        printed=by_J_plus @ c_m_star,
        holds=by_J_plus_transposed @ c_m_star,
    )


def test_12_torque_map_needs_no_inverse_of_Lambda(branched):
    """Λ⁻¹ J_m*⁺ᵀ = J_m* H_m*⁻¹ where Λ exists; the right side stands where it does not."""
    robot = branched.robot
    H_m_star = ospace.generalized_dynamics(branched).generalized_inertia
    few = robot.point(last_link(branched)[1].frame, axes="linear")
    many = [robot.point(frame) for frame in robot.frame_names[:3]]
    for points, invertible in ((few, True), (many, False)):
        terms = ospace.free_floating(branched, points)
        reference = np.linalg.solve(H_m_star, terms.generalized_jacobian.T).T
        assert apart(terms.torque_map, reference) <= HOLDS
        assert (np.linalg.cond(terms.floating_inertia_inverse) < 1e12) == invertible
        if invertible:
            Lambda = np.linalg.inv(terms.floating_inertia_inverse)
            J_plus = np.linalg.solve(H_m_star, terms.generalized_jacobian.T) @ Lambda
            assert apart(terms.floating_inertia_inverse @ J_plus.T, reference) <= HOLDS


def test_section_2_2_momentum_about_the_moving_base_is_not_constant(branched):
    """Nothing acts, yet Ṁ_0 = [0; −v_b × P]; about a point at rest the momentum is constant."""
    model = branched.robot.model
    free = pin.aba(model, model.createData(), branched.q, branched.v, np.zeros(model.nv))
    after, before = at(branched, STEP, free), at(branched, -STEP, free)
    rate = (ospace.momentum(after) - ospace.momentum(before)) / (2.0 * STEP)
    assert_erratum(rate, np.zeros(6), holds=moving_point_term(branched), tolerance=HOLDS_NUMERICALLY)

    about_origin = [wrench_transform(np.eye(3), state.q[:3]) @ ospace.momentum(state) for state in (after, before)]
    assert apart(about_origin[0], about_origin[1]) <= HOLDS


def test_section_2_2_holds_without_linear_momentum(branched):
    model, v = branched.robot.model, branched.v.copy()
    v[:3] -= branched.T_WB.rotation.T @ ospace.momentum(branched)[:3] / branched.robot.total_mass
    state = branched.robot.state(branched.q, v)
    free = pin.aba(model, model.createData(), state.q, state.v, np.zeros(model.nv))
    after, before = (ospace.momentum(at(state, t, free)) for t in (STEP, -STEP))
    assert np.abs(after - before).max() / (2.0 * STEP) <= HOLDS_NUMERICALLY * np.abs(after).max()


# -- §6.3: the locked robot --------------------------------------------------------------------------------------


def test_section_6_3_Lambda_b_is_the_composite_inertia_at_the_point(branched):
    """At one point it is I_0^C taken to that point; turned to inertial axes alone it belongs to the base's origin."""
    _, point = last_link(branched)
    H_b = ospace.joint_space_dynamics(branched).base_inertia
    reference = np.linalg.inv(ospace.free_floating(branched, point).base_inertia_inverse)
    to_point = wrench_transform(np.eye(3), -branched.placement_about_base(point).translation)
    assert_erratum(reference, printed=H_b, holds=to_point @ H_b @ to_point.T)
    at_base = ospace.free_floating(branched, branched.robot.point("base")).base_inertia_inverse
    assert apart(np.linalg.inv(at_base), H_b) <= HOLDS


@pytest.mark.parametrize("p", [1, 2, 3])
def test_section_6_3_Lambda_b_of_several_points_has_no_inverse(branched, p):
    points = [branched.robot.point(frame) for frame in branched.robot.frame_names[:p]]
    terms = ospace.free_floating(branched, points)
    I_0C_inv = np.linalg.inv(ospace.joint_space_dynamics(branched).base_inertia)
    X = [wrench_transform(np.eye(3), branched.placement_about_base(point).translation) for point in points]
    blocks = np.block([[X_i.T @ I_0C_inv @ X_j for X_j in X] for X_i in X])
    assert apart(terms.base_inertia_inverse, blocks) <= HOLDS
    assert np.linalg.matrix_rank(terms.base_inertia_inverse, tol=1e-12 * np.linalg.norm(blocks)) == 6
    Gamma_e_inv = ospace.operational_space(branched, points, "dense").inertia_inverse
    assert apart(terms.floating_inertia_inverse, Gamma_e_inv - blocks) <= HOLDS


# -- coordinates, rank, distance ---------------------------------------------------------------------------------


def test_pinocchio_and_paper_coordinates_of_the_base(branched):
    """H = T H Tᵀ, J = J Tᵀ; c without the term of the classical base acceleration is another one."""
    model = branched.robot.model
    data = model.createData()
    T = np.eye(model.nv)
    T[:6, :6] = twists_to_inertial(branched)
    H = pin.crba(model, data, branched.q)
    H = T @ (np.triu(H) + np.triu(H, 1).T) @ T.T
    c = T @ pin.rnea(model, data, branched.q, branched.v, np.zeros(model.nv))
    v_b, omega_b = branched.base_twist[:3], branched.base_twist[3:]
    terms = ospace.joint_space_dynamics(branched)
    bias = np.r_[terms.base_bias, terms.manipulator_bias]
    assert apart(H[:6, :6], terms.base_inertia) <= HOLDS
    assert apart(H[:6, 6:], terms.coupling_inertia) <= HOLDS
    assert apart(H[6:, 6:], terms.manipulator_inertia) <= HOLDS
    assert_erratum(bias, printed=c, holds=c - H @ np.r_[np.cross(omega_b, v_b), np.zeros(model.nv - 3)])


def test_rank_of_the_rows_of_the_demonstration():
    """Four joints stand between base and head: both with six rows each, two rows are too many."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    state = trees.state(robot, 0)
    full = [robot.point(frame) for frame in ("right_hand", "head", "base")]
    terms = ospace.operational_space(state, full)
    assert (len(terms.inertia_inverse), terms.rank) == (18, 16)
    assert np.linalg.matrix_rank(terms.jacobian, tol=1e-9) == 16
    with pytest.raises(ospace.DependentRowsError) as caught:
        ospace.operational_space(state, full, strict=True)
    assert set(caught.value.points) == {"head", "base"}

    held = [robot.point("right_hand"), robot.point("head", "angular"), robot.point("base", "angular")]
    terms = ospace.operational_space(state, held, strict=True)
    assert (len(terms.inertia_inverse), terms.rank) == (12, 12)


def test_distance_from_the_origin_costs_digits_about_the_origin_alone(branched):
    """The same robot 7e6 m away, by ospace and by Pinocchio about the world's origin."""
    _, point = last_link(branched)
    reference = ospace.operational_space(branched, point).inertia_inverse
    q = branched.q.copy()
    q[:3] = 7e6 * np.array([0.6, 0.0, 0.8])
    far = branched.robot.state(q, branched.v)
    model = branched.robot.model
    data = model.createData()
    H_inv = pin.computeMinverse(model, data, q)
    H_inv = np.triu(H_inv) + np.triu(H_inv, 1).T
    J = pin.computeFrameJacobian(model, data, q, model.getFrameId(point.frame), pin.LOCAL_WORLD_ALIGNED)
    about_origin = J @ H_inv @ J.T
    assert_erratum(reference, about_origin, holds=ospace.operational_space(far, point).inertia_inverse)


# -- numbers of equations ----------------------------------------------------------------------------------------


def test_the_net_force_on_a_body_is_cited_by_its_number():
    """I a + v ×̂ I v is (19) of the paper; (18) passes forces on to the parent."""
    package = Path(ospace.__file__).parent
    lines = [line for file in package.rglob("*.py") for line in file.read_text(encoding="utf-8").splitlines()]
    net_force = [line for line in lines if re.search(r"×̂ I_?i? ?v", line)]
    assert len(net_force) >= 2
    assert [line for line in net_force if "(18)" in line] == []
    assert any("(19)" in line for line in net_force)
    assert [line for line in lines if "(18)" in line and "f_h" not in line] == []

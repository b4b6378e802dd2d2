"""Forward chain of the paper: its parts against their definitions, the whole against dense forms and 50 digits."""

import booms
import numpy as np
import pinocchio as pin
import pytest
import trees
from exact import exact

import ospace
from ospace.dynamics import paper_sweeps
from ospace.dynamics.dense import Dense
from ospace.kernels import forward_chain as kernel


@pytest.fixture
def rng():
    return np.random.default_rng(8)


def close(value, reference, tolerance=1e-13):
    assert np.abs(value - reference).max() <= tolerance * max(np.abs(reference).max(), 1e-3)


def positive(rng):
    A = rng.normal(size=(6, 6))
    return A @ A.T + np.eye(6)


def along_z(rng):
    """The column of a revolute joint, in the paper's frame."""
    return np.eye(6)[5]


def along_anything(rng):
    return rng.normal(size=6)


# -- parts -----------------------------------------------------------------------------------------------------


def test_a_force_transform_takes_wrenches_as_pinocchio_does(rng):
    placements = [pin.SE3.Random() for _ in range(4)]
    X = kernel.force_transform(
        np.array([M.rotation for M in placements]), np.array([M.translation for M in placements])
    )
    for M, one in zip(placements, X, strict=True):
        f, v = rng.normal(size=6), rng.normal(size=6)
        close(one @ f, M.act(pin.Force(f)).vector)
        close(one.T @ v, M.actInv(pin.Motion(v)).vector)
        close(kernel.inverse_transform(one) @ one, np.eye(6))


def test_velocity_products_of_forces(rng):
    v, f = rng.normal(size=(2, 4, 6))
    expected = [pin.Motion(one).cross(pin.Force(two)).vector for one, two in zip(v, f, strict=True)]
    close((kernel.cross_force(v) @ f[:, :, None])[:, :, 0], np.array(expected))


def test_classical_acceleration(rng):
    a, v = rng.normal(size=(2, 3, 6))
    expected = a.copy()
    expected[:, :3] += np.cross(v[:, 3:], v[:, :3])
    close(kernel.classical(a, v), expected)


def test_solving_in_unlike_units(rng):
    """Kilograms beside micrograms, as in the inertia of a finger that hangs from a bus."""
    size = np.array([1e3, 1e3, 1e3, 1e5, 1e5, 1e-6])
    A, B = positive(rng) * np.sqrt(np.outer(size, size)), rng.normal(size=(6, 4))
    assert (np.abs(A @ kernel.solve(A, B) - B) <= 1e-12 * np.sqrt(np.outer(size, 1e6 * np.ones(4)))).all()
    close(kernel.solve(A, B[:, 0]), kernel.solve(A, B)[:, 0], 1e-12)
    close(kernel.solve(A, A), np.eye(6), 1e-9)


@pytest.mark.parametrize("axis", [along_z, along_anything])
@pytest.mark.parametrize("armature", [0.0, 0.7])
def test_propagating_an_inertia_across_a_joint(rng, axis, armature):
    """The printed form of (38), I − I S Sᵀ I/β."""
    I, S = positive(rng), axis(rng)
    L, I_L, beta = kernel.propagate(I, S, armature)
    U = I @ S
    assert beta == pytest.approx(S @ U + armature, rel=1e-14)
    close(L, np.eye(6) - np.outer(U, S) / beta)
    close(I_L, I - np.outer(U, U) / beta)


def test_along_its_axis_a_joint_passes_on_what_its_drive_holds_and_no_rounding(rng):
    """Sᵀ L = a_r Sᵀ/β, whether there is an armature or none, and with it Sᵀ (I L) S = a_r Sᵀ I S/β."""
    for armature in (0.0, 1e-6):
        for S in (along_z(rng), 3.0 * along_z(rng)):
            I = 1e8 * positive(rng)
            L, I_L, beta = kernel.propagate(I, S, armature)
            np.testing.assert_allclose(S @ L, armature / beta * S, rtol=1e-14, atol=0)
            passed = S @ I_L @ S
            assert passed == pytest.approx(armature * (S @ I @ S) / beta, rel=1e-12, abs=0.0)
    S = along_anything(rng)
    L, _, _ = kernel.propagate(1e8 * positive(rng), S, 0.0)
    assert np.abs(S @ L).max() < 1e-15


def test_the_relative_pivot_is_over_the_traces_of_the_inertia():
    """β of a joint that lifts what it moves, and of one that only turns a ball about its centre."""
    ball = np.diag([2.0, 2.0, 2.0, 5.0, 5.0, 5.0])
    S = np.array([[0, 0, 1.0, 0, 0, 0], [0, 0, 0, 0, 0, 1.0], [0, 0, 3.0, 0, 0, 1.0]])
    beta = np.array([2.0, 5.0, 18.0 + 5.0])
    np.testing.assert_allclose(kernel.relative_pivot(beta, S, np.array([ball] * 3)), [1 / 3, 1 / 3, 1 / 3], rtol=1e-14)
    assert kernel.relative_pivot(0.0, S[:1], np.zeros((1, 6, 6))) == 0.0


# -- the whole -------------------------------------------------------------------------------------------------


@pytest.fixture(params=[*trees.JOINT_TYPES, "mixed"])
def state(request):
    types = None if request.param == "mixed" else (request.param,)
    return trees.state(trees.tree(17, 16 if types is None else 6, types), 9, far=True)


def points_of(robot):
    """Several on one link, on links of one branch and of two, and on the base."""
    last = f"link_{robot.model.njoints - 3}"
    offset = pin.SE3(pin.exp3(np.array([0.3, 0.1, -0.2])), np.array([0.1, -0.2, 0.3]))
    names = ["link_3", "base", last, "link_2"]
    return [*(robot.point(name, offset=offset) for name in names), robot.point(last, "linear")]


def test_forward_chain_against_the_dense_forms(state):
    points = points_of(state.robot)
    dense = Dense(state, points)
    Gamma_inv, mu, response, pivots = paper_sweeps.forward(state, points)
    close(Gamma_inv, dense.Gamma_e_inv, 1e-12)
    close(mu, dense.mu, 1e-12)
    close(response, dense.response, 1e-12)
    assert (pivots[1:] > 1e-6).all()


def test_links_in_the_papers_frames(state):
    """Chained from link to link, the transforms lead to Pinocchio's placements and joint columns about the base."""
    robot = state.robot
    chain, _ = paper_sweeps.paper_frames(state, [robot.point("base")])
    T = np.eye(6)
    T[:3, :3] = T[3:, 3:] = state.T_WB.rotation
    to_base = [T]
    for i in range(1, len(chain.parent)):
        to_base.append(to_base[chain.parent[i]] @ chain.X[i])  # forces of link i to the base, inertial axes
    robot.scratch.place(state.q, state.v)
    columns = robot.scratch.columns[6:]
    motions = np.array([np.linalg.solve(X.T, S) for X, S in zip(to_base[1:], chain.S[1:], strict=True)])
    close(motions, columns, 1e-12)
    bodies = sum(X @ I @ X.T for X, I in zip(to_base, chain.I, strict=True))
    close(bodies, Dense(state, [robot.point("base")]).H[:6, :6], 1e-12)


def test_passing_inward_collects_the_composite_inertia_as_well(state):
    """At the base it is H_b; each joint moves what is composed beyond it."""
    base = state.robot.point("base")
    chain, _ = paper_sweeps.paper_frames(state, [base])
    body = kernel.links_alone(chain)
    for i in range(len(chain.parent) - 1, 0, -1):
        kernel.pass_inward(chain, body, i)
    T = np.kron(np.eye(2), state.T_WB.rotation)
    close(T @ body.IC[0] @ T.T, Dense(state, [base]).H[:6, :6], 1e-12)
    np.testing.assert_array_equal(body.moved[1:], body.IC[1:])


def test_one_column_joints_turn_about_the_third_axis_exactly(state):
    robot = state.robot
    chain, _ = paper_sweeps.paper_frames(state, [robot.point("base")])
    for j in range(2, robot.model.njoints):
        kind = robot.model.joints[j].shortname()
        if robot.model.nvs[j] == 1 and "Composite" not in kind:
            S = chain.S[robot.link_of_joint[j]]
            assert np.count_nonzero(S) == (2 if "JointModelH" in kind else 1)
            assert 1.0 in S[[2, 5]]


def error(result, reference):
    """Errors of Γ_e⁻¹, relative to its diagonal, and of μ, relative to its largest row."""
    size = np.sqrt(np.diag(reference.inertia_inverse))
    off = (result.inertia_inverse - reference.inertia_inverse) / np.outer(size, size)
    drift = result.bias_acceleration - reference.bias_acceleration
    return np.abs(off).max(), np.abs(drift).max() / np.abs(reference.bias_acceleration).max()


@pytest.mark.parametrize("finger", booms.FINGERS)
@pytest.mark.parametrize("reach", [20.0, 100.0])
def test_a_light_finger_on_a_long_boom_costs_no_digits(reach, finger):
    robot = booms.boom(reach, finger)
    points = [robot.point("finger_0"), robot.point("arm_6"), robot.point("base")]
    for seed in range(3):
        state = trees.state(robot, seed, far=True)
        result, reference = ospace.operational_space(state, points, "forward"), exact(state, points)
        assert max(error(result, reference)) < 1e-13
        scale = np.abs(reference.response).max(axis=1, keepdims=True)
        assert (np.abs(result.response - reference.response) <= 1e-12 * scale).all()

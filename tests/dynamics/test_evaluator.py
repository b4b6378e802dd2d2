"""The evaluator and the batch: the same results as one state at a time, in all their forms."""

import copy
import subprocess
import sys
import tracemalloc

import numba
import numpy as np
import pinocchio as pin
import pytest
import trees
from hypothesis import given, settings
from hypothesis import strategies as st
from numba.core.runtime import _nrt_python, rtsys

import ospace
from ospace.dynamics import batch, evaluator
from ospace.dynamics.dense import Dense
from ospace.dynamics.workspace import layout_of
from ospace.kernels import batch as kernels
from ospace.kernels import workspace
from ospace.kernels.jit import simd
from ospace.validation.sampling import random_state

ONE_DEGREE = tuple(name for name in trees.JOINT_TYPES if name.startswith(("revolute", "continuous", "prismatic")))
ALL = tuple(batch.QUANTITIES)


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


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


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 14), st.floats(0.0, 1.0), st.integers(1, 6), st.booleans(), st.booleans())
def test_any_points_on_any_tree(seed, joints, branching, count, far, mixed):
    robot = trees.tree(seed, joints, None if mixed else ONE_DEGREE, branching)
    points = draw_points(robot, np.random.default_rng(seed), count)
    state = trees.state(robot, seed, far)
    result = ospace.OperationalSpaceEvaluator(robot, points).update(state.q, state.v)
    tolerance = 1e-12 * np.linalg.cond(Dense(state, points).H)
    agrees(result, state, points, tolerance)
    assert result.rank == ospace.operational_space(state, points).rank


@pytest.mark.parametrize("name", ospace.models.names())
def test_models(name):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    points = [robot.point(link) for link in robot.leaf_links]
    run = ospace.OperationalSpaceEvaluator(robot, points)
    for seed in range(4):
        state = random_state(robot, np.random.default_rng(seed), far=bool(seed % 2))
        agrees(run.update(state.q, state.v), state, points)


def test_inertia_and_bias_force(chaser):
    points = [chaser.point("right_hand"), chaser.point("head", "angular")]
    state = random_state(chaser, np.random.default_rng(1))
    result = ospace.OperationalSpaceEvaluator(chaser, points).update(state.q, state.v)
    reference = ospace.operational_space(state, points, "dense")
    close(result.inertia, reference.inertia)
    close(result.bias_force, reference.bias_force)
    close(result.jacobian, reference.jacobian)
    np.testing.assert_array_equal(result.inertia, result.inertia.T)


@pytest.mark.parametrize("quantities", [(), ("inertia_inverse",), evaluator.QUANTITIES])
def test_what_update_leaves_is_computed_when_it_is_read(chaser, quantities):
    points = [chaser.point("right_hand"), chaser.point("head", "angular")]
    run = ospace.OperationalSpaceEvaluator(chaser, points, quantities)
    for seed in range(3):
        state = random_state(chaser, np.random.default_rng(seed), far=seed == 1)
        run.update(state.q, state.v)
        reference = ospace.operational_space(state, points)
        close(run.bias_force, reference.bias_force)
        for name in ("inertia_inverse", "inertia", "bias_acceleration", "jacobian", "response"):
            close(getattr(run, name), getattr(reference, name))
        for name in ("dynamically_consistent_inverse", "null_space_projector"):
            close(getattr(run, name), getattr(reference, name))
        floating = ospace.generalized_jacobian(state, points)
        close(run.generalized_jacobian, floating.generalized_jacobian)
        close(run.generalized_inertia, ospace.generalized_dynamics(state).generalized_inertia)
        close(run.generalized_bias, ospace.generalized_dynamics(state).generalized_bias)
        close(run.momentum, ospace.momentum(state))
        assert run.rank == 9


@pytest.mark.parametrize("name", [*evaluator.QUANTITIES, "rank", "response"])
def test_without_a_state_there_is_nothing_to_read(chaser, name):
    run = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"))
    with pytest.raises(ospace.OspaceError, match="update"):
        getattr(run, name)
    run.update(chaser.configuration())
    with pytest.raises(ospace.OspaceError):
        run.update(np.full(chaser.nq, np.nan))
    with pytest.raises(ospace.OspaceError, match="update"):
        getattr(run, name)


compiled = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="about compiled kernels")


@compiled
def test_update_allocates_nothing(chaser):
    state = random_state(chaser, np.random.default_rng(1))
    q, v = state.q.copy(), state.v.copy()
    run = ospace.OperationalSpaceEvaluator(chaser, [chaser.point("right_hand"), chaser.point("head")])
    run.update(q, v)
    _nrt_python.memsys_enable_stats()
    tracemalloc.start()
    before, (held, _) = rtsys.get_allocation_stats(), tracemalloc.get_traced_memory()
    tracemalloc.reset_peak()
    for _ in range(100):
        run.update(q, v)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    allocated = rtsys.get_allocation_stats()
    _nrt_python.memsys_disable_stats()
    assert (allocated.mi_alloc, allocated.alloc) == (before.mi_alloc, before.alloc)  # not even handles of arrays
    assert peak - held < run.inertia.nbytes  # Python's own objects: a tuple of arguments, a whole number


def test_a_chain_of_a_thousand_joints_needs_no_data_of_pinocchio(monkeypatch):
    def refuse(self, *given):
        raise AssertionError("64 nv³ bytes")

    monkeypatch.setattr("ospace.model.pinocchio_pass.PinocchioPass.__init__", refuse)
    robot = chain(1000)
    q, rng = robot.configuration(), np.random.default_rng(0)
    q[7:] = rng.uniform(-1.0, 1.0, 1000)
    points = [robot.point("link_999"), robot.point("link_500", "linear")]
    run = ospace.OperationalSpaceEvaluator(robot, points).update(q, rng.normal(size=1006))
    close(run.inertia @ run.inertia_inverse, np.eye(9), 1e-9)
    assert np.abs(run.momentum).max() > 0.0
    twice = ospace.OperationalSpaceEvaluator(robot, [robot.point("link_9"), robot.point("link_9")]).update(q)
    assert twice.rank == 6
    with pytest.raises(ospace.OspaceError, match=r"q\[9\]"):
        run.update(np.r_[q[:9], np.nan, q[10:]])
    many = ospace.operational_space_batch(robot, points, [q, q * np.nan, q])
    close(many.inertia_inverse[2], run.update(q).inertia_inverse, 1e-9)
    np.testing.assert_array_equal(many.bad, [1])


def chain(joints):
    """A chain of equal links: too long for Pinocchio's own working memory."""
    model = pin.Model()
    placement, body = pin.SE3.Identity(), pin.Inertia.FromBox(50.0, 1.0, 1.0, 1.0)
    for k in range(-1, joints):
        j = model.addJoint(k + 1, pin.JointModelRX() if k % 2 else pin.JointModelRY(), placement, f"joint_{k}")
        if k < 0:
            model = pin.Model()
            j = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
        model.appendBodyToJoint(j, body, pin.SE3.Identity())
        model.addBodyFrame("base" if k < 0 else f"link_{k}", j, pin.SE3.Identity(), 0)
        placement, body = pin.SE3(np.eye(3), np.array([0.3, 0.1, 0.2])), pin.Inertia.FromBox(2.0, 0.3, 0.2, 0.1)
    return ospace.SpaceRobot.from_model(model)


@pytest.mark.parametrize("turns", [10**3, 10**6, 10**9])
def test_angles_of_many_turns(chaser, turns):
    state = random_state(chaser, np.random.default_rng(7))
    q = state.q.copy()
    q[9] += 2.0 * np.pi * turns
    points = [chaser.point("right_hand")]
    agrees(ospace.OperationalSpaceEvaluator(chaser, points).update(q, state.v), chaser.state(q, state.v), points)


def test_joints_without_inertia_are_refused_by_both_alike():
    """Two joints about one axis with a massless ring between them."""
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia.FromBox(10.0, 1.0, 1.0, 1.0), pin.SE3.Identity())
    placement = pin.SE3(pin.exp3(np.array([0.3, -0.4, 0.5])), np.array([0.7, 0.2, -0.4]))
    ring = model.addJoint(root, pin.JointModelRZ(), placement, "outer")
    hand = model.addJoint(ring, pin.JointModelRZ(), pin.SE3.Identity(), "inner")
    model.appendBodyToJoint(hand, pin.Inertia.FromBox(1.0, 0.2, 0.3, 0.4), pin.SE3.Identity())
    model.addBodyFrame("hand", hand, pin.SE3.Identity(), 0)
    robot = ospace.SpaceRobot.from_model(model)
    point = robot.point("hand")
    run = ospace.OperationalSpaceEvaluator(robot, point)
    states = [trees.state(robot, seed) for seed in range(20)]
    for state in states:
        with pytest.raises(ospace.SingularInertiaError):
            run.update(state.q, state.v)
    assert ospace.operational_space_batch(robot, point, [state.q for state in states]).bad.size == 20


def test_without_velocity_there_is_no_bias(chaser):
    state = random_state(chaser, np.random.default_rng(2))
    result = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head")).update(state.q)
    np.testing.assert_array_equal(result.bias_acceleration, 0.0)


def test_arrays_are_its_own_and_stay_where_they_are(chaser):
    run = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"))
    states = [random_state(chaser, np.random.default_rng(seed)) for seed in range(2)]
    first = run.update(states[0].q, states[0].v).inertia
    kept = first.copy()
    assert run.update(states[1].q, states[1].v).inertia is first
    assert np.abs(first - kept).max() > 0.0
    run.update(states[0].q, states[0].v)
    np.testing.assert_array_equal(first, kept)


def test_two_evaluators_do_not_disturb_each_other(chaser):
    states = [random_state(chaser, np.random.default_rng(seed)) for seed in range(2)]
    one, two = (ospace.OperationalSpaceEvaluator(chaser, chaser.point("head")) for _ in range(2))
    kept = one.update(states[0].q, states[0].v).inertia.copy()
    two.update(states[1].q, states[1].v)
    np.testing.assert_array_equal(one.inertia, kept)


@pytest.mark.parametrize("form", [list, tuple, lambda x: x[::1].astype(np.longdouble), lambda x: np.repeat(x, 2)[::2]])
def test_what_is_no_plain_array_is_taken_as_well(chaser, form):
    state = random_state(chaser, np.random.default_rng(3))
    run = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"))
    expected = run.update(state.q.copy(), state.v.copy()).inertia.copy()
    np.testing.assert_array_equal(run.update(form(state.q), form(state.v)).inertia, expected)


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


@pytest.mark.parametrize("kind", ["nan", "infinite rate", "zero quaternion", "long quaternion", "huge rate", "short"])
def test_bad_input_is_an_error(chaser, kind):
    state = random_state(chaser, np.random.default_rng(4))
    run = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"))
    with pytest.raises(ospace.OspaceError):
        run.update(*broken(state.q, state.v, kind))
    agrees(run.update(state.q, state.v), state, [chaser.point("head")])


def test_dependent_rows_are_inverted_on_their_range(chaser):
    points = [chaser.point(name) for name in ("right_hand", "head", "base")]
    state = random_state(chaser, np.random.default_rng(5))
    run = ospace.OperationalSpaceEvaluator(chaser, points).update(state.q, state.v)
    reference = ospace.operational_space(state, points)
    assert (run.rank, reference.rank) == (16, 16)
    close(run.inertia, reference.inertia, 1e-9)
    close(run.bias_force, reference.bias_force, 1e-9)


def test_unknown_quantities_are_refused(chaser):
    with pytest.raises(ospace.OspaceError, match="'gamma'"):
        ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"), ("gamma",))
    with pytest.raises(ospace.OspaceError, match="'gamma'"):
        ospace.operational_space_batch(chaser, chaser.point("head"), np.zeros((0, chaser.nq)), quantities=("gamma",))


@pytest.mark.parametrize("largest", [1.0, 1e3, 9.9e4])
def test_sine_and_cosine_as_compiled(chaser, largest):
    run = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"), ())
    q, rng = chaser.configuration(), np.random.default_rng(0)
    for _ in range(100):
        q[7:] = rng.uniform(-largest, largest, 18)
        run.update(q)
        np.testing.assert_allclose(run.table("sine")[7:, 0], np.sin(q[7:]), rtol=0.0, atol=4e-16)
        np.testing.assert_allclose(run.table("cosine")[7:, 0], np.cos(q[7:]), rtol=0.0, atol=4e-16)


def test_the_rank_is_that_of_the_last_state():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    axes = (True, True, False, False, False, False)
    points = [robot.point(robot.frame_names[0]), robot.point("end_effector", axes)]
    first, second = robot.joint_names
    bent, straight = (robot.configuration({first: 0.3, second: angle}) for angle in (0.9, 0.0))
    run = ospace.OperationalSpaceEvaluator(robot, points)
    ranks = [ospace.operational_space(robot.state(q), points).rank for q in (bent, straight, bent)]
    assert len(set(ranks)) == 2
    assert [run.update(q).rank for q in (bent, straight, bent)] == ranks
    later = ospace.OperationalSpaceEvaluator(robot, points, ("inertia_inverse",)).update(straight)
    assert later.rank == ranks[1]
    assert later.jacobian.shape == (8, robot.nv)
    assert later.rank == ranks[1]


@pytest.mark.parametrize("form", [list, np.array])
def test_after_a_failure_no_old_result_is_left(chaser, form):
    for robot in (chaser, trees.tree(3, 14)):
        run = ospace.OperationalSpaceEvaluator(robot, robot.point(robot.frame_names[0]))
        run.update(robot.configuration())
        for wrong in (np.full(robot.nq, np.nan), np.zeros(3)):
            with pytest.raises(ospace.OspaceError):
                run.update(form(wrong))
            with pytest.raises(ospace.OspaceError, match="update"):
                _ = run.inertia


def test_velocities_are_checked_whatever_is_asked_for(chaser):
    v = np.zeros(24)
    v[3] = np.nan
    with pytest.raises(ospace.OspaceError, match=r"v\[3\]"):
        ospace.OperationalSpaceEvaluator(chaser, chaser.point("head"), "inertia_inverse").update(
            chaser.configuration(), v
        )
    result = ospace.operational_space_batch(chaser, chaser.point("head"), [chaser.configuration()] * 2, [v, v * 0.0])
    np.testing.assert_array_equal(result.bad, [0, 1])


def test_copies_have_memory_of_their_own(chaser):
    run = ospace.OperationalSpaceEvaluator(chaser, chaser.point("head")).update(chaser.configuration())
    kept = run.inertia.copy()
    copy.copy(run).update(chaser.configuration({"torso_1": 1.0}))
    np.testing.assert_array_equal(run.inertia, kept)
    with pytest.raises(AttributeError, match="inertia"):
        run.inertia = kept


def test_first_use_by_several_threads(tmp_path):
    program = """
import numba, numpy as np, threading, ospace
robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
before, failed = numba.config.SLP_VECTORIZE, []
def use():
    try:
        ospace.OperationalSpaceEvaluator(robot, robot.point("head")).update(robot.configuration())
    except BaseException as error:
        failed.append(error)
threads = [threading.Thread(target=use) for _ in range(4)]
[thread.start() for thread in threads]
[thread.join() for thread in threads]
assert not failed, failed
assert numba.config.SLP_VECTORIZE == before
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=300)


# -- many states -------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def states(chaser):
    rng = np.random.default_rng(6)
    return [random_state(chaser, rng, far=k % 2 == 0) for k in range(21)]


@pytest.fixture(scope="module")
def many(states):
    return np.array([state.q for state in states]), np.array([state.v for state in states])


@pytest.fixture(scope="module")
def points(chaser):
    return [chaser.point("right_hand"), chaser.point("head", "angular")]


@pytest.fixture(scope="module")
def whole(chaser, points, many):
    return ospace.operational_space_batch(chaser, points, *many, quantities=ALL)


def test_every_state_is_as_it_is_alone(chaser, points, states, whole):
    for k, state in enumerate(states):
        one = ospace.operational_space(state, points, "dense")
        close(whole.inertia_inverse[k], one.inertia_inverse)
        close(whole.inertia_inverse_packed[k], one.inertia_inverse[np.tril_indices(9)])
        close(whole.inertia[k], one.inertia)
        close(whole.bias_acceleration[k], one.bias_acceleration)
        close(whole.bias_force[k], one.bias_force)
        close(whole.momentum[k], ospace.momentum(state))
        close(whole.generalized_inertia[k], ospace.generalized_dynamics(state).generalized_inertia)
        J = ospace.generalized_jacobian(state, points).generalized_jacobian
        close(whole.generalized_jacobian[k], J)
        assert whole.smallest_singular_value[k] == pytest.approx(np.linalg.svd(J, compute_uv=False)[-1], rel=1e-9)
    assert whole.bad.size == 0


@pytest.mark.parametrize("width", sorted(simd.WIDTHS))
def test_all_widths_agree(chaser, points, many, whole, width, monkeypatch):
    monkeypatch.setattr(simd, "widest", lambda: width)
    narrow = ospace.operational_space_batch(chaser, points, *many, quantities=ALL)
    for name in ALL:
        close(getattr(narrow, name), getattr(whole, name), 1e-12)


def test_threads_and_chunks_do_not_matter(chaser, points, many, whole, monkeypatch):
    monkeypatch.setattr(batch, "CHUNK", 4)
    for threads in (1, 3):
        split = ospace.operational_space_batch(chaser, points, *many, quantities=ALL, threads=threads)
        for name in ALL:
            np.testing.assert_array_equal(getattr(split, name), getattr(whole, name))


def test_threads_by_environment(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert batch._threads(None) == 3
    monkeypatch.setenv("OMP_NUM_THREADS", "3,1")
    assert batch._threads(None) == 3
    monkeypatch.setenv("OSPACE_NUM_THREADS", "2")
    assert batch._threads(None) == 2
    assert batch._threads(5) == 5


@pytest.mark.parametrize("kind", ["nan", "infinite rate", "zero quaternion", "long quaternion", "huge rate"])
def test_a_bad_state_is_told_and_touches_no_other(chaser, points, many, whole, kind):
    Q, V = (states.copy() for states in many)
    Q[5], V[5] = broken(Q[5], V[5], kind)
    result = ospace.operational_space_batch(chaser, points, Q, V, ALL)
    np.testing.assert_array_equal(result.bad, [5])
    for name in ALL:
        assert not np.any(getattr(result, name)[5])
        np.testing.assert_array_equal(np.delete(getattr(result, name), 5, 0), np.delete(getattr(whole, name), 5, 0))


def test_results_may_go_to_a_file(chaser, points, many, whole, tmp_path):
    shape = whole.inertia_inverse.shape
    out = np.lib.format.open_memmap(tmp_path / "out.npy", mode="w+", dtype=float, shape=shape)
    result = ospace.operational_space_batch(chaser, points, *many, out={"inertia_inverse": out})
    assert result.inertia_inverse is out
    out.flush()
    close(np.load(tmp_path / "out.npy"), whole.inertia_inverse, 1e-12)


def test_joints_of_all_types_run_in_the_lanes():
    robot = trees.tree(3, 14)
    states = [trees.state(robot, seed) for seed in range(5)]
    point = robot.point("link_7")
    result = ospace.operational_space_batch(
        robot, point, [state.q for state in states], [state.v for state in states], ALL
    )
    for k, state in enumerate(states):
        one = ospace.operational_space(state, point)
        close(result.inertia_inverse[k], one.inertia_inverse)
        close(result.bias_force[k], one.bias_force)


def test_dependent_rows_of_many_states(chaser, many):
    points = [chaser.point(name) for name in ("right_hand", "head", "base")]
    result = ospace.operational_space_batch(chaser, points, many[0][:3], quantities=("inertia",))
    reference = ospace.operational_space(chaser.state(many[0][1]), points)
    assert result.bad.size == 0
    close(result.inertia[1], reference.inertia, 1e-9)


@compiled
def test_states_may_be_read_only_and_the_last_chunk_short(chaser, points, many, whole, monkeypatch):
    monkeypatch.setattr(batch, "CHUNK", 4)
    before = len(kernels.BY_WIDTH[simd.widest()].signatures)
    for states in many:
        states.flags.writeable = False
    split = ospace.operational_space_batch(chaser, points, *many, quantities=ALL)
    np.testing.assert_array_equal(split.inertia, whole.inertia)
    assert len(kernels.BY_WIDTH[simd.widest()].signatures) == before


def test_no_states(chaser, points):
    result = ospace.operational_space_batch(chaser, points, np.zeros((0, chaser.nq)), quantities=("inertia_inverse",))
    assert result.inertia_inverse.shape == (0, 9, 9)


@pytest.mark.parametrize(
    ("Q", "V", "out", "threads", "words"),
    [
        (np.zeros(25), None, {}, 1, r"\(N, 25\)"),
        (np.zeros((3, 24)), None, {}, 1, r"\(N, 25\)"),
        ("some", None, {}, 1, "not an array"),
        (np.zeros((3, 25)), np.zeros((2, 24)), {}, 1, "3 states"),
        (np.zeros((3, 25)), None, {"inertia_inverse": np.zeros((3, 9, 8))}, 1, "shape"),
        (np.zeros((3, 25)), None, {"inertia_inverse": np.zeros((3, 9, 9), np.float32)}, 1, "float64"),
        (np.zeros((3, 25)), None, {"inertia_inverse": [0.0]}, 1, "writable"),
        (np.zeros((3, 25)), None, {"gamma": np.zeros(3)}, 1, "'gamma'"),
        (np.zeros((3, 25)), None, {"inertia": np.zeros((3, 9, 9))}, 1, "'inertia'"),
        (np.zeros((3, 25)), None, np.zeros((3, 9, 9)), 1, "mapping"),
        (np.zeros((3, 25)) * 1j, None, {}, 1, "not an array"),
        (np.zeros((3, 25)), None, {}, 0, "threads"),
        (np.zeros((3, 25)), None, {}, "2", "threads"),
    ],
)
def test_wrong_use_is_an_error(chaser, points, Q, V, out, threads, words):
    with pytest.raises(ospace.OspaceError, match=words):
        ospace.operational_space_batch(chaser, points, Q, V, out=out, threads=threads)


def test_an_interrupt_ends_the_run(chaser, points, many, monkeypatch):
    def interrupt(self, chunk):
        raise KeyboardInterrupt

    monkeypatch.setattr(batch._Worker, "run", interrupt)
    with pytest.raises(KeyboardInterrupt):
        ospace.operational_space_batch(chaser, points, *many)


@pytest.mark.parametrize("lanes", [1, 2, 8])
def test_tables_begin_with_a_line_of_the_cache_and_do_not_overlap(chaser, points, lanes):
    work = workspace.lay_out(layout_of(chaser, points), chaser.nq, lanes)
    starts, rows, columns = work[: 3 * workspace.TABLES].view(np.int64).reshape(-1, 3).T
    each = np.where(np.arange(workspace.TABLES) < workspace.place_of("q"), 1, lanes)
    ends = np.r_[3 * workspace.TABLES, starts + rows * columns * each]
    assert work.ctypes.data % 64 == 0
    np.testing.assert_array_equal(starts % 8, 0)
    assert (ends <= np.r_[starts, len(work)]).all()

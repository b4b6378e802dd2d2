"""The evaluator: the same results as functions of a state, in arrays of its own."""

import copy
import subprocess
import sys
import tracemalloc

import numpy as np
import pinocchio as pin
import pytest
import trees
from evaluated import agrees, broken, close, compiled, draw_points
from hypothesis import given, settings
from hypothesis import strategies as st
from numba.core.runtime import _nrt_python, rtsys

import ospace
from ospace.dynamics import evaluator
from ospace.dynamics.dense import Dense
from ospace.validation.sampling import random_state

ONE_DEGREE = tuple(name for name in trees.JOINT_TYPES if name.startswith(("revolute", "continuous", "prismatic")))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 14), st.floats(0.0, 1.0), st.integers(1, 6), st.booleans(), st.booleans())
def test_any_points_on_any_tree_agree_with_the_dense_form(seed, joints, branching, count, far, mixed):
    robot = trees.tree(seed, joints, None if mixed else ONE_DEGREE, branching)
    points = draw_points(robot, np.random.default_rng(seed), count)
    state = trees.state(robot, seed, far)
    result = ospace.OperationalSpaceEvaluator(robot, points).update(state.q, state.v)
    tolerance = 1e-12 * np.linalg.cond(Dense(state, points).H)
    agrees(result, state, points, tolerance)
    assert result.rank == ospace.operational_space(state, points).rank


@pytest.mark.parametrize("name", ospace.models.names())
def test_models_that_come_with_ospace_agree_with_the_dense_form(name):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    points = [robot.point(link) for link in robot.leaf_links]
    run = ospace.OperationalSpaceEvaluator(robot, points)
    for seed in range(4):
        state = random_state(robot, np.random.default_rng(seed), far=bool(seed % 2))
        agrees(run.update(state.q, state.v), state, points)


def test_inertia_and_bias_force_are_the_dense_ones(chaser):
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
def test_angles_of_many_turns_are_those_of_one(chaser, turns):
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


@pytest.mark.parametrize("kind", ["nan", "infinite rate", "zero quaternion", "long quaternion", "huge rate", "short"])
def test_the_evaluator_refuses_bad_input(chaser, kind):
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

"""Many states at once: each as it is alone, whatever threads, chunks and lanes take it."""

import numpy as np
import pytest
import trees
from evaluated import ALL, broken, close, compiled

import ospace
from ospace.dynamics import batch
from ospace.kernels import batch as kernels
from ospace.kernels.jit import simd
from ospace.validation.sampling import random_state


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
def test_results_do_not_depend_on_the_width_of_a_vector(chaser, points, many, whole, width, monkeypatch):
    monkeypatch.setattr(simd, "widest", lambda: width)
    narrow = ospace.operational_space_batch(chaser, points, *many, quantities=ALL)
    for name in ALL:
        close(getattr(narrow, name), getattr(whole, name), 1e-12)


def test_results_do_not_depend_on_threads_and_chunks(chaser, points, many, whole, monkeypatch):
    monkeypatch.setattr(batch, "CHUNK", 4)
    for threads in (1, 3):
        split = ospace.operational_space_batch(chaser, points, *many, quantities=ALL, threads=threads)
        for name in ALL:
            np.testing.assert_array_equal(getattr(split, name), getattr(whole, name))


def test_the_environment_sets_the_threads(monkeypatch):
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


def test_no_states_give_empty_arrays(chaser, points):
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
def test_the_batch_refuses_wrong_use(chaser, points, Q, V, out, threads, words):
    with pytest.raises(ospace.OspaceError, match=words):
        ospace.operational_space_batch(chaser, points, Q, V, out=out, threads=threads)


def test_an_interrupt_ends_the_batch(chaser, points, many, monkeypatch):
    def interrupt(self, chunk):
        raise KeyboardInterrupt

    monkeypatch.setattr(batch._Worker, "run", interrupt)
    with pytest.raises(KeyboardInterrupt):
        ospace.operational_space_batch(chaser, points, *many)

"""A program on what levels above leave free: against the same by matrices."""

import numba
import numpy as np
import pytest

import ospace
from ospace.control import BaseAttitudeTask, Controller, DampingTask
from ospace.control.priorities import Level, solve_by_levels
from ospace.control.solvers import by_proximal_steps, solver_named
from ospace.kernels.qp.null_space import Restricted, eliminate, excess, restrict
from ospace.kernels.qp.tables import UNLIMITED, Program


def program_of(seed, size=9, rows=6):
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(size, size))
    C = rng.normal(size=(rows, size))
    bounds = rng.uniform(0.5, 2.0, size=(2, size + rows))
    bounds[rng.random(bounds.shape) < 0.3] = UNLIMITED
    none = np.zeros((2, size), dtype=np.int64)
    return Program(A.T @ A + np.eye(size), rng.normal(size=size), C, -bounds[0], bounds[1], none)


def directions(seed, size, m):
    return np.linalg.qr(np.random.default_rng(seed).normal(size=(size, m)))[0]


def restricted(program, z, N, room):
    size, m = N.shape
    rows = size + len(program.C)
    to = Restricted(*map(np.full, ((m, m), m, (rows, m), m + rows, m + rows, (size, m)), [np.nan] * 6))
    kept = restrict(program, z, N, room, to)
    return to.H, to.f, to.C[:kept], to.lower[: m + kept], to.upper[: m + kept]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("room", [0.0, 1e-3])
def test_the_program_in_y_is_that_of_matrices(seed, room):
    program, m = program_of(seed), 5
    rng = np.random.default_rng(seed + 100)
    z, N = 0.1 * rng.normal(size=9), np.ascontiguousarray(directions(seed, 9, m))
    H, f, C, lower, upper = restricted(program, z, N, room)
    scale = 1.0 / np.diag(N.T @ program.H @ N).max()
    np.testing.assert_allclose(H, scale * N.T @ program.H @ N, atol=1e-13)
    np.testing.assert_allclose(f, scale * N.T @ (program.f + program.H @ z), atol=1e-13)
    rows = np.vstack([np.eye(9), program.C])
    bounded = (program.lower > -UNLIMITED) | (program.upper < UNLIMITED)
    length, value = np.linalg.norm(rows @ N, axis=1)[bounded], (rows @ z)[bounded]
    np.testing.assert_allclose(C, (rows @ N)[bounded] / length[:, None], atol=1e-13)
    assert (lower[:m] == -UNLIMITED).all()
    assert (upper[:m] == UNLIMITED).all()
    for bound, mine, sign in ((program.lower, lower[m:], -1.0), (program.upper, upper[m:], 1.0)):
        bound, none = bound[bounded], np.abs(bound[bounded]) == UNLIMITED
        way = np.maximum(sign * (bound - value) + room * np.maximum(1.0, np.abs(bound)), 0.0) / length
        np.testing.assert_allclose(mine[~none], sign * way[~none], atol=1e-13)
        np.testing.assert_array_equal(mine[none], sign * UNLIMITED)


def test_rows_without_a_part_in_the_free_directions_are_left_out():
    program = program_of(0)
    N = np.zeros((9, 2))
    N[3, 0] = N[4, 1] = 1.0
    _, _, C, lower, _ = restricted(program._replace(lower=np.full(15, -1.0)), np.zeros(9), N, 0.0)
    assert len(C) == 2 + 6  # two of z, all of C
    assert len(lower) == 2 + 8


@pytest.mark.parametrize(("rows", "rank"), [(3, 3), (4, 2), (9, 6), (2, 0)])
@pytest.mark.parametrize("seed", range(3))
def test_the_directions_left_are_free_of_the_rows_and_orthonormal(rows, rank, seed):
    rng, m = np.random.default_rng(seed), 6
    A = rng.normal(size=(rows, rank)) @ rng.normal(size=(rank, 9))
    N = np.ascontiguousarray(directions(seed, 9, m))
    before, B = N.copy(), A @ N
    taken = eliminate(B, N, 1e-9 * np.linalg.norm(A))
    assert taken == rank
    np.testing.assert_allclose(A @ N[:, taken:], 0.0, atol=1e-12)
    np.testing.assert_allclose(N.T @ N, np.eye(m), atol=1e-13)
    np.testing.assert_allclose(N @ N.T, before @ before.T, atol=1e-13)


def test_the_excess_is_that_of_the_bound_that_is_passed_most():
    program, rng = program_of(3), np.random.default_rng(0)
    y = 3.0 * rng.normal(size=9)
    value = np.r_[y, program.C @ y]
    passed = np.maximum(value - program.upper, program.lower - value)
    assert excess(program, y) == pytest.approx(passed.max())
    assert excess(program, 0.0 * y) == 0.0
    assert excess(program, y * np.nan) == np.inf


def test_a_solution_that_passes_bounds_is_not_believed():
    """As DAQP's are at times, where many bind at once: the level is solved in proximal steps instead."""
    program, level = program_of(1), Level(np.eye(9)[:2], np.array([5.0, 5.0]), *np.zeros((2, 9)))
    right, calls = solver_named("daqp"), []

    def wrong(given):
        y = right(given)
        calls.append(len(given.f))
        return y if len(calls) == 1 else y + 1e-3

    found = solve_by_levels(program, [level], wrong, 1e-6)
    expected = solve_by_levels(program, [level], right, 1e-6)
    assert len(calls) == 2
    assert found.dropped == ()
    np.testing.assert_allclose(found.z, expected.z, atol=1e-6)
    assert excess(program, found.z) < 1e-5
    assert by_proximal_steps(program) is not None


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="about compiled kernels")
def test_warm_up_compiles_what_levels_and_limits_in_contradiction_would():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    controller = Controller(robot, [BaseAttitudeTask(name="base", robot=robot, level=0), DampingTask(name="rest")])
    Controller(robot, DampingTask(name="rest")).warm_up()
    codes = [len(one.overloads) for one in (restrict, eliminate, excess)]
    assert min(codes) > 0
    controller.update(0.0, robot.configuration(), np.full(robot.nv, 0.1))
    assert [len(one.overloads) for one in (restrict, eliminate, excess)] == codes

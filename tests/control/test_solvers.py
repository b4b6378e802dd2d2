"""Solvers: all give the same command, a rough one is refused, and one that fails ends in a damped stop."""

import numpy as np
import pinocchio as pin
import pytest
import qpsolvers
from commands import KEPT, SOLVERS, accelerations, leveled_states, paper_tasks, state

import ospace
from ospace.control import (
    Constant,
    Controller,
    JointLimits,
    PoseTask,
)


@pytest.mark.parametrize("share", [1.0, 0.02])
def test_a_solver_that_fails_ends_in_a_damped_stop(chaser, hand, share):
    limits = JointLimits.of(chaser, share=share)
    run = Controller(chaser, [PoseTask(name="hand", point=hand)], limits=limits)
    run._solve = lambda program: None
    for seed in range(20):
        q, v = state(chaser, seed, speed=1.0)
        command = run.update(0.0, q, v)
        assert command.status == "stopped"
        assert "braked" in command.explanation
        assert (np.abs(command.torque) <= limits.torque).all()
        assert (command.torque * v[6:] <= 1e-10).all()
        a = accelerations(chaser, q, v, command)
        np.testing.assert_allclose(a[6:], command.joint_acceleration, rtol=0, atol=1e-8 * np.abs(a).max())


def test_the_solvers_that_are_compared_are_many():
    assert set(qpsolvers.available_solvers) >= {"daqp", "proxqp", "quadprog", "clarabel", "highs", "osqp", "piqp"}


def test_a_solver_that_is_too_rough_is_refused(chaser, hand):
    with pytest.raises(ospace.OspaceError, match="'ecos'"):
        Controller(chaser, [PoseTask(name="hand", point=hand)], solver="ecos")


@pytest.mark.parametrize("solver", SOLVERS)
def test_all_solvers_give_the_same(chaser, hand, head, solver):
    limits = JointLimits.of(chaser, share=0.2, acceleration=5.0)
    tasks = paper_tasks(chaser, hand, head)
    runs = [Controller(chaser, tasks, limits=limits, solver=name, base="flying") for name in ("daqp", solver)]
    for seed in range(10):
        q, v = state(chaser, seed)
        for run in runs:
            run.follow("hand", Constant(pin.SE3.Identity()))
        one, other = (run.update(0.0, q, v) for run in runs)
        for name in ("joint_acceleration", "torque", "base_wrench"):
            value, reference = getattr(other, name), getattr(one, name)
            np.testing.assert_allclose(value, reference, rtol=0, atol=1e-6 * max(1.0, np.abs(reference).max()))


SLOW = {"highs": 20, "osqp": 5, "scs": 5}


@pytest.mark.parametrize("solver", SOLVERS)
def test_all_solvers_give_the_same_by_levels(chaser, hand, solver):
    limits = JointLimits.of(chaser, share=0.3)
    for tasks, q, v in leveled_states(chaser, hand, SLOW.get(solver, 100)):
        one, other = (
            Controller(chaser, tasks, limits=limits, solver=name).update(0.0, q, v) for name in ("daqp", solver)
        )
        assert {one.status, other.status} <= {*KEPT}, (one.explanation, other.explanation)
        assert not other.dropped
        np.testing.assert_allclose(other.torque, one.torque, rtol=0, atol=1e-4 * (1.0 + np.abs(one.torque).max()))

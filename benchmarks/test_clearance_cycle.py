"""A control cycle that keeps 20 pairs of links apart, and Coal alone: ``pytest benchmarks -k clearance``."""

import itertools

import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.collision import CollisionGeometry
from ospace.collision.pairs import solver_of_links
from ospace.control import BaseAttitudeTask, Clearance, Controller, OrientationTask, PoseTask, PostureTask

ROBOT = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
PAIRS = 20


def nearest_pairs(q):
    """Return the pairs of links that are nearest to each other in a configuration."""
    watched = Clearance(robot=ROBOT, distance=0.03).watched
    solver, places = solver_of_links(CollisionGeometry.of(ROBOT), watched)
    solver.configure(q)
    found = solver.distances()
    order = np.argsort([found[place].min() for place in places])
    return [watched[k] for k in order[:PAIRS]]


def states():
    """Return states around one, all of whose 20 pairs are near enough to have rows."""
    rng, q = np.random.default_rng(1), ROBOT.configuration()
    return [(pin.integrate(ROBOT.model, q, 1e-3 * rng.normal(size=ROBOT.nv)), 0.05 * rng.normal(size=ROBOT.nv))
            for _ in range(64)]  # fmt: skip


STATES = states()


def cycle(inequalities):
    tasks = [
        PoseTask(name="hand", point=ROBOT.point("right_hand")),
        OrientationTask(name="head", point=ROBOT.point("head")),
        BaseAttitudeTask(name="base", robot=ROBOT),
        PostureTask(name="posture"),
    ]
    run, clock = Controller(ROBOT, tasks, inequalities=inequalities), itertools.count()
    return lambda q, v: run.update(next(clock) * 1e-3, q, v)


@pytest.mark.parametrize("what", ["without", "with 20 pairs", "Coal alone"])
def test_cycle_with_clearance(benchmark, what):
    chosen = nearest_pairs(STATES[0][0])
    if what == "Coal alone":
        solver, _ = solver_of_links(CollisionGeometry.of(ROBOT), chosen)
        numbers, all_ = np.zeros((PAIRS, 10)), np.arange(PAIRS)

        def once(q, v):
            solver.configure(q)
            solver.nearest(all_, numbers)
    else:
        once = cycle(Clearance(robot=ROBOT, distance=0.03, pairs=chosen) if what != "without" else ())
    taken = itertools.cycle(STATES)
    benchmark(lambda: once(*next(taken)))

"""The table of allowed collisions: what it leaves out need not be watched, and it says why."""

import numpy as np
import pytest
import solids

import ospace
from ospace.collision import CollisionGeometry, pair_table
from ospace.collision.pairs import overlaps, solver_of_links
from ospace.validation.sampling import random_state

REACH = solids.joint("bus", "arm", reach=0.2)


def table_of(folder, *parts, clearance=0.0, **given):
    robot = solids.robot(folder, *parts)
    table = pair_table(CollisionGeometry.of(robot), clearance, **given)
    return {tuple(sorted(pair)): reason for pair, reason in table.items()}


def test_one_body_and_the_next_one_with_a_shape_need_no_watch(tmp_path):
    table = table_of(
        tmp_path,
        solids.link("deck", solids.BOX),
        solids.joint("bus", "deck", "fixed"),
        solids.link("mast", solids.BOX, origin="0 0 0.5"),
        solids.joint("bus", "mast", "fixed"),
        solids.link("elbow"),
        solids.joint("deck", "elbow", origin="0.3 0 0"),
        solids.link("fore", solids.BALL),
        solids.joint("elbow", "fore", axis="0 1 0", origin="0.1 0 0"),
        solids.link("hand", solids.BALL),
        solids.joint("fore", "hand", axis="0 1 0", origin="0.35 0 0"),
    )
    assert table["deck", "mast"] == "one body"
    assert table["deck", "fore"] == table["fore", "mast"] == "adjacent"  # the elbow between them has no shape
    assert table["fore", "hand"] == "adjacent"
    assert table["deck", "hand"] == "watched"


def test_what_overlaps_at_zero_is_told_and_not_watched(tmp_path):
    parts = [
        solids.link("first", solids.BALL),
        solids.joint("bus", "first", origin="0.5 0 0"),
        solids.link("second", solids.BALL, origin="-0.4 0.05 0"),
        solids.joint("bus", "second", origin="0.95 0 0"),
    ]
    robot = solids.robot(tmp_path, *parts)
    geometry = CollisionGeometry.of(robot)
    assert pair_table(geometry)["first", "second"] == "overlap at zero"
    assert overlaps(geometry) == {("first", "second"): pytest.approx(0.2 - np.hypot(0.05, 0.05), abs=1e-5)}


def test_what_never_comes_near_is_left_out_only_beyond_the_clearance(tmp_path):
    parts = (
        solids.link("pole", solids.BALL, origin="0 2 0"),
        solids.joint("bus", "pole", "prismatic", reach=0.01),
        solids.link("arm", solids.BALL, origin="0.5 0 0"),
        REACH,
    )
    assert table_of(tmp_path, *parts)["arm", "pole"] == "never near"
    assert table_of(tmp_path, *parts, clearance=1.8)["arm", "pole"] == "watched"
    assert table_of(tmp_path, *parts, clearance=5.0)["arm", "pole"] == "always near"
    assert table_of(tmp_path, *parts, sampled=False)["arm", "pole"] == "watched"


@pytest.mark.parametrize("model", ["chaser_24dof", "chaser_7dof", "ets_vii"])
def test_no_other_configuration_brings_what_is_left_out_near(model):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(model))
    geometry = CollisionGeometry.of(robot)
    table = pair_table(geometry, 0.03)
    left_out = [pair for pair, reason in table.items() if reason == "never near"]
    assert left_out
    solver, places = solver_of_links(geometry, left_out)
    starts, rng = [place.start for place in places], np.random.default_rng(99)
    low, high = robot.model.lowerPositionLimit[7:], robot.model.upperPositionLimit[7:]
    for _ in range(1000):
        q = robot.configuration()
        q[7:] = rng.uniform(low, high)
        solver.configure(q)
        nearest = np.minimum.reduceat(solver.distances(), starts)
        assert nearest.min() > 0.03, left_out[int(nearest.argmin())]


def test_the_table_is_the_same_each_time():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
    again = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
    random_state(robot, np.random.default_rng(0))
    tables = [pair_table(CollisionGeometry.of(one), 0.02) for one in (robot, again)]
    assert tables[0] == tables[1]

"""Maps of an arm: their numbers are those of single states, and their extremes those of all postures."""

from __future__ import annotations

import numpy as np
import pytest
import trees

import ospace
from ospace import OspaceError, analysis
from ospace.analysis import arm_map
from ospace.analysis.arm_map import ArmMap, grid_postures, random_postures
from ospace.analysis.cells import Cells
from ospace.analysis.map_result import MapResult

ALL = tuple(arm_map.WHAT)


@pytest.fixture(scope="module")
def chaser():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
    return analysis.Arm(robot, robot.point("end_effector"))


@pytest.fixture(scope="module")
def mapped(chaser):
    return analysis.map_arm(chaser, ALL, random=3000, seed=2)


def column(found, name):
    return [one.name for one in found.quantities].index(name)


def test_quantities_are_those_of_a_state(chaser):
    """The arm is 3.8 m long, which is L."""
    x = chaser.draw(np.random.default_rng(0), 4)
    found, values = ArmMap.empty(chaser, ALL).with_postures(x)
    hand, rows = chaser.point, np.r_[np.full(3, 1.0 / chaser.length), np.ones(3)]
    for k, q in enumerate(chaser.configurations(x)):
        state = chaser.robot.state(q)
        J = rows[:, None] * ospace.generalized_jacobian(state, hand).generalized_jacobian
        H = ospace.generalized_dynamics(state).generalized_inertia / chaser.length**2
        centre = chaser.posture(x[k : k + 1]).centre[0]
        motion = analysis.base_motion(chaser.robot, [chaser.at[7:], q[7:]])
        expected = {
            **dict(zip(("hand_x", "hand_y", "hand_z"), state.placement(hand).translation, strict=True)),
            "reach": np.linalg.norm(state.placement(hand).translation - centre),
            "singular_value": np.linalg.svd(J, compute_uv=False)[-1],
            "manipulability": np.prod(np.linalg.svd(J @ np.linalg.inv(H), compute_uv=False)),
            "disturbance": analysis.disturbance_map(state).sizes[0],
            "base_turn": analysis.base_turn(motion),
        }
        most = np.abs(analysis.wheel_momentum(state)) @ chaser.robot.model.velocityLimit[6:]
        expected |= dict(zip(("wheel_x", "wheel_y", "wheel_z"), most, strict=True))
        for name, value in expected.items():
            tolerance = 2e-6 if name == "base_turn" else 1e-9 * abs(value)
            assert values[k, column(found, name)] == pytest.approx(value, abs=tolerance), name


@pytest.mark.parametrize("seed", range(2))
def test_joints_that_slide_count_in_lengths_of_the_arm(seed):
    robot = trees.tree(seed, 4, ("revolute", "prismatic", "revolute about any axis"), branching=0.0)
    arm = analysis.Arm(robot, robot.point("link_3", "linear"))
    x = arm.draw(np.random.default_rng(seed), 3)
    found, values = ArmMap.empty(arm, ["singularity", "disturbance", "wheels"]).with_postures(x)
    for k, q in enumerate(arm.configurations(x)):
        state = robot.state(q)
        J = ospace.generalized_jacobian(state, arm.point).generalized_jacobian / arm.length * arm.scale
        spin = ospace.generalized_jacobian(state, arm.point).base_generalized_jacobian[3:] * arm.scale
        least, disturbance = (np.linalg.svd(one, compute_uv=False) for one in (J, spin))
        np.testing.assert_allclose(values[k, column(found, "singular_value")], least[-1], rtol=1e-9)
        np.testing.assert_allclose(values[k, column(found, "disturbance")], disturbance[0], rtol=1e-9)
        np.testing.assert_allclose(values[k, 3:], np.abs(analysis.wheel_momentum(state)).sum(axis=1), rtol=1e-9)


def test_extremes_means_and_postures_are_those_of_all(chaser, mapped, monkeypatch):
    x = np.vstack(list(random_postures(chaser, 3000, 2)))
    _, values = ArmMap.empty(chaser, ALL).with_postures(x)
    assert mapped.count == 3000
    np.testing.assert_allclose(mapped.whole.low[0], values.min(axis=0))
    np.testing.assert_allclose(mapped.whole.high[0], values.max(axis=0))
    np.testing.assert_allclose(mapped.mean, values.mean(axis=0))
    np.testing.assert_array_equal(mapped.whole.at_low[0], x[values.argmin(axis=0)])
    np.testing.assert_array_equal(mapped.whole.at_high[0], x[values.argmax(axis=0)])
    monkeypatch.setattr(arm_map, "CHUNK", 700)  # chunks or not, a seed gives the same
    again = analysis.map_arm(chaser, ALL, random=3000, seed=2)
    for cells, others in ((again.voxels, mapped.voxels), (again.shells, mapped.shells), (again.grades, mapped.grades)):
        np.testing.assert_array_equal(cells.index, others.index)
        np.testing.assert_array_equal(cells.count, others.count)
        np.testing.assert_allclose(cells.at_low, others.at_low, rtol=1e-12)
        np.testing.assert_allclose(cells.high, others.high, rtol=1e-12)


def test_voxels_and_shells_are_where_the_hand_is(chaser, mapped):
    assert mapped.voxels.count.sum() == mapped.shells.count.sum() == 3000
    least = [one.name for one in mapped.fields].index("singular_value")
    posture = chaser.posture(mapped.voxels.at_low[:, least])
    assert np.abs(posture.hand - mapped.voxel_centres).max() <= 0.5 * mapped.voxel + 1e-12
    posture = chaser.posture(mapped.shells.at_high[:, least])
    off = np.linalg.norm(posture.from_centre, axis=1) - mapped.shell_radii
    assert np.abs(off).max() <= 0.5 * mapped.shell + 1e-12


def test_the_level_base_envelope_is_that_of_all_postures(chaser, mapped):
    _, values = ArmMap.empty(chaser, ALL).with_postures(np.vstack(list(random_postures(chaser, 3000, 2))))
    turn, reach = values[:, column(mapped, "base_turn")], values[:, column(mapped, "reach")]
    grades = MapResult(mapped, None, None, 3000, "random").grades
    assert [grade.share for grade in grades][-1] == 1.0
    for grade in grades:
        inside = turn <= grade.turn
        assert grade.share == pytest.approx(inside.mean())
        np.testing.assert_allclose(grade.reach, [reach[inside].min(), reach[inside].max()])
        assert 0.0 < grade.volume <= 1.0


def test_a_grid_goes_from_end_to_end():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    arm = analysis.Arm(robot, robot.point("end_effector", "linear"))
    x = np.vstack(list(grid_postures(arm, 5)))
    assert x.shape == (25, 2)
    np.testing.assert_allclose(x[[0, 4, 20, 24]], [[a, b] for a in (-2.9671, 2.9671) for b in (-2.9671, 2.9671)])
    for each in (5, 72, 73):
        found = analysis.map_arm(arm, ["disturbance"], grid=each)
        assert found.count == len(found.plane.index) == each**2 == found.plane_cells**2
        np.testing.assert_array_equal(found.plane.count, 1)


def test_progress_counts_postures_and_may_end_the_map(chaser):
    done = []
    analysis.map_arm(chaser, random=20_000, progress=done.append)
    assert done == [8192, 16384, 20000]

    def enough(count):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        analysis.map_arm(chaser, random=20_000, progress=enough)


def test_memory_grows_with_cells_alone(chaser):
    one, ten = (analysis.map_arm(chaser, random=count) for count in (8192, 81920))
    assert len(ten.voxels.index) < 3 * len(one.voxels.index)
    assert len(ten.voxels.index) < 28**3


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"what": ["reach", "gravity"]}, "'gravity' is unknown: give some of reach"),
        ({"what": []}, "a map of nothing"),
        ({"random": 0}, "random is 0: give a whole number from 1 on"),
        ({"grid": 1}, "grid is 1: give a whole number from 2 on"),
        ({"seed": 0.5}, "seed is 0.5"),
    ],
)
def test_a_map_that_makes_no_sense_is_refused(chaser, options, message):
    with pytest.raises(OspaceError, match=message):
        analysis.map_arm(chaser, **options)


@pytest.mark.parametrize("directions", [1, 3])
def test_cells_hold_the_extremes_of_what_falls_into_them(directions):
    rng = np.random.default_rng(directions)
    index, values, x = rng.integers(-2, 3, (500, directions)), rng.normal(size=(500, 3)), rng.normal(size=(500, 2))
    cells = Cells.empty(directions, 3, 2)
    for part in np.split(np.arange(500), [1, 200, 333]):
        cells = cells.with_postures(index[part], values[part], x[part])
    assert len(cells.index) == len(np.unique(index, axis=0))
    for k, cell in enumerate(cells.index):
        inside = (index == cell).all(axis=1)
        assert cells.count[k] == inside.sum()
        np.testing.assert_array_equal(cells.low[k], values[inside].min(axis=0))
        np.testing.assert_array_equal(cells.high[k], values[inside].max(axis=0))
        np.testing.assert_array_equal(cells.at_low[k], x[inside][values[inside].argmin(axis=0)])
        np.testing.assert_array_equal(cells.at_high[k], x[inside][values[inside].argmax(axis=0)])

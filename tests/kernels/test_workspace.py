"""The tables of a state: they begin with a line of the cache, and do not overlap."""

import numpy as np
import pytest

import ospace
from ospace.dynamics.workspace import layout_of
from ospace.kernels import workspace


@pytest.mark.parametrize("lanes", [1, 2, 8])
def test_tables_begin_with_a_line_of_the_cache_and_do_not_overlap(lanes):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    points = [robot.point("right_hand"), robot.point("head", axes="angular")]
    work = workspace.lay_out(layout_of(robot, points), robot.nq, lanes)
    starts, rows, columns = work[: 3 * workspace.TABLES].view(np.int64).reshape(-1, 3).T
    each = np.where(np.arange(workspace.TABLES) < workspace.place_of("q"), 1, lanes)
    ends = np.r_[3 * workspace.TABLES, starts + rows * columns * each]
    assert work.ctypes.data % 64 == 0
    np.testing.assert_array_equal(starts % 8, 0)
    assert (ends <= np.r_[starts, len(work)]).all()

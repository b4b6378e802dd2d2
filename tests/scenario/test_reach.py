"""Regions that a point cannot leave: how they move and grow, and how far they are from each other."""

import numpy as np
import pytest

from ospace.scenario.reach import Region


@pytest.mark.parametrize("last", [0.5, 1.0, 7.0])
def test_regions_that_are_pushed_grow_as_what_a_constant_force_moves(last):
    """By ½ (F/M) t² of each, until the last of the times."""
    here = Region(np.zeros(3), np.zeros(3), 0.2, growth=0.03)
    there = Region(np.array([3.0, 0.0, 4.0]), np.zeros(3), 0.1, growth=0.01)
    assert here.distance(there, 0.1, last) == pytest.approx(5.0 - 0.2 - 0.1 - 0.5 * (0.03 + 0.01) * last**2, abs=1e-12)
    assert there.distance(here, 0.1, last) == pytest.approx(here.distance(there, 0.1, last), abs=1e-12)


def test_regions_are_least_apart_when_they_pass_each_other_or_at_an_end_of_the_time():
    """One that comes by at 3 m in 4 s; along the way alone it meets the other."""
    here = Region.still(np.zeros(3))
    there = Region(np.array([-8.0, 3.0, 0.0]), np.array([2.0, 0.0, 0.0]), 0.5)
    assert here.distance(there, 0.0, 10.0) == pytest.approx(2.5)
    assert here.distance(there, 0.0, 2.0) == pytest.approx(4.5)
    assert here.distance(there, 6.0, 10.0) == pytest.approx(4.5)
    assert here.distance(there, 0.0, 10.0, rows=(0,)) == pytest.approx(-0.5)

"""Agreement of two results: the verdict of a row, and of the robot."""

from __future__ import annotations

import numpy as np
import pytest

from ospace.validation import report
from ospace.validation.agreement import Agreement, summary


@pytest.mark.parametrize("error", [np.nan, np.inf])
def test_an_error_that_is_not_finite_differs_whatever_the_bound(error):
    for bound in (1e-9, np.inf):
        assert summary("q", "1", "a", "b", [(error, bound), (0.0, 1e-9)]).verdict == "differs"


def row(error, bound):
    return Agreement("q", "1", "a", "b", error, bound, int(bound <= 1e-4), 1)


@pytest.mark.parametrize(
    ("rows", "verdict"),
    [
        ([row(0.0, 1e-9)], "sound"),
        ([row(0.0, 1e-9), row(1e-3, 1.0)], "undecided"),
        ([row(1e-3, np.inf)], "undecided"),
        ([row(2.0, 1.0), row(1e-3, 1.0)], "unsound"),
        ([], "sound"),
    ],
)
def test_one_undecided_row_leaves_the_robot_undecided(rows, verdict):
    assert report.Report(None, (), rows).verdict == verdict

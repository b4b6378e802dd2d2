"""The disturbances of a scenario as wrenches on one robot.

A wrench that begins or ends within a step of the integrator would cost its order there. So it acts in each step evenly
in time, by the share of the step during which it lasts: its impulse is that of the file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint
from ospace.scenario.schema import DisturbanceTable

Wrenches = Mapping[OperationalPoint, Callable[[float], Floats]]


class Disturbances:
    """Disturbances by the point at which each acts.

    Parameters
    ----------
    points : mapping of DisturbanceTable to OperationalPoint
        Of one robot.
    step : float
        Of the integrator, s.

    Attributes
    ----------
    wrenches : mapping of OperationalPoint to function
        From the time within the step that has begun (s) to the wrench (6,); inertial axes.
    """

    def __init__(self, points: Mapping[DisturbanceTable, OperationalPoint], step: float) -> None:
        self._points, self._step = points, step
        self._shares = dict.fromkeys(points, 0.0)
        by_frame = {point.frame: point for point in points.values()}
        self.wrenches: Wrenches = {point: self._at(frame) for frame, point in by_frame.items()}

    def begin(self, time: float) -> None:
        """Begin the step from `time` on, s."""
        for one in self._shares:
            self._shares[one] = one.share(time, self._step)

    def _at(self, frame: str) -> Callable[[float], Floats]:
        own = [one for one, point in self._points.items() if point.frame == frame]

        def wrench(time: float) -> Floats:
            total = np.zeros(6)
            for one in own:
                if share := self._shares[one]:
                    total += share * one.at(time)
            return total

        return wrench

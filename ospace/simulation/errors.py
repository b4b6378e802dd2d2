"""Errors of a run."""

from __future__ import annotations

from ospace.exceptions import OspaceError
from ospace.simulation.trajectory import Trajectory


class SimulationError(OspaceError):
    """A run could not go on.

    Attributes
    ----------
    time : float
        When, s.
    trajectory : Trajectory
        What was run until then.
    """

    def __init__(self, reason: str, time: float, trajectory: Trajectory) -> None:
        super().__init__(reason)
        self.time, self.trajectory = time, trajectory

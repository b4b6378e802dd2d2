"""A scenario to watch while it runs, at its own pace; afterwards its animation, to go back and forth in.

It is seen from the frame that moves along with the base as it is at the start: what is in orbit stays in the picture.
"""

from __future__ import annotations

import time as clock
from types import TracebackType
from typing import Self

import numpy as np

from ospace.model.state import State
from ospace.scenario import Run, Scenario
from ospace.scenario.runner import Moment
from ospace.simulation.moving_frame import MovingFrame
from ospace.visual import run_report
from ospace.visual.server import LOOPBACK, Server

_FRAME = 1.0 / 30.0  # s from one picture to the next
_LONGEST = 0.05  # s, at once: an interrupt is not kept waiting


class Live:
    """Serves the scene of a scenario; a context manager.

    Parameters
    ----------
    scenario : Scenario
    host : str
        As of `Server`.
    """

    def __init__(self, scenario: Scenario, host: str = LOOPBACK) -> None:
        self._scene, self._targets = run_report.scene_of(scenario), tuple(scenario.targets)
        self._frame = MovingFrame(np.zeros(3), scenario.start.base_twist[:3]).inverse
        self._server = Server(self._scene.content, host)
        self._began: float | None = None
        self._due = 0.0
        self.address = self._server.address

    def __enter__(self) -> Self:
        self._server.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._server.__exit__(kind, error, trace)

    def wait(self) -> None:
        """Wait until a page is open."""
        while not self._server.viewers:
            clock.sleep(_LONGEST)

    def watch(self, time: float, states: Moment) -> None:
        """Show the states at `time`, s, when it has come on the clock; for `ospace.scenario.run`."""
        if time < self._due:
            return
        self._due = time + _FRAME
        if self._began is None:
            self._began = clock.perf_counter() - time
        while (early := time - (clock.perf_counter() - self._began)) > 0.0:
            clock.sleep(min(early, _LONGEST))
        now = states()
        combined = self._seen(time, now.combined)
        robot = combined if now.robot is now.combined else self._seen(time, now.robot)
        others = [self._seen(time, now.targets[name]).q for name in self._targets]
        self._scene.display(robot.q, robot.v, others, combined=combined)

    def _seen(self, time: float, state: State) -> State:
        q, v = self._frame.to_user_frame(np.array([time]), state.q[None], state.v[None])
        return State(state.robot, q[0], v[0])

    def replay(self, run: Run) -> None:
        """Give the page the whole run as an animation, and serve it until Ctrl-C."""
        run_report.animate(self._scene, run)
        while True:
            clock.sleep(_LONGEST)

"""Commands that act later than they are given."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from ospace.simulation.actuation import Actuation, CommandLike


class DelayLine:
    """Commands on their way, each until it is due, and the one that acts.

    Parameters
    ----------
    delay : int
        From when a command is given to when it acts, in steps.
    """

    def __init__(self, delay: int) -> None:
        self._delay = delay
        self._under_way: deque[tuple[int, CommandLike]] = deque()
        self._acting: CommandLike | None = None

    def put(self, k: int, command: CommandLike) -> None:
        """Take a copy of a command that is given at step `k`; steps do not decrease from call to call."""
        kept = Actuation(*map(np.array, (command.torque, command.base_wrench, command.wheel_torque)))
        self._under_way.append((k + self._delay, kept))

    def acting(self, k: int) -> CommandLike | None:
        """Return the command that acts from step `k` on; None as long as none does."""
        while self._under_way and self._under_way[0][0] <= k:
            self._acting = self._under_way.popleft()[1]
        return self._acting

    def convert(self, converted: Callable[[CommandLike], CommandLike]) -> None:
        """Convert all commands, as for another robot."""
        self._under_way = deque((k, converted(command)) for k, command in self._under_way)
        if self._acting is not None:
            self._acting = converted(self._acting)

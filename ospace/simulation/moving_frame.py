"""The frame in which a motion is integrated: it moves along with the base as the base was at the start.

A base 7e6 m from the origin at 7.5e3 m/s leaves nine digits for a motion of millimetres. Seen from an inertial frame
that starts at the base with the base's velocity, the same motion has them all, and by Galilean
invariance the same equations.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ospace.kernels.base_wrench import add_velocity
from ospace.kernels.tree import Floats
from ospace.model.state import State


@dataclass(frozen=True)
class MovingFrame:
    """An inertial frame with the user's axes.

    Attributes
    ----------
    origin : (3,) array
        Where it is at the start, m.
    velocity : (3,) array
        Its velocity, m/s.
    """

    origin: Floats
    velocity: Floats

    @classmethod
    def of(cls, state: State) -> MovingFrame:
        """Take the frame that is centred on the base of `state`, and moves along with it."""
        return cls(state.q[:3].copy(), state.base_twist[:3].copy())

    @property
    def moves(self) -> bool:
        """True where it has a velocity."""
        return bool(self.velocity.any())

    @property
    def inverse(self) -> MovingFrame:
        """The user's frame as seen from here: its `to_user_frame` brings the user's motions into this one."""
        return MovingFrame(-self.origin, -self.velocity)

    def from_user_frame(self, q: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return (q, v) of the start as seen from here."""
        q, v = q.copy(), v.copy()
        q[:3] -= self.origin
        if self.moves:
            add_velocity(q[None], -self.velocity, v[None])
        return q, v

    def to_user_frame(self, elapsed: Floats, Q: Floats, V: Floats) -> tuple[Floats, Floats]:
        """Return the motion `Q` (N, nq), `V` (N, nv) as the user sees it, `elapsed` (N,) seconds after the start."""
        Q, V = Q.copy(), V.copy()
        Q[:, :3] += self.origin + np.multiply.outer(elapsed, self.velocity)
        if self.moves:
            add_velocity(Q, self.velocity, V)
        return Q, V

    def to_user_frame_at(self, elapsed: float, q: Floats, v: Floats) -> tuple[Floats, Floats]:
        """Return one state (q, v), `elapsed` seconds after the start, as the user sees it."""
        q, v = q.copy(), v.copy()
        q[:3] += self.origin
        if self.moves:
            q[:3] += elapsed * self.velocity
            add_velocity(q[None], self.velocity, v[None])
        return q, v

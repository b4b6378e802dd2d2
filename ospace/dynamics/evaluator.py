"""Operational-space dynamics in a loop: the quantities of `operational_space` in microseconds, without allocation."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ospace.checks import checked_vector
from ospace.dynamics.operational_space import operational_space
from ospace.exceptions import OspaceError
from ospace.kernels import evaluation
from ospace.kernels.tables import Floats
from ospace.link_frames import flatten
from ospace.points import OperationalPoint, point_set
from ospace.robot import SpaceRobot

QUANTITIES = ("inertia_inverse", "inertia", "bias_acceleration", "bias_force", "jacobian")


class OperationalSpaceEvaluator:
    """Γ_e, Γ_e⁻¹, μ_e and μ of the same points, again and again.

    The arrays are the evaluator's own: `update` overwrites them. Copy what is to be kept. An evaluator belongs to one
    thread at a time; several of one robot do not disturb each other.

    Parameters
    ----------
    robot : SpaceRobot
    points : OperationalPoint or sequence of them
        r rows in the order given.
    quantities : sequence of str
        What `update` computes: "inertia_inverse" always; "inertia", "bias_acceleration", "bias_force" and "jacobian"
        cost extra.

    Attributes
    ----------
    inertia_inverse, inertia : (r, r)
        Γ_e⁻¹ and Γ_e; at `rank` < r the pseudo-inverse on the numerical range.
    bias_acceleration, bias_force : (r,)
        μ and μ_e.
    jacobian : (r, nv)
        J_e, base columns for ẋ_b in inertial axes.
    rank : int or None
        Rank of Γ_e⁻¹; None where neither `inertia` nor `bias_force` is asked for, since it is found by inverting.

    What is not asked for is None.

    Raises
    ------
    OspaceError
        No point, another robot's point, or an unknown quantity.

    Notes
    -----
    Joints of one degree of freedom run on kernels of their own (`ospace.kernels.propagated`), without Pinocchio. Any
    other joint type takes the way of `operational_space`, with the same results.
    """

    def __init__(
        self,
        robot: SpaceRobot,
        points: OperationalPoint | Sequence[OperationalPoint],
        quantities: Sequence[str] = QUANTITIES,
    ) -> None:
        quantities = (quantities,) if isinstance(quantities, str) else quantities
        for name in quantities:
            if name not in QUANTITIES:
                raise OspaceError(f"quantity '{name}' is unknown: give some of {', '.join(QUANTITIES)}")
        self.robot = robot
        self._given = point_set(robot, points)
        self.quantities = tuple(quantities)
        rows = len(self._given.rows)
        self._still = np.zeros(robot.nv)
        self._evaluate: Callable[..., int] = evaluation.evaluate
        wanted = set(quantities)
        self._want = evaluation.MOBILITY
        self._want |= evaluation.INERTIA * bool(wanted & {"inertia", "bias_force"})
        self._want |= evaluation.JACOBIAN * ("jacobian" in wanted)
        self._want |= evaluation.BIAS * bool(wanted & {"bias_acceleration", "bias_force"})

        flat = flatten(robot, self._given)
        nodes = len(flat.nodes.parent) if flat else 1
        p = len(self._given.points)
        self._at, length = evaluation.layout(robot.n_joints + 1, nodes, p, rows, robot.nq, robot.nv, 1)
        self._memory = np.zeros(length)
        self.inertia_inverse = self._result("inertia_inverse")
        inverted, biased = bool(self._want & evaluation.INERTIA), bool(self._want & evaluation.BIAS)
        self.inertia = self._result("inertia") if inverted else None
        self.bias_acceleration = self._result("bias_acceleration")[:, 0] if biased else None
        self.bias_force = self._result("bias_force")[:, 0] if inverted and biased else None
        self.jacobian = self._result("jacobian") if "jacobian" in wanted else None
        self.rank: int | None = rows if inverted else None
        self._arguments: tuple[Any, ...] = ()
        if flat is not None:
            self._arguments = (self._want, *evaluation.pack(flat), self._memory, self._at)
            _only_doubles(self._still, self._arguments)

    def _result(self, name: str) -> Floats:
        start, rows, columns = self._at[evaluation.Work._fields.index(name)]
        result: Floats = self._memory[start : start + rows * columns].reshape(rows, columns)
        return result

    def update(self, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> OperationalSpaceEvaluator:
        """Compute the quantities at `q` (nq,) and `v` (nv,), zero without it; return the evaluator itself.

        Raises
        ------
        SingularInertiaError
            A joint moves nothing in this state; names the joint.
        OspaceError
            Wrong length, numbers that are not finite, or a quaternion that is not of unit length; or a result that is
            not finite. The arrays then hold nothing of use.
        """
        if v is None:
            v = self._still
        if self._arguments:
            try:
                status = self._evaluate(q, v, *self._arguments)
            except (
                TypeError,
                AttributeError,
            ):  # not writable arrays of doubles; the latter where kernels run interpreted
                q = checked_vector(q, self.robot.nq, "q", self.robot.name)
                v = checked_vector(v, self.robot.nv, "v", self.robot.name)
                status = self._evaluate(q, v, *self._arguments)
            if status == evaluation.FINE:
                if self.rank is not None:
                    self.rank = len(self.inertia_inverse)
                return self
        return self._update_by_state(q, v)

    def _update_by_state(self, q: npt.ArrayLike, v: npt.ArrayLike) -> OperationalSpaceEvaluator:
        """Go the way of `operational_space`: any joint type, any rank, and errors that say what is wrong."""
        result = operational_space(self.robot.state(q, v), self._given.points)
        for name in QUANTITIES:
            own = getattr(self, name)
            if own is not None:
                own[...] = getattr(result, name)
        if self.rank is not None:
            self.rank = result.rank
        return self


def _only_doubles(v: Floats, arguments: tuple[Any, ...]) -> None:
    """Compile for plain arrays of doubles, and for nothing else: any other type is a TypeError from here on."""
    evaluation.evaluate(np.empty(0), v, *arguments)
    if hasattr(evaluation.evaluate, "disable_compile"):  # not there where kernels run interpreted
        evaluation.evaluate.disable_compile()

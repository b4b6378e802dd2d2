"""Operational-space dynamics in a loop: the quantities of `operational_space` in microseconds, without allocation."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ospace.checks import check_kind, checked_names, checked_vector
from ospace.dynamics.workspace import Workspace, wanted_of
from ospace.exceptions import OspaceError
from ospace.kernels import evaluation
from ospace.kernels.jit.compile import refuse_other_types
from ospace.kernels.tree import Floats
from ospace.kernels.workspace import Robot
from ospace.model.points import OperationalPoint, points_of
from ospace.model.robot import SpaceRobot
from ospace.model.state import checked_state

BITS = {
    "inertia_inverse": evaluation.MOBILITY,
    "inertia": evaluation.MOBILITY | evaluation.INERTIA,
    "bias_acceleration": evaluation.MOBILITY | evaluation.BIAS,
    "bias_force": evaluation.MOBILITY | evaluation.INERTIA | evaluation.BIAS,
    "jacobian": evaluation.JACOBIAN,
    "generalized_jacobian": evaluation.FLOATING_BASE,
    "generalized_inertia": evaluation.FLOATING_BASE | evaluation.GENERALIZED_INERTIA,
    "generalized_bias": evaluation.FLOATING_BASE | evaluation.GENERALIZED_BIAS,
    "momentum": evaluation.FLOATING_BASE,
}
"""Bits of the kernel that each quantity needs."""
QUANTITIES = tuple(BITS)
_VECTORS = ("bias_acceleration", "bias_force", "generalized_bias", "momentum")
_A_STATE, _PSEUDO_INVERSE = 1 << 20, 1 << 21  # of what is known: beside the bits of the kernel, which ignores them

_FIRST_USE = threading.Lock()


class _Quantity:
    """An array of the evaluator, computed when it is read unless `update` has done so."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name, self.bits = name, BITS[name]

    def __get__(self, run: OperationalSpaceEvaluator | None, owner: type) -> Any:
        if run is None:
            return self
        if self.bits & ~run._known:
            run._compute(self.bits)
        return run._arrays[self.name]

    def __set__(self, run: OperationalSpaceEvaluator, value: object) -> None:
        raise AttributeError(f"'{self.name}' is computed, and cannot be set")


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
        What `update` computes, of the attributes below. Any other is computed from the last state when it is read,
        by a pass of its own.

    Attributes
    ----------
    inertia_inverse, inertia : (r, r)
        Γ_e⁻¹ and Γ_e; at `rank` < r the pseudo-inverse on the numerical range.
    bias_acceleration, bias_force : (r,)
        μ and μ_e.
    jacobian : (r, nv)
        J_e, base columns for ẋ_b in inertial axes.
    generalized_jacobian : (r, n)
        J_m*.
    generalized_inertia : (n, n)
        H_m*.
    generalized_bias : (n,)
        c_m*.
    momentum : (6,)
        M_0.

    Raises
    ------
    OspaceError
        No point, another robot's point, or an unknown quantity; an attribute is read before the first `update`, or
        after one that failed.

    Notes
    -----
    The kernels place the links themselves, without Pinocchio. Where they do not know a joint type, or an angle is
    beyond 1e5 rad, Pinocchio places them as for a `State`; all that follows is the same.
    """

    inertia_inverse = _Quantity()
    inertia = _Quantity()
    bias_acceleration = _Quantity()
    bias_force = _Quantity()
    jacobian = _Quantity()
    generalized_jacobian = _Quantity()
    generalized_inertia = _Quantity()
    generalized_bias = _Quantity()
    momentum = _Quantity()

    def __init__(
        self,
        robot: SpaceRobot,
        points: OperationalPoint | Sequence[OperationalPoint],
        quantities: Sequence[str] = ("inertia_inverse", "inertia", "bias_acceleration", "bias_force"),
    ) -> None:
        check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
        self.robot, self.quantities = robot, checked_names(quantities, QUANTITIES, "quantity")
        self._want = _A_STATE
        for name in self.quantities:
            self._want |= BITS[name]
        self._want = wanted_of(robot, self._want)
        self._couples = robot.free is not None and bool(self._want & evaluation.MOBILITY)
        self._run = Workspace(robot, points_of(robot, points))
        self._memory, self._wanted = self._run.memory, self._run.wanted
        self._wanted[0] = self._want
        self._known, self._still = 0, np.zeros(robot.nv)
        self._stands = 0
        tables = {name: self._run.table(name) for name in BITS}
        self._arrays = {name: table.reshape(-1) if name in _VECTORS else table for name, table in tables.items()}
        composes, before = self._want & evaluation.COMPOSITE, self._want & evaluation.PLACED_BEFORE
        self._composes = bool(composes and before)
        self._place: Callable[..., int] = evaluation.compose if composes and not before else evaluation.evaluate
        if robot.own_kinematics:
            with _FIRST_USE:
                refuse_other_types(self._place, (self._still, self._still, self._memory))
        else:
            self._place = _by_pinocchio

    @property
    def memory(self) -> Floats:
        """The array of `ospace.kernels.workspace`, for kernels that go on from the last state."""
        return self._memory

    @property
    def layout(self) -> Robot:
        """Robot and points as they are laid out there."""
        return self._run.layout

    @property
    def points(self) -> tuple[OperationalPoint, ...]:
        """The points, in the order of the rows."""
        return self._run.points

    def table(self, name: str) -> Floats:
        """Return a view of a table of `ospace.kernels.workspace.Work`: for kernels that go on from the last state.

        Parameters
        ----------
        name : str
            Of the table.

        Returns
        -------
        array
            Overwritten by the next `update`.
        """
        return self._run.table(name)

    def update(self, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> OperationalSpaceEvaluator:
        """Compute the quantities of a state.

        Parameters
        ----------
        q : (nq,)
            Configuration, as `SpaceRobot.state` takes it; m, rad.
        v : (nv,), optional
            Velocity, base twist in base axes; zero without it. m/s, rad/s.

        Returns
        -------
        OperationalSpaceEvaluator
            Itself: results are its attributes, in arrays that the next call overwrites.

        Raises
        ------
        SingularInertiaError
            A joint or the base moves nothing in this state; names the joint.
        OspaceError
            Wrong length, numbers that are not finite, or a quaternion that is not of unit length; or a result that is
            not finite. There are no results then: arrays that are held show zeros.
        """
        if v is None:
            v = self._still
        try:
            status = self._place(q, v, self._memory)
        except (TypeError, AttributeError):  # not arrays of doubles; the latter where kernels run interpreted
            self._known = 0
            q = checked_vector(q, self.robot.nq, "q", self.robot.name)
            v = checked_vector(v, self.robot.nv, "v", self.robot.name)
            status = evaluation.FAR if self._place is _by_pinocchio else self._place(q, v, self._memory)
        if status:
            self._refine(status, q, v)
            return self
        if self._composes and evaluation.compose(self._still, self._still, self._memory):
            self._refine(evaluation.OK, q, v)
        if self._couples and (status := evaluation.couple(self._memory)):
            self._refine(status, q, v)
            return self
        self._known, self._stands = self._want, 0
        return self

    @property
    def rank(self) -> int:
        """Rank of Γ_e⁻¹: how many of the rows are independent."""
        if evaluation.INERTIA & ~self._known:
            self._compute(BITS["inertia"])
        return self._run.rank if self._known & _PSEUDO_INVERSE else len(self._run.rows)

    @property
    def response(self) -> Floats:
        """H⁻¹ J_eᵀ (nv, r), a new array, by a pass of its own."""
        self._compute(BITS["inertia_inverse"])
        self._run.respond(floating=False)
        self._wanted[0] = self._want
        return self._run.copy("response")

    @property
    def dynamically_consistent_inverse(self) -> Floats:
        """J_e⁺ = H⁻¹ J_eᵀ Γ_e (11), (nv, r), from `response`."""
        inverse: Floats = self.response @ self.inertia
        return inverse

    @property
    def null_space_projector(self) -> Floats:
        """1 − J_e⁺ J_e, (nv, nv), from `response`."""
        projector: Floats = np.eye(self.robot.nv) - self.dynamically_consistent_inverse @ self.jacobian
        return projector

    def __repr__(self) -> str:
        points = ", ".join(map(repr, self.points))
        return f"OperationalSpaceEvaluator('{self.robot.name}', [{points}], quantities={self.quantities})"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by making another of its own memory, that holds the same numbers."""
        held = self._known, self._stands, self._run.rank, self._memory
        return OperationalSpaceEvaluator, (self.robot, self.points, self.quantities), held

    def __setstate__(self, held: tuple[int, int, int, Floats]) -> None:
        self._known, self._stands, self._run.rank, memory = held
        self._memory[:] = memory

    # -- what is not the straight way ------------------------------------------------------------------------

    def _refine(self, status: int, q: npt.ArrayLike, v: npt.ArrayLike) -> None:
        """Do what the kernel left undone at (q, v), or raise what it cannot do."""
        self._known = self._stands = 0
        try:
            if status == evaluation.BAD_INPUT:
                status = self._place(*checked_state(self.robot, q, v), self._memory)
            if status == evaluation.FAR:
                state = self.robot.state(q, v)
                self._run.load(state)
                self._run.q[:] = state.q
                self._stands = evaluation.LINKS_STAND
                self._run.evaluate(self._want)
            else:
                self._run.settle(status, self._want)
                if self._composes:
                    self._run.compose()
                if self._couples:
                    self._run.settle(evaluation.couple(self._memory), self._want)
        except OspaceError as error:
            self._refuse(error)
        finally:
            self._wanted[0] = self._want
        self._note(self._want)

    def _note(self, bits: int) -> None:
        """Note that `bits` are known, of a run that noted the rank."""
        reduced = bits & evaluation.INERTIA and self._run.rank < len(self._run.rows)
        self._known |= bits | (_PSEUDO_INVERSE if reduced else 0)

    def _refuse(self, error: OspaceError) -> None:
        """Leave nothing of a state that is refused."""
        self._known = 0
        for array in self._arrays.values():
            array.fill(0.0)
        raise error

    def _compute(self, bits: int) -> None:
        """Compute what `bits` want at the state of the last update."""
        if not self._known:
            raise OspaceError("there is no state to compute this from: call update(q, v) first, and heed its error")
        try:
            if not self._stands:  # the links' motion may not
                self._wanted[0] = evaluation.FLOATING_BASE | evaluation.JOINT_BIAS | evaluation.NORMALIZED
                self._place(self._run.q, self._run.v, self._memory)
            self._run.evaluate(bits)
        finally:
            self._wanted[0] = self._want
        self._note(bits)


def _by_pinocchio(q: Floats, v: Floats, memory: Floats) -> int:
    """Stand where the kernels cannot place the links."""
    return evaluation.FAR

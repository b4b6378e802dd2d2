"""Operational-space dynamics in a loop: the quantities of `operational_space` in microseconds, without allocation."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ospace.checks import checked_names, checked_vector, not_finite
from ospace.dynamics.generalized_jacobian import generalized_jacobian
from ospace.dynamics.joint_space import generalized_dynamics, momentum
from ospace.dynamics.operational_space import operational_space
from ospace.dynamics.ranges import inverse_on_range
from ospace.exceptions import OspaceError, SingularInertiaError
from ospace.kernels import evaluation, memory
from ospace.kernels.articulated import NO_INERTIA
from ospace.kernels.kinematics import REVOLUTE
from ospace.kernels.tables import Floats
from ospace.link_frames import flatten
from ospace.points import OperationalPoint, point_set
from ospace.robot import SpaceRobot
from ospace.state import State, checked_state

BITS = {
    "inertia_inverse": evaluation.MOBILITY,
    "inertia": evaluation.MOBILITY | evaluation.INERTIA,
    "bias_acceleration": evaluation.MOBILITY | evaluation.BIAS,
    "bias_force": evaluation.MOBILITY | evaluation.INERTIA | evaluation.BIAS,
    "jacobian": evaluation.JACOBIAN,
    "generalized_jacobian": evaluation.FLOATING,
    "generalized_inertia": evaluation.FLOATING | evaluation.GENERALIZED_INERTIA,
    "generalized_bias": evaluation.FLOATING | evaluation.GENERALIZED_BIAS,
    "momentum": evaluation.FLOATING,
}
"""What each quantity asks of the kernel."""
QUANTITIES = tuple(BITS)
_A_STATE, _PSEUDO_INVERSE = 1 << 20, 1 << 21  # of what is known: beside those of the kernel, which does not heed them

_FIRST_USE = threading.Lock()


class _Quantity:
    """An array of the evaluator, computed when it is read unless `update` has done so."""

    def __set_name__(self, owner: type, name: str) -> None:
        self.name, self.bits = name, BITS[name]

    def __get__(self, run: OperationalSpaceEvaluator | None, owner: type) -> Any:
        if run is None:
            return self
        if self.bits & ~run._known:
            run._complete(self.bits)
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
    Joints of one degree of freedom run on kernels of their own (`ospace.kernels.propagated`), without Pinocchio. Any
    other joint type takes the way of `operational_space`, with the same results.
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
        self.robot = robot
        self.quantities = checked_names(quantities, QUANTITIES, "quantity")
        self._want = _A_STATE
        for name in self.quantities:
            self._want |= BITS[name]
        self._given = point_set(robot, points)
        self._known = 0
        self._still = np.zeros(robot.nv)
        self._rank = r = len(self._given.rows)
        self._state: State | None = None
        n, nv = robot.n_joints, robot.nv
        shapes = ((r, r), (r, r), (r,), (r,), (r, nv), (r, n), (n, n), (n,), (6,))
        self._arrays: dict[str, Floats] = {name: np.zeros(shape) for name, shape in zip(BITS, shapes, strict=True)}

        flat = flatten(robot, self._given)
        self._on_kernel = flat is not None
        self._evaluate: Callable[..., int] = _no_kernel
        self.work = np.zeros(0)
        if flat is not None:
            self._joints, self.nodes = flat.joints, flat.nodes
            self.work = memory.lay_out(flat, robot.nq)
            self._evaluate = evaluation.evaluate
            self._wanted = memory.wanted(self.work)
            self._wanted[0] = self._want
            self._q, self._v = self.table("q")[:, 0], self.table("velocity")[:, 0]
            self._arrays = {name: self.table(name).reshape(shape) for name, shape in zip(BITS, shapes, strict=True)}
            _only_doubles(self._still, self.work)

    def table(self, name: str) -> Floats:
        """Look at a table of `ospace.kernels.memory.Work`: for kernels that go on from the last state."""
        return memory.result(self.work, name)

    def update(self, q: npt.ArrayLike, v: npt.ArrayLike | None = None) -> OperationalSpaceEvaluator:
        """Compute the quantities at `q` (nq,) and `v` (nv,), zero without it; return the evaluator itself.

        Raises
        ------
        SingularInertiaError
            A joint moves nothing in this state; names the joint.
        OspaceError
            Wrong length, numbers that are not finite, or a quaternion that is not of unit length; or a result that is
            not finite. There are no results then.
        """
        if v is None:
            v = self._still
        try:
            status = self._evaluate(q, v, self.work)
        except (TypeError, AttributeError):  # not writable arrays of doubles; the latter where kernels run interpreted
            self._known = 0
            if not self._on_kernel:
                self._take_state(self.robot.state(q, v))
                return self
            q = checked_vector(q, self.robot.nq, "q", self.robot.name)
            v = checked_vector(v, self.robot.nv, "v", self.robot.name)
            status = self._evaluate(q, v, self.work)
        if status:
            self._known = 0
            if status == evaluation.BAD_INPUT:
                status = self._evaluate(*self._in_reach(q, v), self.work)
            self._known = self._want | self._mend(status, self._want)
            return self
        self._known = self._want
        return self

    @property
    def rank(self) -> int:
        """Rank of Γ_e⁻¹: how many of the rows are independent."""
        if evaluation.INERTIA & ~self._known:
            self._complete(BITS["inertia"])
        return self._rank if self._known & _PSEUDO_INVERSE else len(self._given.rows)

    @property
    def response(self) -> Floats:
        """H⁻¹ J_eᵀ (nv, r), a new array by the sweeps of `operational_space`, which take as long as that does."""
        self._complete(0)
        state = self._state or self.robot.state(self._q, self._v)
        return operational_space(state, self._given.points).response

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

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy by making another of its own memory, that holds the same numbers."""
        held = self._known, self._rank, self._state, self.work, self._arrays
        return OperationalSpaceEvaluator, (self.robot, self._given.points, self.quantities), held

    def __setstate__(self, held: tuple[int, int, State | None, Floats, dict[str, Floats]]) -> None:
        self._known, self._rank, self._state, work, arrays = held
        self.work[:] = work
        for name, array in arrays.items():
            self._arrays[name][:] = array

    # -- what is not the straight way ------------------------------------------------------------------------

    def _complete(self, bits: int) -> None:
        """Compute what `bits` want as well, at the state of the last update."""
        if not self._known:
            raise OspaceError("there is no state to compute this from: call update(q, v) first, and heed its error")
        if bits:
            self._known |= bits | self._mend(self._evaluate_again(bits), bits)

    def _evaluate_again(self, bits: int) -> int:
        """Compute what `bits` want, and no more, at the same state."""
        self._wanted[0] = bits
        try:
            return self._evaluate(self._q, self._v, self.work)
        finally:
            self._wanted[0] = self._want

    def _in_reach(self, q: npt.ArrayLike, v: npt.ArrayLike) -> tuple[Floats, Floats]:
        """Return the state with all angles in (−π, π], where the kernel's sine holds; raise where it is no state."""
        q, v = checked_state(self.robot, q, v)
        joints = self._joints
        angles = joints.first[1:][joints.kind[1:] == REVOLUTE]
        q[angles] = np.arctan2(np.sin(q[angles]), np.cos(q[angles]))
        return q, v

    def _mend(self, status: int, bits: int) -> int:
        """Do what the kernel left undone, or raise what it cannot do; return `_PSEUDO_INVERSE` if Γ_e is one."""
        if status == evaluation.BAD_INPUT:
            raise not_finite("the operational-space dynamics")
        if status == evaluation.SINGULAR:
            none = np.flatnonzero(~(self.table("share")[1:, 0] > NO_INERTIA))
            raise SingularInertiaError(self.robot.joint_of_link(int(none[-1]) + 1))
        if status == evaluation.DEPENDENT:
            self._invert_on_range(bits)
            return _PSEUDO_INVERSE
        return 0

    def _invert_on_range(self, bits: int) -> None:
        """Γ_e, μ_e and the rank where rows depend on each other."""
        self._evaluate_again(BITS["jacobian"] | BITS["momentum"])
        arrays = self._arrays
        base = self.table("IC")[0, [0, 2, 5, 9, 14, 20]]
        joints = np.einsum("ij,ij->i", self.table("S"), self.table("F"))[1:] + self._joints.mass[1:, 1]
        mobility = np.diag(arrays["inertia_inverse"])
        H = np.concatenate([base, joints])
        inverted = inverse_on_range(arrays["inertia_inverse"], arrays["jacobian"], mobility, H)
        arrays["inertia"][:], self._rank = inverted.inverse, inverted.rank
        if bits & evaluation.BIAS:
            arrays["bias_force"][:] = arrays["inertia"] @ arrays["bias_acceleration"]

    def _take_state(self, state: State) -> None:
        """Go the way of `operational_space`, which has every joint type."""
        result = operational_space(state, self._given.points)
        for name in ("inertia_inverse", "inertia", "bias_acceleration", "bias_force", "jacobian"):
            self._arrays[name][:] = getattr(result, name)
        floating = generalized_jacobian(state, self._given.points)
        self._arrays["generalized_jacobian"][:] = floating.generalized_jacobian
        generalized = generalized_dynamics(state)
        self._arrays["generalized_inertia"][:] = generalized.generalized_inertia
        self._arrays["generalized_bias"][:] = generalized.generalized_bias
        self._arrays["momentum"][:] = momentum(state)
        self._rank, self._state = result.rank, state
        self._known = -1


def _no_kernel(q: Floats, v: Floats, work: Floats) -> int:
    """Stand where a robot's joints have no kernel."""
    raise TypeError


def _only_doubles(v: Floats, work: Floats) -> None:
    """Compile for plain arrays of doubles, and for nothing else: any other type is a TypeError from here on."""
    with _FIRST_USE:
        evaluation.evaluate(np.empty(0), v, work)
        if hasattr(evaluation.evaluate, "disable_compile"):  # not there where kernels run interpreted
            evaluation.evaluate.disable_compile()

"""The tables of a robot, its points and one state, and what becomes of a kernel's status: the way in of every quantity.

`of` keeps a workspace for each robot, set of points and thread. A function of a state loads the links that Pinocchio
placed and runs the kernels; `OperationalSpaceEvaluator` owns one and lets the kernels place the links.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from ospace.checks import check_kind, not_finite
from ospace.dynamics.ranges import inverse_on_range
from ospace.exceptions import DependentRowsError, SingularInertiaError
from ospace.kernels import evaluation as kernel
from ospace.kernels import workspace
from ospace.kernels.articulated_body import NO_INERTIA
from ospace.kernels.jit.together import compile_together
from ospace.kernels.kinematics import place_from_pinocchio
from ospace.kernels.tree import Floats, Ints
from ospace.model.layout import Layout
from ospace.model.points import OperationalPoint, points_of, rows_of
from ospace.model.state import State

_KEPT = 16
"""Workspaces of a robot on a thread, of the points used last."""


class Workspace:
    """Tables for the kernels.

    Attributes
    ----------
    robot, points : the robot and the points on it
    rows : (r,) rows taken, out of six for each point
    layout : both as the kernels take them
    memory : the one array of `ospace.kernels.workspace`
    wanted : (1,) what the kernels compute, bits
    q, v : views of the state that the kernels placed last
    rank : rank of Γ_e⁻¹ in the state of the last run, or of Λ⁻¹ after `respond`
    dependent : rows that depend on each other there
    """

    def __init__(self, robot: Layout, points: Sequence[OperationalPoint]) -> None:
        self.robot, self.points = robot, tuple(points)
        self.layout = layout_of(robot, points)
        self.rows: Ints = self.layout.rows
        self.memory = workspace.lay_out(self.layout, robot.nq)
        self._tables: dict[str, Floats] = {}
        self._links, self.wanted = workspace.links(self.memory), workspace.wanted(self.memory)
        self.q, self.v = self.table("q")[: robot.nq, 0], self.table("velocity")[:, 0]
        self.rank, self.dependent = len(self.rows), np.zeros(0, dtype=np.int64)

    def table(self, name: str) -> Floats:
        """Return a view of a table of `ospace.kernels.workspace.Work`."""
        if name not in self._tables:
            self._tables[name] = workspace.view(self.memory, name)
        return self._tables[name]

    def copy(self, name: str) -> Floats:
        """Return a copy of a table."""
        return self.table(name).copy()

    def load(self, state: State) -> None:
        """Take the links of a state of this robot."""
        self._links[:] = state.links

    def evaluate(self, want: int) -> None:
        """Compute what the bits `want` stand for, of the links that stand.

        Raises
        ------
        SingularInertiaError
            A joint or the base moves nothing in this state; names the joint.
        OspaceError
            A result is not finite.
        """
        self.wanted[0] = want = wanted_of(self.robot, want | kernel.LINKS_STAND)
        if want & ~(kernel.COMPOSITE | kernel.LINKS_STAND):
            self.settle(kernel.evaluate(self.q, self.v, self.memory), want)
        if want & kernel.COMPOSITE:
            self.compose()
        if want & kernel.MOBILITY and self.robot.free:
            self.settle(kernel.couple(self.memory), want)

    def compose(self) -> None:
        """Compute the composite bodies of the links that stand, as the bits of `wanted` have it.

        Raises
        ------
        SingularInertiaError
            The base has no inertia about some axis in this state, or none beside what it carries.
        OspaceError
            A result is not finite.
        """
        status = kernel.compose(self.q, self.v, self.memory)
        if status == kernel.SINGULAR:
            raise SingularInertiaError(None)
        if status:
            raise not_finite("the dynamics of the composite bodies")

    def settle(self, status: int, want: int) -> None:
        """Do what `evaluate` of the kernels left undone, or raise what its `status` means."""
        if want & kernel.INERTIA:
            self.rank = len(self.rows)
        if status == kernel.BAD_INPUT:
            raise not_finite("the operational-space dynamics")
        if status == kernel.SINGULAR:
            none = np.flatnonzero(~(self.table("relative_pivot")[1:, 0] > NO_INERTIA))
            of_joint = want & kernel.MOBILITY and none.size
            raise SingularInertiaError(self.robot.joint_of_link(int(none[-1]) + 1) if of_joint else None)
        if status == kernel.DEPENDENT:
            stand = want & (kernel.MOTION | kernel.LINKS_STAND)
            self.wanted[0] = kernel.JACOBIAN | kernel.FLOATING_BASE | kernel.NORMALIZED | stand
            kernel.evaluate(self.q, self.v, self.memory)
            self.table("inertia")[:] = self.inverse_on_range(self.table("inertia_inverse"), self.table("jacobian"))
            if want & kernel.BIAS:
                self.table("bias_force")[:] = self.table("inertia") @ self.table("bias_acceleration")
            self.wanted[0] = want

    def respond(self, floating: bool) -> None:
        """Compute H⁻¹ J_eᵀ after `evaluate` with MOBILITY; with `floating`, Λ and μ as well, after all of COMPOSITE.

        Raises
        ------
        OspaceError
            A result is not finite.
        """
        if not floating:
            self.wanted[0] = 0
        status = kernel.respond(self.memory)
        if status == kernel.BAD_INPUT:
            raise not_finite("the free-floating dynamics")
        if floating:
            self.rank = len(self.rows)
        if floating and status == kernel.DEPENDENT:
            Lambda_inv, J_m_star = self.table("floating_inertia_inverse"), self.table("generalized_jacobian")
            H_m_star = np.diag(self.table("generalized_inertia"))
            mobility = np.diag(self.table("inertia_inverse"))
            Lambda, self.rank, self.dependent = inverse_on_range(Lambda_inv, J_m_star, mobility, H_m_star)
            self.table("floating_inertia")[:] = Lambda

    def inverse_on_range(self, Gamma_inv: Floats, J_e: Floats) -> Floats:
        """Return the inverse of Γ_e⁻¹ on its numerical range; note its rank and the rows that depend on each other."""
        self.wanted[0] |= kernel.FLOATING_BASE
        kernel.compose(self.q, self.v, self.memory)
        H = self.table("inertia_diagonal")[:, 0]
        Gamma, self.rank, self.dependent = inverse_on_range(Gamma_inv, J_e, np.diag(Gamma_inv), H)
        return Gamma

    def refuse_dependent(self, points: Sequence[OperationalPoint]) -> None:
        """Raise the `DependentRowsError` that names those of `points` whose rows depend on each other."""
        if self.rank < len(self.rows):
            names: Iterable[str] = (points[self.rows[row] // 6].frame for row in self.dependent)
            raise DependentRowsError(self.rank, len(self.rows), dict.fromkeys(names))


def wanted_of(robot: Layout, want: int) -> int:
    """Return the bits `want` with those that they take where joints of the robot mimic others."""
    if robot.free is None or not want & kernel.MOBILITY:
        return want
    return want | kernel.COUPLED_MOBILITY | (kernel.GENERALIZED_BIAS if want & kernel.BIAS else 0)


def layout_of(robot: Layout, points: Sequence[OperationalPoint]) -> workspace.Robot:
    """Lay out a robot and points on it for the kernels."""
    joints, positions = [point.joint for point in points], [point.placement.translation for point in points]
    return robot.with_points(joints, positions, rows_of(points))


_NO_POINTS: tuple[OperationalPoint, ...] = ()


def of(state: State, points: OperationalPoint | Sequence[OperationalPoint] = _NO_POINTS) -> Workspace:
    """Return this thread's workspace for the state's robot, and `points` on it, with the links of the state in it.

    It is the caller's until the next call for the same points.

    Raises
    ------
    OspaceError
        Not a state; or no point where there are to be some, or another robot's.
    """
    check_kind(state, State, "make it with robot.state(q, v)")
    given = _NO_POINTS if points is _NO_POINTS else points_of(state.robot, points)
    kept: OrderedDict[Any, Workspace] = vars(state.robot.local).setdefault("workspaces", OrderedDict())
    key = tuple([point.key for point in given])
    run = kept.get(key)
    if run is None:
        run = kept[key] = Workspace(state.robot, given)
        if len(kept) > _KEPT:
            kept.popitem(last=False)
    run.load(state)
    return run


def compile_kernels() -> None:
    """Compile what every function of a state and the evaluator run, several kernels at once where there are cores."""
    vector, table = np.zeros(1), np.zeros((1, 1))
    compile_together(
        [
            (kernel.evaluate, (vector, vector, vector)),
            (kernel.compose, (vector, vector, vector)),
            (kernel.respond, (vector,)),
            (kernel.couple, (vector,)),
            (kernel.normalize, (vector, vector, vector)),
            (place_from_pinocchio, (table, table, table, vector)),
            (kernel.inverse_dynamics, (vector, vector)),
        ]
    )

"""One pass of Pinocchio's kinematics, seen without a copy.

Python access to ``data.oMi[i]`` costs microseconds a body. Pinocchio keeps these quantities in contiguous C++
arrays, so a NumPy view of the memory gives all bodies at once. Strides belong to the wheel, not to the interface:
they are tried out on a moving robot once, and where they do not hold the plain way is taken.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from ospace.kernels import evaluation, kinematics, workspace
from ospace.kernels.tree import Floats
from ospace.model.mimic import FreeJoints

_SE3, _MOTION = 12, 6  # numbers from one body to the next


class PinocchioPass:
    """`pin.Data` of a model, what a pass leaves in it as arrays, and the links that kernels make of them.

    Where joints mimic others, model and data are those of the robot without its couplings.

    Attributes
    ----------
    placements : (njoints, 12) rotation by columns, then translation, of each joint; world axes and origin.
    accelerations : (njoints, 6) spatial accelerations at zero q̈; world axes and origin.
    columns : (nv, 6) joint columns; world axes and origin.
    q : (nq,) of the robot, the configuration of the last pass, quaternions at unit length.
    """

    def __init__(self, model: pin.Model, memory: Floats, free: FreeJoints | None = None) -> None:
        nq = int(model.nq)
        self._order = None if free is None else free.order
        self.model = model = model if free is None else free.model
        self.data = model.createData()
        self._still = np.zeros(model.nv)
        self.columns: Floats = self.data.J.T
        self.zero_copy = self._views_hold()
        if not self.zero_copy:
            self.placements = np.zeros((model.njoints, _SE3))
            self.accelerations = np.zeros((model.njoints, _MOTION))
            self.columns = np.zeros((model.nv, 6))
        self._memory = memory
        self._links = workspace.links(memory)
        self.q = workspace.view(memory, "q")[:nq, 0]
        self._q_beside_base = workspace.view(memory, "q_beside_base")[:, 0]
        self._v_beside_base = workspace.view(memory, "v_beside_base")[:, 0]
        self._diagnostics = workspace.view(memory, "diagnostics")

    @property
    def norm_error(self) -> float:
        """Largest distance of the square of a quaternion's length from one."""
        return float(self._diagnostics[0, evaluation.NORM_ERROR])

    def place(self, q: Floats, v: Floats) -> Floats | None:
        """Let Pinocchio place the links at (q, v), from beside the base; return a copy of their tables.

        None where (q, v) is not a state, or its motion is not finite.
        """
        if evaluation.normalize(q, v, self._memory):
            return None
        q_beside = self._q_beside_base if self._order is None else self._q_beside_base[self._order]
        pin.computeForwardKinematicsDerivatives(self.model, self.data, q_beside, self._v_beside_base, self._still)
        if not self.zero_copy:
            self.placements[:] = _placements(self.data)
            self.accelerations[:] = _accelerations(self.data)
            self.columns[:] = self.data.J.T
        if kinematics.place_from_pinocchio(self.placements, self.columns, self.accelerations, self._memory):
            return None
        return self._links.copy()

    def _views_hold(self) -> bool:
        rng = np.random.default_rng(0)
        q = pin.integrate(self.model, pin.neutral(self.model), rng.normal(size=self.model.nv))
        try:
            self.placements = _view([body.rotation for body in (self.data.oMi[0], self.data.oMi[1])], self.data, _SE3)
            self.accelerations = _view([body.linear for body in (self.data.oa[0], self.data.oa[1])], self.data, _MOTION)
        except (AttributeError, KeyError, TypeError, ValueError):
            return False
        pin.computeForwardKinematicsDerivatives(self.model, self.data, q, rng.normal(size=self.model.nv), self._still)
        return (
            np.array_equal(self.placements, _placements(self.data))
            and np.array_equal(self.accelerations, _accelerations(self.data))
            and np.array_equal(self.columns, np.array(self.data.J.T))
            and self.columns.flags.c_contiguous
        )


def _placements(data: pin.Data) -> Floats:
    return np.array([np.r_[M.rotation.ravel(order="F"), M.translation] for M in data.oMi])


def _accelerations(data: pin.Data) -> Floats:
    return np.array([a.vector for a in data.oa])


class _Memory:
    """Memory that `owner` keeps alive, offered to NumPy."""

    def __init__(self, owner: pin.Data, address: int, shape: tuple[int, int]) -> None:
        self.owner = owner
        self.__array_interface__ = {"data": (address, True), "shape": shape, "typestr": "<f8", "version": 3}


def _view(first_two: Sequence[Floats], owner: pin.Data, numbers: int) -> Floats:
    """Return rows that start where the arrays of the first two bodies do; ValueError where these are no neighbours."""
    here, there = (int(array.__array_interface__["data"][0]) for array in first_two)
    if there - here != 8 * numbers:
        raise ValueError("bodies do not lie side by side")
    return np.asarray(_Memory(owner, here, (len(owner.oMi), numbers)))

"""A number that counts what is done with it, and the kernels run on tables of such numbers."""

from __future__ import annotations

import math

import numpy as np

from ospace.dynamics.workspace import Workspace
from ospace.kernels import composite_body, evaluation, kinematics, points
from ospace.kernels.workspace import Work, open_robot, open_wide, open_work


class Counted:
    """A float; each sum, difference, product, quotient and root adds one to `Counted.done`. Signs cost nothing."""

    done = 0
    __slots__ = ("value",)

    def __init__(self, value):
        self.value = float(value)

    def __float__(self):
        return self.value

    def __neg__(self):
        return Counted(-self.value)

    def __abs__(self):
        return Counted(abs(self.value))

    def __lt__(self, other):
        return self.value < float(other)

    def __le__(self, other):
        return self.value <= float(other)

    def __ge__(self, other):
        return self.value >= float(other)

    def sqrt(self):
        Counted.done += 1
        return Counted(math.sqrt(self.value))


def _operator(of_floats):
    def forward(a, b):
        Counted.done += 1
        return Counted(of_floats(a.value, float(b)))

    def backward(a, b):
        Counted.done += 1
        return Counted(of_floats(float(b), a.value))

    return forward, backward


for _name, _of_floats in (
    ("add", float.__add__),
    ("sub", float.__sub__),
    ("mul", float.__mul__),
    ("truediv", float.__truediv__),
):
    for _prefix, _function in zip(("__", "__r"), _operator(_of_floats), strict=True):
        setattr(Counted, f"{_prefix}{_name}__", _function)


class Counter:
    """A robot in one configuration, whose kernels run interpreted on counted numbers.

    Sines and cosines are taken before. Tables come back as floats, so that what is counted is seen to be right.
    """

    def __init__(self, robot, frames, q):
        run = Workspace(robot, [robot.point(frame) for frame in frames])
        run.q[:], run.v[:] = q, 0.0
        self.robot, work, wide = open_robot(run.memory), open_work(run.memory, 0.0), open_wide(run.memory)
        kinematics.sines_cosines(wide.q, wide.sine, wide.cosine)
        self.w = Work(*(np.vectorize(Counted, otypes=[object])(table) if table.size else table for table in work))

    def kinematics(self):
        """Links and points."""

        def run():
            kinematics.place_links(self.robot.joints, self.w, self.w.IA)
            points.place_points(self.robot.nodes, self.w)

        done = self._count(run)
        self.w.I[:] = self.w.IA  # which the sweeps turn into articulated ones
        return done

    def pv_osimr(self):
        """Γ_e⁻¹ of links that stand."""
        return self._count(lambda: evaluation.mobility(self.robot, self.w, False))

    def composite_bodies(self):
        """H_b, H_bm, J_b* and J_m* of links that stand."""

        def run():
            composite_body.compose(self.robot.joints, self.w)
            composite_body.base_generalized_jacobian(self.w)
            composite_body.generalized_jacobian(self.robot, self.w)

        return self._count(run)

    def table(self, name):
        return getattr(self.w, name).astype(float)

    @staticmethod
    def _count(run):
        before = Counted.done
        run()
        return Counted.done - before

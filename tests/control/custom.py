"""Tasks, inequalities and solvers as users write them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ospace.control import CustomTask, Inequality, RowsInequality, RowsTask
from ospace.control.solvers import solver_named
from ospace.model.points import OperationalPoint


@dataclass(frozen=True, kw_only=True, eq=False)
class Height(CustomTask):
    """z of a point."""

    point: OperationalPoint
    height: float = 0.0

    def error(self, at):
        return at.position(self.point)[2] - self.height

    def jacobian(self, at):
        return at.jacobian(self.point)[2]


@dataclass(frozen=True, kw_only=True, eq=False)
class HeightWithDrift(Height):
    """The same, with its drift."""

    def drift(self, at):
        return at.drift(self.point)[2]


@dataclass(frozen=True, kw_only=True, eq=False)
class Distance(CustomTask):
    """Square of the distance of two points, and height of the first: two rows, of which one bends."""

    size = 2
    points_of_it: tuple[OperationalPoint, ...]
    square: float = 1.0

    def error(self, at):
        first, second = map(at.position, self.points_of_it)
        return [(first - second) @ (first - second) - self.square, first[2]]

    def jacobian(self, at):
        d = at.position(self.points_of_it[0]) - at.position(self.points_of_it[1])
        first, second = (at.jacobian(point)[:3] for point in self.points_of_it)
        return np.array([2.0 * d @ (first - second), first[2]])


@dataclass(frozen=True, kw_only=True, eq=False)
class Bobbing(Height):
    """A height that goes up and down."""

    def error(self, at):
        return at.position(self.point)[2] - self.height - 0.1 * np.sin(2.0 * at.time)

    def rate(self, at):
        return self.jacobian(at) @ at.v - 0.2 * np.cos(2.0 * at.time)


@dataclass(frozen=True, kw_only=True, eq=False)
class Spin(RowsTask):
    """One joint's acceleration."""

    joint: int
    acceleration: float

    def equations(self, at):
        A = np.zeros((1, len(at.v) - 6))
        A[0, self.joint] = 1.0
        return A, [self.acceleration]


@dataclass(frozen=True, kw_only=True, eq=False)
class Sum(RowsInequality):
    """A bound on the sum of all of z, of `count` numbers, and a row that bounds nothing."""

    size = 2
    count: int
    most: float

    def bounds(self, at):
        return np.ones((2, self.count)), np.array([self.most, np.inf])


@dataclass(frozen=True, kw_only=True, eq=False)
class Below(Inequality):
    """A point stays below a height."""

    point: OperationalPoint
    height: float

    def value(self, at):
        return self.height - at.position(self.point)[2]

    def jacobian(self, at):
        return -at.jacobian(self.point)[2]


def daqp_by_hand(program):
    return solver_named("daqp")(program)

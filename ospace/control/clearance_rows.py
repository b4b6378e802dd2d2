"""Rows of a cycle's program that keep links apart: solids placed, distances by Coal, and the kernels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import Any

import coal
import numpy as np
import pinocchio as pin

from ospace.checks import checked_vector
from ospace.collision import DistanceSolver, Solid
from ospace.collision.solver import NUMBERS
from ospace.control.clearance import Clearance, Nearest
from ospace.exceptions import OspaceError
from ospace.kernels.qp import contacts as kernel
from ospace.kernels.qp.clearance import write_clearance_rows
from ospace.kernels.qp.contacts import bound_distances, take_distances
from ospace.kernels.qp.tables import Program
from ospace.kernels.tasks.tables import BaseActuation
from ospace.kernels.tree import Floats

_SPARE = 5e-4
"""By which more than the clearance is kept, m: how nearest points move over the solids is not foreseen."""
_CORNERS = 100
"""At most, of a mesh; those of one with more are the outermost in so many directions."""


class ClearanceRows:
    """Writes the rows of a clearance to the program of a controller.

    Parameters
    ----------
    clearance : Clearance
    first : int
        Row of `Program.C` where they begin.
    base, program : the controller's tables
    memory : Floats
        Of its evaluator.
    period, horizon : float
        Of control, and how far ahead limits are seen; s.

    Attributes
    ----------
    nearest : Nearest
        Of the last cycle.
    names : list of str
        What each row is called, empty for one that bounds nothing.
    """

    def __init__(
        self,
        clearance: Clearance,
        first: int,
        base: BaseActuation,
        program: Program,
        memory: Floats,
        period: float,
        horizon: float,
    ) -> None:
        self._clearance = clearance
        robot, bodies, watched = clearance.robot, clearance.bodies, set(clearance.watched)
        self._bodies = _Bodies(clearance)
        numbers = [(i, j) for i, (a, *_) in enumerate(bodies) for j, (b, *_) in enumerate(bodies) if (a, b) in watched]
        links = self._bodies.links
        self._solids = _solids(clearance, links, len(self._bodies.places))
        p = len(numbers)
        self._first, self._second = np.array(numbers, dtype=np.int64).T.copy()
        self._pairs = kernel.Pairs(
            self._first, self._second, np.zeros((p, NUMBERS)), np.full(p, -np.inf), *np.zeros((2, p))
        )
        fixed = [
            Solid(solid.link, joint if obstacle < 0 else 0, solid.placement, solid.geometry)
            for _, obstacle, joint, solid in bodies
        ]
        self._solver = DistanceSolver(robot.model, fixed, numbers)
        self._links = [(bodies[i][0], bodies[j][0]) for i, j in numbers]
        self._rows = np.full(clearance.size, -1, dtype=np.int64)
        self.names = [""] * clearance.size
        count = kernel.MOST_CONTACTS * p
        contacts = kernel.Contacts(
            pair=np.zeros(count, dtype=np.int64),
            numbers=np.zeros((count, NUMBERS)),
            slack=np.zeros(count),
            rate=np.zeros(count),
            least=np.zeros(clearance.size),
        )
        self._smallest, self._found = 0, np.zeros(1, dtype=np.int64)
        self.nearest = Nearest(math.inf, ("", ""))
        self._q = np.zeros(robot.nq)
        kept = clearance.distance + _SPARE, clearance.deceleration, period, horizon
        self._bounding = memory, self._solids, self._pairs, *kept
        self._writing = memory, base, *kept, self._solids, self._pairs, contacts, self._rows, first, program

    @property
    def below(self) -> float:
        """By how much the smallest distance is below the clearance, m."""
        return self._clearance.distance - self.nearest.distance

    def outside(self, least: float) -> dict[str, float]:
        """Return by how much pairs are too near, by name, where it is more than `least`."""
        found: dict[str, float] = {}
        for k in np.flatnonzero(self._pairs.least < self._clearance.distance - least).tolist():
            name, by = self._name(k), self._clearance.distance - float(self._pairs.least[k])
            found[name] = max(by, found.get(name, 0.0))
        return found

    @property
    def units(self) -> dict[str, str]:
        """Unit of the distance of each pair, by its name."""
        return {self._name(k): "m" for k in range(len(self._links))}

    def write(self, time: float, q: Floats, v: Floats) -> bool:
        """Write the rows for the state that the controller's evaluator has evaluated last.

        Returns
        -------
        bool
            Whether `names` are others than before.

        Raises
        ------
        OspaceError
            The motion of an obstacle fails, or is not finite; Coal finds no distance.
        """
        pairs, solids = self._pairs, self._solids
        self._q[3:] = q[3:]
        self._solver.configure(self._q)  # about the base: nothing is lost far from the origin
        self._bodies.place(time, q, v, self._solver, solids)
        bound_distances(*self._bounding)
        near = pairs.least < pairs.reach
        near[self._smallest] = True
        while True:
            self._found = near.nonzero()[0]
            self._solver.nearest(self._found, pairs.numbers)
            self._smallest = take_distances(solids, pairs, self._found)
            if self._smallest < 0:
                failed, self._smallest = self._links[-1 - self._smallest], 0
                raise OspaceError(f"clearance: Coal finds no distance of {' / '.join(failed)}: check their shapes")
            if near[self._smallest]:
                break
            near[self._smallest] = True
        self.nearest = Nearest(float(pairs.least[self._smallest]), self._links[self._smallest])
        changed = bool(write_clearance_rows(*self._writing, self._found))
        if changed:
            self.names = [self._name(k) if k >= 0 else "" for k in self._rows.tolist()]
        return changed

    def calls(self) -> list[tuple[Any, tuple[Any, ...]]]:
        """Return the kernels, with the arguments that they are called with."""
        return [
            (bound_distances, self._bounding),
            (take_distances, (self._solids, self._pairs, self._found)),
            (write_clearance_rows, (*self._writing, self._found)),
        ]

    def _name(self, k: int) -> str:
        return f"{' / '.join(self._links[k])}: {self._clearance.name}"


class _Bodies:
    """Bodies of obstacles, as they move.

    Attributes
    ----------
    links : list of int
        What carries each solid: the link of the recursions, or −1 − m for body m.
    places : list of (int, int)
        Number of the obstacle and of its joint for each body m.
    """

    def __init__(self, clearance: Clearance) -> None:
        self._obstacles = tuple(clearance.obstacles)
        self._data = [one.robot.model.createData() for one in self._obstacles]
        self.places: list[tuple[int, int]] = []
        self.links: list[int] = []
        self._solids: list[tuple[int, int, pin.SE3]] = []
        for s, (_, obstacle, joint, solid) in enumerate(clearance.bodies):
            if obstacle < 0:
                self.links.append(int(clearance.robot.link_of_joint[joint]))
                continue
            if (obstacle, joint) not in self.places:
                self.places.append((obstacle, joint))
            m = self.places.index((obstacle, joint))
            self.links.append(-1 - m)
            self._solids.append((s, m, solid.placement))

    def place(self, time: float, q: Floats, v: Floats, solver: DistanceSolver, to: kernel.Solids) -> None:
        """Write how the bodies move at a time, about the base in the state (q, v), and place their solids."""
        if not self.places:
            return
        for one, data in zip(self._obstacles, self._data, strict=True):
            try:
                given_q, given_v = one.motion(time)
            except Exception as error:
                if isinstance(error, OspaceError):
                    raise
                raise OspaceError(
                    f"motion of obstacle '{one.robot.name}' failed: {type(error).__name__}: {error}"
                ) from error
            model, name = one.robot.model, f"of obstacle '{one.robot.name}'"
            own_q = checked_vector(given_q, model.nq, f"q {name}")
            own_v = checked_vector(given_v, model.nv, f"v {name}")
            own_q[:3] -= q[:3]
            a = pin.aba(model, data, own_q, own_v, np.zeros(model.nv))
            pin.forwardKinematics(model, data, own_q, own_v, a)
        poses, base = [], pin.Quaternion(q[3:7]).toRotationMatrix() @ v[:3]
        for m, (k, joint) in enumerate(self.places):
            data = self._data[k]
            T, twist, a = data.oMi[joint], data.v[joint], data.a[joint]
            R, omega = T.rotation, T.rotation @ twist.angular
            linear = R @ twist.linear
            to.body_R[m], to.body_r[m] = R.ravel(order="F"), T.translation
            to.body_v[m, :3], to.body_v[m, 3:] = linear - base, omega
            to.body_a[m, :3], to.body_a[m, 3:] = R @ a.linear + np.cross(omega, linear), R @ a.angular
            poses.append(T)
        for s, m, placement in self._solids:
            solver.place(s, poses[m] * placement)


def _solids(clearance: Clearance, links: Sequence[int], bodies: int) -> kernel.Solids:
    """Lay out all solids, with the spheres around them, their corners and their symmetry."""
    count, robot = len(links), clearance.robot
    centre, axis = np.zeros((2, count, 3))
    radius, disc, rounding = np.zeros((3, count))
    symmetry, corners = np.zeros(count, dtype=np.int64), []
    for s, (_, obstacle, joint, solid) in enumerate(clearance.bodies):
        shape, R = solid.geometry, np.eye(3) if obstacle >= 0 else robot.link_axes[joint].T
        shape.computeLocalAABB()
        radius[s] = shape.aabb_radius
        centre[s] = R @ solid.placement.act(shape.aabb_center)
        own = np.zeros((1, 3))
        if isinstance(shape, coal.Sphere):
            symmetry[s], rounding[s] = kernel.BALL, shape.radius
        elif isinstance(shape, coal.Capsule | coal.Cylinder):
            symmetry[s], axis[s] = kernel.AXIS, R @ solid.placement.rotation[:, 2]
            own = np.array([[0.0, 0.0, -shape.halfLength], [0.0, 0.0, shape.halfLength]])
            (disc if isinstance(shape, coal.Cylinder) else rounding)[s] = shape.radius
        elif isinstance(shape, coal.Box):
            own = np.array(list(product(*([-half, half] for half in shape.halfSide.tolist()))))
        else:
            own = _outermost(np.array(shape.points()))
        corners.append((solid.placement.rotation @ own.T).T + solid.placement.translation)
        corners[-1] = corners[-1] @ R.T
    return kernel.Solids(
        np.array(links, dtype=np.int64),
        centre,
        radius,
        symmetry,
        axis,
        np.concatenate(corners),
        np.concatenate([[0], np.cumsum([len(own) for own in corners])]).astype(np.int64),
        disc,
        rounding,
        np.zeros((bodies, 9)),
        np.zeros((bodies, 3)),
        np.zeros((bodies, 6)),
        np.zeros((bodies, 6)),
        np.zeros((count, 3)),
        np.zeros((count, 9)),
        np.zeros(count),
        np.zeros((count, 3)),
        np.zeros(count),
    )


def _outermost(points: Floats) -> Floats:
    """Return points (N, 3), at most so many of them as count: the outermost in directions all around."""
    if len(points) <= _CORNERS:
        return points
    z = np.linspace(-1.0, 1.0, _CORNERS)
    turn = np.pi * (3.0 - math.sqrt(5.0)) * np.arange(_CORNERS)
    across = np.sqrt(1.0 - z * z)
    directions = np.array([across * np.cos(turn), across * np.sin(turn), z])
    chosen: Floats = points[np.unique((points @ directions).argmax(axis=0))]
    return chosen

"""Quantities that a scene shows beside the robot, as nodes that are placed anew for each state.

mass centre          a ball
operational inertia  the ellipsoid f Γ_e⁻¹ f = 1 of each point's translational Γ_e: semi-axes along its eigenvectors,
                     as long as the roots of its eigenvalues, which are effective masses
manipulability       the ellipsoids J_m* φ̇ and J_m φ̇ with |φ̇| ≤ 1: what the point reaches in linear velocity on
                     the floating base, and on one that is held; semi-axes are singular values
momentum             linear and angular, of the whole, of the base, of all that hangs from it; arrows at their
                     centres of mass, angular ones about that of the whole
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import permutations
from typing import ClassVar

import numpy as np
import pinocchio as pin
from meshcat import geometry as g

from ospace.dynamics.generalized_jacobian import generalized_jacobian
from ospace.dynamics.joint_space import momentum
from ospace.dynamics.operational_space import operational_space
from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.model.layout import Layout
from ospace.model.points import OperationalPoint
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.urdf.description import Colour
from ospace.visual.environment import arrow
from ospace.visual.meshcat_scene import MeshcatScene, component
from ospace.visual.shapes import SmoothSphere, homogeneous, material

_MASS: Colour = (0.95, 0.35, 0.75, 0.38)
_FLOATING: Colour = (0.15, 0.85, 0.95, 0.45)
_HELD: Colour = (0.62, 0.66, 0.74, 0.34)
_CENTRE = 0xFFD23F
_MOMENTA = {"linear": 0x3FA7FF, "angular": 0xFF6BD6}
_PARTS = ("whole", "base", "arms")
_THIN = 1e-3  # of the longest semi-axis, which a singular direction is drawn with
_VANISHED = 1e-6  # of the robot's size: what a scale of zero, which no page can invert, is drawn with
_ROUND_OFF = 1e-9  # of the scale of momentum: rounding, and no arrow
_SLOW = 0.1  # m/s and rad/s: what the arrows of momentum are measured by, unless a motion sets the scale

Placed = Iterator[tuple[str, Floats]]


class Overlay(ABC):
    """A quantity drawn over a scene.

    Attributes
    ----------
    name, title : str
        Of its layer, and what pages call it.
    round : bool
        Whether it is made of balls, whose axes may change places.
    paths : list of str
        Its nodes.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    round: ClassVar[bool] = False
    paths: list[str]
    _legend = ""

    @abstractmethod
    def __init__(
        self, scene: MeshcatScene, root: str, points: Sequence[OperationalPoint], reach: float, robot: SpaceRobot
    ) -> None: ...

    @property
    def legend(self) -> str:
        """Meaning of its lengths and colours."""
        return self._legend

    def measure(self, states: Iterable[State]) -> None:  # noqa: B027 (most have a scale of their own)
        """Take the scale from the states of a motion, where it is not given once for all."""

    @abstractmethod
    def place(self, state: State) -> Placed:
        """Yield paths and placements (4, 4) as seen from the base's origin, inertial axes, m.

        The state is that of the robot, or of the robot combined with what it holds.
        """


class MassCentre(Overlay):
    """The centre of mass."""

    name, title = "mass-centre", "centre of mass"

    def __init__(
        self, scene: MeshcatScene, root: str, points: Sequence[OperationalPoint], reach: float, robot: SpaceRobot
    ) -> None:
        self.paths = [f"{root}/mass centre"]
        scene.set_object(self.paths[0] + "/ball", SmoothSphere(0.018 * reach), g.MeshPhongMaterial(color=_CENTRE))

    def place(self, state: State) -> Placed:
        """Place its nodes, as `Overlay.place`."""
        yield self.paths[0], homogeneous(np.eye(3), _mass_centre(state))


class OperationalInertia(Overlay):
    """Translational Γ_e of each point by itself."""

    name, title = "operational-inertia", "operational-space inertia Γₑ"
    round = True

    def __init__(
        self, scene: MeshcatScene, root: str, points: Sequence[OperationalPoint], reach: float, robot: SpaceRobot
    ) -> None:
        self._points = _linear(points)
        self.paths = [f"{root}/inertia {component(point.frame)} {k}" for k, point in enumerate(points)]
        self._scale, self._least = 0.4 * reach / robot.total_mass**0.5, _VANISHED * reach
        self._legend = f"effective masses: semi-axes are {100.0 * self._scale:.2g} cm √(m/kg)"
        for path in self.paths:
            scene.set_object(f"{path}/ball", SmoothSphere(1.0), material(_MASS))

    def place(self, state: State) -> Placed:
        """Place its nodes, as `Overlay.place`."""
        for path, point in zip(self.paths, _on(state.robot, self._points), strict=True):
            at = state.placement_about_base(point).translation
            try:
                masses, axes = np.linalg.eigh(operational_space(state, point).inertia)
            except OspaceError:  # the point cannot be accelerated in some direction
                masses, axes = np.zeros(3), np.eye(3)
            yield path, _ellipsoid(axes, self._scale * np.sqrt(np.maximum(masses, 0.0)), at, self._least)


class Manipulability(Overlay):
    """Generalized manipulability, and that of the same arm on a base that is held."""

    name, title = "manipulability", "generalized manipulability"
    round = True

    def __init__(
        self, scene: MeshcatScene, root: str, points: Sequence[OperationalPoint], reach: float, robot: SpaceRobot
    ) -> None:
        self._points = _linear(points)
        names = [f"{component(point.frame)} {k}" for k, point in enumerate(points)]
        self._floating = [f"{root}/floating {name}" for name in names]
        self._held = [f"{root}/held {name}" for name in names]
        self.paths = self._floating + self._held
        self._scale, self._least = 0.2, _VANISHED * reach
        self._legend = "velocity at unit joint rates, 1 m/s as 20 cm; cyan: floating base, grey: base held"
        for paths, colour in ((self._floating, _FLOATING), (self._held, _HELD)):
            for path in paths:
                scene.set_object(f"{path}/ball", SmoothSphere(1.0), material(colour))

    def place(self, state: State) -> Placed:
        """Place its nodes, as `Overlay.place`."""
        for floating, held, point in zip(self._floating, self._held, _on(state.robot, self._points), strict=True):
            at = state.placement_about_base(point).translation
            J_m = operational_space(state, point, method="dense").jacobian[:, 6:]
            for path, J in ((floating, generalized_jacobian(state, point).generalized_jacobian), (held, J_m)):
                U, sigma, _ = np.linalg.svd(J @ J.T)
                yield path, _ellipsoid(U, self._scale * np.sqrt(sigma), at, self._least)


class Momentum(Overlay):
    """Linear and angular momentum."""

    name, title = "momentum", "momentum"

    def __init__(
        self, scene: MeshcatScene, root: str, points: Sequence[OperationalPoint], reach: float, robot: SpaceRobot
    ) -> None:
        self._arrows = {(part, kind): f"{root}/{kind} {part}" for part in _PARTS for kind in _MOMENTA}
        self.paths = list(self._arrows.values())
        self._length, self._least = 0.45 * reach, _VANISHED * reach
        mass = robot.total_mass
        self._largest = {"linear": _SLOW * mass, "angular": _SLOW * mass * (0.5 * reach) ** 2}
        for (_, kind), path in self._arrows.items():
            arrow(scene, path, _MOMENTA[kind])

    @property
    def legend(self) -> str:
        """Meaning of the arrows' lengths."""
        linear, angular = (f"{largest / self._length:.2g}" for largest in self._largest.values())
        return (
            f"blue: linear, {linear} kg m/s as 1 m; magenta: angular, {angular} kg m²/s as 1 m; "
            f"of the whole, of the base, of what hangs from it"
        )

    def measure(self, states: Iterable[State]) -> None:
        """Take the scale of the arrows from the largest momenta of a motion."""
        sizes = np.array(
            [[np.linalg.norm(h.reshape(2, 3), axis=1) for h, _ in _momenta(one).values()] for one in states]
        )
        for kind, largest in zip(_MOMENTA, sizes.reshape(-1, 2).max(axis=0), strict=True):
            self._largest[kind] = float(largest) or self._largest[kind]

    def place(self, state: State) -> Placed:
        """Place its nodes, as `Overlay.place`."""
        scale = float(np.linalg.norm(state.v)) * state.robot.total_mass
        for part, (h, at) in _momenta(state).items():
            for kind, vector in (("linear", h[:3]), ("angular", h[3:])):
                size = float(np.linalg.norm(vector))
                shown = size > _ROUND_OFF * scale
                length = max(self._least, self._length * size / self._largest[kind]) if shown else self._least
                yield self._arrows[part, kind], homogeneous(length * (_z_along(vector) if shown else np.eye(3)), at)


def align_axes(places: Sequence[Floats]) -> list[Floats]:
    """Return placements of a ball (4, 4), axes numbered and signed as is nearest to those before.

    Eigenvectors come in any order and with any sign: between two that differ an ellipsoid would turn about itself.
    """
    found = [places[0]]
    for T in places[1:]:
        before, axes = (one[:3, :3] / np.linalg.norm(one[:3, :3], axis=0) for one in (found[-1], T))
        alike = before.T @ axes
        order = max(permutations(range(3)), key=lambda order: np.abs(alike[range(3), order]).sum())
        signs = np.where(alike[range(3), order] < 0.0, -1.0, 1.0)
        turned = T.copy()
        turned[:3, :3] = T[:3, order] * signs
        if np.linalg.det(axes[:, order] * signs) < 0.0:
            turned[:3, np.argmin(np.abs(alike[range(3), order]))] *= -1.0
        found.append(turned)
    return found


OVERLAYS: tuple[type[Overlay], ...] = (MassCentre, OperationalInertia, Manipulability, Momentum)


def _linear(points: Sequence[OperationalPoint]) -> list[OperationalPoint]:
    return [replace(point, axes=(True, True, True, False, False, False)) for point in points]


def _on(robot: Layout, points: Sequence[OperationalPoint]) -> list[OperationalPoint]:
    """Return the points on a combined robot, which has all frames of the robot that they were made for."""
    return [
        point if point.robot is robot else replace(point, robot=robot, joint=int(robot.frame(point.frame).parentJoint))
        for point in points
    ]


def _ellipsoid(axes: Floats, lengths: Floats, at: Floats, least: float) -> Floats:
    """Place a unit ball as an ellipsoid with semi-axes along the columns of `axes`, none shorter than `least`, m."""
    turn = axes * np.sign(np.linalg.det(axes))
    return homogeneous(turn * np.maximum(lengths, max(least, _THIN * lengths.max())), at)


def _z_along(direction: Floats) -> Floats:
    """Return a rotation whose third column is along `direction`."""
    turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), direction / np.linalg.norm(direction))
    return np.asarray(turn.matrix())


def _mass_centre(state: State) -> Floats:
    """As seen from the base's origin, inertial axes, m."""
    robot = state.robot
    data = robot.data
    return np.array(pin.centerOfMass(robot.model, data, state.base_frame_state()[0]))


def _momenta(state: State) -> dict[str, tuple[Floats, Floats]]:
    """Return momentum (6,) about the centre of mass of the whole, and centre of mass (3,), of each part."""
    robot = state.robot
    own, centre, R = robot.model.inertias[1], _mass_centre(state), state.T_WB.rotation
    at = R @ own.lever
    h = own * pin.Motion(state.v[:6])  # about the base's origin, base axes
    linear, angular = R @ h.linear, R @ h.angular
    base = np.r_[linear, angular - np.cross(centre, linear)]
    M_0 = momentum(state)
    whole = np.r_[M_0[:3], M_0[3:] - np.cross(centre, M_0[:3])]
    rest = robot.total_mass - own.mass
    beyond = (robot.total_mass * centre - own.mass * at) / rest if rest > 0.0 else at
    return {"whole": (whole, centre), "base": (base, at), "arms": (whole - base, beyond)}

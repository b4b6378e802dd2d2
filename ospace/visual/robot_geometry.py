"""A robot as a scene shows it: links on nodes that move with its joints, meshes, and inertias as ellipsoids."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin
from meshcat import geometry as g

from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.urdf.bodies import link_places, placement, tensor_of
from ospace.urdf.description import Colour, Description, Inertial, Link, Shape
from ospace.urdf.lint.findings import Finding, make_finding
from ospace.urdf.lint.meshes import MeshError, locate
from ospace.visual.meshcat_scene import MeshcatScene, component
from ospace.visual.shapes import ShapePart, SmoothSphere, box_corners, homogeneous, material, shape_parts

TITLES = {"robot": "robot", "collision": "collision shapes", "inertia": "inertia of each link"}
"""The layers of a robot, and what pages call them."""
LEGENDS = {"inertia": "uniform ellipsoids of the same mass and tensor; red: no mass is spread so"}
_COLLISION: Colour = (0.25, 0.9, 0.55, 0.35)
_INERTIA: Colour = (1.0, 0.72, 0.2, 0.45)
_WRONG: Colour = (1.0, 0.15, 0.15, 0.7)
_IN_PLACE_OF_MESH: Colour = (0.62, 0.64, 0.68, 1.0)
_THIN = 1e-3  # of the largest semi-axis: how a tensor without extent is drawn
_ROUNDED = 1e-4  # of the largest moment, as findings have it


@dataclass
class RobotGeometry:
    """Hold what stands in a scene for one robot.

    Attributes
    ----------
    nodes : list of str
        Path of the node that moves with each body: the base, and what each joint carries.
    rest : list of (4, 4)
        Their placements with all joints at zero and the base at the origin, m.
    layers : dict of layer name to list of str
        Paths that belong to it.
    findings : list of Finding
        On meshes that cannot be shown.
    extents : list of (int, (8, 3))
        Number of a node, and corners of a box that holds a part of what stands on it, m.
    links : dict of link name to (int, (4, 4))
        Of a robot that a file describes: number of the node that a link is on, and its frame in that of the node, m.
    """

    nodes: list[str] = field(default_factory=list)
    rest: list[Floats] = field(default_factory=list)
    layers: dict[str, list[str]] = field(default_factory=lambda: {name: [] for name in TITLES})
    findings: list[Finding] = field(default_factory=list)
    extents: list[tuple[int, Floats]] = field(default_factory=list)
    links: dict[str, tuple[int, Floats]] = field(default_factory=dict)

    def of_link(self, name: str, layer: str) -> str:
        """Return the path below which all of a link in a layer stands."""
        return f"{self.nodes[self.links[name][0]]}/{layer}/link {component(name)}"

    def corners(self, places: Sequence[Floats]) -> Floats:
        """Return corners (N, 3) that all lies between, nodes placed at `places` (4, 4), m."""
        extents = self.extents or [(0, box_corners(np.eye(4), np.ones(3)))]
        return np.concatenate([box @ places[node][:3, :3].T + places[node][:3, 3] for node, box in extents])


def of_robot(scene: MeshcatScene, root: str, robot: SpaceRobot) -> RobotGeometry:
    """Put a robot into the scene below `root`."""
    model, description, builder = robot.model, robot.description, _GeometryBuilder(scene, {})
    data = robot.data
    pin.forwardKinematics(model, data, pin.neutral(model))
    for j in range(1, model.njoints):
        builder.node(f"{root}/joint {component(model.names[j])}" if j > 1 else f"{root}/base", data.oMi[j].homogeneous)
    if description is None or robot.source is None:
        for j in range(1, model.njoints):
            own = model.inertias[j]
            for show in (builder.inertia, builder.box):
                show(j - 1, model.names[j], _Inertia(own.mass, own.lever, own.inertia))
    else:
        builder.describes(description, robot.source, robot.package_dirs)
        for frame in model.frames:
            if frame.type == pin.FrameType.BODY and frame.parentJoint > 0:
                builder.link(description.link[frame.name], frame.parentJoint - 1, frame.placement)
    return builder.geometry


def of_description(
    scene: MeshcatScene,
    root: str,
    description: Description,
    urdf: Path,
    package_dirs: Sequence[Path],
    marked: Mapping[str, Colour],
) -> RobotGeometry:
    """Put into the scene what a file describes, sound or not, with all joints at zero.

    Parameters
    ----------
    scene : MeshcatScene
    root : str
        Path below which all stands.
    description : Description
    urdf : Path
        The robot's file.
    package_dirs : sequence of Path
        Where ``package://`` names of meshes are looked up.
    marked : mapping of link name to colour
        Colours in place of the links' own.

    Returns
    -------
    RobotGeometry
    """
    builder = _GeometryBuilder(scene, marked)
    builder.describes(description, urdf, package_dirs)
    bodies, places = link_places(description)
    for body in bodies:
        above = builder.geometry.rest[body.parent] if body.parent >= 0 else np.eye(4)
        builder.node(f"{root}/body {component(body.link.name)}", above @ homogeneous(body.rotation, body.translation))
    for name, (node, R, p) in places.items():
        builder.link(description.link[name], node, pin.SE3(R, p))
    return builder.geometry


class _Inertia(NamedTuple):
    """Mass, its centre and the tensor about it; Pinocchio's own class takes none that is unsound."""

    mass: float
    centre: Floats
    tensor: Floats


class _GeometryBuilder:
    def __init__(self, scene: MeshcatScene, marked: Mapping[str, Colour]) -> None:
        self.scene, self.marked = scene, marked
        self.geometry = RobotGeometry()
        self.bare = False

    def describes(self, description: Description, urdf: Path, package_dirs: Sequence[Path]) -> None:
        """Show links of a file; meshes are looked up beside it, and in the folders of packages."""
        self.urdf, self.package_dirs = urdf, package_dirs
        self.bare = not any(link.shapes for link in description.links)

    def node(self, path: str, T: Floats) -> None:
        """Add a node, at rest at `T` (4, 4), m."""
        self.geometry.nodes.append(path)
        self.geometry.rest.append(T)
        self.scene.set_transform(path, T)

    def link(self, link: Link, node: int, T: pin.SE3) -> None:
        """Show a link at `T` in the node's frame."""
        self.geometry.links[link.name] = node, T.homogeneous
        inertia = None if link.inertial is None else _seen(link.inertial, T)
        if self.bare and inertia is not None:
            self.box(node, link.name, inertia)
        boxed = False
        for k, shape in enumerate(link.shapes):
            try:
                mesh = locate(shape.filename, self.urdf, self.package_dirs) if shape.kind == "mesh" else None
                parts = list(shape_parts(shape, mesh))
            except (MeshError, ValueError) as error:
                code = error.code if isinstance(error, MeshError) else "mesh-unreadable"
                finding = make_finding(code, link.subject, str(error), line=shape.line, value=shape.filename)
                self.geometry.findings.append(finding)
                if shape.role == "visual" and inertia is not None and not boxed:
                    self.box(node, link.name, inertia)
                    boxed = True
                continue
            for i, part in enumerate(parts):
                self._solid(node, link.name, shape, f"{k}.{i}" if len(parts) > 1 else f"{k}", part, T)
        if inertia is not None:
            self.inertia(node, link.name, inertia)

    def _solid(self, node: int, link: str, shape: Shape, number: str, part: ShapePart, T: pin.SE3) -> None:
        layer = "robot" if shape.role == "visual" else "collision"
        path = self._path(node, layer, f"link {component(link)}/{shape.role} {number}")
        colour = self.marked.get(link, part.colour) if layer == "robot" else _COLLISION
        self.scene.set_object(path, part.geometry, material(colour))
        place = T.homogeneous @ part.T
        self.scene.set_transform(path, place)
        self.geometry.extents.append((node, box_corners(place, part.half)))

    def inertia(self, node: int, name: str, inertia: _Inertia) -> None:
        """Show the uniform ellipsoid of the same mass and moments; in red where there is none."""
        squares, axes, gross = _semi_axes_squared(inertia)
        if inertia.mass <= 0.0 or squares.max() <= 0.0:
            return
        lengths = np.sqrt(np.maximum(squares, _THIN**2 * squares.max()))
        path = self._path(node, "inertia", component(f"link {name}"))
        self.scene.set_object(path, SmoothSphere(1.0), material(_WRONG if gross else _INERTIA))
        self.scene.set_transform(path, homogeneous(axes * lengths, inertia.centre))

    def box(self, node: int, name: str, inertia: _Inertia) -> None:
        """Show the uniform box of the same mass and moments, in place of what cannot be shown or is not there."""
        squares, axes, _ = _semi_axes_squared(inertia)
        if inertia.mass <= 0.0 or squares.max() <= 0.0:
            return
        sides = 2.0 * np.sqrt(0.6 * np.maximum(squares, _THIN**2 * squares.max()))
        path = self._path(node, "robot", component(f"link {name}") + "/inertia box")
        self.scene.set_object(path, g.Box(sides.tolist()), material(self.marked.get(name, _IN_PLACE_OF_MESH)))
        self.scene.set_transform(path, homogeneous(axes, inertia.centre))
        self.geometry.extents.append((node, box_corners(homogeneous(axes, inertia.centre), 0.5 * sides)))

    def _path(self, node: int, layer: str, name: str) -> str:
        own = f"{self.geometry.nodes[node]}/{layer}"
        if own not in self.geometry.layers[layer]:
            self.geometry.layers[layer].append(own)
        return f"{own}/{name}"


def _seen(inertial: Inertial, T: pin.SE3) -> _Inertia:
    """Return the inertia of a link that stands at `T`."""
    R, centre = placement(inertial.pose)
    turn = T.rotation @ R
    return _Inertia(inertial.mass, T.act(centre), turn @ tensor_of(inertial) @ turn.T)


def _semi_axes_squared(inertia: _Inertia) -> tuple[Floats, Floats, bool]:
    """Return squares (3,) of the semi-axes of the uniform ellipsoid, m²; its axes as columns; whether it is none.

    With moments I_k = m/5 (a_i² + a_j²), a_k² = 5/2m (I_i + I_j − I_k), which is negative where no mass is spread so.
    """
    moments, axes = np.linalg.eigh(inertia.tensor)
    if np.linalg.det(axes) < 0.0:
        axes[:, 0] *= -1.0
    squares = 2.5 / inertia.mass * (moments.sum() - 2.0 * moments) if inertia.mass > 0.0 else np.zeros(3)
    return squares, axes, bool((moments.sum() - 2.0 * moments).min() < -_ROUNDED * moments.max())

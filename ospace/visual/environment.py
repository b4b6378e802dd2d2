"""Surroundings of a robot: background and stars, sun and camera; arrows and triads that stand for quantities."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from meshcat import geometry as g

from ospace.exceptions import OspaceError
from ospace.kernels.tree import Floats
from ospace.visual.meshcat_scene import MeshcatScene
from ospace.visual.shapes import homogeneous, material

Background = Literal["space", "paper"]
BACKGROUNDS: tuple[Background, ...] = ("space", "paper")
_SKIES = {"space": ((0.035, 0.05, 0.10), (0.005, 0.007, 0.02)), "paper": ((1.0, 1.0, 1.0), (0.93, 0.94, 0.96))}
_VIEW = np.array([0.80, -0.72, 0.42])  # from where the camera looks
_SUN = np.array([0.35, -0.75, 0.85])
_FIELD = 36.0  # of view, deg
_ASPECT, _MARGIN = 1.25, 1.12  # of the picture, which is wider than high, and what stays free around the robot
_LEVEL, _LEAN, _RISE = 0.2, 0.35, 0.42  # of two robots above each other; of the view aside, and from above
_STARS = 1400


class _Light(g.Object):  # type: ignore[misc]
    _type = "DirectionalLight"

    def __init__(self, colour: int, intensity: float, position: Floats, reach: float) -> None:
        super().__init__(None, None)
        self._colour, self._intensity, self._position, self._reach = colour, intensity, position, reach

    def lower(self) -> dict[str, Any]:
        reach = self._reach
        camera = {"type": "OrthographicCamera", "left": -reach, "right": reach, "top": reach, "bottom": -reach}
        return {
            "metadata": {"version": 4.5, "type": "Object"},
            "geometries": [],
            "materials": [],
            "object": {
                "uuid": self.uuid,
                "type": self._type,
                "color": self._colour,
                "intensity": self._intensity,
                "matrix": homogeneous(np.eye(3), self._position).ravel(order="F").tolist(),
                "shadow": {
                    "bias": -0.0005,
                    "normalBias": 0.02,
                    "mapSize": [2048, 2048],
                    "camera": camera | {"near": 0.1 * reach, "far": 6.0 * reach},
                },
            },
        }


class _Dots(g.PointsMaterial):  # type: ignore[misc]
    def lower(self, object_data: Any) -> Any:
        return super().lower(object_data) | {"sizeAttenuation": False}


def surround(scene: MeshcatScene, background: Background, corners: Floats, along: Floats | None = None) -> None:
    """Set up background, light and camera for a scene that lies between `corners` (N, 3), m.

    The camera looks across `along` (3,), the way from one robot to another, if there is one.

    Raises
    ------
    OspaceError
        The background is none of `BACKGROUNDS`.
    """
    if background not in BACKGROUNDS:
        raise OspaceError(f"background '{background}': choose from {', '.join(BACKGROUNDS)}")
    lower, upper = corners.min(axis=0), corners.max(axis=0)
    centre, reach = 0.5 * (lower + upper), 0.5 * float(np.linalg.norm(upper - lower))
    top, bottom = _SKIES[background]
    scene.set_property("/Background", "top_color", list(top))
    scene.set_property("/Background", "bottom_color", list(bottom))
    for default in (
        "/Grid",
        "/Axes",
        "/Lights/PointLightNegativeX",
        "/Lights/PointLightPositiveX",
        "/Lights/FillLight",
    ):
        scene.set_property(default, "visible", False)
    ambient, sun = (0.42, 0.85) if background == "space" else (0.55, 0.5)
    scene.set_property("/Lights/AmbientLight/<object>", "intensity", ambient)
    for name, colour, intensity, direction in (
        ("Sun", 0xFFF6E8, sun, _SUN),
        ("Earthshine", 0x9DB8FF, 0.28, np.array([-0.6, 0.9, -0.5])),
        ("Front", 0xFFFFFF, 0.25 * sun, _VIEW),
    ):
        position = 3.0 * reach * direction / np.linalg.norm(direction)
        scene.set_object(f"/Lights/{name}", _Light(colour, intensity, centre + position, 1.3 * reach))
        scene.set_property(f"/Lights/{name}/<object>", "castShadow", name == "Sun")
    view = _view(along)
    distance = _distance(corners - centre, view)
    camera = "/Cameras/default/rotated/<object>"
    scene.set_property(camera, "fov", _FIELD)
    scene.set_property(camera, "near", 0.01 * distance)
    scene.set_property(camera, "far", 30.0 * distance)
    for name, (x, y, z) in (("position", centre + distance * view), ("target", centre)):
        scene.set_property(camera, name, [x, z, -y])  # its frame stands with y upwards
    if background == "space":
        rng = np.random.default_rng(7)
        where = rng.normal(size=(3, _STARS))
        where *= 20.0 * distance / np.linalg.norm(where, axis=0)
        bright = 0.25 + 0.75 * rng.random(_STARS) ** 3
        colour = bright * np.array([[0.95], [0.97], [1.0]])
        stars = g.Points(g.PointsGeometry(where.astype(np.float32), colour.astype(np.float32)), _Dots(size=1.6))
        scene.set_object("/stars", stars)


def _view(along: Floats | None) -> Floats:
    """Return the direction (3,) from what the camera looks at to the camera."""
    view = _VIEW
    if along is not None:
        across = np.cross(along, [0.0, 0.0, 1.0])
        if np.linalg.norm(across) > _LEVEL * np.linalg.norm(along):
            side = across / np.linalg.norm(across)
            ahead = along * [1.0, 1.0, 0.0] / np.linalg.norm(along[:2])
            view = side * np.copysign(1.0, side @ _VIEW) + _LEAN * ahead + [0.0, 0.0, _RISE]
    return np.asarray(view / np.linalg.norm(view))


def _distance(corners: Floats, away: Floats) -> float:
    """Return from how far away a camera in the direction `away` sees all of `corners`, seen from where it looks to."""
    right = np.cross([0.0, 0.0, 1.0], away)
    right /= np.linalg.norm(right)
    up = np.cross(away, right)
    tangent = np.tan(np.radians(0.5 * _FIELD))
    across, high, near = np.abs(corners @ right) / _ASPECT, np.abs(corners @ up), corners @ away
    return float(_MARGIN * (near + np.maximum(across, high) / tangent).max())


def arrow(scene: MeshcatScene, path: str, colour: int) -> None:
    """Put an arrow of length 1 along z at `path`."""
    paint = material(((colour >> 16) / 255.0, (colour >> 8 & 255) / 255.0, (colour & 255) / 255.0, 1.0))
    for part, geometry, middle in (
        ("shaft", g.Cylinder(0.8, 0.018), 0.4),
        ("head", g.Cylinder(0.2, radiusTop=0.0, radiusBottom=0.055), 0.9),
    ):
        scene.set_object(f"{path}/{part}", geometry, paint)
        T = homogeneous(np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]), np.array([0.0, 0.0, middle]))
        scene.set_transform(f"{path}/{part}", T)


def triad(scene: MeshcatScene, path: str, length: float) -> None:
    """Put axes x, y, z, red, green and blue, at `path`."""
    turns = (
        np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]]),
        np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]]),
        np.eye(3),
    )
    for name, colour, R in zip("xyz", (0xE8453C, 0x43B649, 0x3F7BF0), turns, strict=True):
        arrow(scene, f"{path}/{name}", colour)
        scene.set_transform(f"{path}/{name}", homogeneous(length * R, np.zeros(3)))

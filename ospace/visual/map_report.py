"""The report of a map: the field on the robot in three dimensions, workspaces, extremes and curves, in one file."""

from __future__ import annotations

import base64
import gzip
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import ospace
from ospace.analysis import map_text
from ospace.analysis.arm import Arm
from ospace.analysis.map_result import MapResult
from ospace.files import write_text
from ospace.visual import map_plots, page
from ospace.visual.page import Layer
from ospace.visual.scene import Scene

_FIELD = "/map"
_LAYERS = ("robot", "points", "collision")
"""Of a scene: those that stand still when the robot is put elsewhere, or move along with it."""
_DEXTERITY = ("singular_value", "manipulability")
_LEGEND = "cubes where the hand can be; point at one for its value and posture, click it to put the robot there"


def save(result: MapResult, path: str | PathLike[str], *, name: str) -> Path:
    """Write the report of a map to one HTML file, which needs no network.

    Parameters
    ----------
    result : MapResult
    path : path-like
        Where to.
    name : str
        Of the robot, as the user wrote it.

    Returns
    -------
    Path
        Of the file written.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    text = render(result, name=name)
    return write_text(path, text)


def render(result: MapResult, *, name: str) -> str:
    """Return the report as a page; parameters as of `save`."""
    arm, found = result.arm, result.arm_map
    scene = Scene(arm.robot, [arm.point], show=_LAYERS[:2])
    scene.display(arm.at)
    scene.surround(arm.at, found.voxel_centres)
    scene.meshcat_scene.set_property(_FIELD, "visible", True)
    content = scene.content()
    layers = [one for one in content.layers if one.name in _LAYERS]
    return page.render(
        replace(
            content,
            heading=map_text.heading(result),
            labels=[one for one in content.labels if one.layer in _LAYERS],
            layers=[*layers, Layer("map", "map of the hand", _LEGEND, [_FIELD], True)],
        ),
        template="map.html",
        report_style=page.own_text("report.css"),
        map_script=page.own_text("map.js"),
        map_data=_field(result, scene),
        fields=[one.title for one in found.fields],
        about=None,
        result=result,
        name=name,
        facts=list(map_text.facts(result)),
        extremes=list(map_text.extremes(result)),
        grades=list(map_text.grades(result)),
        panels=map_plots.panels(result, dark=True),
        versions={"ospace": ospace.__version__, "Pinocchio": pin.__version__},
    )


def _field(result: MapResult, scene: Scene) -> dict[str, Any]:
    """Return what the script of the page draws: cubes, their values and postures, and how the robot stands in each."""
    arm, found = result.arm, result.arm_map
    voxels, units = found.voxels, [map_text.shown_unit(one) for one in found.fields]
    factors = np.array([factor for factor, _ in units])
    parts = (found.voxel_centres, voxels.low * factors, voxels.high * factors, voxels.at_low, voxels.at_high)
    numbers = np.concatenate([part.ravel() for part in parts]).astype("<f4")
    return {
        "node": _FIELD,
        "size": found.voxel,
        "count": len(voxels.index),
        "titles": [one.title for one in found.fields],
        "units": [unit for _, unit in units],
        "best": ["high" if one.name in _DEXTERITY else "low" for one in found.fields],
        "first": next((k for k, one in enumerate(found.fields) if one.name != "reach"), 0),
        "joints": [{"name": name, "unit": unit} for name, unit in zip(arm.joints, arm.units, strict=True)],
        "home": arm.home.tolist(),
        "extremes": [at[0].tolist() for at in (found.whole.at_low, found.whole.at_high)] if found.count else [],
        "bodies": _bodies(arm, scene),
        "numbers": base64.b64encode(gzip.compress(numbers.tobytes(), 6, mtime=0)).decode(),
    }


def _bodies(arm: Arm, scene: Scene) -> list[dict[str, Any]]:
    """Return of each body the node, its parent, its place in it at rest (column by column), and what moves it.

    A body is moved by the k-th joint that varies: x turns it by offset + ratio x about its axis, or shifts it along.
    """
    robot = arm.robot
    whole = robot if robot.free is None else robot.free
    followers = {} if robot.free is None else robot.free.followers
    model, data = whole.model, whole.model.createData()
    pin.forwardKinematics(model, data, arm.at if robot.free is None else robot.free.configuration(arm.at))
    number = {name: k for k, name in enumerate(arm.joints)}
    bodies = []
    for j, node in enumerate(scene.nodes, start=1):
        joint, name = model.joints[j], str(model.names[j])
        leader, ratio, offset = name, 1.0, 0.0
        if name in followers:
            leader, ratio, offset = followers[name].leader, followers[name].ratio, followers[name].offset
        body: dict[str, Any] = {"node": node, "parent": int(model.parents[j]) - 1, "joint": number.get(leader, -1)}
        if body["joint"] < 0:
            rest = data.liMi[j]
        else:
            rest = model.jointPlacements[j]
            S = np.asarray(joint.createData().S).ravel()
            turns = bool(np.abs(S[3:]).max() > 0.0)
            body |= {"turns": turns, "axis": (S[3:] if turns else S[:3]).tolist(), "ratio": ratio, "offset": offset}
        bodies.append(body | {"rest": rest.homogeneous.ravel(order="F").tolist()})
    return bodies

"""A robot as its file describes it, sound or not, joints at zero: links with findings coloured and named."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ospace.exceptions import printable
from ospace.urdf.bodies import bodies_of
from ospace.urdf.description import Colour, Description
from ospace.urdf.lint.findings import Finding, by_severity
from ospace.visual import environment
from ospace.visual.environment import Background
from ospace.visual.meshcat_scene import MeshcatScene
from ospace.visual.page import Content, Label, Layer
from ospace.visual.robot_geometry import LEGENDS, TITLES, RobotGeometry, of_description
from ospace.visual.shapes import GREY, SmoothSphere, box_corners, material

COLOURS: dict[str, Colour] = {"error": (0.93, 0.13, 0.13, 1.0), "warning": (1.0, 0.62, 0.0, 1.0)}
"""Of links with findings."""
_HIGHLIGHT, _NAMES = "/shown", "names"  # node of the axes of the link that a page highlights, layer of names
_MARKING = "red: errors, amber: warnings, grey: others; what is found at a joint colours the link that it carries"
_MOST_NAMES = 12  # in the scene, gravest first
_LARGEST = 1e12  # m, that a scene is drawn to
_AXES, _DOT = 0.09, 0.02  # of the size of the robot: axes of a link that is highlighted, a link that has no shape
_UNREADABLE_PLACE = {"number-unreadable", "number-range", "two-orientations"}
"""Errors after which an <origin> is read as zero."""


@dataclass
class MarkedRobot:
    """A robot as drawn, with what a page needs to show its parts.

    Attributes
    ----------
    scene : MeshcatScene
        Empty but for what surrounds a robot where nothing of it can be drawn.
    layers : list of Layer
    labels : list of Label
    notes : list of str
        On the picture: what is not drawn, or not where it belongs.
    hints : dict of path to str
        Findings on what stands below a node.
    subjects : dict of subject of a finding to dict
        Nodes and frame that a page highlights on demand: ``paths`` of the nodes of its links, and ``at``, the
        placement of the first, (16,) column by column, m.
    """

    scene: MeshcatScene
    layers: list[Layer] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    hints: dict[str, str] = field(default_factory=dict)
    subjects: dict[str, dict[str, Any]] = field(default_factory=dict)

    def content(self, title: str, heading: str, background: Background, findings: Iterable[Finding] = ()) -> Content:
        """Return what a page is made of.

        Parameters
        ----------
        title, heading : str
        background : "space" or "paper"
        findings : iterable of Finding, optional
            Listed before the notes on the picture; a page with a table of them needs none.

        Returns
        -------
        Content
        """
        notes = [*map(str, findings), *self.notes]
        return Content(self.scene, title, heading, background, self.layers, self.labels, notes, self.hints)


def draw(
    description: Description,
    findings: Sequence[Finding],
    urdf: Path,
    package_dirs: Sequence[Path],
    *,
    layers: Collection[str] = ("robot",),
    background: Background = "space",
) -> MarkedRobot:
    """Draw a robot, sound or not, joints at zero, with the links coloured that errors and warnings are about.

    Parameters
    ----------
    description : Description
    findings : sequence of Finding
    urdf : Path
        The robot's file.
    package_dirs : sequence of Path
        Where ``package://`` names of meshes are looked up.
    layers : collection of str
        Layers shown at first, of `ospace.visual.robot_geometry.TITLES`; for an empty ``"robot"`` the first that is not.
    background : "space" or "paper"

    Returns
    -------
    MarkedRobot

    Raises
    ------
    OspaceError
        The background is unknown.
    """
    places = links_of_subjects(description)
    marks = _marks(findings, places)
    scene = MeshcatScene()
    with np.errstate(over="ignore", invalid="ignore"):  # shapes may have any size
        colours = {link: COLOURS[severity] for link, severity in marks.items()}
        if marks:  # a robot may have red and amber parts of its own
            colours = {link.name: GREY for link in description.links} | colours
        geometry = of_description(scene, "/robot", description, urdf, package_dirs, colours)
        at = {link: geometry.rest[node] @ T for link, (node, T) in geometry.links.items()}
        corners = np.concatenate([geometry.corners(geometry.rest), *(at[link][:3, 3:].T for link in marks)])
    if not marks and not any(geometry.layers.values()):
        return _nothing(background, "nothing of this robot can be drawn: it has neither shapes nor masses")
    if not np.abs(corners).max() < _LARGEST:
        return _nothing(background, f"this robot cannot be drawn: something of it is larger than {_LARGEST:g} m")
    reach = 0.5 * float(np.linalg.norm(np.ptp(corners, axis=0)))
    environment.surround(scene, background, corners)
    first = next((name for name, paths in geometry.layers.items() if paths), "robot")
    for link in marks:
        if not any(shape.role == "visual" for shape in description.link[link].shapes):
            _dot(scene, geometry, link, colours[link], _DOT * reach)
    environment.triad(scene, f"{_HIGHLIGHT}/axes", _AXES * reach)
    scene.set_property(_HIGHLIGHT, "visible", False)
    shown = {*layers, first} if "robot" in layers else set(layers)
    hints = hints_of(description, findings, geometry)
    return MarkedRobot(
        scene,
        _layers(scene, geometry, shown, named=bool(marks)),
        _labels(scene, geometry, marks, hints),
        [*_not_placed(description, findings), *_notes(geometry, findings, marks)],
        hints,
        {
            finding.subject: {
                "paths": [geometry.of_link(link, layer) for link in links for layer in geometry.layers],
                "at": at[links[0]].ravel(order="F").tolist(),
            }
            for finding in findings
            if (links := places.get(finding.subject, ()))
        },
    )


def links_of_subjects(description: Description) -> dict[str, tuple[str, ...]]:
    """Return the links that each subject of a finding is about: of a joint, the link that it carries.

    Parameters
    ----------
    description : Description

    Returns
    -------
    dict of str to tuple of str
        Names of links by subject; what is about no link, such as the file, is not in it.
    """
    places: dict[str, tuple[str, ...]] = {}
    for body in bodies_of(description):
        places[printable(body.subject)] = tuple(link.name for link in body.weighed)
    for link in description.links:
        places[printable(link.subject)] = places[printable(f"point '{link.name}'")] = (link.name,)
    for joint in description.joints:
        places[printable(joint.subject)] = (joint.child,)
    return places


def hints_of(description: Description, findings: Iterable[Finding], geometry: RobotGeometry) -> dict[str, str]:
    """Return the errors and warnings on each link, for whoever points at it.

    Parameters
    ----------
    description : Description
    findings : iterable of Finding
    geometry : RobotGeometry
        Of the robot as it is drawn.

    Returns
    -------
    dict of path to str
        A line for each finding on what stands below the node, the gravest first.
    """
    places, lines = links_of_subjects(description), defaultdict(list)
    for finding in by_severity(findings):
        if finding.severity in COLOURS:
            for link in places.get(finding.subject, ()):
                lines[link].append(str(finding))
    return {geometry.of_link(link, layer): "\n".join(of) for link, of in lines.items() for layer in geometry.layers}


def _nothing(background: Background, why: str) -> MarkedRobot:
    scene = MeshcatScene()
    environment.surround(scene, background, box_corners(np.eye(4), np.ones(3)))
    return MarkedRobot(scene, notes=[why])


def _marks(findings: Sequence[Finding], places: Mapping[str, tuple[str, ...]]) -> dict[str, str]:
    """Return the severity that each link is marked for, the gravest first."""
    marks: dict[str, str] = {}
    for finding in by_severity(findings):
        if finding.severity in COLOURS:
            for link in places.get(finding.subject, ()):
                marks.setdefault(link, finding.severity)
    return marks


def _dot(scene: MeshcatScene, geometry: RobotGeometry, link: str, colour: Colour, radius: float) -> None:
    """Put a ball at the frame of a link that has no shape to be coloured."""
    node, T = geometry.links[link]
    path = f"{geometry.of_link(link, 'robot')}/dot"
    scene.set_object(path, SmoothSphere(radius), material(colour))
    scene.set_transform(path, T)
    layer = f"{geometry.nodes[node]}/robot"
    if layer not in geometry.layers["robot"]:
        geometry.layers["robot"].append(layer)


def _layers(scene: MeshcatScene, geometry: RobotGeometry, shown: Collection[str], *, named: bool) -> list[Layer]:
    """Return the layers that hold something, and that of names where links have any."""
    layers = [
        Layer(name, TITLES[name], LEGENDS.get(name, ""), paths, name in shown)
        for name, paths in geometry.layers.items()
        if paths
    ]
    for layer in layers:
        for path in layer.paths:
            scene.set_property(path, "visible", layer.shown)
    return [*layers, Layer(_NAMES, "links with findings", _MARKING, [], True)] if named else layers


def _labels(
    scene: MeshcatScene, geometry: RobotGeometry, marks: Mapping[str, str], hints: Mapping[str, str]
) -> list[Label]:
    labels = []
    for link, severity in list(marks.items())[:_MOST_NAMES]:
        path = geometry.of_link(link, "names")
        scene.set_transform(path, geometry.links[link][1])
        hint = hints[geometry.of_link(link, "robot")]
        labels.append(Label(f"{printable(link)}: {severity}", path, _NAMES, hint))
    return labels


def _not_placed(description: Description, findings: Iterable[Finding]) -> list[str]:
    """Return notes on links that stand elsewhere than the file may mean: where it does not say so in numbers."""
    unreadable = {
        finding.subject
        for finding in findings
        if finding.severity == "error" and finding.code in _UNREADABLE_PLACE and "<origin>" in finding.message
    }
    notes = []
    beyond: dict[str, list[str]] = {}
    for joint in reversed(description.joints):  # each stands behind those between it and the base
        beyond.setdefault(joint.parent, []).extend([joint.child, *beyond.get(joint.child, ())])
        if printable(joint.subject) in unreadable:
            more = len(beyond.get(joint.child, ()))
            links = f"link '{printable(joint.child)}'" + (f" and {more} beyond it" if more else "")
            of = printable(joint.subject)
            notes.append(f"{links} cannot be placed: the <origin> of {of} cannot be read, and is taken as zero")
    return notes[::-1]


def _notes(geometry: RobotGeometry, findings: Sequence[Finding], marks: Mapping[str, str]) -> list[str]:
    """Return notes on the picture that the findings do not already report."""
    reported = {(finding.code, finding.subject) for finding in findings}
    notes = [str(one) for one in geometry.findings if (one.code, one.subject) not in reported]
    if geometry.findings:
        notes.append("where a mesh cannot be shown, a box of the link's inertia stands in its place")
    if len(marks) > _MOST_NAMES:
        notes.append(f"{len(marks)} links are coloured; the names of {_MOST_NAMES} are shown")
    return notes

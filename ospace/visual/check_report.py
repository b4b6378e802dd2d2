"""The report of a check: the robot with its faulty links coloured, findings, agreement and masses, in one file."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import ospace
from ospace.exceptions import printable
from ospace.files import replacing
from ospace.urdf.bodies import Body, bodies_of, tensor_of
from ospace.urdf.description import Colour, Description
from ospace.urdf.lint import explain
from ospace.urdf.lint.findings import Finding, by_severity
from ospace.urdf.lint.rules import RULES
from ospace.validation import words
from ospace.validation.report import Report
from ospace.visual import environment, page
from ospace.visual.meshcat_scene import MeshcatScene
from ospace.visual.page import Label, Layer
from ospace.visual.robot_geometry import LEGENDS, TITLES, RobotGeometry, of_description
from ospace.visual.shapes import GREY, SmoothSphere, box_corners, material

COLOURS: dict[str, Colour] = {"error": (0.93, 0.13, 0.13, 1.0), "warning": (1.0, 0.62, 0.0, 1.0)}
"""Of links with findings."""
_BACKGROUND: environment.Background = "space"
_SHOWN, _NAMES = "/shown", "names"  # node of the axes of the link that is shown, layer of names
_MARKING = "red: errors, amber: warnings, grey: others; what is found at a joint colours the link that it carries"
_MOST_NAMES = 12  # in the scene, gravest first
_LARGEST = 1e12  # m, that a scene is drawn to
_AXES, _DOT = 0.09, 0.02  # of the size of the robot: axes of a link that is shown, a link that has no shape


@dataclass(frozen=True)
class Weight:
    """A link that has mass, and what there is to say of it.

    Attributes
    ----------
    link, body : str
        Its name, and that of the link at whose frame the body lies that it moves with.
    mass : float
        kg.
    share : float or None
        Of the total; None where the total is not positive, or a part exceeds it.
    centre : tuple of float
        Centre of mass in the link's frame, m.
    moments : sequence of float
        Principal moments of inertia about it, kg m².
    """

    link: str
    body: str
    mass: float
    share: float | None
    centre: tuple[float, float, float]
    moments: Sequence[float]


def save(
    report: Report, description: Description, path: str | PathLike[str], *, urdf: str, folders: Sequence[Path]
) -> Path:
    """Write the report of a check to one HTML file, which needs no network; return its path.

    Parameters
    ----------
    report : Report
    description : Description
        Of the robot that was checked; sound or not.
    path : path-like
    urdf : str
        Name of the robot as the user wrote it.
    folders : sequence of Path
        The URDF, then folders of packages: where meshes are looked up.
    """
    text = render(report, description, urdf=urdf, folders=folders)
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")
    return Path(path)


def render(report: Report, description: Description, *, urdf: str, folders: Sequence[Path]) -> str:
    """Return the report as a page; parameters as of `save`."""
    bodies = bodies_of(description)
    places = _places(description, bodies)
    seen = picture(report.findings, description, places, folders)
    weights = breakdown(bodies)
    codes = dict.fromkeys(finding.code for finding in report.findings)
    return page.render(
        page.Content(
            seen.scene,
            printable(description.name),
            f"{report.verdict}: {words.summary(report)}",
            _BACKGROUND,
            seen.layers,
            seen.labels,
            seen.notes,
        ),
        template="check.html",
        report_style=page.own_text("report.css"),
        check_script=page.own_text("check.js"),
        words=words,
        printable=printable,
        urdf=printable(urdf),
        report=report,
        subjects=list(seen.shown),
        shown=list(seen.shown.values()),
        codes=[(RULES[code], explain.level(RULES[code])) for code in codes],
        weights=weights,
        total=sum(weight.mass for weight in weights),
        unweighed=len(description.links) - len(weights),
        versions={"ospace": ospace.__version__, "Pinocchio": pin.__version__},
    )


def breakdown(bodies: Sequence[Body]) -> list[Weight]:
    """Return links by mass, the heaviest first."""
    masses = [link.inertial.mass for body in bodies for link in body.weighed if link.inertial is not None]
    total = sum(masses)
    parts = total > 0.0 and all(mass >= 0.0 for mass in masses)  # a negative mass makes others more than the whole
    weights = [
        Weight(
            printable(link.name),
            printable(body.link.name),
            link.inertial.mass,
            link.inertial.mass / total if parts else None,
            link.inertial.pose.xyz,
            np.linalg.eigvalsh(tensor_of(link.inertial)).tolist(),
        )
        for body in bodies
        for link in body.weighed
        if link.inertial is not None
    ]
    return sorted(weights, key=lambda weight: -weight.mass)


def _places(description: Description, bodies: Sequence[Body]) -> dict[str, tuple[str, ...]]:
    """Return the links that each subject of a finding is about."""
    places: dict[str, tuple[str, ...]] = {}
    for body in bodies:
        places[printable(body.subject)] = tuple(link.name for link in body.weighed)
    for link in description.links:
        places[printable(link.subject)] = places[printable(f"point '{link.name}'")] = (link.name,)
    for joint in description.joints:
        places[printable(joint.subject)] = (joint.child,)
    return places


# -- the robot ---------------------------------------------------------------------------------------------------


@dataclass
class Picture:
    """A robot as drawn, with what the page needs to show its parts.

    Attributes
    ----------
    scene : MeshcatScene
        Empty but for what surrounds a robot where nothing of it can be drawn.
    layers : list of Layer
    labels : list of Label
    notes : list of str
    shown : dict of subject of a finding to dict
        Nodes and frame that the page highlights on demand: ``paths`` of the nodes of its links, and ``at``, the
        placement of the first, (16,) column by column, m.
    """

    scene: MeshcatScene
    layers: list[Layer] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    shown: dict[str, dict[str, Any]] = field(default_factory=dict)


def picture(
    findings: Sequence[Finding],
    description: Description,
    places: Mapping[str, tuple[str, ...]],
    folders: Sequence[Path],
) -> Picture:
    """Draw a robot, sound or not, joints at zero, with the links coloured that findings of some gravity are about."""
    marks = _marks(findings, places)
    scene = MeshcatScene()
    with np.errstate(over="ignore", invalid="ignore"):  # shapes may have any size
        colours = {link: COLOURS[severity] for link, severity in marks.items()}
        if marks:  # a robot may have red and amber parts of its own
            colours = {link.name: GREY for link in description.links} | colours
        geometry = of_description(scene, "/robot", description, folders, colours)
        at = {link: geometry.rest[node] @ T for link, (node, T) in geometry.links.items()}
        corners = np.concatenate([geometry.corners(geometry.rest), *(at[link][:3, 3:].T for link in marks)])
    if not marks and not any(geometry.layers.values()):
        return _nothing("nothing of this robot can be drawn: it has neither shapes nor masses")
    if not np.abs(corners).max() < _LARGEST:
        return _nothing(f"this robot cannot be drawn: something of it is larger than {_LARGEST:g} m")
    reach = 0.5 * float(np.linalg.norm(np.ptp(corners, axis=0)))
    environment.surround(scene, _BACKGROUND, corners)
    first = next((name for name, paths in geometry.layers.items() if paths), "robot")
    for link in marks:
        if not any(shape.role == "visual" for shape in description.link[link].shapes):
            _dot(scene, geometry, link, colours[link], _DOT * reach)
    environment.triad(scene, f"{_SHOWN}/axes", _AXES * reach)
    scene.set_property(_SHOWN, "visible", False)
    return Picture(
        scene,
        _layers(scene, geometry, {"robot", first}, named=bool(marks)),
        _labels(scene, geometry, marks),
        _notes(geometry, findings, marks),
        {
            finding.subject: {
                "paths": [geometry.of_link(link, layer) for link in links for layer in geometry.layers],
                "at": at[links[0]].ravel(order="F").tolist(),
            }
            for finding in findings
            if (links := places.get(finding.subject, ()))
        },
    )


def _nothing(why: str) -> Picture:
    scene = MeshcatScene()
    environment.surround(scene, _BACKGROUND, box_corners(np.eye(4), np.ones(3)))
    return Picture(scene, notes=[why])


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


def _labels(scene: MeshcatScene, geometry: RobotGeometry, marks: Mapping[str, str]) -> list[Label]:
    labels = []
    for link, severity in list(marks.items())[:_MOST_NAMES]:
        path = geometry.of_link(link, "names")
        scene.set_transform(path, geometry.links[link][1])
        labels.append(Label(f"{printable(link)}: {severity}", path, _NAMES))
    return labels


def _notes(geometry: RobotGeometry, findings: Sequence[Finding], marks: Mapping[str, str]) -> list[str]:
    """Return notes on the picture that the findings do not already report."""
    reported = {(finding.code, finding.subject) for finding in findings}
    notes = [str(one) for one in geometry.findings if (one.code, one.subject) not in reported]
    if geometry.findings:
        notes.append("where a mesh cannot be shown, a box of the link's inertia stands in its place")
    if len(marks) > _MOST_NAMES:
        notes.append(f"{len(marks)} links are coloured; the names of {_MOST_NAMES} are shown")
    return notes

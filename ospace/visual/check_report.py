"""The report of a check: the robot with its faulty links coloured, findings, agreement and masses, in one file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import ospace
from ospace.analysis import map_text
from ospace.analysis.overview import POSTURES, Overview
from ospace.exceptions import printable
from ospace.files import write_text
from ospace.urdf.bodies import Body, bodies_of, tensor_of
from ospace.urdf.description import Description
from ospace.urdf.lint import explain
from ospace.urdf.lint.rules import RULES
from ospace.validation import report_text
from ospace.validation.report import Report
from ospace.visual import joint_limits, marked_robot, page
from ospace.visual.environment import Background
from ospace.visual.provenance import Provenance


@dataclass(frozen=True)
class Weight:
    """Mass properties of a link that has an <inertial>.

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
    report: Report,
    description: Description,
    path: str | PathLike[str],
    *,
    name: str,
    urdf: Path,
    package_dirs: Sequence[Path] = (),
    hands: Sequence[Overview] = (),
    about: Provenance | None = None,
) -> Path:
    """Write the report of a check to one HTML file, which needs no network.

    Parameters
    ----------
    report : Report
    description : Description
        Of the robot that was checked; sound or not.
    path : path-like
        Where to.
    name : str
        Of the robot, as the user wrote it.
    urdf : Path
        Its file.
    package_dirs : sequence of Path
        Where ``package://`` names of meshes are looked up.
    hands : sequence of Overview
        What hands do while the base floats.
    about : Provenance, optional
        Shown at its beginning.

    Returns
    -------
    Path
        Of the file written.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    text = render(report, description, name=name, urdf=urdf, package_dirs=package_dirs, hands=hands, about=about)
    return write_text(path, text)


def render(
    report: Report,
    description: Description,
    *,
    name: str,
    urdf: Path,
    package_dirs: Sequence[Path] = (),
    hands: Sequence[Overview] = (),
    about: Provenance | None = None,
    background: Background = "space",
) -> str:
    """Return the report as a page; parameters as of `save`, for paper with `background` "paper".

    Returns
    -------
    str
        HTML.
    """
    drawn = marked_robot.draw(description, report.findings, urdf, package_dirs, background=background)
    weights = breakdown(bodies_of(description))
    codes = dict.fromkeys(finding.code for finding in report.findings)
    return page.render(
        drawn.content(printable(description.name), f"{report.verdict}: {report_text.summary(report)}", background),
        template="check.html",
        report_style=page.own_text("report.css"),
        check_script=page.own_text("check.js"),
        about=about,
        limits=joint_limits.of_description(description),
        report_text=report_text,
        printable=printable,
        urdf=printable(name),
        report=report,
        subjects=list(drawn.subjects),
        shown=list(drawn.subjects.values()),
        codes=[(RULES[code], explain.level(RULES[code])) for code in codes],
        weights=weights,
        hands=[_row(one) for one in hands],
        postures=POSTURES,
        total=sum(weight.mass for weight in weights),
        unweighed=len(description.links) - len(weights),
        versions={"ospace": ospace.__version__, "Pinocchio": pin.__version__},
    )


def _row(one: Overview) -> dict[str, Any]:
    """Return the cells of a hand's row, or why it has none."""
    if one.result is None or one.result.workspaces is None:
        return {"frame": printable(one.frame), "reason": one.reason}
    shells, mapped = one.result.workspaces, one.result.arm_map
    column = {quantity.name: c for c, quantity in enumerate(mapped.quantities)}
    low, high = mapped.whole.low[0], mapped.whole.high[0]
    return {
        "frame": printable(one.frame),
        "reason": "",
        "cells": (
            map_text.rows(one.result.arm),
            map_text.intervals([shells.reach]),
            map_text.intervals(shells.path_independent),
            map_text.intervals(shells.path_dependent),
            f"{low[column['singular_value']]:.3g}",
            f"{np.rad2deg(high[column['base_turn']]):.3g} deg",
            ", ".join(f"{high[column[f'wheel_{axis}']]:.3g}" for axis in "xyz"),
        ),
    }


def breakdown(bodies: Sequence[Body]) -> list[Weight]:
    """Return links by mass, the heaviest first.

    Parameters
    ----------
    bodies : sequence of Body

    Returns
    -------
    list of Weight
        Of the links that have an <inertial>.
    """
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

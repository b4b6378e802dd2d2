"""Text of a check's report: the same for a terminal and for a page."""

from __future__ import annotations

import math

from ospace.validation.agreement import Agreement
from ospace.validation.report import ModelFacts, Report


def facts(model: ModelFacts) -> list[tuple[str, str]]:
    """Return the facts of a model by name."""
    joints = ", ".join(f"{count} {kind}" for kind, count in model.joints.items()) or "none"
    inertias = ", ".join(f"{value:.6g}" for value in model.principal_inertias)
    points = ", ".join(f"{point['frame']} ({point['rows']} rows)" for point in model.points)
    return [
        ("bodies", f"{model.bodies}, fixed joints merged"),
        ("joints", joints),
        ("degrees of freedom", f"{model.degrees_of_freedom}, of these 6 of the floating base"),
        ("total mass", f"{model.total_mass:.6g} kg"),
        ("arm-to-base mass ratio", f"{model.arm_to_base_mass_ratio:.4g} (base {model.base_mass:.6g} kg)"),
        ("principal inertias", f"{inertias} kg m² about the centre of mass, joints at zero"),
        ("centre of mass", f"{position(model.mass_centre)} m from the base link, joints at zero"),
        ("condition of H_b", condition(model.condition_H_b)),
        ("gravity", f"{model.gravity:g} m/s²"),
        ("units", model.units),
        ("operational points", points),
    ]


def condition(value: float) -> str:
    """Return the condition number of H_b, joints at zero."""
    return f"{value:.4g} with unit diagonal" if math.isfinite(value) else "singular, joints at zero"


def position(centre: list[float] | tuple[float, ...]) -> str:
    """Return coordinates, m, without the noise of rounding."""
    return ", ".join(f"{round(value, 12) + 0.0:.6g}" for value in centre)


def error(value: float) -> str:
    """Return an error or its bound."""
    return f"{value:.1e}" if math.isfinite(value) else "not finite"


def verdict(row: Agreement) -> str:
    """Return the verdict on one quantity, and how many states can tell where not all can."""
    return row.verdict + (f" ({row.telling} of {row.states} can tell)" if row.telling < row.states else "")


def agreement(report: Report) -> str:
    """Return how many rows agree, over which states."""
    agreeing = sum(row.verdict == "agrees" for row in report.agreement)
    return (
        f"{agreeing} of {len(report.agreement)} rows agree over {report.samples} states "
        f"(seed {report.seed}, every second 7e6 m away)"
    )


def summary(report: Report) -> str:
    """Return how many errors and warnings there are, and how many rows are undecided if any is."""
    warnings = sum(finding.severity == "warning" for finding in report.findings)
    texts = [number(report.errors, "error"), number(warnings, "warning")]
    if report.undecided:
        texts.append(f"{report.undecided} of {len(report.agreement)} rows undecided")
    return ", ".join(texts)


def number(count: int, what: str) -> str:
    """Return ``1 error`` or ``2 errors``."""
    return f"{count} {what}" + ("" if count == 1 else "s")

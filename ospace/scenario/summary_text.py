"""Text on the outcome of a phase: the same for a terminal and for a page."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np

from ospace.kernels.tree import Floats
from ospace.scenario.result import PhaseResult, Verdict
from ospace.scenario.schema import Scenario
from ospace.simulation import Excess

_SHOWN = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "deg")}
_BASE_ROW = "base moved"
_MOST_LIMITS, _MOST_SHORTFALLS = 6, 4


def conditions(scenario: Scenario) -> Iterator[str]:
    """Yield what makes control harder than a model that is exact and acts at once."""
    if scenario.control.delay:
        yield f"commands act {scenario.control.delay * 1e3:g} ms late"
    if scenario.noise.any:
        yield f"sensors are noisy (seed {scenario.noise.seed}): errors of tasks are the true ones, not those measured"
    for error in scenario.mass_errors:
        links = f"'{error.link}'" if error.link else "all links"
        inertia = error.mass if error.inertia is None else error.inertia
        yield (
            f"the controller takes {links} of the {error.of} for {100.0 * error.mass:+g} % in mass, "
            f"{100.0 * inertia:+g} % in inertia, off by {np.linalg.norm(error.mass_centre) * 1e3:g} mm"
        )

    for one in scenario.disturbances:
        amounts = [(one.force, "N"), (one.torque, "N m")]
        size = ", ".join(f"{np.linalg.norm(amount):.4g} {unit}" for amount, unit in amounts if amount.any())
        wave = f" at {one.frequency:g} Hz" if one.frequency else ""
        until = f" to {one.start + one.duration:g} s" if math.isfinite(one.duration) else " s on"
        yield f"disturbance '{one.name}': {size}{wave} on '{one.point}' of the {one.of}, from {one.start:g}{until}"


def errors(norms: Floats, units: tuple[str, str]) -> str:
    """Return both norms (2,), in mm and deg where they are lengths and angles."""
    shown = []
    for norm, unit in zip(norms, units, strict=True):
        if math.isnan(norm):
            continue
        factor, name = _SHOWN.get(unit, (1.0, unit))
        shown.append(f"{norm * factor:.2g} {name}")
    return ", ".join(shown) or "-"


def tasks(phase: PhaseResult) -> list[tuple[str, str, str]]:
    """Return name, worst error and error at the end of each task; dashes where there is none."""
    rows = [(name, errors(one.worst, one.units), errors(one.last, one.units)) for name, one in phase.errors.items()]
    return rows or [("-", "-", "-")]


def rows(phase: PhaseResult) -> list[tuple[str, str, str]]:
    """Return the rows of `tasks`, and how far the base has moved: at most, and at the end."""
    moved = phase.base_motion
    if len(moved) == 0:
        return tasks(phase)
    known = tasks(phase) if phase.errors else []
    return [*known, (_BASE_ROW, errors(moved.max(axis=0), ("m", "rad")), errors(moved[-1], ("m", "rad")))]


def cycles(phase: PhaseResult) -> str:
    """Return how many control cycles had which status."""
    return ", ".join(f"{count} {status}" for status, count in phase.statuses.items()) or "none"


def remarks(phase: PhaseResult) -> Iterator[str]:
    """Yield what is worth a line of its own: tasks that fell short, limits, singularities, grasps."""
    for cause, count in sorted(phase.shortfalls.items(), key=lambda item: -item[1])[:_MOST_SHORTFALLS]:
        yield f"{phase.name}: {cause}, at most {phase.most_short[cause]} ({count} cycles)"
    if phase.active_limits:
        most = sorted(phase.active_limits.items(), key=lambda item: -item[1])
        shown = ", ".join(f"{limit} ({count} cycles)" for limit, count in most[:_MOST_LIMITS])
        more = f", and {len(most) - _MOST_LIMITS} more" if len(most) > _MOST_LIMITS else ""
        yield f"{phase.name}: active limits: {shown}{more}"
    if phase.near_singularity:
        near = ", ".join(f"{task} ({count} cycles)" for task, count in phase.near_singularity.items())
        yield f"{phase.name}: near a dynamic singularity: {near}"
    if phase.separation is not None:
        kept = phase.separation
        pair, distance = next(iter(kept.closest.items()))
        time = phase.time[int(kept.distance.argmin())]
        shown = f"{distance * 1e3:.4g} mm at {time:.3f} s, {kept.clearance * 1e3:g} mm to be kept"
        yield f"{phase.name}: smallest distance: {pair}, {shown}"
    if phase.grasp is not None:
        held = phase.grasp
        yield (
            f"{phase.name}: grasp at {phase.end:.3f} s, off by {held.position_error * 1e3:.2g} mm and "
            f"{math.degrees(held.angle_error):.2g} deg; impulse {np.linalg.norm(held.impulse[:3]):.2g} N s, "
            f"{np.linalg.norm(held.impulse[3:]):.2g} N m s; {held.energy_lost:.2g} J lost"
        )


def exceeded(limits: Mapping[str, Excess]) -> str:
    """Return which limits of joints were passed, and how far."""
    return ", ".join(f"{limit} by {excess}" for limit, excess in limits.items()) or "none"


def remedy(run: Verdict, step: float) -> str:
    """Return how to tell whether a certificate failed for the integrator's `step` (s); nothing where it passed."""
    failed = [one for one in run.certificate.quantities if not one.passed and math.isfinite(one.error + one.scale)]
    if not failed:
        return ""
    names = ", ".join(one.name for one in failed)
    return (
        f"off: {names}. Torques that change by much from cycle to cycle, or a step of {step * 1e3:g} ms that "
        f'is too long, make such errors: run it with control.step = "{step * 500.0:g} ms"; if they fall to a '
        "tenth or less, it was the step"
    )


def verdict(run: Verdict) -> str:
    """Return whether the run passed, in one word."""
    return "passed" if run.passed else "interrupted" if run.interrupted else "failed"


def summary(run: Verdict) -> str:
    """Return how many phases are complete, and what the certificate says."""
    done = sum(phase.outcome == "complete" for phase in run.phases)
    kept = "passed" if run.certificate.passed else "FAILED"
    return f"{done} of {len(run.phases) + len(run.not_begun)} phases complete, certificate {kept}"

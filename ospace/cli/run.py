"""``ospace run SCENARIO``: run a scenario phase by phase, and certify what the run conserved."""

from __future__ import annotations

import argparse
import math
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import paper
from ospace.cli.paper import plain

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.scenario import PhaseResult, Run, Scenario

_WIDTH = 120
_COLOURS = {"complete": "green", "interrupted": "yellow"}
_MOST_LIMITS = 6
_TICK = 0.05
"""Simulated time from one move of the progress bar to the next, s."""


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    verb = verbs.add_parser(
        "run",
        help="run a scenario and certify the run",
        description="Run a scenario: its phases one after the other, then the certificate of momentum and energy. "
        "Exit status: 0 all phases complete and certificate passed, 1 not, 2 invalid scenario, unwritable output or "
        "wrong usage, 130 interrupted; what was run by then is shown and logged.",
    )
    verb.add_argument("scenario", metavar="SCENARIO", help="a TOML file, or a scenario that comes with ospace")
    verb.add_argument("--check", action="store_true", help="validate the scenario only")
    verb.add_argument("--log", metavar="FILE", type=_log, help="write everything to a file: .npz")
    verb.add_argument("--csv", metavar="DIR", type=Path, help="write everything to a folder of CSV files")
    verb.add_argument("--headless", action="store_true", help="no progress bar")
    verb.set_defaults(run=run)


def _log(text: str) -> Path:
    path = Path(text)
    if path.suffix != ".npz":
        raise argparse.ArgumentTypeError(f"'{text}' does not end in .npz")
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f"'{text}': no such folder '{path.parent}'")
    return path


def find(scenario: str) -> Path:
    """Return the file, or the scenario of that name that comes with ospace."""
    from ospace import models

    if os.path.lexists(scenario) or Path(scenario).name != scenario or Path(scenario).suffix:
        return Path(scenario)
    return models.scenario(scenario)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Run; return the exit status and the text to print."""
    from ospace.cli import progress
    from ospace.cli.main import EXIT_FINDINGS, EXIT_INTERRUPTED
    from ospace.scenario import load, log
    from ospace.scenario import run as run_scenario

    scenario = load(find(given.scenario))
    if given.check:
        return 0, _valid(scenario, given.scenario)
    if given.log:
        given.log.open("ab").close()  # whether it can be written, before anything is run
    if given.csv:
        given.csv.mkdir(parents=True, exist_ok=True)
    total = math.ceil(sum(phase.timeout for phase in scenario.phases) * 10.0)
    if given.headless:
        result = run_scenario(scenario, _seldom(lambda tenths: given.refuse_if_interrupted()))
    else:
        with progress.bar(given, "simulating, tenths of a second", total) as advance:
            result = run_scenario(scenario, _seldom(advance))
    if given.log:
        log.save(result, given.log)
    if given.csv:
        log.to_csv(result, given.csv)
    text = _text(result, given.scenario)
    if result.interrupted:
        sys.stdout.write(text)
        sys.stdout.flush()
        return EXIT_INTERRUPTED, ""
    return 0 if result.passed else EXIT_FINDINGS, text


def _seldom(advance: Any) -> Any:
    """Return what moves the bar, and looks for an interrupt, every few milliseconds of simulated time."""
    due = 0.0

    def tick(time: float) -> None:
        nonlocal due
        if time >= due:
            due = time + _TICK
            advance(int(time * 10.0))

    return tick


# -- what people read --------------------------------------------------------------------------------------------


def _valid(scenario: Scenario, name: str) -> str:
    phases = ", ".join(phase.name for phase in scenario.phases)
    longest = sum(phase.timeout for phase in scenario.phases)
    return f"{scenario.name}\nphases: {phases}; at most {longest:g} s\nvalid: {name}\n"


def _text(result: Run, name: str) -> str:
    console = paper.console(_WIDTH, fits_terminal=True)
    _show(console, result, name)
    return paper.text(console)


def _show(console: Console, result: Run, name: str) -> None:
    scenario = result.scenario
    control = scenario.control
    console.print(f"[bold]{plain(scenario.name)}[/]")
    console.print(
        f"{plain(repr(scenario.robot))}, base {_base(scenario)}; control every {control.period * 1e3:g} ms "
        f"({plain(control.solver)}), {control.integrator} in steps of {control.step * 1e3:g} ms"
    )
    console.print(f"{result.duration:g} s simulated in {result.seconds:.1f} s\n")
    console.print(_phases(result))
    for phase in result.phases:
        _show_more(console, phase)
    if result.not_begun:
        console.print(f"not begun: {plain(', '.join(result.not_begun))}")
    past = result.exceeded
    limits = ", ".join(f"{limit} by {excess:.2g}" for limit, excess in past.items()) or "none"
    console.print(f"limits of joints exceeded: {plain(limits)}")
    console.print("\n[bold]Certificate[/]")
    for line in str(result.certificate).splitlines():
        console.print(plain(line))
    verdict = "passed" if result.passed else "interrupted" if result.interrupted else "failed"
    colour = "bold green" if result.passed else "bold red"
    done = sum(phase.outcome == "complete" for phase in result.phases)
    kept = "passed" if result.certificate.passed else "FAILED"
    phases = f"{done} of {len(scenario.phases)} phases complete"
    console.print(f"\n[{colour}]{verdict}[/]: {plain(name)}: {phases}, certificate {kept}")


def _phases(result: Run) -> Any:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    for heading in ("phase", "from s", "to s", "outcome", "task", "worst error", "at the end", "cycles"):
        right = heading in ("from s", "to s", "worst error", "at the end")
        table.add_column(heading, justify="right" if right else "left", no_wrap=heading != "phase")
    for phase in result.phases:
        colour = _COLOURS.get(phase.outcome, "bold red")
        cycles = ", ".join(f"{count} {status}" for status, count in phase.statuses.items()) or "none"
        first = (
            plain(phase.name),
            f"{phase.start:.3f}",
            f"{phase.end:.3f}",
            f"[{colour}]{phase.outcome}[/]",
        )
        rows = [(task, _errors(e.worst, e.units), _errors(e.last, e.units)) for task, e in phase.errors.items()]
        for k, (task, most, last) in enumerate(rows or [("-", "-", "-")]):
            begin = first if k == 0 else ("",) * 4
            table.add_row(*begin, plain(task), most, last, cycles if k == 0 else "")
    return table


def _errors(norms: Any, units: tuple[str, str]) -> str:
    """Return both norms, in mm and deg where they are lengths and angles."""
    shown = []
    for norm, unit in zip(norms, units, strict=True):
        if math.isnan(norm):
            continue
        factor, name = {"m": (1e3, "mm"), "rad": (180.0 / math.pi, "deg")}.get(unit, (1.0, unit))
        shown.append(f"{norm * factor:.2g} {name}")
    return ", ".join(shown) or "-"


def _show_more(console: Console, phase: PhaseResult) -> None:
    """Print what is worth a line of its own: why a phase did not complete, limits, grasps."""
    name = plain(phase.name)
    if phase.reason:
        console.print(f"{name}: [bold red]{plain(phase.reason)}[/]")
    if phase.active_limits:
        most = sorted(phase.active_limits.items(), key=lambda item: -item[1])
        shown = ", ".join(f"{limit} ({count} cycles)" for limit, count in most[:_MOST_LIMITS])
        more = f", and {len(most) - _MOST_LIMITS} more" if len(most) > _MOST_LIMITS else ""
        console.print(f"{name}: active limits: {plain(shown)}{more}")
    if phase.near_singularity:
        tasks = ", ".join(f"{task} ({count} cycles)" for task, count in phase.near_singularity.items())
        console.print(f"{name}: near a dynamic singularity: {plain(tasks)}")
    if phase.grasp is not None:
        held = phase.grasp
        console.print(
            f"{name}: grasp at {phase.end:.3f} s, off by {held.position_error * 1e3:.2g} mm and "
            f"{math.degrees(held.angle_error):.2g} deg; impulse {_length(held.impulse[:3]):.2g} N s, "
            f"{_length(held.impulse[3:]):.2g} N m s; {held.energy_lost:.2g} J lost"
        )


def _length(vector: Any) -> float:
    return math.hypot(*vector)


def _base(scenario: Scenario) -> str:
    from ospace.control.base import MODES

    named = [name for name, mode in MODES.items() if mode == scenario.base]
    if named:
        return named[0]
    base = scenario.base
    shown = [
        f"{what} {given} {unit}"
        for what, given, unit in (("force", base.force, "N"), ("torque", base.torque, "N m"))
        if given
    ]
    return ", ".join(shown) + (" by wheels" if base.wheels else "")

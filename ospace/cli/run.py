"""``ospace run SCENARIO``: run a scenario phase by phase, and certify what the run conserved."""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import output
from ospace.cli.columns import Column, fit
from ospace.cli.console import buffered_console, buffered_text, plain, show_table, show_text
from ospace.cli.streams import title

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.scenario import Run, Scenario
    from ospace.scenario.result import PhaseResult
    from ospace.visual.live import Live

PAGE = "scenario"
EXAMPLES = (
    "ospace run grasp",
    "ospace run mission.toml --check",
    "ospace run mission.toml --log mission.npz --html report.html",
    "ospace run grasp --log - --headless | ospace plot - --out grasp.svg",
    "ospace run mission.toml --plugin my_tasks",
)
_COLOURS = {"complete": "green", "interrupted": "yellow"}
_TICK = 0.05
"""Simulated time from one move of the progress bar to the next, s."""


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    from ospace.cli.main import takes_report

    verb = verbs.add_parser(
        "run",
        help="run a scenario and certify the run",
        description="Run a scenario: its phases one after the other, then the certificate of momentum and energy. "
        "Exit status: 0 all phases complete and certificate passed, 1 not, 2 invalid scenario, unwritable output or "
        "wrong usage, 130 interrupted; what was run by then is shown and logged.",
    )
    verb.add_argument("scenario", metavar="SCENARIO", help="a TOML file, or a scenario that comes with ospace")
    verb.add_argument("--check", action="store_true", help="validate the scenario only")
    verb.add_argument("--schema", action=_Schema, help="print the JSON Schema of scenarios, for editors, and exit")
    verb.add_argument("--log", metavar="FILE", type=_log, help="write everything to a file: .npz")
    verb.add_argument("--csv", metavar="DIR", type=Path, help="write everything to a folder of CSV files")
    verb.add_argument("--html", metavar="FILE", type=output.file, help="write a report with the animation: one file")
    takes_report(verb)
    verb.add_argument("--view", action="store_true", help="play it in a browser as it runs; Ctrl-C ends the view")
    verb.add_argument(
        "--plugin",
        metavar="MODULE",
        action="append",
        default=[],
        help="a Python module whose tasks, inequalities and solvers the scenario may name, as MODULE:MyTask; its code "
        "runs. It lies beside the scenario, in this folder, or is installed (repeatable)",
    )
    verb.add_argument("--headless", action="store_true", help="no progress bar")
    verb.set_defaults(run=run, refuse_usage=verb.error)


class _Schema(argparse.Action):
    """Prints the JSON Schema of scenarios; no scenario is needed then, as for ``--help``."""

    def __init__(self, option_strings: Sequence[str], dest: str, **more: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **more)

    def __call__(self, parser: argparse.ArgumentParser, *given: object) -> None:
        from ospace.cli.main import EXIT_USAGE
        from ospace.scenario.schema import json_schema

        parser.exit(0 if output.printed(json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n") else EXIT_USAGE)


def _log(text: str) -> Path:
    if text == "-":
        return output.file(text, ".npz")
    if Path(text).suffix != ".npz":
        raise argparse.ArgumentTypeError(f"'{text}' does not end in .npz")
    return output.file(text)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Run; return the exit status and the text to print."""
    from ospace.cli import progress
    from ospace.cli.main import EXIT_FINDINGS, EXIT_INTERRUPTED, EXIT_USAGE, check_report_options, find
    from ospace.dynamics.workspace import compile_kernels
    from ospace.extras import require, require_scene
    from ospace.scenario import load

    if given.html or given.pdf or given.view:
        require_scene("a scene")
    if given.html or given.pdf:
        require("matplotlib", "a report")
    check_report_options(given)
    file = find(given.scenario, scenario=True)
    output.distinct([file], [given.log, given.csv, given.html, given.pdf])
    with nullcontext() if given.headless else progress.bar(given, "reading the scenario", 1):
        compile_kernels()
        sys.path[:0] = [str(file.parent), str(Path.cwd())] if given.plugin else []
        scenario = load(file, given.plugin)
    if given.check:
        return 0, _valid(scenario, title(given.scenario), _rehearsed(given, scenario))
    output.writable(given.log, given.html, given.pdf)
    if given.csv:
        given.csv.mkdir(parents=True, exist_ok=True)
    with _live(given, scenario) if given.view else nullcontext() as live:
        result = _run(given, scenario, live.watch if live else None)
        done = [
            *_write_outputs(given, result),
            output.printed(_text(result, title(given.scenario))),
            _write_report(given, result),
        ]
        if result.interrupted:
            return EXIT_INTERRUPTED, ""
        if live:
            try:
                live.replay(result)
            except KeyboardInterrupt:  # which is how a view ends well
                given.clear_interrupt()
    if not all(done):
        return EXIT_USAGE, ""
    return 0 if result.passed else EXIT_FINDINGS, ""


def _rehearsed(given: argparse.Namespace, scenario: Scenario) -> str:
    from ospace.scenario import rehearse

    return rehearse(scenario, _throttled(lambda tenths: given.refuse_if_interrupted()))


def _run(given: argparse.Namespace, scenario: Scenario, watch: Any) -> Run:
    from ospace.cli import progress
    from ospace.scenario import run as run_scenario

    if given.headless:
        return run_scenario(scenario, _throttled(lambda tenths: given.refuse_if_interrupted()), watch)
    total = math.ceil(sum(phase.timeout for phase in scenario.phases) * 10.0)
    with progress.bar(given, "simulating, tenths of a second", total) as advance:
        return run_scenario(scenario, _throttled(advance), watch)


def _write_outputs(given: argparse.Namespace, result: Run) -> Iterator[bool]:
    """Write log and tables; yield for each file whether it was written."""
    from ospace.scenario import log

    if given.log:
        yield output.written(given.log, "log", lambda: log.save(result, given.log))
    if given.csv:
        yield output.written(given.csv, "tables", lambda: log.to_csv(result, given.csv))


def _write_report(given: argparse.Namespace, result: Run) -> bool:
    """Draw the report, if --html or --pdf is given; return whether nothing failed."""
    from ospace.cli import progress

    if not (given.html or given.pdf):
        return True

    def report() -> None:
        from ospace.visual import browser, run_report
        from ospace.visual.provenance import Provenance

        about = Provenance.of(
            result.scenario.path,
            name=title(given.scenario),
            command=given.command,
            project=given.project,
            author=given.author,
        )
        if given.html:
            run_report.save(result, given.html, about)
        if given.pdf:
            browser.pdf(run_report.render(result, about, "paper"), given.pdf)

    with nullcontext() if given.headless else progress.bar(given, "drawing the report", 1):
        return output.written(given.html or given.pdf, "report", report)


@contextmanager
def _live(given: argparse.Namespace, scenario: Scenario) -> Iterator[Live]:
    """Serve the scenario's scene while it runs."""
    from ospace.visual.live import Live

    with Live(scenario) as live:
        print(f"{title(given.scenario)} at {live.address}: runs when the page is opened (Ctrl-C ends)", flush=True)
        live.wait()
        yield live


def _throttled(advance: Any) -> Any:
    """Return what moves the bar, and looks for an interrupt, every few milliseconds of simulated time."""
    due = 0.0

    def tick(time: float) -> None:
        nonlocal due
        if time >= due:
            due = time + _TICK
            advance(int(time * 10.0))

    return tick


# -- what people read --------------------------------------------------------------------------------------------


def _valid(scenario: Scenario, name: str, not_rehearsed: str) -> str:
    from ospace.exceptions import printable_lines
    from ospace.model.joint_positions import excess_text

    phases = ", ".join(phase.name for phase in scenario.phases)
    longest = sum(phase.timeout for phase in scenario.phases)
    remarks = [
        f"{who} starts outside limits of joints: {excess_text(robot.model, beyond)}\n"
        for who, robot, state in (
            ("robot", scenario.robot, scenario.start),
            *((name, *target) for name, target in scenario.targets.items()),
        )
        if (beyond := robot.outside_limits(state.q))
    ]
    if not_rehearsed:
        remarks.append(f"not rehearsed: {not_rehearsed}\n")
    text = f"{scenario.name}\nphases: {phases}; at most {longest:g} s\n{''.join(remarks)}valid: {name}\n"
    return printable_lines(text)


def _text(result: Run, name: str) -> str:
    console = buffered_console()
    _show(console, result, name)
    return buffered_text(console)


def _show(console: Console, result: Run, name: str) -> None:
    from ospace.scenario import summary_text

    scenario = result.scenario
    control = scenario.control
    show_text(console, f"[bold]{plain(scenario.name)}[/]")
    show_text(
        console,
        f"{plain(repr(scenario.robot))}, base {_base(scenario)}; control every {control.period * 1e3:g} ms "
        f"({plain(control.solver)}), {control.integrator} in steps of {control.step * 1e3:g} ms",
    )
    for line in summary_text.conditions(scenario):
        show_text(console, line)
    show_text(console, f"{result.duration:g} s simulated in {result.seconds:.1f} s\n")
    _show_phases(console, result.phases)
    for phase in result.phases:
        if phase.reason:
            show_text(console, f"{plain(phase.name)}: [bold red]{plain(phase.reason)}[/]")
        for line in summary_text.remarks(phase):
            show_text(console, plain(line))
    if result.not_begun:
        show_text(console, f"not begun: {plain(', '.join(result.not_begun))}")
    show_text(console, f"limits of joints exceeded: {plain(summary_text.exceeded(result.exceeded))}")
    console.print("\n[bold]Certificate[/]")
    show_table(console, _CERTIFICATE, [[plain(cell) for cell in one.cells()] for one in result.certificate.quantities])
    if hint := summary_text.remedy(result, control.step):
        show_text(console, plain(hint))
    colour = "bold green" if result.passed else "bold red"
    console.print()
    show_text(console, f"[{colour}]{summary_text.verdict(result)}[/]: {plain(name)}: {summary_text.summary(result)}")


_TIMES = (Column("from s", right=True), Column("to s", right=True))
_PHASE = (Column("phase"), *_TIMES, Column("outcome"), Column("cycles", wraps=True))
_TASK = (Column("task"), Column("worst error", right=True), Column("at the end", right=True))
_CERTIFICATE = (Column(), Column(right=True), Column(), Column(right=True), Column(wraps=True))


def _show_phases(console: Console, phases: Sequence[PhaseResult]) -> None:
    """Show a line for each phase, and below it one for each of its tasks."""
    from itertools import islice

    from ospace.scenario import summary_text

    def outcome(text: str) -> str:
        return f"[{_COLOURS.get(text, 'bold red')}]{text}[/]"

    table = fit(
        _PHASE,
        [
            (plain(one.name), f"{one.start:.3f}", f"{one.end:.3f}", outcome(one.outcome), summary_text.cycles(one))
            for one in phases
        ],
        console.width,
    )
    tasks = [[tuple(map(plain, row)) for row in summary_text.rows(one) if one.time.size] for one in phases]
    below = fit(_TASK, [row for rows in tasks for row in rows], console.width, "  ")
    left = iter(below.rows)
    lines = [*table.heading, *(below.heading if any(tasks) else ())]
    for phase, rows in zip(table.rows, tasks, strict=True):
        lines += [*phase, *(line for row in islice(left, len(rows)) for line in row)]
    for line in lines:
        console.print(line)


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

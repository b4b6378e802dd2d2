"""``ospace check URDF``: whether the model is sound, and every quantity of the paper agrees with Pinocchio."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import output
from ospace.cli.columns import Column, fit
from ospace.cli.console import buffered_console, buffered_text, plain, show_findings, show_table, show_text
from ospace.cli.dialect import shell
from ospace.cli.streams import title

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.analysis.overview import Overview
    from ospace.model.points import OperationalPoint
    from ospace.model.robot import SpaceRobot
    from ospace.urdf.description import Description
    from ospace.urdf.source import Limits
    from ospace.validation.agreement import Agreement
    from ospace.validation.report import Report

PAGE = "check"
EXAMPLES = (
    "ospace check chaser_24dof --point right_hand --point head",
    "ospace check arm.urdf bus.urdf --json",
    "ospace check robot.urdf.xacro hand:=true --package-dir ~/ros",
    "ospace check robot.urdf --html report.html",
    "ospace check robot.urdf --fix repaired.urdf",
    "ospace check - < robot.urdf",
)
_MOST_POINTS = 50  # unless points are given: their matrices grow with the square of their number
_COLOURS = {
    "agrees": "green",
    "differs": "bold red",
    "undecided": "yellow",
    "sound": "bold green",
    "unsound": "bold red",
}
_LIMITS = {
    "bytes": "bytes of the file",
    "nodes": "elements, attributes and comments",
    "depth": "elements within each other",
    "attributes": "attributes of an element",
    "text": "characters of an attribute",
    "links": "links",
    "dof": "degrees of freedom",
    "seconds": "seconds to expand a xacro",
    "memory": "bytes of memory to expand a xacro",
}
"""Those of `ospace.Limits`, by their names."""


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    from ospace.cli.main import takes_report, takes_robot

    verb = verbs.add_parser(
        "check",
        help="check a URDF and the dynamics computed from it",
        description="Read a URDF, compute every quantity of the paper by its recursion, and compare it with Pinocchio "
        "over random states. Exit status: 0 sound, 1 findings of level error, 2 unreadable input, unwritable output or "
        "wrong usage, 130 interrupted. Where nothing is wrong and too few digits are left to vouch for every quantity, "
        "the verdict is undecided, with status 0.",
    )
    verb.add_argument(
        "urdfs",
        metavar="URDF",
        nargs="*",
        help="a URDF, a xacro with its NAME:=VALUE..., or a robot that comes with ospace; - is standard input. Several "
        "are checked one after the other",
    )
    verb.add_argument(
        "--point",
        metavar="FRAME",
        action="append",
        help="operational point; repeatable (default: the first 50 leaf links)",
    )
    verb.add_argument("--samples", metavar="N", type=_count, default=20, help="random states (default: %(default)s)")
    verb.add_argument("--seed", metavar="S", type=_seed, default=0, help="seed of the states (default: %(default)s)")
    verb.add_argument(
        "--batch", action="store_true", help="compile the batch and compare all its states (default: interpret three)"
    )
    verb.add_argument("--json", action="store_true", help="print one JSON document instead of tables")
    verb.add_argument(
        "--html", metavar="FILE", type=output.file, help="write a report with the robot to look at: one file"
    )
    takes_report(verb)
    takes_robot(verb)
    verb.add_argument("--free-mimic", action="store_true", help="take joints that mimic others as independent ones")
    for name, what in _LIMITS.items():
        verb.add_argument(f"--max-{name}", metavar="N", type=_limit, help=f"{what}, at most")
    verb.add_argument(
        "--frames", action="store_true", help="list links, joints and their limits as a table, and check no dynamics"
    )
    other = verb.add_mutually_exclusive_group()
    other.add_argument("--fix", metavar="OUT", type=_repaired, help="write a repaired copy of URDF, and check nothing")
    other.add_argument("--explain", metavar="CODE", help="explain the code of a finding, and check nothing")
    verb.set_defaults(run=run, refuse_usage=verb.error)


def _repaired(text: str) -> Path:
    return output.file(text, ".urdf") if text == "-" else Path(text)


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 100_000:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of states from 1 to 100000")
    return int(text)


def _limit(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 on")
    return int(text)


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 0 on")
    return int(text)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Check; return the exit status and the text to print."""
    if given.frames and (given.html or given.pdf or given.fix is not None or given.explain is not None):
        given.refuse_usage("--frames lists what the file holds: give it without --html, --pdf, --fix and --explain")
    for option in ("json", "html", "pdf"):
        if getattr(given, option) and (given.fix is not None or given.explain is not None):
            given.refuse_usage(f"--{option} describes a check: give it without --fix and --explain")
    if given.explain is not None:
        from ospace.urdf.lint import explain

        return 0, shell(explain.text(given.explain))
    if not given.urdfs:
        given.refuse_usage("give a URDF, or a code with --explain")
    one = _frames if given.frames else _fix if given.fix is not None else _check
    if len(given.urdfs) > 1:
        return _several(given, one)
    given.urdf = given.urdfs[0]
    return one(given)


def _several(given: argparse.Namespace, one: Callable[[argparse.Namespace], tuple[int, str]]) -> tuple[int, str]:
    """Check files one after the other; those that cannot be read are reported, and the rest goes on."""
    from ospace.cli.main import EXIT_USAGE
    from ospace.exceptions import OspaceError

    for option in ("html", "pdf", "fix"):
        if getattr(given, option):
            given.refuse_usage(f"--{option} writes one file: give it with one URDF")
    statuses, texts = [], []
    for urdf in given.urdfs:
        given.urdf = urdf
        try:
            status, text = one(given)
            texts.append(text)
        except OspaceError as error:
            output.tell(f"error: {error}")
            status = EXIT_USAGE
        statuses.append(status)
    worst = max(statuses)
    if given.json:
        return worst, "[\n" + ",\n".join(text.rstrip("\n") for text in texts) + "\n]\n"
    return worst, "\n".join([*texts, f"{statuses.count(0)} of {len(statuses)} files without errors\n"])


def _check(given: argparse.Namespace) -> tuple[int, str]:
    from ospace.cli.main import EXIT_FINDINGS, EXIT_USAGE, check_report_options, find, package_dirs
    from ospace.extras import require_scene

    if given.html or given.pdf:
        require_scene("a report")
    check_report_options(given)
    file, folders = find(given.urdf), package_dirs(given)
    output.distinct([file], [given.html, given.pdf])
    output.writable(given.html, given.pdf)
    result, description, robot, points = _report(given, file, folders)
    text = (
        json.dumps(result.as_dict(), indent=2, allow_nan=False) + "\n"
        if given.json
        else _text(result, title(given.urdf))
    )
    status = EXIT_FINDINGS if result.errors else 0
    files = [path for path in (given.html, given.pdf) if path]
    if not files:
        return status, text

    def report() -> None:
        from ospace.visual import browser, check_report
        from ospace.visual.provenance import Provenance

        name = title(given.urdf)
        about = Provenance.of(file, name=name, command=given.command, project=given.project, author=given.author)
        hands = [] if robot is None or result.errors else _hands(given, robot, points)
        more: dict[str, Any] = {"name": name, "urdf": file, "package_dirs": folders, "hands": hands, "about": about}
        if given.html:
            check_report.save(result, description, given.html, **more)
        if given.pdf:
            browser.pdf(check_report.render(result, description, **more, background="paper"), given.pdf)

    given.refuse_if_interrupted()  # which an import may have swallowed: nothing is printed then
    done = [output.printed(text), output.written(files[0], "report", report)]
    if not all(done):
        return EXIT_USAGE, ""
    return status, "" if given.json else "".join(f"wrote {path}\n" for path in files)


def _hands(given: argparse.Namespace, robot: SpaceRobot, points: Sequence[OperationalPoint]) -> list[Overview]:
    """Map what hands do while the base floats, for the report."""
    from ospace.analysis.overview import hands_of, overviews
    from ospace.cli import progress

    with progress.bar(given, "mapping hands", len(hands_of(points))) as advance:
        return overviews(robot, points, seed=given.seed, progress=advance)


def _report(
    given: argparse.Namespace, file: Path, folders: Sequence[Path]
) -> tuple[Report, Description, SpaceRobot | None, list[OperationalPoint]]:
    """Check; return the report, what the file says, and the robot with its points, if one is made of it."""
    from ospace.cli import progress
    from ospace.dynamics.workspace import compile_kernels
    from ospace.model.robot import SpaceRobot
    from ospace.urdf import reader
    from ospace.urdf.lint.findings import by_severity
    from ospace.validation import report
    from ospace.validation.mesh_boxes import of_meshes

    reading = reader.read(
        file,
        package_dirs=folders,
        xacro_args=given.xacro_args,
        limits=_limits(given),
        free_mimic=given.free_mimic,
        root=given.root,
    )
    description, findings = reading.description, reading.findings
    if reading.model is None:
        on_meshes = of_meshes(description, file, folders, findings)
        return report.Report(None, by_severity([*findings, *on_meshes]), seed=given.seed), description, None, []
    robot = SpaceRobot(reading.model, findings, source=file, description=description, package_dirs=folders)
    points = [robot.point(name) for name in given.point or robot.leaf_links[:_MOST_POINTS]]
    with progress.bar(given, "comparing states", given.samples) as advance:
        compile_kernels()
        result = report.check(
            robot, points, samples=given.samples, seed=given.seed, batch=given.batch, progress=advance
        )
    return result, description, robot, points


def _frames(given: argparse.Namespace) -> tuple[int, str]:
    """List what the file holds; its findings decide the status, and are counted."""
    from ospace.cli import frames
    from ospace.cli.main import EXIT_FINDINGS, find, package_dirs
    from ospace.urdf import reader

    folders = [Path(folder) for folder in package_dirs(given)]
    reading = reader.read(
        find(given.urdf),
        package_dirs=folders,
        xacro_args=given.xacro_args,
        limits=_limits(given),
        free_mimic=given.free_mimic,
        root=given.root,
    )
    text = frames.document(reading) if given.json else frames.table(reading, title(given.urdf))
    return EXIT_FINDINGS if reading.model is None else 0, text


def _fix(given: argparse.Namespace) -> tuple[int, str]:
    from ospace.cli.main import EXIT_FINDINGS, find, package_dirs
    from ospace.exceptions import printable
    from ospace.urdf import reader, repair
    from ospace.validation.report_text import number

    limits, out = _limits(given), given.fix
    folders = [Path(folder) for folder in package_dirs(given)]
    changes = repair.write(
        find(given.urdf), out, limits, package_dirs=folders, xacro_args=given.xacro_args, root=given.root
    )
    if not out.exists():
        return 0, printable(f"nothing to repair: {out} was not written") + "\n"
    left = reader.read(out, limits=limits, free_mimic=given.free_mimic, root=given.root).findings
    errors = sum(finding.severity == "error" for finding in left)
    lines = [str(change) for change in changes] or ["nothing to repair"]
    lines.append(f"wrote {out}: {number(len(changes), 'change')}, {number(errors, 'error')} left")
    return EXIT_FINDINGS if errors else 0, "".join(f"{printable(line)}\n" for line in lines)


def _limits(given: argparse.Namespace) -> Limits:
    """Return the limits, raised where the command says so."""
    from ospace.urdf.source import Limits

    raised = {name: getattr(given, f"max_{name}") for name in _LIMITS}
    return Limits(**{name: value for name, value in raised.items() if value is not None})


# -- what people read --------------------------------------------------------------------------------------------


def _text(result: Report, urdf: str) -> str:
    console = buffered_console()
    _show(console, result, urdf)
    return buffered_text(console)


_FACT = (Column(), Column(wraps=True))
_AGREEMENT = (
    Column(f"{'computed by':29}"),
    Column("error", right=True),
    Column("  bound", right=True),
    Column("verdict", wraps=True),
)


def _show(console: Console, result: Report, urdf: str) -> None:
    from ospace.validation import report_text

    if result.model is not None:
        show_text(console, f"[bold]{plain(result.model.name)}[/]")
        facts = [(f"{name:22}", plain(value)) for name, value in report_text.facts(result.model)]
        show_table(console, _FACT, facts, "  ")
    if result.findings:
        if result.model is not None:
            console.print()
        show_findings(console, result.findings)
    if result.agreement:
        console.print()
        _show_agreement(console, result)
        console.print()
        show_text(console, report_text.agreement(result))
    show_text(console, f"[{_COLOURS[result.verdict]}]{result.verdict}[/]: {plain(urdf)}: {report_text.summary(result)}")


def _show_agreement(console: Console, result: Report) -> None:
    """Show each quantity, with what it is checked against, and below it a row for each of its ways in."""
    from ospace.validation import report_text

    rows = [
        (
            plain(row.computed_by),
            f"{report_text.error(row.error):>7}",
            f"{report_text.error(row.bound):>7}",
            f"[{_COLOURS[row.verdict]}]{report_text.verdict(row)}[/]",
        )
        for row in result.agreement
    ]
    table = fit(_AGREEMENT, rows, console.width, "  ")
    show_text(console, "[bold]quantity (equations): checked against[/]", then="    ")
    for line in table.heading:
        console.print(line)
    before = ""
    for row, lines in zip(result.agreement, table.rows, strict=True):
        if _quantity(row) != before:
            before = _quantity(row)
            show_text(console, plain(before), then="    ")
        for line in lines:
            console.print(line)


def _quantity(row: Agreement) -> str:
    """Return what the rows of a quantity have in common."""
    return f"{row.quantity} ({row.equation}): {row.checked_against}"

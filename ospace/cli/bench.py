"""``ospace bench [URDF]``: how fast this machine computes the quantities, side by side with Pinocchio."""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING, Any

from ospace.cli import output
from ospace.cli.console import buffered_console, buffered_text, plain

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.benchmark.report import Benchmark
    from ospace.benchmark.timing import Ratio

_WIDTH = 120


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    from ospace.cli.main import takes_robot

    verb = verbs.add_parser(
        "bench",
        help="time ospace and Pinocchio side by side",
        description="Compute each quantity by ospace and by Pinocchio, see that both give the same numbers, and time "
        "them in windows that take turns. Exit status: 0 measured, 2 unreadable input, unwritable output, wrong usage "
        "or different numbers, 130 interrupted.",
    )
    verb.add_argument(
        "urdf",
        metavar="URDF",
        nargs="?",
        default="chaser_24dof",
        help="a URDF, a xacro with its NAME:=VALUE..., or a robot that comes with ospace",
    )
    verb.add_argument("--points", metavar="N", type=_count, help="at most N operational points at once (default: 6)")
    verb.add_argument("--seconds", metavar="S", type=_seconds, default=1.0, help="time for each row (default: 1)")
    takes_robot(verb)
    verb.add_argument("--free-mimic", action="store_true", help="release the coupling of mimic joints")
    verb.add_argument(
        "--codegen", action="store_true", help="also against C that CasADi generates; needs gcc, casadi, adam-robotics"
    )
    verb.add_argument("--json", action="store_true", help="print one JSON document instead of tables")
    verb.add_argument("--plot", metavar="FILE", type=output.figure, help="write a plot: .svg, .png or .pdf")
    verb.set_defaults(run=run)


def _count(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 100:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of points from 1 to 100")
    return int(text)


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds <= 3600.0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a time in seconds, above 0 and up to 3600")
    return seconds


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Measure; return the exit status and the text to print."""
    from ospace.benchmark import codegen, plot, report
    from ospace.cli import progress
    from ospace.cli.main import EXIT_USAGE, find, package_dirs
    from ospace.exceptions import OspaceError
    from ospace.extras import require
    from ospace.model.robot import SpaceRobot

    if given.plot:
        require("matplotlib", "a plot")
    if given.codegen:
        codegen.require()
    file = find(given.urdf)
    if given.codegen and file.suffix.lower() == ".xacro":
        raise OspaceError(f"--codegen reads a URDF: write one with ospace check {file} --fix OUT")
    output.distinct([file], [given.plot])
    output.writable(given.plot)
    robot = SpaceRobot.from_urdf(
        file, package_dirs(given), xacro_args=given.xacro_args, free_mimic=given.free_mimic, root=given.root
    )
    with progress.bar(given, "comparing results", 1):
        plan = report.prepare(robot, given.points, file if given.codegen else None)
    with progress.bar(given, "timing", plan.turns) as advance:
        result = report.run(plan, seconds=given.seconds, tick=_counted(advance))
    text = _document(result) if given.json else _text(result)
    if not given.plot:
        return 0, text
    given.refuse_if_interrupted()  # which an import may have swallowed: nothing is printed then
    done = [output.printed(text), output.written(given.plot, "plot", lambda: plot.save(result, given.plot))]
    return 0 if all(done) else EXIT_USAGE, ""


def _counted(advance: Any) -> Any:
    done = 0

    def tick() -> None:
        nonlocal done
        done += 1
        advance(done)

    return tick


def _document(result: Benchmark) -> str:
    return json.dumps(result.as_dict(), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


# -- what people read --------------------------------------------------------------------------------------------


def _text(result: Benchmark) -> str:
    console = buffered_console(_WIDTH)
    _show(console, result)
    return buffered_text(console)


def _show(console: Console, result: Benchmark) -> None:
    machine = dict(result.machine)
    console.print(f"[bold]{plain(result.robot)}[/], {result.degrees_of_freedom} degrees of freedom")
    console.print(f"{machine.pop('processor')}, {machine.pop('processors')} processors, {machine.pop('lanes')} lanes")
    console.print(", ".join(f"{name} {version}" for name, version in machine.items()))
    console.print(
        f"median and quartiles of {result.windows} windows that take turns, over {result.states} states; "
        "times from Python, all included\n"
    )
    one = _table("one state", "points", "Pinocchio's way")
    for row in result.rows:
        one.add_row(row.quantity, str(row.points), row.called, *_times(row.times))
    many = _table("Γ_e⁻¹ of many states, times of one", "points", "states", "threads")
    for each in result.batch:
        many.add_row(each.output, str(each.points), str(each.states), str(each.threads), *_times(each.times))
    console.print(one)
    console.print(many)
    grown = _plain_table("Γ_e⁻¹ and μ_e of two points, µs", *map(str, result.growth[0].sizes), "slope")
    for growth in result.growth:
        grown.add_row(growth.shape, *(f"{time:.1f}" for time in growth.ours), f"{growth.slope:.2f}")
        dense = ("-" if time is None else f"{time:.1f}" for time in growth.dense)
        grown.add_row(f"{growth.shape}, pin.crba and Cholesky alone", *dense, f"{growth.dense_slope:.2f}")
    console.print(grown)


def _table(*headings: str) -> Any:
    return _plain_table(*headings, "ospace µs", "Pinocchio µs", "ratio", "quartiles")


def _plain_table(*headings: str) -> Any:
    from rich.table import Table

    table = Table(box=None, pad_edge=False, header_style="bold")
    for k, heading in enumerate(headings):
        numbers = k > 0 and heading != "Pinocchio's way"
        table.add_column(heading, justify="right" if numbers else "left", no_wrap=numbers, overflow="fold")
    return table


def _times(times: Ratio) -> tuple[str, ...]:
    return f"{times.ours:.2f}", f"{times.theirs:.2f}", f"{times.ratio:.1f}", f"{times.low:.1f}-{times.high:.1f}"

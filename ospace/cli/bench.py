"""``ospace bench [URDF]``: how fast this machine computes the quantities, side by side with Pinocchio."""

from __future__ import annotations

import argparse
import json
import math
from typing import TYPE_CHECKING, Any

from ospace.cli import output
from ospace.cli.columns import Column, fit
from ospace.cli.console import buffered_console, buffered_text, plain, show_table, show_text

if TYPE_CHECKING:
    from rich.console import Console

    from ospace.benchmark.report import Benchmark
    from ospace.benchmark.timing import Ratio

PAGE = "speed"
EXAMPLES = (
    "ospace bench",
    "ospace bench robot.urdf --points 3 --seconds 0.2",
    "ospace bench chaser_24dof --json --plot bench.svg",
)


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
    console = buffered_console()
    _show(console, result)
    return buffered_text(console)


def _show(console: Console, result: Benchmark) -> None:
    machine = dict(result.machine)
    show_text(console, f"[bold]{plain(result.robot)}[/], {result.degrees_of_freedom} degrees of freedom")
    processor, count, lanes = (machine.pop(name) for name in ("processor", "processors", "lanes"))
    show_text(console, plain(f"{processor}, {count} processors, {lanes} lanes"))
    show_text(console, plain(", ".join(f"{name} {version}" for name, version in machine.items())))
    show_text(
        console,
        f"median and quartiles of {result.windows} windows that take turns, over {result.states} states; "
        "times from Python, all included\n",
    )
    _show_one_state(console, result)
    console.print()
    many = [
        (each.output, str(each.points), str(each.states), str(each.threads), *_times(each.times))
        for each in result.batch
    ]
    show_text(console, "[bold]Γ_e⁻¹ of many states, times of one, µs[/]")
    show_table(console, _columns("output", "points", "states", "threads"), many, "  ")
    console.print()
    grown = []
    for growth in result.growth:
        grown.append((growth.shape, *(f"{time:.1f}" for time in growth.ours), f"{growth.slope:.2f}"))
        dense = ("-" if time is None else f"{time:.1f}" for time in growth.dense)
        grown.append((f"{growth.shape}, dense", *dense, f"{growth.dense_slope:.2f}"))
    show_text(console, "[bold]Γ_e⁻¹ and μ_e of two points, µs; dense: pin.crba and Cholesky alone[/]")
    sizes = ("degrees of freedom", *map(str, result.growth[0].sizes), "slope")
    show_table(console, [Column(name, right=k > 0) for k, name in enumerate(sizes)], grown, "  ")


def _show_one_state(console: Console, result: Benchmark) -> None:
    """Show each quantity, below the way of Pinocchio that it is timed beside."""
    rows = [(row.quantity, str(row.points), *_times(row.times)) for row in result.rows]
    table = fit(_columns("quantity", "points"), rows, console.width, "  ")
    show_text(console, "[bold]times of one state, µs, beside Pinocchio's way[/]")
    for line in table.heading:
        console.print(line)
    before = ""
    for row, lines in zip(result.rows, table.rows, strict=True):
        if row.called != before:
            before = row.called
            show_text(console, plain(before))
        for line in lines:
            console.print(line)


def _columns(*headings: str) -> list[Column]:
    numbers = (*headings[1:], "ospace", "Pinocchio", "ratio", "quartiles")
    return [Column(headings[0]), *(Column(name, right=True) for name in numbers)]


def _times(times: Ratio) -> tuple[str, ...]:
    return f"{times.ours:.2f}", f"{times.theirs:.2f}", f"{times.ratio:.1f}", f"{times.low:.1f}-{times.high:.1f}"

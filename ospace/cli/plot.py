"""``ospace plot LOG.npz [LOG2.npz]``: draw the curves of a run, or of two over each other."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import output, streams

if TYPE_CHECKING:
    from ospace.scenario.series import Series

PAGE = "plot"
EXAMPLES = (
    "ospace plot grasp.npz",
    "ospace plot before.npz after.npz --quantity torque --out torque.pdf",
    "ospace plot - --out - < grasp.npz > grasp.svg",
)
QUANTITIES = (
    *("position-error", "angle-error", "joint-error", "momentum-error", "angular-momentum-error"),
    *(
        "orientation",
        "path",
        "torque",
        "unlimited-torque",
        "momentum",
        "energy",
        "sigma-min",
        "clearance",
        "cycle-time",
    ),
)
"""The names of `ospace.scenario.series.TITLES`, which would take seconds to load."""


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    verb = verbs.add_parser(
        "plot",
        help="draw the curves of a run that was logged",
        description="Draw what a run left behind over time, from the file of `ospace run --log`; the same of a second "
        "run, dashed, over it. Exit status: 0 drawn, 2 unreadable log, unknown quantity, unwritable output or wrong "
        "usage, 130 interrupted.",
    )
    verb.add_argument("log", metavar="LOG.npz", type=_log, help="what `ospace run --log` wrote; - is standard input")
    verb.add_argument("other", metavar="LOG2.npz", type=_log, nargs="?", help="another run to compare")
    what = f"what to draw, can be given again (default: all): {', '.join(QUANTITIES)}"
    verb.add_argument("--quantity", metavar="NAME", action="append", help=what)
    verb.add_argument(
        "--out", metavar="FILE", type=output.figure, help="where to: .svg, .png or .pdf (default: LOG.svg, here)"
    )
    verb.set_defaults(run=run)


def _log(text: str) -> Path:
    return streams.current.standard_input(".npz") if text == "-" else Path(text)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Draw; return the exit status and the text to print."""
    from ospace.exceptions import printable
    from ospace.scenario import log
    from ospace.visual import plots

    files = [given.log, given.other] if given.other else [given.log]
    out: Path = given.out or Path(f"{given.log.stem}.svg")
    plots.require()
    _known(given.quantity or ())
    output.distinct(files, [out])
    output.writable(out)
    logs = [log.load(file) for file in files]
    drawn = _drawn(dict(zip(_names(files), logs, strict=True)), given.quantity)
    plots.save(plots.figure(list(drawn.values()), logs[0].phases), out)
    return 0, f"{printable(str(out))}: {', '.join(drawn)}\n"


def _known(names: Sequence[str]) -> None:
    """Raise where a quantity is unknown."""
    from ospace.exceptions import OspaceError, closest, printable
    from ospace.scenario.series import TITLES

    for name in names:
        if name not in TITLES:
            near = closest(name, TITLES).partition("; known:")[0]
            known = f"{' There' if near else '; there'} are {', '.join(TITLES)}"
            raise OspaceError(f"no quantity '{printable(name)}'{near}{known}")


def _drawn(logs: Mapping[str, Any], names: Sequence[str] | None) -> dict[str, Mapping[str, Series] | Series]:
    """Return what to draw by quantity: a series, or those of two logs by their names."""
    from ospace.exceptions import OspaceError
    from ospace.scenario import series

    made = {log: series.of(content) for log, content in logs.items()}
    found = {name: {log: one[name] for log, one in made.items() if name in one} for name in series.TITLES}
    there = [name for name, of_logs in found.items() if of_logs]
    for name in names or ():
        if name not in there:
            raise OspaceError(f"no {name} in {' or '.join(logs)}: there are {', '.join(there) or 'none'}")
    if not there:
        raise OspaceError(f"{' or '.join(logs)}: the run ended before anything could be plotted")
    chosen = list(dict.fromkeys(names)) if names else there
    return {name: found[name] if len(logs) > 1 else next(iter(found[name].values())) for name in chosen}


def _names(files: Sequence[Path]) -> list[str]:
    """Return the names of logs in a legend: as short as they differ."""
    short = [file.stem for file in files]
    return short if len(set(short)) == len(files) else [f"{k + 1}: {file}" for k, file in enumerate(files)]

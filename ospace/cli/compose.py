"""``ospace compose BUS ARM…``: arms and payloads on a bus, as the URDF of one robot."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ospace.cli import output, streams
from ospace.cli.columns import Column, fit
from ospace.cli.console import buffered_console, buffered_text, plain, show_findings, show_text

if TYPE_CHECKING:
    from ospace.urdf.composition.parts import Composition, Part, PlacedPart

PAGE = "compose"
EXAMPLES = (
    "ospace compose box:1.2x1x0.8m,250kg arm.urdf --at 0.6,0,0 \\",
    "    --rpy 0,90,0deg --prefix arm_ --out servicer.urdf",
    "ospace compose bus.urdf arm.urdf --out - | ospace check -",
)
_USAGE = """ospace compose BUS ARM [--at X,Y,Z] [--rpy R,P,Y] [--on LINK]
                      [--prefix WORD] [--remove LINK]... [NAME:=VALUE]...
                      [ARM ...] [--payload LINK BODY]...
                      [--package-dir DIR]... --out FILE"""
_SPLIT = re.compile(r"([^a-zA-Z°]+(?:[eE][+-]?\d+)?|.*?)\s*((?:[a-zA-Z°].*)?)", re.DOTALL)
"""A number, and its unit."""
_ONCE = ("at", "rpy", "on", "prefix")
_VALUES = {
    "--payload": 2,
    **dict.fromkeys(("--at", "--rpy", "--on", "--prefix", "--remove", "--out", "--package-dir"), 1),
}
"""Options, and how many words each takes."""


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    verb = verbs.add_parser(
        "compose",
        help="put arms and payloads on a bus, as one URDF",
        usage=_USAGE,
        description="Put arms on a bus and write the robot as one URDF. BUS and each ARM is a URDF, a xacro, the name "
        "of a robot that comes with ospace, box:1x1x0.8m,250kg, cylinder:RADIUSxLENGTHm,MASSkg, sphere:RADIUSm,MASSkg, "
        "or a mesh with its mass or density: bus.stl,250kg or bus.stl,120kg/m3 (bus.stl,250kg,mm where it is drawn in "
        "millimetres). --at, --rpy, --on, --prefix and --remove belong to the ARM that they follow, as the NAME:=VALUE "
        "of a xacro does. Of several ARMs in a row each takes one of every option that follows, in the same order.\n\n"
        "Exit status: 0 written, 1 written with findings of level error, 2 unreadable part, names that clash, "
        "unwritable output or wrong usage, 130 interrupted.",
    )
    verb.add_argument("--part", action=_InOrder, help=argparse.SUPPRESS)  # what `_marked` writes for BUS and ARM
    verb.add_argument(
        "--at",
        metavar="X,Y,Z",
        type=_metres,
        action=_InOrder,
        help="where the ARM's root stands, m; 60,0,0cm (default: 0,0,0)",
    )
    verb.add_argument(
        "--rpy",
        metavar="R,P,Y",
        type=_radians,
        action=_InOrder,
        help="its roll, pitch, yaw about fixed axes, rad; 0,90,0deg in degrees",
    )
    verb.add_argument(
        "--on", metavar="LINK", action=_InOrder, help="link of a part before it, prefixed (default: the base)"
    )
    verb.add_argument("--prefix", metavar="WORD", action=_InOrder, help="comes before all names of the ARM: left_")
    verb.add_argument(
        "--remove",
        metavar="LINK",
        action=_InOrder,
        help="leave out a link of BUS or ARM, as its file calls it, with all that it carries; of a stand below all "
        "else only what is fixed to it; repeatable",
    )
    verb.add_argument(
        "--payload",
        metavar=("LINK", "BODY"),
        nargs=2,
        action="append",
        default=[],
        help="fix a body at the origin of a link: 5kg,0.1x0.1x0.1kgm2,0x0x0.2m (mass, principal moments, centre of "
        "mass), box:0.3x0.2x0.2m,5kg, or a mesh; repeatable",
    )
    verb.add_argument("--out", metavar="FILE", type=output.file, required=True, help="the URDF to write")
    verb.add_argument(
        "--package-dir",
        metavar="DIR",
        action="append",
        default=[],
        help="where package:// names of meshes and $(find PACKAGE) of a xacro are looked up; repeatable",
    )
    verb.set_defaults(run=run, refuse_usage=verb.error, words=[])
    # argparse forgets in which order positional arguments and options came, and takes -0.5,0,0 for an option.
    known = verb.parse_known_args
    verb.parse_known_args = lambda words, *more: known(list(_marked(words)), *more)


class _InOrder(argparse.Action):
    """Keeps the order in which parts and their options were given."""

    def __call__(self, parser: object, given: argparse.Namespace, values: object, option: str | None = None) -> None:
        given.words = [*given.words, (self.dest, values)]


def _marked(words: Sequence[str]) -> Iterator[str]:
    """Write each word that belongs to no option as ``--part=WORD``, and each value behind its option's ``=``."""
    left = list(words)
    while left:
        word = left.pop(0)
        if not word.startswith("-") or word == "-":
            yield f"--part={word}"
        elif _VALUES.get(word) == 1 and left and not left[0].startswith("--"):
            yield f"{word}={left.pop(0)}"
        else:
            count = _VALUES.get(word, 0)
            yield from (word, *left[:count])
            del left[:count]


def _metres(text: str) -> tuple[float, ...]:
    return _three(text, "length", "0.5,0,0.4 or 50,0,40cm")


def _radians(text: str) -> tuple[float, ...]:
    return _three(text, "angle", "0,1.5708,0 or 0,90,0deg")


def _three(text: str, dimension: str, example: str) -> tuple[float, ...]:
    """Read three numbers, each with a unit, or with that of the last one, or in SI units."""
    from ospace.quantities import parse
    from ospace.urdf.numbers import NumberError, number

    words = [_SPLIT.fullmatch(word.strip()) for word in text.split(",")]
    if len(words) == 1:
        words = [_SPLIT.fullmatch(word) for word in text.split()]
    if len(words) != 3:
        raise argparse.ArgumentTypeError(f"'{text}' has {len(words)} numbers instead of 3: write {example}")
    last = words[-1][2] if words[-1] else ""
    try:
        pairs = [(number(word[1] or word[0]), word[2] or last) for word in words if word]
        return tuple(parse(f"{value!r} {unit}" if unit else value, dimension) for value, unit in pairs)
    except NumberError as error:
        raise argparse.ArgumentTypeError(f"'{text}' {error}: write {example}") from None
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"'{text}': {error}; write {example}") from None


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Compose; return the exit status and the text to print."""
    from ospace.cli.main import EXIT_FINDINGS, package_dirs
    from ospace.urdf.composition.compose import compose

    parts = _parts(given)
    output.distinct([part.file for part in parts if part.file is not None], [given.out])
    output.writable(given.out)
    to_file = given.out if given.out != streams.current.pending else None  # whose relative paths are from this folder
    robot = compose(*parts, payloads=given.payload, out=to_file, package_dirs=package_dirs(given))
    if to_file is None:
        given.out.write_bytes(robot.content)
    errors = any(finding.severity == "error" for finding in robot.findings)
    return EXIT_FINDINGS if errors else 0, _text(robot, str(given.out))


def _parts(given: argparse.Namespace) -> list[Part]:
    """Read the parts; raises `SystemExit` with the usage where an option belongs to none, or not one to each."""
    from ospace.cli.main import find
    from ospace.urdf.composition.parts import Part
    from ospace.urdf.composition.simple_body import is_simple_body

    parts = []
    for row in _rows(given):
        for k, (text, xacro_args) in enumerate(zip(row.sources, row.xacro_args, strict=True)):
            own = {key: row.options[key][k] for key in _ONCE if row.options[key]}
            source = text if is_simple_body(text) else find(text)
            parts.append(Part(source, **own, remove=tuple(row.options["remove"]), xacro_args=xacro_args))
    if not parts:
        given.refuse_usage("give a BUS: a URDF, or a body as box:1x1x0.8m,250kg")
    return parts


class _Row:
    """The bus, or arms in a row, each with arguments of its xacro; and the options that follow them."""

    def __init__(self) -> None:
        self.sources: list[str] = []
        self.xacro_args: list[dict[str, str]] = []
        self.options: dict[str, list[Any]] = {option: [] for option in (*_ONCE, "remove")}


def _rows(given: argparse.Namespace) -> list[_Row]:
    """Sort parts and options into rows, and refuse what fits none."""
    from ospace.cli.main import XACRO_VALUE

    rows: list[_Row] = []
    for key, value in given.words:
        argument = XACRO_VALUE.fullmatch(value) if key == "part" else None
        if not rows and (argument or key != "part"):
            given.refuse_usage(f"{value if argument else f'--{key}'} stands before BUS: write it behind its part")
        if argument:
            rows[-1].xacro_args[-1][argument[1]] = argument[2]
        elif key == "part":
            if len(rows) < 2 or any(rows[-1].options.values()):
                rows.append(_Row())
            rows[-1].sources.append(value)
            rows[-1].xacro_args.append({})
        else:
            rows[-1].options[key].append(value)
    for row in rows:
        _check_row(given, row, is_bus=row is rows[0])
    return rows


def _check_row(given: argparse.Namespace, row: _Row, *, is_bus: bool) -> None:
    count, named = len(row.sources), ", ".join(row.sources)
    arms = "1 ARM" if count == 1 else f"{count} ARMs"
    for option in _ONCE:
        times = len(row.options[option])
        if is_bus and times:
            given.refuse_usage(f"--{option} follows BUS, which stands on nothing: write it behind an ARM")
        if times not in (0, count):
            often = "once" if times == 1 else f"{times} times"
            given.refuse_usage(f"--{option} is given {often} for {arms} ({named}): give one for each, behind it")
    if row.options["remove"] and count > 1:
        given.refuse_usage(f"--remove follows {arms} ({named}): write it right behind the one it is for")


# -- what people read --------------------------------------------------------------------------------------------


def _text(robot: Composition, out: str) -> str:
    from ospace.validation.report_text import number, position

    console = buffered_console()
    links, moving = sum(len(part.links) for part in robot.parts), sum(part.moving for part in robot.parts)
    rows = [_row(part.source, len(part.links), part.moving, part.mass) for part in robot.parts]
    table = fit(_PART, [*rows, _row("together", links, moving, robot.total_mass)], console.width)
    for line in table.heading:
        console.print(line)
    for part, lines in zip(robot.parts, table.rows, strict=False):
        for line in lines:
            console.print(line)
        for text in _placing(part):
            show_text(console, plain(text), "  ", "    ")
    for line in table.rows[-1]:
        console.print(line, style="bold")
    centre = position(robot.mass_centre.tolist())
    show_text(console, f"centre of mass {centre} m from '{plain(robot.base)}', joints at zero")
    for about in (*robot.parts, None):
        findings = [finding for finding in robot.findings if robot.part_of(finding) is about]
        if findings:
            console.print()
            show_findings(console, findings, "Findings on " + ("the whole" if about is None else about.label))
    counts = [sum(one.severity == level for one in robot.findings) for level in ("error", "warning")]
    show_text(console, f"\nwrote {plain(out)}: {number(counts[0], 'error')}, {number(counts[1], 'warning')}")
    return buffered_text(console)


_PART = (Column("part"), *(Column(name, right=True) for name in ("links", "joints", "mass kg")))


def _row(name: str, links: int, moving: int, mass: float) -> tuple[str, str, str, str]:
    return plain(name), str(links), str(moving), f"{mass:.6g}"


def _placing(part: PlacedPart) -> Iterator[str]:
    """Return lines on where a part stands and what was made of it."""
    from ospace.validation.report_text import position

    prefix = f"{part.part.prefix} " if part.part.prefix else ""
    if part.on:
        yield f"{prefix}on {part.on} at {position(part.part.at)} m, rpy {position(part.part.rpy)} rad"
    if part.removed:
        yield f"without {', '.join(part.removed)}"
    if part.note:
        yield part.note

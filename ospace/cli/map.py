"""``ospace map URDF``: what an arm can do while its base floats."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import map_text, output
from ospace.cli.pose import joint_values, position

if TYPE_CHECKING:
    from ospace.analysis.arm import Arm
    from ospace.analysis.map_result import MapResult
    from ospace.cli.map_files import Rows
    from ospace.kernels.tree import Floats
    from ospace.model.robot import SpaceRobot

PAGE = "map"
EXAMPLES = (
    "ospace map chaser_7dof",
    "ospace map robot.urdf --point hand --what all --random 100000 --csv map.csv",
    "ospace map robot.urdf --over shoulder,elbow=0:90deg --grid 50 --npz map.npz",
)
_WHAT = ("reach", "singularity", "base-turn", "level-base", "disturbance", "wheels")
_RANDOM, _MOST = 20_000, 100_000_000


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    from ospace.cli.main import takes_robot

    verb = verbs.add_parser(
        "map",
        help="map what an arm can do while its base floats",
        description="Map a hand over many postures of its arm, base level and momentum zero: how far it reaches, where "
        "its workspace is path-independent and path-dependent (Papadopoulos and Dubowsky), how near it is to dynamic "
        "singularities, how far the base turns, what wheels would have to store. Ctrl-C ends the map, and prints and "
        "writes what there is of it. Exit status: 0 mapped, 2 unreadable input, unwritable output or wrong usage, 130 "
        "interrupted.",
    )
    verb.add_argument(
        "urdf", metavar="URDF", help="a URDF, a xacro with its NAME:=VALUE..., or a robot that comes with ospace"
    )
    verb.add_argument("--point", metavar="FRAME", help="the hand (default: the one leaf link that joints carry)")
    verb.add_argument(
        "--axes",
        choices=("all", "linear", "angular"),
        help="rows of the hand that count for singularities: pose, position or attitude (default: all where six or "
        "more joints vary, else linear)",
    )
    verb.add_argument(
        "--over",
        metavar="JOINT[=LOW:HIGH],...",
        default="",
        help="joints that vary, and their ranges, rad or m (default: those between base and hand, within their limits)",
    )
    verb.add_argument(
        "--pose",
        metavar="JOINT=VALUE,...",
        default="",
        help="where other joints stand, and where paths of the base's turn begin, rad or m (default: 0, or inside "
        "their limits where 0 is not)",
    )
    how = verb.add_mutually_exclusive_group()
    how.add_argument("--random", metavar="N", type=_whole, help=f"so many random postures (default: {_RANDOM})")
    how.add_argument("--grid", metavar="N", type=_whole, help="N values of each joint that varies, every combination")
    verb.add_argument("--seed", metavar="S", type=_seed, default=0, help="seed of what is random (default: 0)")
    verb.add_argument(
        "--what",
        metavar="NAME,...",
        default="reach,singularity",
        help=f"what to map, of {', '.join(_WHAT)}; or all (default: %(default)s)",
    )
    verb.add_argument("--json", action="store_true", help="print one JSON document instead of tables")
    verb.add_argument("--csv", metavar="FILE", type=output.file, help="write every posture as a row")
    verb.add_argument("--npz", metavar="FILE", type=_npz, help="write every posture, voxels and shells as arrays")
    verb.add_argument(
        "--html", metavar="FILE", type=output.file, help="write a page with the map on the robot: one file"
    )
    verb.add_argument("--plot", metavar="FILE", type=output.figure, help="write plots: .svg, .png or .pdf")
    takes_robot(verb)
    verb.add_argument("--free-mimic", action="store_true", help="take joints that mimic others as independent ones")
    verb.set_defaults(run=run, refuse_usage=verb.error)


def _whole(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= _MOST:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 1 to {_MOST}")
    return int(text)


def _seed(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number from 0 on")
    return int(text)


def _npz(text: str) -> Path:
    if text == "-":
        return output.file(text, ".npz")
    if Path(text).suffix != ".npz":
        raise argparse.ArgumentTypeError(f"'{text}' does not end in .npz")
    return output.file(text)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Map; return the exit status and the text to print."""
    from ospace.cli.main import EXIT_INTERRUPTED, EXIT_USAGE, find, package_dirs
    from ospace.extras import require, require_scene
    from ospace.model.robot import SpaceRobot

    what = _what(given.what)
    if given.html:
        require_scene("a page")
    if given.html or given.plot:
        require("matplotlib", "a plot")
    file, files = find(given.urdf), [given.csv, given.npz, given.plot, given.html]
    output.distinct([file], files)
    output.writable(*files)
    robot = SpaceRobot.from_urdf(
        file, package_dirs(given), xacro_args=given.xacro_args, free_mimic=given.free_mimic, root=given.root
    )
    arm = _arm(given, robot)
    with ExitStack() as stack:
        rows = stack.enter_context(_rows(arm, what, given.csv or given.npz)) if given.csv or given.npz else None
        result = _mapped(given, arm, what, rows)
        document = json.dumps(_document(result, given), indent=2, allow_nan=False) + "\n" if given.json else ""
        done = [output.printed(document or map_text.text(result)), *_written(given, result, rows)]
    if not all(done):
        return EXIT_USAGE, ""
    if result.interrupted:
        output.tell(f"interrupted after {result.arm_map.count} of {result.wanted} postures")
        return EXIT_INTERRUPTED, ""
    return 0, "" if given.json else "".join(f"wrote {path}\n" for path in filter(None, files))


def _rows(arm: Arm, what: Sequence[str], beside: Path) -> Rows:
    from ospace.analysis.arm_map import quantities_of
    from ospace.cli.map_files import Rows

    joints = [f"{name}_{unit}" for name, unit in zip(arm.joints, arm.units, strict=True)]
    return Rows([*joints, *(one.name for one in quantities_of(what))], beside)


def _written(given: argparse.Namespace, result: MapResult, rows: Rows | None) -> Iterator[bool]:
    """Write what was asked for; yield for each file whether it was written."""
    from ospace.analysis.map_result import arrays_of
    from ospace.cli import map_files, progress

    if rows is not None and given.csv:
        yield output.written(given.csv, "table", lambda: map_files.to_csv(rows, given.csv))
    if rows is not None and given.npz:
        yield output.written(given.npz, "arrays", lambda: map_files.to_npz(rows, given.npz, arrays_of(result)))
    if given.plot or given.html:
        with progress.bar(given, "drawing", 1):
            yield from _drawn(given, result)


def _drawn(given: argparse.Namespace, result: MapResult) -> Iterator[bool]:
    from ospace.visual import map_plots, map_report, plots

    if given.plot:
        yield output.written(given.plot, "plots", lambda: plots.save(map_plots.figure(result), given.plot))
    if given.html:
        yield output.written(given.html, "page", lambda: map_report.save(result, given.html, name=given.urdf))


def _what(text: str) -> tuple[str, ...]:
    from ospace.checks import checked_names

    names = tuple(name for name in (part.strip() for part in text.split(",")) if name)
    return checked_names(_WHAT if names == ("all",) else names, _WHAT, "--what:")


def _arm(given: argparse.Namespace, robot: SpaceRobot) -> Arm:
    from ospace.analysis.arm import Arm, default_arm
    from ospace.model.joint_positions import excess_text

    frame = given.point or _only_hand(robot)
    joints, ranges = _over(given.over, robot)
    at = robot.configuration({**robot.joint_positions(robot.neutral()), **joint_values(given.pose, robot)})
    if beyond := robot.outside_limits(at):
        output.tell(f"warning: --pose is outside limits: {excess_text(robot.model, beyond)}")
    if given.axes:
        return Arm(robot, robot.point(frame, given.axes), joints or None, ranges, at)
    return default_arm(robot, robot.point(frame), joints or None, ranges, at)


def _only_hand(robot: SpaceRobot) -> str:
    """Return the one leaf link that joints carry; raise `OspaceError` where there are several or none."""
    from ospace.exceptions import OspaceError, printable

    carried = [name for name in robot.leaf_links if robot.frame(name).parentJoint > 1]
    if len(carried) == 1:
        return carried[0]
    if not carried:
        raise OspaceError(
            f"robot '{printable(robot.name)}' has no joint that moves a leaf link: there is no arm to map"
        )
    raise OspaceError(f"several links may be the hand: give one with --point, such as {printable(carried[-1])}")


def _over(text: str, robot: SpaceRobot) -> tuple[list[str], dict[str, tuple[float, float]]]:
    """Read joints and ranges, as ``name=low:high,name``."""
    from ospace.exceptions import OspaceError

    joints, ranges = list[str](), dict[str, tuple[float, float]]()
    for part in filter(None, (part.strip() for part in text.split(","))):
        name, equals, span = (piece.strip() for piece in part.partition("="))
        if name in joints:
            raise OspaceError(f"--over '{part}': joint '{name}' is given twice")
        joints.append(name)
        if equals:
            bounds = span.split(":")
            if len(bounds) != 2:
                raise OspaceError(f"--over '{part}': write joint=low:high, rad or m, such as {name}=-1.5:1.5")
            low, high = (position(robot, f"--over '{part}'", name, bound) for bound in bounds)
            ranges[name] = low, high
    return joints, ranges


def _mapped(given: argparse.Namespace, arm: Arm, what: Sequence[str], rows: Rows | None) -> MapResult:
    """Map until Ctrl-C."""
    from ospace.analysis.arm_map import ArmMap
    from ospace.analysis.map_result import MapResult
    from ospace.analysis.rays import reach_along
    from ospace.analysis.workspace_shells import workspaces
    from ospace.cli import progress

    wanted, how, postures = _postures(given, arm)
    shells = rays = None
    interrupted = False
    with progress.bar(given, "mapping postures", wanted) as advance:
        found = ArmMap.empty(arm, what) if given.grid is None else ArmMap.empty(arm, what, given.grid)
        try:
            for x in postures:
                larger, values = found.with_postures(x)
                if rows is not None:
                    rows.add(x, values)
                found = larger
                advance(found.count)
        except KeyboardInterrupt:
            interrupted = True
    if "reach" in what and not interrupted:
        with progress.bar(given, "searching rays and workspaces", 2) as advance:
            try:
                rays = reach_along(arm, seed=given.seed)
                advance(1)
                shells = workspaces(arm, seed=given.seed)
                advance(2)
            except KeyboardInterrupt:
                interrupted = True
    if interrupted:
        given.clear_interrupt()
    return MapResult(found, shells, rays, wanted, how, interrupted)


def _postures(given: argparse.Namespace, arm: Arm) -> tuple[int, str, Iterator[Floats]]:
    """Return how many postures there are to map, how they are chosen, and these."""
    from ospace.analysis.arm_map import grid_postures, random_postures
    from ospace.exceptions import OspaceError

    if given.grid is None:
        count = given.random or _RANDOM
        return count, f"random, seed {given.seed}", random_postures(arm, count, given.seed)
    count = given.grid ** len(arm.joints)
    if count > _MOST:
        raise OspaceError(
            f"--grid {given.grid}: {given.grid}^{len(arm.joints)} postures are more than {_MOST}; give fewer joints "
            f"with --over, or --random N"
        )
    return count, f"grid of {given.grid} values of each joint", grid_postures(arm, given.grid)


def _document(result: MapResult, given: argparse.Namespace) -> dict[str, Any]:
    import ospace

    return {"ospace": ospace.__version__, "file": given.urdf, "seed": given.seed, **result.as_dict()}

"""``ospace view URDF``: a robot and the quantities of the paper, in a browser or as one file."""

from __future__ import annotations

import argparse
import time as clock
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import output
from ospace.cli.pose import joint_values
from ospace.cli.streams import title

if TYPE_CHECKING:
    from ospace.kernels.tree import Floats
    from ospace.model.robot import SpaceRobot
    from ospace.simulation.zero_momentum import JointSweep
    from ospace.urdf.errors import UnsoundModelError
    from ospace.visual import Scene
    from ospace.visual.page import Content

PAGE = "view"
EXAMPLES = (
    "ospace view chaser_24dof --sweep",
    "ospace view robot.urdf --pose elbow=20deg,wrist=-0.3",
    "ospace view robot.urdf --html robot.html --screenshot robot.png",
)
_FRAME = 1.0 / 30.0  # s from one picture of a sweep to the next
_WAIT = 0.2  # s


def add_to(verbs: Any) -> None:
    """Describe the verb to argparse."""
    from ospace.cli.main import takes_robot

    verb = verbs.add_parser(
        "view",
        help="look at a robot in a browser",
        description="Show a robot, its operational points and centre of mass, and as layers its inertias, the "
        "operational-space inertia, the generalized manipulability and momentum. Serves a page to browsers on this "
        "machine until Ctrl-C, unless --html or --screenshot writes a file. A robot with findings of level error has "
        "no dynamics: it is shown as its file describes it, faults coloured. Exit status: 0 shown or written, 1 shown "
        "or written with such findings, 2 unreadable input, unwritable output or wrong usage, 130 interrupted before "
        "it was shown.",
    )
    verb.add_argument(
        "urdf", metavar="URDF", help="a URDF, a xacro with its NAME:=VALUE..., or a robot that comes with ospace"
    )
    verb.add_argument(
        "--point",
        metavar="FRAME",
        action="append",
        help="operational point; repeatable (default: the first 8 leaf links that move)",
    )
    verb.add_argument(
        "--pose",
        metavar="JOINT=VALUE,...",
        default="",
        help="joint positions, rad or m, or with a unit, as elbow=20deg; others are 0, or inside their limits where 0 "
        "is not",
    )
    verb.add_argument(
        "--layers",
        metavar="NAME,...",
        help="layers shown at first: robot, collision, inertia, points, mass-centre, operational-inertia, "
        "manipulability, momentum (default: robot,points,mass-centre)",
    )
    verb.add_argument("--collision", action="store_true", help="show collision shapes instead of visuals")
    verb.add_argument(
        "--sweep",
        action="store_true",
        help="move every joint through its range; the base reacts, its momentum zero; prints by how much",
    )
    verb.add_argument("--csv", metavar="FILE", type=output.file, help="write the motion of --sweep as a table")
    verb.add_argument("--background", choices=("space", "paper"), default="space", help="default: %(default)s")
    verb.add_argument("--html", metavar="FILE", type=output.file, help="write one file that any browser opens")
    verb.add_argument(
        "--screenshot", metavar="PNG", type=_picture, help="write a picture, by a Chromium that is installed"
    )
    verb.add_argument("--host", metavar="ADDRESS", help="address to serve at (default: 127.0.0.1, this machine alone)")
    verb.add_argument(
        "--port", metavar="N", type=_port, help="port to serve at (default: the first free one from 7000)"
    )
    takes_robot(verb)
    verb.add_argument("--free-mimic", action="store_true", help="take joints that mimic others as independent ones")
    verb.set_defaults(run=run, refuse_usage=verb.error)


def _picture(text: str) -> Path:
    if text == "-":
        return output.file(text, ".png")
    if Path(text).suffix.lower() != ".png":
        raise argparse.ArgumentTypeError(f"'{text}' does not end in .png")
    return output.file(text)


def _port(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"'{text}' is not a port from 1 to 65535")
    return int(text)


def run(given: argparse.Namespace) -> tuple[int, str]:
    """Show; return the exit status and the text to print."""
    from ospace.cli.main import find, package_dirs
    from ospace.exceptions import printable
    from ospace.extras import require_scene
    from ospace.model.joint_positions import excess_text
    from ospace.model.robot import SpaceRobot
    from ospace.urdf.errors import UnsoundModelError
    from ospace.visual import browser

    if given.html or given.screenshot:
        for option in ("host", "port"):
            if getattr(given, option) is not None:
                given.refuse_usage(f"--{option} selects where to serve: give it without --html and --screenshot")
    if given.sweep and given.screenshot and not given.html:
        given.refuse_usage("--screenshot is a still picture: give --html too, for the motion of --sweep")
    if given.csv and not given.sweep:
        given.refuse_usage("--csv writes the motion of --sweep: give both")
    require_scene("a scene")
    if given.screenshot:
        browser.find()  # before any work is done
    file = find(given.urdf)
    output.distinct([file], [given.html, given.screenshot, given.csv])
    output.writable(given.html, given.screenshot, given.csv)
    folders = package_dirs(given)
    try:
        robot = SpaceRobot.from_urdf(
            file, folders, xacro_args=given.xacro_args, free_mimic=given.free_mimic, root=given.root
        )
    except UnsoundModelError as error:
        return _unsound(given, error, file, folders)
    q = robot.configuration({**robot.joint_positions(robot.neutral()), **joint_values(given.pose, robot)})
    if beyond := robot.outside_limits(q):
        output.tell(f"warning: --pose is outside limits: {excess_text(robot.model, beyond)}")
    scene = _scene(given, robot)
    scene.display(q)
    for finding in scene.findings:
        output.tell(str(finding))
    motion, text = _sweep(given, robot, q) if given.sweep else None, ""
    if motion is not None:
        text = _reactions(robot, motion)
        if given.csv:
            _write_motion(given.csv, robot, motion)
            text += f"wrote {printable(str(given.csv))}\n"
    if given.html or given.screenshot:
        return 0, text + _write(given, scene.html, lambda: _animated(given, scene, motion))
    return 0, _serve(given, scene.content, _player(scene, motion), text)


def _unsound(
    given: argparse.Namespace, error: UnsoundModelError, file: Path, folders: Sequence[Path]
) -> tuple[int, str]:
    """Show a robot without sound dynamics as its file describes it, its faults coloured."""
    from ospace.cli.main import EXIT_FINDINGS
    from ospace.exceptions import printable
    from ospace.urdf.lint.findings import by_severity
    from ospace.validation.report_text import number
    from ospace.visual import marked_robot, page
    from ospace.visual.robot_geometry import TITLES
    from ospace.visual.scene import checked_layers

    description = error.description
    assert description is not None  # as the robot was read from a file
    layers = checked_layers(_layers(given))
    drawn = marked_robot.draw(description, error.findings, file, folders, layers=layers, background=given.background)
    faults = [finding for finding in by_severity(error.findings) if finding.severity != "info"]
    errors = sum(finding.severity == "error" for finding in faults)
    for text in (*map(str, faults), *drawn.notes):
        output.tell(text)
    unused = [f"--{name}" for name in ("point", "pose", "sweep", "csv") if getattr(given, name)]
    if given.layers is not None:
        unused += [f"layer {name}" for name in layers if name not in TITLES]
    if unused:
        output.tell(f"warning: not used, as no dynamics can be computed: {', '.join(unused)}")
    heading = f"unsound: {number(errors, 'error')}, {number(len(faults) - errors, 'warning')}; all joints at zero"
    content = drawn.content(printable(description.name), heading, given.background, faults)
    if given.html or given.screenshot:
        text = page.render(content)
        return EXIT_FINDINGS, _write(given, lambda: text, lambda: text)
    return EXIT_FINDINGS, _serve(given, lambda: content)


def _layers(given: argparse.Namespace) -> list[str]:
    """Return the names of the layers shown at first."""
    from ospace.visual.scene import SHOWN

    shown = [name.strip() for name in given.layers.split(",")] if given.layers is not None else list(SHOWN)
    if given.collision:
        shown = ["collision", *(name for name in shown if name != "robot")]
    return [name for name in shown if name]


def _scene(given: argparse.Namespace, robot: SpaceRobot) -> Scene:
    from ospace.visual.scene import Scene

    points = [robot.point(name) for name in given.point] if given.point else None
    return Scene(robot, points, show=_layers(given), background=given.background)


def _sweep(given: argparse.Namespace, robot: SpaceRobot, q: Floats) -> JointSweep:
    from ospace.cli import progress
    from ospace.simulation.zero_momentum import joint_sweep

    with progress.bar(given, "moving every joint through its range, percent", 100) as advance:
        return joint_sweep(robot, q, progress=lambda share: advance(int(100.0 * share)))


def _reactions(robot: SpaceRobot, motion: JointSweep) -> str:
    """Return the table of a sweep: how far each joint moves, and how far the base turns and shifts meanwhile."""
    from math import degrees

    from ospace.cli.columns import Column
    from ospace.cli.console import buffered_console, buffered_text, plain, show_table, show_text

    turns = robot.turning_rates
    rows = []
    for name, turn, ways, (shift, angle) in zip(robot.rate_names, turns, motion.ranges, motion.largest, strict=True):
        low, high = (f"{degrees(way):.1f} deg" if turn else f"{way:.3g} m" for way in ways + 0.0)
        rows.append((plain(name), low, high, f"{degrees(angle):.3g} deg", f"{1e3 * shift:.3g} mm"))
    console = buffered_console()
    show_text(console, "The base while each joint moves by itself and nothing else acts:")
    headings = ("down", "up", "base turns", "base shifts")
    show_table(console, [Column("joint"), *(Column(heading, right=True) for heading in headings)], rows)
    return buffered_text(console)


def _write_motion(file: Path, robot: SpaceRobot, motion: JointSweep) -> None:
    """Write a sweep: which joint moves when, shift and turn of the base, and q."""
    import csv

    from ospace.files import replacing

    heading = ["time [s]", "joint", "base shift [m]", "base turn [rad]", *(f"q[{i}]" for i in range(robot.nq))]
    with replacing(file) as part, part.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(heading)
        for time, i, base, q in zip(motion.time, motion.moving, motion.base, motion.q, strict=True):
            writer.writerow([float(time), robot.rate_names[i], *map(float, base), *map(float, q)])


def _animated(given: argparse.Namespace, scene: Scene, motion: JointSweep | None) -> str:
    """Return the page of a scene, in motion with --sweep."""
    from ospace.cli import progress

    if motion is not None:
        with progress.bar(given, "drawing the motion", 1):
            scene.animate(motion)
    return scene.html()


def _write(given: argparse.Namespace, still: Callable[[], str], page: Callable[[], str]) -> str:
    """Write the picture of a page that stands still, and a page; return what was written."""
    from ospace.exceptions import printable
    from ospace.files import write_text
    from ospace.visual import browser

    written = []
    if given.screenshot:
        browser.screenshot(still(), given.screenshot)
        written.append(f"wrote {printable(str(given.screenshot))}\n")
    if given.html:
        size = write_text(given.html, page()).stat().st_size / 1e6
        written.append(f"wrote {printable(str(given.html))}: {size:.1f} MB, opened by any browser\n")
    return "".join(written)


def _serve(
    given: argparse.Namespace, content: Callable[[], Content], play: Callable[[], None] | None = None, text: str = ""
) -> str:
    """Serve until Ctrl-C, which is how it ends well; `play` shows a motion once, whenever somebody looks.

    `text` is printed below the address.
    """
    from ospace.visual.server import LOOPBACK, Server

    with Server(content, given.host or LOOPBACK, given.port) as server:
        print(f"{title(given.urdf)} at {server.address} (Ctrl-C ends)\n{text}", end="", flush=True)
        try:
            while True:
                if play is not None and server.viewers:
                    play()
                else:
                    clock.sleep(_WAIT)
        except KeyboardInterrupt:
            given.clear_interrupt()
    return ""


def _player(scene: Scene, motion: JointSweep | None) -> Callable[[], None] | None:
    """Return what shows the motion of --sweep once, at its own pace; None without one."""
    if motion is None:
        return None

    def play() -> None:
        began, k = clock.perf_counter(), 0
        while k < len(motion.time):
            scene.display(motion.q[k], motion.v[k])
            clock.sleep(_FRAME)
            k = max(k + 1, int(motion.time.searchsorted(clock.perf_counter() - began)))

    return play

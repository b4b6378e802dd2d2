"""``ospace view URDF``: a robot and the quantities of the paper, in a browser or as one file."""

from __future__ import annotations

import argparse
import sys
import time as clock
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ospace.cli import output

if TYPE_CHECKING:
    from ospace.kernels.tree import Floats
    from ospace.model.robot import SpaceRobot
    from ospace.simulation.zero_momentum import FloatingMotion
    from ospace.visual import Scene

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
        "machine until Ctrl-C, unless --html or --screenshot writes a file. Exit status: 0 shown or written, 2 "
        "unreadable input, unwritable output or wrong usage, 130 interrupted before it was shown.",
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
        help="joint positions, rad or m; others are 0, or inside their limits where 0 is not",
    )
    verb.add_argument(
        "--layers",
        metavar="NAME,...",
        help="layers shown at first: robot, collision, inertia, points, mass-centre, operational-inertia, "
        "manipulability, momentum (default: robot,points,mass-centre)",
    )
    verb.add_argument("--collision", action="store_true", help="show collision shapes instead of visuals")
    verb.add_argument(
        "--sweep", action="store_true", help="move every joint through its range; the base reacts, its momentum zero"
    )
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
    from ospace.extras import require_scene
    from ospace.model.joint_positions import excess_text
    from ospace.model.robot import SpaceRobot
    from ospace.visual import browser

    if given.html or given.screenshot:
        for option in ("host", "port"):
            if getattr(given, option) is not None:
                given.refuse_usage(f"--{option} selects where to serve: give it without --html and --screenshot")
    if given.sweep and given.screenshot and not given.html:
        given.refuse_usage("--screenshot is a still picture: give --html too, for the motion of --sweep")
    require_scene("a scene")
    if given.screenshot:
        browser.find()  # before any work is done
    file = find(given.urdf)
    output.distinct([file], [given.html, given.screenshot])
    output.writable(given.html, given.screenshot)
    robot = SpaceRobot.from_urdf(
        file, package_dirs(given), xacro_args=given.xacro_args, free_mimic=given.free_mimic, root=given.root
    )
    q = robot.configuration({**robot.joint_positions(robot.neutral()), **_pose(given.pose, robot)})
    if beyond := robot.outside_limits(q):
        print(f"ospace: warning: --pose is outside limits: {excess_text(robot.model, beyond)}", file=sys.stderr)
    scene = _scene(given, robot)
    scene.display(q)
    for finding in scene.findings:
        print(f"ospace: {finding}", file=sys.stderr)
    if given.html or given.screenshot:
        return 0, _write(given, scene, q)
    return _serve(given, scene, _sweep(given, robot, q) if given.sweep else None)


def _scene(given: argparse.Namespace, robot: SpaceRobot) -> Scene:
    from ospace.visual.scene import SHOWN, Scene

    shown = [name.strip() for name in given.layers.split(",")] if given.layers is not None else list(SHOWN)
    if given.collision:
        shown = ["collision", *(name for name in shown if name != "robot")]
    points = [robot.point(name) for name in given.point] if given.point else None
    return Scene(robot, points, show=[name for name in shown if name], background=given.background)


def _pose(text: str, robot: SpaceRobot) -> dict[str, float]:
    """Read joint positions, as ``name=value,name=value``."""
    from ospace.exceptions import OspaceError

    positions: dict[str, float] = {}
    for part in filter(None, (part.strip() for part in text.split(","))):
        name, equals, value = (piece.strip() for piece in part.rpartition("="))
        if not equals or not name:
            raise OspaceError(
                f"--pose '{part}': write joint=value, such as {robot.joint_names[0]}=0.5"
                if robot.joint_names
                else f"--pose '{part}': robot '{robot.name}' has no joint"
            )
        if name in positions:
            raise OspaceError(f"--pose '{part}': joint '{name}' is given twice")
        try:
            positions[name] = float(value)
        except ValueError:
            raise OspaceError(f"--pose '{part}': '{value}' is not a number in rad or m") from None
    return positions


def _sweep(given: argparse.Namespace, robot: SpaceRobot, q: Floats) -> FloatingMotion:
    from ospace.cli import progress
    from ospace.simulation.zero_momentum import joint_sweep

    with progress.bar(given, "moving every joint through its range, percent", 100) as advance:
        return joint_sweep(robot, q, progress=lambda share: advance(int(100.0 * share)))


def _write(given: argparse.Namespace, scene: Scene, q: Floats) -> str:
    from ospace.cli import progress
    from ospace.visual import browser

    written = []
    if given.screenshot:
        browser.screenshot(scene.html(), given.screenshot)
        written.append(f"wrote {given.screenshot}\n")
    if given.html:
        if given.sweep:
            motion = _sweep(given, scene.robot, q)
            with progress.bar(given, "drawing the motion", 1):
                scene.animate(motion)
        scene.save_html(given.html)
        written.append(f"wrote {given.html}: {given.html.stat().st_size / 1e6:.1f} MB, opened by any browser\n")
    return "".join(written)


def _serve(given: argparse.Namespace, scene: Scene, motion: FloatingMotion | None) -> tuple[int, str]:
    """Serve until Ctrl-C, which is how it ends well."""
    from ospace.visual.server import LOOPBACK, Server

    with Server(scene.content, given.host or LOOPBACK, given.port) as server:
        print(f"{given.urdf} at {server.address} (Ctrl-C ends)", flush=True)
        try:
            while True:
                if motion is not None and server.viewers:
                    _play(scene, motion.q, motion.v, motion.time)
                else:
                    clock.sleep(_WAIT)
        except KeyboardInterrupt:
            given.clear_interrupt()
    return 0, ""


def _play(scene: Scene, Q: Floats, V: Floats, time: Floats) -> None:
    """Show a motion once, at its own pace."""
    began, k = clock.perf_counter(), 0
    while k < len(time):
        scene.display(Q[k], V[k])
        clock.sleep(_FRAME)
        k = max(k + 1, int(time.searchsorted(clock.perf_counter() - began)))

"""A robot to look at: live in a browser, in a notebook, or as one file."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from meshcat.animation import Animation

from ospace.checks import real_numbers
from ospace.exceptions import OspaceError, closest
from ospace.files import write_text
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, points_of
from ospace.model.robot import SpaceRobot
from ospace.model.state import State, checked_state
from ospace.simulation.moving_frame import MovingFrame
from ospace.urdf.lint.findings import Finding
from ospace.visual import environment, page, resample
from ospace.visual.animation import ERROR, animation
from ospace.visual.environment import Background
from ospace.visual.marked_robot import hints_of
from ospace.visual.meshcat_scene import MeshcatScene, component
from ospace.visual.overlays import OVERLAYS, align_axes
from ospace.visual.page import Label, Layer
from ospace.visual.robot_geometry import LEGENDS, TITLES, of_robot

LAYERS = TITLES | {"points": "operational points"} | {one.name: one.title for one in OVERLAYS}
"""Names of layers, and what the page calls them."""
SHOWN = ("robot", "points", "mass-centre")
_MOST_POINTS = 8  # unless points are given
_QUANTITY_RATE = 20.0  # Hz, at which quantities are drawn in an animation
_SAMPLES = 40  # of a motion, for the size of the scene


def checked_layers(names: Iterable[str]) -> tuple[str, ...]:
    """Return names of layers.

    Raises
    ------
    OspaceError
        One of them is none of `LAYERS`.
    """
    shown = tuple(names)
    for name in shown:
        if name not in LAYERS:
            raise OspaceError(f"layer '{name}' is unknown{closest(name, LAYERS)}")
    return shown


class RecordedMotion(Protocol):
    """A motion in N records, such as `ospace.simulation.Trajectory`."""

    @property
    def time(self) -> Floats:
        """(N,) s, increasing."""

    @property
    def q(self) -> Floats:
        """(N, nq) configurations."""

    @property
    def v(self) -> Floats:
        """(N, nv) velocities."""


class Records(NamedTuple):
    """A motion as arrays; attributes as of `RecordedMotion`."""

    time: Floats
    q: Floats
    v: Floats


_Part = tuple[SpaceRobot, Floats, Floats, Floats]
"""A robot, and its motion: time (N,), q (N, nq), v (N, nv)."""


class _SceneRobot:
    """A robot in the scene, and what moves with it."""

    def __init__(self, scene: MeshcatScene, number: int, robot: SpaceRobot) -> None:
        self.robot = robot
        self.root = f"/robots/{number} {component(robot.name)}"
        self.geometry = of_robot(scene, self.root, robot)
        description = robot.description if self.geometry.links else None
        self.hints = {} if description is None else hints_of(description, robot.findings, self.geometry)

    def nodes(self, q: Floats) -> Floats:
        """Return position and quaternion of each node (J, 7)."""
        data = self.robot.data
        pin.forwardKinematics(self.robot.model, data, q)
        return np.array([pin.SE3ToXYZQUAT(data.oMi[j]) for j in range(1, self.robot.model.njoints)])

    def corners(self, q: Floats) -> Floats:
        """Return corners (N, 3) that it lies between at `q`."""
        return self.geometry.corners([pin.XYZQUATToSE3(pose).homogeneous for pose in self.nodes(q)])


class Scene:
    """A robot, with operational points and quantities of the paper as layers that can be switched on and off.

    Parameters
    ----------
    robot : SpaceRobot
    points : sequence of OperationalPoint, optional
        Shown as triads with names, and with ellipsoids; the first 8 leaf links without it.
    show : iterable of str
        Names of the layers shown at first, of `LAYERS`; the others can be switched on in the page.
    background : "space" or "paper"

    Attributes
    ----------
    frame : MovingFrame
        The inertial frame, with the user's axes, in which everything is drawn: it starts where the base is displayed
        first and moves along with the base as it is at the start of an animation.
    duration : float
        Of the animation, s.
    error : float
        Largest deviation of a body from its motion between two keys of the animation, m and half angles in rad.
    findings : list of Finding
        Meshes that cannot be shown; a box of the link's inertia stands in their place.

    Raises
    ------
    OspaceError
        A layer or background is unknown, a point is another robot's, or meshcat is not installed.

    Examples
    --------
    >>> scene = Scene(robot)
    >>> scene.display(robot.configuration({"right_arm_4": 1.2}))
    >>> scene.save_html("robot.html")
    """

    def __init__(
        self,
        robot: SpaceRobot,
        points: Sequence[OperationalPoint] | None = None,
        *,
        show: Iterable[str] = SHOWN,
        background: Background = "space",
    ) -> None:
        shown = checked_layers(show)
        if points is None:
            points = _default_points(robot)
        elif points:
            points_of(robot, points)
        self.robot = robot
        self.meshcat_scene = MeshcatScene()
        self.frame = MovingFrame(np.zeros(3), np.zeros(3))
        self.duration, self.error = 0.0, 0.0
        self._background: Background = background
        self._displayed = False
        self._robots = [_SceneRobot(self.meshcat_scene, 0, robot)]
        self.findings: list[Finding] = list(self._robots[0].geometry.findings)
        rest = pin.neutral(robot.model)
        reach = 0.5 * float(np.linalg.norm(np.ptp(self._robots[0].corners(rest), axis=0)))
        self._labels = [self._triad(point, k, 0.09 * reach) for k, point in enumerate(points)]
        self._overlays = [one(self.meshcat_scene, "/quantities", points, reach, robot) for one in OVERLAYS]
        drawn = self._robots[0].geometry.layers
        if "robot" in shown and not drawn["robot"]:
            shown = (*shown, "collision")  # all that there is to be seen
        paths = {one.name: one.paths for one in self._overlays} | {"points": [label.path for label in self._labels]}
        self._layers = {
            name: Layer(name, title, LEGENDS.get(name, ""), list(paths.get(name, [])), name in shown)
            for name, title in LAYERS.items()
        }
        self._labels.append(Label("centre of mass", self._overlays[0].paths[0], "mass-centre"))
        self._enlist(self._robots[0])
        self._place(robot.state(rest))
        self._surround([rest])

    def add(self, robot: SpaceRobot) -> None:
        """Put another robot into the scene, such as a target: it is drawn without points and quantities.

        Parameters
        ----------
        robot : SpaceRobot
        """
        drawn = _SceneRobot(self.meshcat_scene, len(self._robots), robot)
        self._robots.append(drawn)
        self.findings += drawn.geometry.findings
        self._enlist(drawn)

    def _enlist(self, drawn: _SceneRobot) -> None:
        for name, paths in drawn.geometry.layers.items():
            self._layers[name].paths.extend(paths)
        for layer in self._layers.values():
            for path in layer.paths:
                self.meshcat_scene.set_property(path, "visible", layer.shown)

    def _triad(self, point: OperationalPoint, number: int, length: float) -> Label:
        node = self._robots[0].geometry.nodes[point.joint - 1]
        path = f"{node}/points/point {component(point.frame)} {number}"
        environment.triad(self.meshcat_scene, f"{path}/axes", length)
        self.meshcat_scene.set_transform(path, point.placement.homogeneous)
        return Label(point.frame, path, "points")

    # -- how it moves ----------------------------------------------------------------------------------------

    def display(
        self,
        q: npt.ArrayLike,
        v: npt.ArrayLike | None = None,
        others: Sequence[npt.ArrayLike] = (),
        *,
        combined: State | None = None,
    ) -> None:
        """Show the robot in a configuration.

        Parameters
        ----------
        q : (nq,)
            As of `SpaceRobot.state`.
        v : (nv,), optional
            Velocity, for the arrows of momentum; zero without it.
        others : sequence of (nq,)
            Configurations of the robots that were added, in their order; without it they stay where they are.
        combined : State, optional
            Of the robot combined with what it holds, such as that of a `Grasp`: quantities are those of it.

        Raises
        ------
        OspaceError
            q or v is not a state of the robot, or there are more configurations than robots.
        """
        q, v = checked_state(self.robot, q, np.zeros(self.robot.nv) if v is None else v)
        if len(others) >= len(self._robots):
            raise OspaceError(f"{len(others)} configurations of others: there are {len(self._robots) - 1} in the scene")
        seen = [q]
        for drawn, own in zip(self._robots[1:], others, strict=False):
            seen.append(checked_state(drawn.robot, own, np.zeros(drawn.robot.nv))[0])
        if self.duration:
            self.meshcat_scene.set_animation(Animation())
            self.duration = self.error = 0.0
            self._displayed = False
        if not self._displayed:
            self.frame = MovingFrame(q[:3].copy(), np.zeros(3))
        for drawn, own in zip(self._robots, seen, strict=False):
            own[:3] -= self.frame.origin
            for path, pose in zip(drawn.geometry.nodes, drawn.nodes(own), strict=True):
                self.meshcat_scene.set_transform(path, pin.XYZQUATToSE3(pose).homogeneous)
        held = None if combined is None or combined.robot is self.robot else combined
        if held is None:
            self._place(self.robot.state(q, v))
        else:
            own = held.q.copy()
            own[:3] -= self.frame.origin
            self._place(State(held.robot, own, held.v))
        if not self._displayed:
            self._surround(*([own] for own in seen))
        self._displayed = True

    def animate(self, *motions: RecordedMotion, segments: Sequence[tuple[SpaceRobot, RecordedMotion]] = ()) -> None:
        """Show a motion; the page gets a time slider.

        Parameters
        ----------
        motions : RecordedMotion
            Such as a `Trajectory`: of the robot, and of each other one in the scene, over the same time.
        segments : sequence of SpaceRobot and RecordedMotion
            Motions of the robot combined with what it holds, or alone, one after the other over the same time:
            quantities are those of them, and change at once from one to the next. Those of the robot alone without it.

        Raises
        ------
        OspaceError
            A motion is another robot's, or has less than two records; there are not as many as robots.

        Notes
        -----
        The keys of the animation are so many that no body is further than `error` from where it was, at any time;
        between records it goes from one velocity to the next.
        """
        if len(motions) != len(self._robots):
            raise OspaceError(f"give one motion for each of the {len(self._robots)} robots in the scene")
        checked = [_checked(drawn.robot, motion) for drawn, motion in zip(self._robots, motions, strict=True)]
        start, first = checked[0].time[0], checked[0]
        self.frame = MovingFrame.of(self.robot.state(first.q[0], first.v[0]))
        moved: dict[str, tuple[Floats, Floats]] = {}
        seen, between_records = [], 0.0
        for drawn, motion in zip(self._robots, checked, strict=True):
            time = motion.time - start
            Q, V = self.frame.inverse.to_user_frame(time, motion.q, motion.v)
            times, poses, off = resample.resample_poses(drawn.robot.model, time, Q, V, drawn.nodes, ERROR)
            between_records = max(between_records, off)
            for j, path in enumerate(drawn.geometry.nodes):
                moved[path] = times, poses[:, j]
            seen.append((time, Q, V))
        moved |= self._quantities_along([(self.robot, *seen[0])] if not segments else self._seen(segments, start))
        self.duration = float(seen[0][0][-1])
        made, between_keys = animation(moved)
        self.error = between_records + between_keys
        self.meshcat_scene.set_animation(made)
        self._surround(*(Q[:: max(1, len(Q) // _SAMPLES)] for _, Q, _ in seen))
        self._displayed = True

    def _seen(self, segments: Sequence[tuple[SpaceRobot, RecordedMotion]], start: float) -> list[_Part]:
        """Return motions as seen from the frame."""
        parts = []
        for robot, motion in segments:
            time = np.asarray(motion.time) - start
            parts.append((robot, time, *self.frame.inverse.to_user_frame(time, motion.q, motion.v)))
        return parts

    def _quantities_along(self, parts: Sequence[_Part]) -> dict[str, tuple[Floats, Floats]]:
        times: list[npt.NDArray[np.float32]] = []
        states: list[State] = []
        for k, (robot, time, Q, V) in enumerate(parts):
            span = time[-1] - time[0]
            wanted = time[0] + np.linspace(0.0, span, max(2, round(span * _QUANTITY_RATE)))
            records = np.unique(np.searchsorted(time, wanted).clip(0, len(time) - 1))
            own = time[records].astype(np.float32)
            if k + 1 < len(parts):  # the last of it stands just before the first of the next, by a page's own clock
                own[-1] = np.nextafter(np.float32(parts[k + 1][1][0]), np.float32(0.0))
            later = np.flatnonzero(np.diff(np.r_[times[-1][-1] if times else np.float32(-1.0), own]) > 0.0)
            times.append(own[later])
            states += [robot.state(Q[records[one]], V[records[one]]) for one in later]
        at = np.concatenate(times).astype(np.float64)
        moved = {}
        for overlay in self._overlays:
            overlay.measure(states)
            placed: dict[str, list[Floats]] = {path: [] for path in overlay.paths}
            for state in states:
                for path, T in overlay.place(state):
                    T[:3, 3] += state.q[:3]
                    placed[path].append(T)
            for path, places in placed.items():
                poses = [_pose_and_scale(T) for T in (align_axes(places) if overlay.round else places)]
                moved[path] = at, np.array(poses)
        return moved

    def _place(self, state: State) -> None:
        for overlay in self._overlays:
            for path, T in overlay.place(state):
                T[:3, 3] += state.q[:3]
                self.meshcat_scene.set_transform(path, T)

    def _surround(self, *motions: Sequence[Floats] | Floats) -> None:
        corners = [
            np.concatenate([drawn.corners(q) for q in Q]) for drawn, Q in zip(self._robots, motions, strict=False)
        ]
        along = corners[1].mean(axis=0) - corners[0].mean(axis=0) if len(corners) > 1 else None
        environment.surround(self.meshcat_scene, self._background, np.concatenate(corners), along)

    # -- parts for pages of other kinds ----------------------------------------------------------------------

    @property
    def nodes(self) -> list[str]:
        """Nodes of the robot's bodies, the base first."""
        return self._robots[0].geometry.nodes

    def surround(self, q: npt.ArrayLike, points: Floats) -> None:
        """Place camera and light so that the robot and some points are seen.

        Parameters
        ----------
        q : (nq,)
            Configuration, the base at the origin.
        points : (N, 3)
            Base frame, m.
        """
        corners = np.vstack([self._robots[0].corners(np.asarray(q, dtype=float)), points])
        environment.surround(self.meshcat_scene, self._background, corners)

    # -- where it is seen ------------------------------------------------------------------------------------

    def html(self) -> str:
        """Return the scene as a page that needs nothing else: no server, no file beside it, no network.

        Returns
        -------
        str
            HTML.
        """
        return page.render(self.content())

    def content(self) -> page.Content:
        """Return the parts of a page.

        Returns
        -------
        Content
        """
        robot = self.robot
        heading = f"{robot.nv} degrees of freedom, {robot.total_mass:.6g} kg"
        legends = {one.name: one.legend for one in self._overlays}
        layers = [replace(one, legend=legends.get(one.name, one.legend)) for one in self._layers.values() if one.paths]
        return page.Content(
            self.meshcat_scene,
            robot.name,
            heading,
            self._background,
            layers,
            self._labels,
            [str(finding) for finding in self.findings],
            {path: hint for drawn in self._robots for path, hint in drawn.hints.items()},
        )

    def save_html(self, path: str | PathLike[str]) -> Path:
        """Write the scene to one file that a browser opens, without a request to anywhere.

        Parameters
        ----------
        path : path-like

        Returns
        -------
        Path
            Of the file.
        """
        return write_text(path, self.html())

    def _repr_html_(self) -> str:
        return page.frame(self.html())


def _default_points(robot: SpaceRobot) -> list[OperationalPoint]:
    """Take the leaf links that joints move, or all where there is none."""
    points = [robot.point(name) for name in robot.leaf_links]
    return ([point for point in points if point.joint > 1] or points)[:_MOST_POINTS]


def _checked(robot: SpaceRobot, motion: RecordedMotion) -> Records:
    """Return a motion as arrays; raise `OspaceError` where it is none of the robot."""
    try:
        time, q, v = (real_numbers(one) for one in (motion.time, motion.q, motion.v))
    except (AttributeError, TypeError, ValueError) as error:
        raise OspaceError(f"the motion of '{robot.name}': give an object with arrays time, q and v ({error})") from None
    named = getattr(motion, "robot_name", robot.name)
    if named != robot.name:
        raise OspaceError(f"the motion is that of robot '{named}', not of '{robot.name}'")
    n = time.size
    if time.shape != (n,) or q.shape != (n, robot.nq) or v.shape != (n, robot.nv):
        raise OspaceError(
            f"the motion is not of {robot!r}: time, q and v have the shapes {time.shape}, {q.shape}, {v.shape}, "
            f"not (N,), (N, {robot.nq}), (N, {robot.nv})"
        )
    if n < 2:
        raise OspaceError(f"the motion of '{robot.name}' has {n} record: it takes two to move")
    for name, one in (("time", time), ("q", q), ("v", v)):
        if not np.isfinite(one).all():
            k = int(np.flatnonzero(~np.isfinite(one).reshape(n, -1).all(axis=1))[0])
            raise OspaceError(f"the motion of '{robot.name}': {name} is not finite in record {k}")
    if not (np.diff(time) > 0.0).all():
        k = int(np.flatnonzero(np.diff(time) <= 0.0)[0]) + 1
        raise OspaceError(f"the motion of '{robot.name}': time does not increase at record {k}, {time[k]} s")
    for k in (int(np.argmax(np.abs(np.linalg.norm(q[:, 3:7], axis=1) - 1.0))), 0, n - 1):
        robot.state(q[k], v[k])
    return Records(time, q, v)


def _pose_and_scale(T: Floats) -> Floats:
    """Return position, quaternion and scale (10,) of a placement."""
    scale = np.linalg.norm(T[:3, :3], axis=0)
    return np.concatenate([pin.SE3ToXYZQUAT(pin.SE3(T[:3, :3] / scale, T[:3, 3])), scale])

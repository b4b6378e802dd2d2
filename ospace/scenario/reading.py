"""From a TOML file to a `Scenario`: all mistakes are found at once, each by its key."""

from __future__ import annotations

import math
import os
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from ospace import models
from ospace.control import Base, Completion, Controller
from ospace.control.base import MODES
from ospace.control.solvers import solver_named
from ospace.exceptions import OspaceError, ScenarioError, closest
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import Position
from ospace.model.points import parse_axes
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario.description import (
    TASKS,
    ControlPlan,
    Follow,
    Goal,
    GraspPlan,
    Hold,
    LimitsPlan,
    PhasePlan,
    Release,
    Scenario,
    Shift,
    TaskPlan,
    ToMomentum,
    ToPose,
)
from ospace.scenario.rehearsal import Rehearsal
from ospace.scenario.table import Problems, Table
from ospace.simulation import grasp, rigid_body, tumbling

_LARGEST_FILE = 1_000_000
_MOST_STEPS = 2_000_000
_SHORTEST, _LONGEST = 1e-6, 10.0
"""Of a control period and of a step, s."""
_LIGHTEST, _SMALLEST = 1e-6, 1e-9
"""Mass and principal moment of inertia of a target's body; kg, kg m²."""
_OPTIONS = (("stiffness", "stiffness", None), ("damping_ratio", "number", 100.0), ("weight", "number", 1e6))
_WITH_POINT = ("pose", "position", "orientation", "look_at", "relative_pose")
_WITH_AXES = ("pose", "position", "orientation", "relative_pose", "centre_of_mass", "base_attitude", "momentum")
_WITHOUT_GOAL = ("posture", "damping")
_INTEGRATORS = ("rk4", "symplectic")
_NEAR, _ALIGNED = 0.01, math.radians(1.0)
_WHOLE = 1e-9
_TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_ROWS = ((0, 3, 4), (3, 1, 5), (4, 5, 2))
_SLIDING = ("JointModelPX", "JointModelPY", "JointModelPZ", "JointModelPrismaticUnaligned")


def load(path: str | os.PathLike[str]) -> Scenario:
    """Read a scenario.

    Parameters
    ----------
    path : path-like
        A TOML file; its schema is in ``docs/scenario.md``.

    Raises
    ------
    ScenarioError
        The file cannot be read, or holds mistakes: carries all of them, by key.
    """
    file = Path(path)
    source = _text(file)
    try:
        data = tomllib.loads(source)
    except ValueError as error:  # also a whole number of more digits than Python reads
        raise ScenarioError(file, [("", f"is no TOML: {error}")]) from None
    except RecursionError:
        raise ScenarioError(file, [("", "is no scenario: values are nested too deep")]) from None
    problems = Problems([])
    scenario = _Reading(file, source, problems).scenario(Table(data, "", problems))
    if problems.found or scenario is None:
        raise ScenarioError(file, problems.found)
    return scenario


def _text(file: Path) -> str:
    try:
        with file.open("rb") as opened:
            content = opened.read(_LARGEST_FILE + 1)
    except OSError as error:
        raise ScenarioError(file, [("", error.strerror or str(error))]) from None
    if len(content) > _LARGEST_FILE:
        raise ScenarioError(file, [("", f"is larger than {_LARGEST_FILE // 1_000_000} MB: no scenario is")])
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise ScenarioError(file, [("", f"is no UTF-8 text: {error.reason} at byte {error.start}")]) from None


@dataclass
class _Reading:
    file: Path
    source: str
    problems: Problems

    def scenario(self, top: Table) -> Scenario | None:
        name = top.text("name", self.file.stem)
        chaser = top.table("robot", required=True)
        start, base = self.robot(chaser) if chaser else (None, MODES["floating"])
        given = top.table("target")
        target = self.target(given) if given else None
        control = self.control(top.table("control"))
        limits = self.limits(top.table("limits"), start)
        shared = [self.task(one, start) for one in top.tables("task")]
        tables = top.tables("phase", required=True)
        if "phase" in top.data and not tables and top.data["phase"] == []:
            top.wrong("phase", "a scenario needs at least one phase, [[phase]]")
        phases = tuple(self.phase(one, shared, start, control) for one in tables)
        top.done()
        longest = sum(phase.timeout for phase in phases)
        if longest > _MOST_STEPS * control.step:
            what = f"time-outs of {longest:g} s in all are more than {_MOST_STEPS} steps of {control.step:g} s"
            top.wrong("phase", f"{what}: make them shorter, or control.step longer")
        names = [phase.name for phase in phases]
        for k, phase in enumerate(phases):
            if phase.name in names[:k]:
                self.problems.add(f"{phase.key}.name", f"two phases are called '{phase.name}'")
        if self.problems.found or start is None:
            return None
        made = Scenario(self.file, self.source, name, start, target, base, limits, control, phases)
        self.rehearse(made)
        return made

    # -- robot and target ------------------------------------------------------------------------------------

    def model(self, table: Table) -> SpaceRobot | None:
        """Read the URDF of the key ``model``: a file beside the scenario, or a robot that comes with ospace."""
        given = table.text("model")
        if not given:
            return None
        file = self.file.parent / given
        try:
            if not os.path.lexists(file) and Path(given).name == given and not Path(given).suffix:
                file = models.path(given)
            return SpaceRobot.from_urdf(file)
        except OspaceError as error:
            table.wrong("model", str(error))
            return None

    def robot(self, table: Table) -> tuple[State | None, Base]:
        robot = self.model(table)
        base = self.base(table)
        T_WB = table.pose()
        twist = np.concatenate(
            [
                table.vector("velocity", "velocity", (0, 0, 0)),
                table.vector("angular_velocity", "angular velocity", (0, 0, 0)),
            ]
        )
        positions = self.joints(table.table("joints"), robot, "length", "angle")
        rates = self.joints(table.table("joint_rates"), robot, "velocity", "angular velocity")
        table.done()
        if robot is None:
            return None, base
        v = np.zeros(robot.nv)
        v[:3], v[3:6] = T_WB.rotation.T @ twist[:3], T_WB.rotation.T @ twist[3:]
        for name, rate in rates.items():
            v[robot.model.idx_vs[2 + robot.joint_names.index(name)]] = rate
        return self.state(table, robot, positions, T_WB, v), base

    def state(
        self, table: Table, robot: SpaceRobot, positions: Mapping[str, float], T_WB: pin.SE3, v: Floats
    ) -> State | None:
        try:
            return robot.state(robot.configuration(self.at_neutral(robot, positions), T_WB), v)
        except OspaceError as error:
            table.wrong("", str(error))
            return None

    @staticmethod
    def at_neutral(robot: SpaceRobot, positions: Mapping[str, float]) -> dict[str, Position]:
        """Return positions of all joints: those given, and of the others one inside their limits."""
        return robot.joint_positions(robot.neutral()) | dict(positions)

    def joints(self, table: Table | None, robot: SpaceRobot | None, linear: str, angular: str) -> dict[str, float]:
        """Read a quantity for each joint that is named."""
        if table is None or robot is None:
            return {}
        found = {}
        for name in table.rest():
            if name not in robot.joint_names:
                table.wrong(name, f"no joint '{name}' in robot '{robot.name}'{closest(name, robot.joint_names)}")
                continue
            found[name] = table.quantity(name, linear if _slides(robot, name) else angular)
        return found

    def base(self, table: Table) -> Base:
        given = table.table("base") if isinstance(table.data.get("base"), dict) else None
        if given is not None:
            force, torque = (self.amount(given, name) for name in ("force", "torque"))
            wheels = given.flag("wheels")
            momentum = given.quantity("wheel_momentum", "angular momentum", math.inf, above=0.0, finite=False)
            given.done()
            try:
                return Base(force, torque, wheels, momentum)
            except OspaceError as error:
                given.wrong("", str(error))
                return MODES["floating"]
        if "base" in table and not isinstance(table.data["base"], str):
            table.wrong("base", f"{table.data['base']!r}: give the name of a mode, or a table{closest('', MODES)}")
            return MODES["floating"]
        return MODES.get(table.text("base", "floating", MODES), MODES["floating"])

    def amount(self, table: Table, name: str) -> float | tuple[float, float, float]:
        """Read one limit, or three."""
        if isinstance(table.data.get(name), list):
            x, y, z = table.vector(name, name)
            return float(x), float(y), float(z)
        return table.quantity(name, name, 0.0, least=0.0, finite=False)

    def target(self, table: Table) -> State | None:
        if ("model" in table) == ("body" in table):
            table.wrong("", "give either model, a URDF, or body, the numbers of a rigid body")
            robot = None
        elif "model" in table:
            robot = self.model(table)
        else:
            robot = self.body(table)
        T_WB = table.pose()
        spin = table.vector("spin", "angular velocity", (0, 0, 0))
        drift = table.vector("velocity", "velocity", (0, 0, 0))
        positions = self.joints(table.table("joints"), robot, "length", "angle")
        table.done()
        try:
            return None if robot is None else tumbling(robot, T_WB, spin, drift, self.at_neutral(robot, positions))
        except OspaceError as error:
            table.wrong("", str(error))
            return None

    def body(self, table: Table) -> SpaceRobot | None:
        given = table.table("body")
        if given is None:
            return None
        mass = given.quantity("mass", "mass", least=_LIGHTEST)
        six = isinstance(given.data.get("inertia"), list) and len(given.data["inertia"]) == len(_TENSOR)
        inertia = given.vector("inertia", "inertia", count=6 if six else 3)
        if six:
            inertia = np.array([[inertia[k] for k in row] for row in _ROWS])
        centre = given.vector("mass_centre", "length", (0, 0, 0))
        name = given.text("name", "target")
        frames = {}
        framed = given.table("frames")
        for frame in framed.rest() if framed else ():
            one = framed.table(frame) if framed else None
            if one is not None:
                frames[frame] = one.pose()
                one.done()
        if framed is not None:
            framed.done()
        given.done()
        if self.problems.found:
            return None
        if not np.abs(np.linalg.eigvalsh(inertia) if six else inertia).min() >= _SMALLEST:
            given.wrong("inertia", f"principal moments must be at least {_SMALLEST:g} kg m^2")
            return None
        try:
            return rigid_body(mass, inertia, centre, name=name, frames=frames)
        except OspaceError as error:
            given.wrong("", str(error))
            return None

    # -- limits and control ----------------------------------------------------------------------------------

    def limits(self, table: Table | None, start: State | None) -> LimitsPlan:
        if table is None:
            return LimitsPlan()
        share = table.quantity("share", "number", 1.0, above=0.0, most=1.0)
        most: dict[str, float] = {}
        robot = None if start is None else start.robot
        if isinstance(table.data.get("acceleration"), dict):
            most = self.joints(table.table("acceleration"), robot, "acceleration", "angular acceleration")
        elif "acceleration" in table:
            one = table.quantity("acceleration", "angular acceleration", above=0.0, finite=False)
            most = dict.fromkeys(robot.joint_names, one) if robot else {}
        for name, value in most.items():
            if not value > 0.0:
                table.wrong(f"acceleration.{name}", "must be above 0")
        table.done()
        return LimitsPlan(share, most)

    def control(self, table: Table | None) -> ControlPlan:
        plain = ControlPlan()
        if table is None:
            return plain
        period = table.quantity("period", "time", plain.period, least=_SHORTEST, most=_LONGEST)
        step = table.quantity(
            "step", "time", min(plain.step, period) if period > 0.0 else plain.step, least=_SHORTEST, most=_LONGEST
        )
        solver = table.text("solver", plain.solver)
        integrator = table.text("integrator", plain.integrator, _INTEGRATORS)
        try:
            solver_named(solver)
        except OspaceError as error:
            table.wrong("solver", str(error))
        if step > 0.0 and period > 0.0 and not _whole(period, step):
            table.wrong("period", f"{period:g} s is no whole number of steps of {step:g} s")
        table.done()
        return ControlPlan(period, step, solver, integrator)

    # -- phases ----------------------------------------------------------------------------------------------

    def phase(self, table: Table, shared: list[TaskPlan], start: State | None, control: ControlPlan) -> PhasePlan:
        name = table.text("name")
        timeout = table.quantity("timeout", "time", above=0.0)
        duration = table.quantity("duration", "time", 0.0, least=0.0)
        if duration > timeout:
            table.wrong("duration", f"{duration:g} s is longer than the time-out, {timeout:g} s")
        own = [self.task(one, start) for one in table.tables("task")]
        names = [task.name for task in own]
        for k, task in enumerate(own):
            if task.name and task.name in names[:k]:
                self.problems.add(f"{task.key}.name", f"two tasks are called '{task.name}'")
        tasks = (*own, *(task for task in shared if task.name not in names))
        if not tasks:
            table.wrong("task", "a phase needs at least one task, [[phase.task]], or one of all phases, [[task]]")
        for task in tasks:
            motion = task.goal.duration if task.goal is not None and task in own else 0.0
            hold = task.completion.hold if task.completion else 0.0
            if motion + hold > timeout:
                part = "goal.duration" if motion > timeout else "completion.hold"
                what = f"{motion + hold:g} s of motion and hold are longer than the time-out of phase '{name}'"
                self.problems.add(f"{task.key}.{part}", f"{what}, {timeout:g} s")
        if not duration and not any(task.completion for task in tasks):
            table.wrong("", "nothing ends the phase: give a duration, or a task with a completion test")
        action: GraspPlan | Release | None = None
        held = table.table("grasp")
        if held is not None:
            action = GraspPlan(
                held.text("hand"),
                held.text("fixture"),
                held.quantity("position", "length", _NEAR, above=0.0, finite=False),
                held.quantity("angle", "angle", _ALIGNED, above=0.0, finite=False),
            )
            held.done()
        if table.flag("release"):
            if action:
                table.wrong("release", "a phase ends by a grasp or by a release, not by both")
            action = Release()
        table.done()
        return PhasePlan(table.key, name, timeout, duration, tasks, action)

    def task(self, table: Table, start: State | None) -> TaskPlan:
        kind = table.text("type", choices=TASKS)
        name = table.text("name")
        if kind not in TASKS:
            table.rest()
            return TaskPlan(table.key, "damping", name, {})
        options: dict[str, Any] = {}
        for option, dimension, most in _OPTIONS:
            if option in table:
                options[option] = table.quantity(option, dimension, least=0.0, most=most)
        if "level" in table:
            options["level"] = table.whole("level")
        completion = table.table("completion")
        if completion is not None:
            options["completion"] = self.completion(completion, kind)
        point = table.text("point") if kind in _WITH_POINT else None
        seen_from = table.text("seen_from") if kind == "relative_pose" else None
        offset = table.table("offset") if kind in _WITH_POINT else None
        T = pin.SE3.Identity()
        if offset is not None:
            T = offset.pose()
            offset.done()
        if kind in _WITH_AXES and "axes" in table:
            options["axes"] = self.axes(table)
        if kind == "look_at" and "axis" in table:
            axis = tuple(float(x) for x in table.vector("axis", "number"))
            if not np.linalg.norm(axis) > _WHOLE:
                table.wrong("axis", f"gives no direction: not all three may be zero, or below {_WHOLE:g}")
            options["axis"] = axis
        if kind == "posture" and "posture" in table:
            options["posture"] = self.joints(table.table("posture"), start.robot if start else None, "length", "angle")
        goal = None if kind in _WITHOUT_GOAL else self.goal(table, kind)
        table.done()
        return TaskPlan(table.key, kind, name, options, point, seen_from, T, goal)

    def axes(self, table: Table) -> str | tuple[bool, ...]:
        given = table.data["axes"]
        if isinstance(given, str):
            return table.text("axes", "all", ("all", "linear", "angular"))
        try:
            if not isinstance(given, list) or not all(isinstance(one, bool) for one in given):
                raise OspaceError(f"{given!r}: give 'all', 'linear', 'angular' or six of true and false")
            return parse_axes(given)
        except OspaceError as error:
            table.wrong("axes", str(error))
            return "all"

    def completion(self, table: Table, kind: str) -> Completion | None:
        momentum = kind == "momentum"
        position = table.quantity("position", "momentum" if momentum else "length", math.inf, above=0.0, finite=False)
        angle = table.quantity("angle", "angular momentum" if momentum else "angle", math.inf, above=0.0, finite=False)
        hold = table.quantity("hold", "time", 0.0, least=0.0)
        table.done()
        try:
            return Completion(position, angle, hold)
        except OspaceError:  # told of each key
            return None

    def goal(self, table: Table, kind: str) -> Goal:
        if kind == "momentum":
            return self.momentum(table)
        given = table.data.get("goal", "hold")
        if isinstance(given, str):
            table.text("goal", "hold", ("hold",))
            return Hold()
        one = table.table("goal")
        if one is None:
            return Hold()
        duration = one.quantity("duration", "time", 0.0, least=0.0)
        ways = {"follow": ("follow",), "shift": ("shift", "turn"), "hold": ("hold",)}
        ways["position"] = ("position", "rpy", "quaternion")
        taken = [way for way, keys in ways.items() if any(key in one for key in keys)]
        if len(taken) != 1:
            one.wrong("", "give one of: follow; shift or turn; position, rpy or quaternion; hold")
            one.rest()
            return Hold()
        goal: Goal = Hold(duration)
        if taken == ["follow"]:
            offset = one.table("offset")
            goal = Follow(one.text("follow"), offset.pose() if offset else pin.SE3.Identity(), duration)
            if offset is not None:
                offset.done()
        elif taken == ["shift"]:
            goal = Shift(one.vector("shift", "length", (0, 0, 0)), one.vector("turn", "angle", (0, 0, 0)), duration)
        elif taken == ["position"]:
            position = one.vector("position", "length") if "position" in one else None
            goal = ToPose(position, one.rotation(), duration)
        elif not one.flag("hold"):
            one.wrong("hold", "give true, or leave it out")
        one.done()
        return goal

    def momentum(self, table: Table) -> Goal:
        if isinstance(table.data.get("goal", "zero"), str):
            return Hold() if table.text("goal", "zero", ("zero", "hold")) == "hold" else ToMomentum(np.zeros(6))
        one = table.table("goal")
        if one is None:
            return Hold()
        linear = one.vector("linear", "momentum", (0, 0, 0))
        angular = one.vector("angular", "angular momentum", (0, 0, 0))
        one.done()
        return ToMomentum(np.concatenate([linear, angular]))

    # -- a rehearsal -----------------------------------------------------------------------------------------

    def rehearse(self, made: Scenario) -> None:
        """Make what each phase needs, with the robot that it will have, and note what cannot be made or reached."""
        robot, held = made.robot, False
        robots = []
        for phase in made.phases:
            for task in phase.tasks:
                self._rehearse_task(task, phase, robot, made, held)
            if self.problems.found:
                return
            try:
                limits = made.limits.of(robot, made.robot)
                tasks = [task.task(robot) for task in phase.tasks]
                Controller(robot, tasks, base=made.base, limits=limits, period=made.control.period)
            except OspaceError as error:
                self.problems.add(phase.key, str(error))
                return
            robots.append(robot)
            if isinstance(phase.action, GraspPlan):
                taken = self._rehearse_grasp(phase.action, f"{phase.key}.grasp", made, held)
                if taken is None:
                    return
                robot, held = taken, True
            elif isinstance(phase.action, Release):
                if not held:
                    self.problems.add(f"{phase.key}.release", "nothing is held at the end of this phase")
                    return
                robot, held = made.robot, False
        reach = Rehearsal(made, self.problems)
        for phase, robot in zip(made.phases, robots, strict=True):
            reach.phase(phase, robot)

    def _rehearse_task(self, task: TaskPlan, phase: PhasePlan, robot: SpaceRobot, made: Scenario, held: bool) -> None:
        where = "" if task.key.startswith(phase.key) else f" (phase '{phase.name}')"
        for key, frame in (("point", task.point), ("seen_from", task.seen_from)):
            if frame is not None and frame not in robot.frame_names:
                known = closest(frame, robot.frame_names)
                self.problems.add(f"{task.key}.{key}", f"no frame '{frame}' in robot '{robot.name}'{known}{where}")
        if isinstance(task.goal, Follow):
            key = f"{task.key}.goal.follow"
            if made.target is None:
                self.problems.add(key, "there is no target to follow: give a table [target]")
            elif held:
                self.problems.add(key, f"the target is held already{where or f' in phase {phase.name!r}'}")
            else:
                self._frame(key, task.goal.frame, made.target.robot)
        if self.problems.found:
            return
        try:
            task.task(robot).rows(robot)
        except OspaceError as error:
            self.problems.add(task.key, str(error) + where)

    def _rehearse_grasp(self, plan: GraspPlan, key: str, made: Scenario, held: bool) -> SpaceRobot | None:
        if made.target is None:
            self.problems.add(key, "there is no target to grasp: give a table [target]")
            return None
        if held:
            self.problems.add(key, "the target is held already")
            return None
        hand = self._frame(f"{key}.hand", plan.hand, made.robot)
        fixture = self._frame(f"{key}.fixture", plan.fixture, made.target.robot)
        if not (hand and fixture):
            return None
        try:
            hand_point, fixture_point = made.robot.point(plan.hand), made.target.robot.point(plan.fixture)
            q = made.target.q.copy()  # the target where it will be: at the hand
            there = made.start.placement(hand_point) * made.target.placement(fixture_point).inverse()
            q[:7] = pin.SE3ToXYZQUAT(there * made.target.robot.base_pose(q))
            target = made.target.robot.state(q, made.target.v)
            return grasp(made.start, hand_point, target, fixture_point).state.robot
        except OspaceError as error:
            self.problems.add(key, str(error))
            return None

    def _frame(self, key: str, frame: str, robot: SpaceRobot) -> bool:
        known = frame in robot.frame_names
        if not known:
            self.problems.add(key, f"no frame '{frame}' in robot '{robot.name}'{closest(frame, robot.frame_names)}")
        return known


def _slides(robot: SpaceRobot, joint: str) -> bool:
    return robot.model.joints[2 + robot.joint_names.index(joint)].shortname() in _SLIDING


def _whole(time: float, step: float) -> bool:
    count = time / step
    return round(count) >= 1 and abs(count - round(count)) <= _WHOLE * max(1.0, count)

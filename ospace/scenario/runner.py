"""Phase after phase: controllers in their order, the target by itself beside them, grasps and releases between."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from ospace.control import Controller, Function, Task
from ospace.control.controller import Limiting
from ospace.control.references import Reference
from ospace.kernels.tree import Floats
from ospace.model.base_displacement import base_displacement
from ospace.model.layout import Layout
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.scenario.clearance import clearances
from ospace.scenario.cycle_log import CycleLog
from ospace.scenario.disturbances import Disturbances
from ospace.scenario.goals import Start
from ospace.scenario.holds import Hold, frames_when_held, parts
from ospace.scenario.mass_errors import believed
from ospace.scenario.motion import FreeMotion
from ospace.scenario.result import Contact, FreeTarget, Outcome, PhaseResult, Run, Segment, worst
from ospace.scenario.schema import ROBOT, Follow, GraspTable, PhaseTable, Scenario
from ospace.simulation import Actuation, Certificate, CommandLike, Conserved, Grasp, Trajectory, grasp, simulate
from ospace.simulation.certificate import relative
from ospace.simulation.delay_line import DelayLine
from ospace.simulation.errors import SimulationError
from ospace.simulation.moving_frame import MovingFrame
from ospace.simulation.sensor_noise import Sensors

_ROUNDING = 1e-9
_GRASP_LIMIT = 1e-9
"""Of momentum and energy in a grasp, relative to their scales."""


_QV = tuple[Floats, Floats]
"""q and v."""


class States(NamedTuple):
    """States at one time: of robot and targets, each by itself, and of the robot together with what it holds."""

    robot: State
    targets: Mapping[str, State]
    combined: State


Moment = Callable[[], States]


def run(
    scenario: Scenario,
    progress: Callable[[float], None] | None = None,
    watch: Callable[[float, Moment], None] | None = None,
) -> Run:
    """Run a scenario.

    Parameters
    ----------
    scenario : Scenario
    progress : function, optional
        Called with the simulated time after each step, s; Ctrl-C may be raised in it.
    watch : function, optional
        Called with the simulated time before each control cycle, s, and with what returns the states then; likewise.

    Returns
    -------
    Run
        Also where a phase timed out, the simulation failed, or Ctrl-C ended it: its `phases` tell.
    """
    return _ScenarioRunner(scenario, progress or (lambda time: None), watch).run()


class _Phase:
    """A phase on its way.

    Parameters
    ----------
    plan : PhaseTable
    scenario : Scenario
    start : Start
        As it was measured, of the robot as the controller knows it.
    robot : SpaceRobot
        As it is.
    shared : dict of str to Reference
        Of tasks of all phases, by name.
    """

    def __init__(
        self, plan: PhaseTable, scenario: Scenario, start: Start, robot: SpaceRobot, shared: dict[str, Reference]
    ) -> None:
        self.plan, self.first, self.period = plan, start.cycle, start.period
        references: list[Reference | None] = []
        for one in plan.tasks:
            own = plan.owns(one)
            reference = start.reference(one) if own else shared.get(one.name)
            if reference is None:
                reference = start.reference(one)
            if not own and reference is not None:
                shared[one.name] = reference
            references.append(reference)
        self._ways: list[Callable[[float], Any]] = [one.motion for one in references if isinstance(one, Function)]

        def tasks_of(robot: SpaceRobot) -> list[Task]:
            return [one.task(robot, reference) for one, reference in zip(plan.tasks, references, strict=True)]

        tasks = tasks_of(start.robot)
        self.controller: Controller | None = None
        self._truth: Controller | None = None
        if tasks:
            kept = clearances(scenario, plan, start.robot, start.targets, start.period)
            self._ways += [obstacle.motion for one in kept for obstacle in one.obstacles]
            inequalities = [*(one.make(start.robot) for one in plan.inequalities), *kept]
            self.controller = _controller(start.robot, tasks, scenario, inequalities)
            self.controller.warm_up()
            if scenario.noise.any or start.robot is not robot:
                tasks = tasks_of(robot)
                self._truth = _controller(robot, tasks, scenario)
        self._clearance = scenario.limits.clearance
        self._awaited = [task.name for task in tasks if task.completion is not None]
        self._earliest = plan.earliest
        self._nothing = Actuation(np.zeros(robot.n_joints))
        self.cycles = CycleLog(robot, tasks)
        self.outcome: Outcome | None = None

    def update(self, cycle: int, time: float, measured: _QV, actual: _QV) -> CommandLike:
        """Return the command of a cycle."""
        command = self._command(time, measured, actual)
        elapsed = (cycle + 1 - self.first) * self.period  # when this command has acted
        if elapsed >= self._earliest - _ROUNDING and not self._open():
            self.outcome = "complete"
        elif elapsed >= self.plan.timeout - _ROUNDING:
            self.outcome = "timed out"
        return command

    def _command(self, time: float, measured: _QV, actual: _QV) -> CommandLike:
        if self.controller is None:
            self.cycles.coast(time)
            return self._nothing
        for way in self._ways:
            way(time)  # where a target moves to is computed ahead, and no part of the control cycle
        command = self.controller.update(time, *measured)
        truth = command if self._truth is None else self._truth.update(time, *actual)
        self.cycles.record(time, actual[0], command, truth)
        return command

    def _open(self) -> list[str]:
        """Return the tasks that are still to be completed."""
        controller = self.controller
        return [] if controller is None else [one for one in self._awaited if not controller.completed(one)]

    def result(self, segment: int, end: float) -> PhaseResult:
        """Return its outcome so far."""
        outcome = self.outcome or "interrupted"
        reason = ""
        if outcome == "timed out":
            open_ = ", ".join(self._open()) or "its motions take longer"
            reason = f"not complete after {self.plan.timeout:g} s: {open_}"
        cycles = self.cycles
        return PhaseResult(
            name=self.plan.name,
            segment=segment,
            start=self.first * self.period,
            end=end,
            outcome=outcome,
            reason=reason,
            time=cycles.time,
            errors=cycles.errors,
            statuses=dict(cycles.statuses),
            active_limits=dict(cycles.active_limits),
            near_singularity=dict(cycles.near_singularity),
            cycle_time=cycles.cycle_time,
            sigma_min=cycles.sigma_min,
            poses=cycles.poses,
            shortfalls=dict(cycles.shortfalls),
            most_short=cycles.most_short,
            separation=cycles.separation(self._clearance),
        )


def _controller(
    robot: SpaceRobot, tasks: list[Task], scenario: Scenario, inequalities: Sequence[Limiting] = ()
) -> Controller:
    limits = scenario.limits.of(robot, scenario.robot)
    return Controller(
        robot, tasks, base=scenario.base, limits=limits, inequalities=inequalities, **scenario.control.settings
    )


class _ScenarioRunner:
    def __init__(
        self,
        scenario: Scenario,
        progress: Callable[[float], None],
        watch: Callable[[float, Moment], None] | None,
    ) -> None:
        self.scenario, self.progress, self.watch = scenario, progress, watch
        self.period, self.step = scenario.control.period, scenario.control.step
        self.ticks = round(self.period / self.step)
        self.delay = round(scenario.control.delay / self.step)
        self.commands = DelayLine(self.delay)
        self.robot, self.state = scenario.robot, scenario.start
        self.known = self._believed(scenario.robot, ROBOT)
        self.cycle = 0
        self.free = {name: self._free(name, target.start) for name, target in scenario.targets.items()}
        self.holds: list[Hold] = []
        self.wheels = np.zeros(3)
        self.shared: dict[str, Reference] = {}
        self.results: list[PhaseResult] = []
        self.segments: list[Segment] = []
        self.certificates: list[Certificate] = []
        self.acts: list[Conserved] = []
        self.interrupted = False

    def run(self) -> Run:
        began = clock.perf_counter()
        plans = list(self.scenario.phases)
        try:
            while plans:
                segment = [plans.pop(0)]
                while plans and not segment[-1].changes_robot:
                    segment.append(plans.pop(0))
                if not self._segment(segment) or not self._act(segment[-1]):
                    break
        except KeyboardInterrupt:  # between segments; within one the trajectory reports it
            self.interrupted = True
        for target in self.free.values():
            self.certificates += target.certificates
        certificate = worst([*self.certificates, Certificate(tuple(self.acts))])
        return Run(
            self.scenario,
            tuple(self.results),
            tuple(plan.name for plan in self.scenario.phases[len(self.results) :]),
            tuple(self.segments),
            certificate,
            clock.perf_counter() - began,
            self.interrupted,
        )

    def states(self, cycle: int, q: Floats, v: Floats) -> States:
        """Return the states at a cycle, of which (q, v) is the controlled robot's."""
        state = self.robot.state(q, v)
        chaser, held = parts(self.holds, q, v) if self.holds else (state, {})
        return States(chaser, {name: target.state(cycle) for name, target in self.free.items()} | held, state)

    def _free(self, name: str, state: State) -> FreeMotion:
        """Return a target as it moves by itself from `state` on."""
        robot, control = self.scenario.targets[name].robot, self.scenario.control
        pushes = {one: robot.point(one.point) for one in self.scenario.disturbances_of(name)}
        disturbances = Disturbances(pushes, control.step)
        return FreeMotion(robot, state, self.cycle, control.period, control.step, control.integrator, disturbances)

    def _disturbances(self) -> Disturbances:
        """Return those that act on the robot, and on what it holds."""
        scenario, robot = self.scenario, self.robot
        points = {one: robot.point(one.point) for one in scenario.disturbances_of(ROBOT)}
        for hold in self.holds:
            points |= {one: robot.point(hold.frames[one.point]) for one in scenario.disturbances_of(hold.target)}
        return Disturbances(points, self.step)

    # -- one segment -----------------------------------------------------------------------------------------

    def _segment(self, plans: list[PhaseTable]) -> bool:
        """Run the phases up to the next grasp or release; return whether all are complete."""
        robot = self.robot
        disturbances = self._disturbances()
        sequencer = _PhaseSequencer(self, robot, plans, disturbances)
        cycles = sum(math.ceil(plan.timeout / self.period - _ROUNDING) for plan in plans)
        failure, first = "", self.cycle
        disturbances.begin(first * self.period)
        try:
            trajectory = simulate(
                robot,
                self.state.q,
                self.state.v,
                sequencer,
                duration=cycles * self.ticks * self.step,
                step=self.step,
                period=self.step if self.delay else self.period,
                integrator=self.scenario.control.integrator,
                wrenches=disturbances.wrenches,
                wheel_momentum=self.wheels,
                start=first * self.period,
                on_step=sequencer.stepped,
            )
        except SimulationError as error:
            trajectory, failure = error.trajectory, str(error)
        phases = sequencer.phases
        end = float(trajectory.time[-1])
        self.cycle = first + (len(trajectory) - 1) // self.ticks
        self.segments.append(self._recorded(robot, trajectory, first))
        self.certificates.append(trajectory.certificate())
        self.wheels = trajectory.wheel_momentum[-1]
        self.interrupted = trajectory.interrupted
        segment = len(self.segments) - 1
        for k, phase in enumerate(phases):
            if phase.cycles:
                over = k + 1 < len(phases) and phases[k + 1].cycles
                result = phase.result(segment, phases[k + 1].first * self.period if over else end)
                result = replace(result, base_motion=base_motion(trajectory, result.time))
                if failure and phase.outcome is None:
                    result = replace(result, outcome="failed", reason=failure)
                self.results.append(result)
        begun = [phase for phase in phases if phase.cycles]
        going_on = not begun or begun[-1].outcome == "complete"
        if (failure or trajectory.interrupted) and going_on and len(begun) < len(plans):
            self.results.append(_nothing(plans[len(begun)], segment, end, failure))
        if failure or trajectory.interrupted:
            return False
        self.state = robot.state(trajectory.q[-1], trajectory.v[-1])
        return len(phases) == len(plans) and phases[-1].outcome == "complete"

    def _recorded(self, robot: SpaceRobot, trajectory: Trajectory, first: int) -> Segment:
        times = np.arange(first, self.cycle + 1, dtype=np.float64) * self.period
        targets = tuple(
            FreeTarget(name, self.scenario.targets[name].robot, times, *target.states(first, self.cycle + 1))
            for name, target in self.free.items()
        )
        return Segment(robot, trajectory, targets, tuple(self.holds))

    # -- between segments ------------------------------------------------------------------------------------

    def _act(self, plan: PhaseTable) -> bool:
        """Do what ends a phase; return whether the run can go on."""
        if plan.release:
            hold = self.holds.pop()
            self.state, target = hold.grasp.release(self.state.q, self.state.v)
            self._becomes(hold.before, hold.known_before)
            self.free[hold.target] = self._free(hold.target, target)
            for task in (task for phase in self.scenario.phases for task in phase.tasks):
                goal = task.followed
                if isinstance(goal, Follow) and self.scenario.target_named(goal.target) == hold.target:
                    self.shared.pop(task.name, None)  # it followed the target as it moved before the grasp
        elif plan.grasp is not None:
            return self._grasp(plan.grasp)
        return True

    def _grasp(self, plan: GraspTable) -> bool:
        name = self.scenario.target_named(plan.target)
        free = self.free[name]
        chaser, target = self.state, free.state(self.cycle)
        held = grasp(chaser, self.robot.point(plan.hand), target, free.robot.point(plan.fixture))
        last = self.results[-1]
        self.results[-1] = replace(last, grasp=Contact.of(held))
        if held.position_error > plan.position or held.angle_error > plan.angle:
            off = f"{held.position_error * 1e3:.4g} mm and {math.degrees(held.angle_error):.4g} deg"
            reason = (
                f"'{plan.hand}' is {off} from '{plan.fixture}': "
                f"a grasp needs {plan.position * 1e3:g} mm and {math.degrees(plan.angle):g} deg"
            )
            self.results[-1] = replace(self.results[-1], outcome="failed", reason=reason)
            return False
        self.acts += conserved_in_grasp(chaser, target, held, self.cycle * self.period)
        self.certificates += free.certificates
        robot = self.scenario.targets[name].robot
        self.holds.append(Hold(name, held, self.robot, self.known, frames_when_held(robot, self.robot)))
        self._becomes(held.robot, self._held_known(plan, chaser, self._believed(robot, name), target) or held.robot)
        self.state = held.state
        del self.free[name]
        return True

    def _believed(self, robot: SpaceRobot, of: str) -> SpaceRobot:
        """Return a robot as the controller knows it."""
        return believed(robot, [one for one in self.scenario.mass_errors if one.of == of])

    def _held_known(
        self, plan: GraspTable, chaser: State, target_known: SpaceRobot, target: State
    ) -> SpaceRobot | None:
        """Return the combined robot as the controller knows it; None where it knows it as it is."""
        if not self.scenario.mass_errors:
            return None
        known = self.known, target_known
        states = [robot.state(one.q, one.v) for robot, one in zip(known, (chaser, target), strict=True)]
        return grasp(states[0], known[0].point(plan.hand), states[1], known[1].point(plan.fixture)).robot

    def _becomes(self, robot: SpaceRobot, known: SpaceRobot) -> None:
        """Change the robot, and how it is known; commands on their way go on to joints that it still has."""
        torque = dict.fromkeys(robot.rate_names, 0.0)
        before, self.robot, self.known = self.robot, robot, known

        def converted(command: CommandLike) -> Actuation:
            known = torque | dict(zip(before.rate_names, command.torque, strict=True))
            return Actuation(np.array([known[name] for name in torque]), command.base_wrench, command.wheel_torque)

        self.commands.convert(converted)


def base_motion(trajectory: Trajectory, times: Floats) -> Floats:
    """Return how far the base has shifted (m) and turned (rad) since the first of `times`, at each of them (N, 2)."""
    records = np.searchsorted(trajectory.time, times - _ROUNDING)
    return base_displacement(trajectory.q[np.minimum(records, len(trajectory) - 1), :7])


def _nothing(plan: PhaseTable, segment: int, time: float, failure: str) -> PhaseResult:
    """Return the result of a phase without a cycle."""
    outcome: Outcome = "failed" if failure else "interrupted"
    return PhaseResult(plan.name, segment, time, time, outcome, failure, np.zeros(0), {}, {}, {}, {}, np.zeros(0))


class _PhaseSequencer:
    """The controller of a segment: hands over from phase to phase."""

    def __init__(
        self, runner: _ScenarioRunner, robot: SpaceRobot, plans: list[PhaseTable], disturbances: Disturbances
    ) -> None:
        self._runner, self._robot, self._plans, self._disturbances = runner, robot, plans, disturbances
        self._cycle, self._steps = runner.cycle, 0
        self._first_step = runner.cycle * runner.ticks
        self._sensors = Sensors(robot, runner.scenario.noise.of(robot, runner.scenario.robot, len(runner.segments)))
        self._nothing = Actuation(np.zeros(robot.n_joints))
        self._wheels = runner.wheels
        self.phases: list[_Phase] = []
        self._over = False

    def update(self, time: float, q: Floats, v: Floats) -> CommandLike:
        """Return what acts now: once a control cycle, or each step where commands act late."""
        runner = self._runner
        if not runner.delay:
            return self._command(time, q, v)
        k = self._first_step + self._steps
        if self._steps % runner.ticks == 0:
            runner.commands.put(k, self._command(time, q, v))
        return runner.commands.acting(k) or self._nothing

    def _command(self, time: float, q: Floats, v: Floats) -> CommandLike:
        """Return the command of a control cycle."""
        runner, measured = self._runner, self._sensors.measure(q, v)
        if not self.phases or self.phases[-1].outcome == "complete":
            start = Start(runner.known, *measured, self._cycle, runner.period, runner.free)
            phase = _Phase(self._plans[len(self.phases)], runner.scenario, start, self._robot, runner.shared)
            if phase.controller is not None:
                phase.controller.wheel_momentum = self._wheels
            self.phases.append(phase)
        if runner.watch is not None:
            runner.watch(time, lambda: runner.states(self._cycle, q, v))
        phase = self.phases[-1]
        command = phase.update(self._cycle, time, measured, (q, v))
        if phase.controller is not None:
            self._wheels = phase.controller.wheel_momentum
        self._cycle += 1
        self._over = phase.outcome == "timed out" or (
            phase.outcome == "complete" and len(self.phases) == len(self._plans)
        )
        return command

    def stepped(self, time: float) -> bool:
        """End the run with the last cycle's last step."""
        self._steps += 1
        self._disturbances.begin(time)
        self._runner.progress(time)
        return self._over and self._steps % self._runner.ticks == 0


def conserved_in_grasp(chaser: State, target: State, held: Grasp, time: float) -> list[Conserved]:
    """Return how well a grasp kept the momentum of both, and accounts for the energy; seen moving with the chaser."""
    frame = MovingFrame.of(chaser)
    parts = [_momentum(*frame.from_user_frame(one.q, one.v), one.robot) for one in (chaser, target)]
    whole = _momentum(*frame.from_user_frame(held.state.q, held.state.v), held.robot)
    before = parts[0][0] + parts[1][0]
    energy = parts[0][1] + parts[1][1]
    mass = held.robot.total_mass
    scale = math.sqrt(2.0 * mass * energy)
    error = relative(np.abs(whole[0] - before), scale).max()
    (lost,) = relative(np.abs([energy - whole[1] - held.energy_lost]), energy)
    return [
        Conserved("grasp momentum", float(error), _GRASP_LIMIT, scale, "kg m/s", time),
        Conserved("grasp energy", float(lost), _GRASP_LIMIT, energy, "J", time),
    ]


def _momentum(q: Floats, v: Floats, robot: Layout) -> tuple[Floats, float]:
    """Return linear momentum and angular momentum about the frame's origin (6,), and kinetic energy."""
    data = robot.model.createData()
    hg = pin.computeCentroidalMomentum(robot.model, data, q, v)
    p = np.array(hg.linear)
    return np.concatenate([p, hg.angular + np.cross(data.com[0], p)]), float(
        pin.computeKineticEnergy(robot.model, data, q, v)
    )

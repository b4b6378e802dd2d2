"""Results of a run of a scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, Literal

import numpy as np

from ospace.extras import require
from ospace.kernels.tree import Floats
from ospace.model.joint_positions import unit_of
from ospace.model.robot import SpaceRobot
from ospace.results import Result
from ospace.scenario.holds import Hold
from ospace.scenario.run_table import run_columns
from ospace.scenario.schema import LimitsTable, Scenario
from ospace.simulation import Certificate, Conserved, Excess, Grasp, Trajectory

Outcome = Literal["complete", "timed out", "interrupted", "failed"]
_ROUNDING = {"torque": 1e-8, "position": 1e-6, "velocity": 1e-6}
"""Tolerance beyond a limit, relative to the larger of it and 1; of positions, rad or m."""
_UNITS = {"torque": {"rad": "N m", "m": "N"}, "velocity": {"rad": "rad/s", "m": "m/s"}}
BASE = "base"
"""Name of the base-link frame's origin among points."""


@dataclass(frozen=True, eq=False)
class TaskErrors(Result):
    """Errors of one task at every cycle of a phase.

    Attributes
    ----------
    norms : (N, 2)
        Of the linear rows and of the angular ones or of the joints; NaN where it has none.
    units : tuple of 2 str
    points : tuple of str
        What the task is about, by its names in `PhaseResult.poses`; none for tasks of joints or of the whole robot.
    """

    norms: Floats
    units: tuple[str, str]
    points: tuple[str, ...] = ()

    @property
    def worst(self) -> Floats:
        """The largest of each (2,)."""
        worst: Floats = self.norms.max(axis=0)
        return worst

    @property
    def last(self) -> Floats:
        """Those of the last cycle (2,)."""
        last: Floats = self.norms[-1]
        return last


@dataclass(frozen=True, eq=False)
class Contact(Result):
    """Impulse, loss and errors of a grasp.

    Attributes
    ----------
    impulse : (6,)
        As of `ospace.simulation.Grasp`, like all the others.
    energy_lost : float
        J.
    position_error, angle_error : float
        m, rad.
    velocity_error : (6,)
        m/s, rad/s.
    """

    impulse: Floats
    energy_lost: float
    position_error: float
    angle_error: float
    velocity_error: Floats

    @classmethod
    def of(cls, held: Grasp) -> Contact:
        """Take the numbers of a grasp.

        Parameters
        ----------
        held : Grasp

        Returns
        -------
        Contact
        """
        return cls(**{one.name: getattr(held, one.name) for one in fields(cls)})


@dataclass(frozen=True, eq=False)
class Separation(Result):
    """Smallest distance of links that keep a clearance from each other and from the target.

    Attributes
    ----------
    clearance : float
        That was to be kept, m.
    distance : (N,)
        The smallest of all at each cycle, m; negative where links overlap.
    closest : mapping of str to float
        The smallest of each pair of links that was the nearest one at a time, by ``'left_hand / head'``; the smallest
        first, m.
    """

    clearance: float
    distance: Floats
    closest: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class PhaseResult(Result):
    """Outcome of a phase.

    Attributes
    ----------
    name : str
    segment : int
        Which of the run's segments it is part of.
    start, end : float
        s.
    outcome : "complete", "timed out", "interrupted" or "failed"
    reason : str
        Why it did not complete.
    time : (N,)
        Of the control cycles, s.
    errors : mapping of task name to TaskErrors
    statuses : mapping of status to int
        Cycles by `Command.status`.
    active_limits : mapping of str to int
        Cycles in which each limit was active, by ``'joint: kind, side'``.
    near_singularity : mapping of task name to int
        Cycles in which the task was near a dynamic singularity.
    cycle_time : (N,)
        What each control cycle took, s.
    sigma_min : mapping of task name to (N,)
        Smallest singular value of the generalized Jacobian J_m* of each task about points, joints alone.
    poses : mapping of str to (N, 7)
        Of each point that a task is about: place (m) and quaternion x, y, z, w, inertial axes, by Pinocchio's forward
        kinematics. The base is not among them: its pose is the first seven numbers of q.
    base_motion : (N, 2)
        Shift (m) and turn (rad) of the base-link frame since the first cycle, whether or not a task holds it.
    grasp : Contact, optional
        That ended it.
    shortfalls : mapping of str to int
        Cycles in which a task fell short of its reference, by why, as ``'out of reach: hand'``.
    most_short : mapping of str to str
        By how much at most, by why, as ``'0.56 m short along (0.93, 0, 0.37)'``.
    separation : Separation, optional
        How near links came to each other, where a clearance was kept.
    """

    name: str
    segment: int
    start: float
    end: float
    outcome: Outcome
    reason: str
    time: Floats
    errors: Mapping[str, TaskErrors]
    statuses: Mapping[str, int]
    active_limits: Mapping[str, int]
    near_singularity: Mapping[str, int]
    cycle_time: Floats
    sigma_min: Mapping[str, Floats] = field(default_factory=dict)
    poses: Mapping[str, Floats] = field(default_factory=dict)
    base_motion: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    grasp: Contact | None = None
    shortfalls: Mapping[str, int] = field(default_factory=dict)
    most_short: Mapping[str, str] = field(default_factory=dict)
    separation: Separation | None = None


@dataclass(frozen=True, eq=False)
class FreeTarget(Result):
    """A target that moves by itself.

    Attributes
    ----------
    name : str
    robot : SpaceRobot
    time : (M,)
        s.
    q, v : (M, nq), (M, nv)
        As of `SpaceRobot.state`.
    """

    name: str
    robot: SpaceRobot
    time: Floats
    q: Floats
    v: Floats


@dataclass(frozen=True, eq=False)
class Segment(Result):
    """Part of a run with one and the same robot: from its start, a grasp or a release to the next.

    Attributes
    ----------
    robot : SpaceRobot
        The chaser, or chaser and target combined.
    trajectory : Trajectory
    targets : tuple of FreeTarget
        Those that move by themselves.
    holds : tuple of Hold
        By which `robot` is chaser and targets combined, in the order in which they were grasped.
    """

    robot: SpaceRobot
    trajectory: Trajectory
    targets: tuple[FreeTarget, ...] = ()
    holds: tuple[Hold, ...] = ()


class Verdict:
    """Verdict on phases and certificate, of a run as of its log."""

    phases: tuple[PhaseResult, ...]
    not_begun: tuple[str, ...]
    certificate: Certificate
    interrupted: bool

    @property
    def complete(self) -> bool:
        """True where all phases are complete."""
        done = all(phase.outcome == "complete" for phase in self.phases)
        return done and not self.not_begun and not self.interrupted

    @property
    def passed(self) -> bool:
        """True where all phases are complete and the certificate passed."""
        return self.complete and self.certificate.passed

    @property
    def duration(self) -> float:
        """Simulated time, s."""
        return self.phases[-1].end if self.phases else 0.0


@dataclass(frozen=True, eq=False)
class Run(Verdict):
    """A scenario that was run.

    Attributes
    ----------
    scenario : Scenario
    phases : tuple of PhaseResult
        Those that began.
    not_begun : tuple of str
        Names of the others.
    segments : tuple of Segment
    certificate : Certificate
        The worst of all segments, of the target by itself, and of grasps.
    seconds : float
        Wall time.
    interrupted : bool
        Ctrl-C ended it.
    """

    scenario: Scenario
    phases: tuple[PhaseResult, ...]
    not_begun: tuple[str, ...]
    segments: tuple[Segment, ...]
    certificate: Certificate
    seconds: float
    interrupted: bool = False

    def as_dict(self) -> dict[str, Any]:
        """Return its records as the columns of one tidy table, over all segments.

        Returns
        -------
        dict of str to (N,) array
            By heading with its unit: time, phase, segment, all of `Trajectory.as_dict`, and errors of tasks at control
            cycles; NaN where a segment or a phase has no such thing.
        """
        return run_columns(self)

    def to_dataframe(self) -> Any:
        """Return its records as a data frame of pandas, which has to be installed.

        Returns
        -------
        pandas.DataFrame
            A row for each record, the columns of `as_dict`.

        Raises
        ------
        OspaceError
            pandas is not installed.
        """
        require("pandas", "a data frame")
        import pandas

        return pandas.DataFrame(self.as_dict())

    def __repr__(self) -> str:
        return f"Run('{self.scenario.name}', {outcomes(self)})"

    @property
    def exceeded(self) -> dict[str, Excess]:
        """Limits of joints that the motion passed, by ``'joint: kind'``, and how far at most."""
        found: dict[str, Excess] = {}
        for segment in self.segments:
            for name, excess in _exceeded(segment, self.scenario.limits, self.scenario.robot).items():
                if name not in found or excess.amount > found[name].amount:
                    found[name] = excess
        return found


def outcomes(run: Verdict) -> str:
    """Return the phases and how they ended, and the verdict."""
    phases = ", ".join(f"{phase.name} {phase.outcome}" for phase in run.phases)
    missing = f", not begun: {', '.join(run.not_begun)}" if run.not_begun else ""
    verdict = "passed" if run.passed else "interrupted" if run.interrupted else "failed"
    return f"{run.duration:.6g} s: {phases}{missing}; {verdict}"


def _exceeded(segment: Segment, plan: LimitsTable, actuated: SpaceRobot) -> dict[str, Excess]:
    robot, run, limits = segment.robot, segment.trajectory, plan.of(segment.robot, actuated)
    driven = set(actuated.joint_names)
    found = {
        f"{joint}: position": excess
        for joint, excess in run.outside_limits.items()
        if joint in driven and excess.amount > _ROUNDING["position"]
    }
    for kind, values, most in (("torque", run.torque, limits.torque), ("velocity", run.v[:, 6:], limits.velocity)):
        past = np.abs(values) - most
        for j in range(2, robot.model.njoints):
            first = robot.model.idx_vs[j] - 6
            own = past[:, first : first + robot.model.nvs[j]]
            if own.shape[1] == 0:
                continue
            size = np.where(np.isfinite(most), np.maximum(1.0, most), 1.0)[first : first + own.shape[1]]
            k, c = np.unravel_index(int(np.argmax(own)), own.shape)
            if own[k, c] > _ROUNDING[kind] * size[c]:
                unit = _UNITS[kind][unit_of(robot.model.joints[j])]
                found[f"{robot.model.names[j]}: {kind}"] = Excess(float(own[k, c]), unit, float(run.time[k]))
    return found


def worst(certificates: list[Certificate]) -> Certificate:
    """Return for each quantity the one that is the worst for its limit; what cannot be computed is the worst of all.

    What came from outside is the most that any of them says.
    """
    by_name: dict[str, Conserved] = {}
    given: dict[str, float] = {}
    for certificate in certificates:
        for one in certificate.quantities:
            known = by_name.get(one.name)
            given[one.name] = max(given.get(one.name, 0.0), one.given)
            if known is None or _badness(one) > _badness(known):
                by_name[one.name] = one
    return Certificate(tuple(replace(one, given=given[name]) for name, one in by_name.items()))


def _badness(one: Conserved) -> float:
    badness = one.error / one.limit
    return badness if math.isfinite(badness + one.scale) else math.inf

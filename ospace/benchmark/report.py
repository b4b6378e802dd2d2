"""Everything that `ospace bench` measures, and what it was measured on."""

from __future__ import annotations

import os
import platform
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import llvmlite
import numba
import numpy as np
import pinocchio as pin

import ospace
from ospace.benchmark import codegen, pinocchio_baseline, scaling
from ospace.benchmark.pinocchio_baseline import TimedComparison
from ospace.benchmark.scaling import Scaling
from ospace.benchmark.timing import WINDOWS, Ratio, States, Tick, window_times
from ospace.dynamics.batch import operational_space_batch
from ospace.dynamics.operational_space import operational_space
from ospace.exceptions import OspaceError
from ospace.kernels.jit import simd
from ospace.kernels.tree import Floats
from ospace.model.robot import SpaceRobot
from ospace.validation.sampling import random_state

POINTS = (1, 2, 3, 4, 6)
STATES = 32
BATCH_POINTS = 3
GENERATED_POINTS = 3
"""C of more points takes minutes to compile."""


@dataclass(frozen=True)
class Row:
    """One state a call: one quantity of p points.

    Attributes
    ----------
    quantity : str
    points : int
    called : str
        Pinocchio's way.
    times : Ratio
    """

    quantity: str
    points: int
    called: str
    times: Ratio


@dataclass(frozen=True)
class BatchRow:
    """Γ_e⁻¹ of many states a call, against a Python loop over pin.computeDelassusMatrix; times of one state.

    Attributes
    ----------
    output : str
        What is written, and whether to new arrays.
    states : int
    threads : int
    points : int
    times : Ratio
    """

    output: str
    states: int
    threads: int
    points: int
    times: Ratio


@dataclass(frozen=True)
class Benchmark:
    """The result.

    Attributes
    ----------
    machine : dict
        Processor, its count, the vector width in doubles, Python, packages, threads of the linear algebra.
    robot : str
    degrees_of_freedom : int
    states, windows : int
        States that calls rotate over, and windows of time that the ways take turns in.
    rows, batch, growth : tuples of Row, BatchRow, Scaling
    """

    machine: dict[str, Any]
    robot: str
    degrees_of_freedom: int
    states: int
    windows: int
    rows: tuple[Row, ...]
    batch: tuple[BatchRow, ...]
    growth: tuple[Scaling, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON takes it."""
        return asdict(self)


@dataclass(frozen=True)
class Plan:
    """Comparisons to time on a robot, found to give the same numbers both ways.

    Attributes
    ----------
    robot : SpaceRobot
    states : sequence of (q, v)
    comparisons : tuple of (p, TimedComparison)
    sizes : tuple of int
        Degrees of freedom of the robots of the growth table.
    """

    robot: SpaceRobot
    states: States
    comparisons: tuple[tuple[int, TimedComparison], ...]
    sizes: tuple[int, ...] = scaling.SIZES

    @property
    def turns(self) -> int:
        """Number of times that `run` calls its `tick`."""
        return WINDOWS * (len(self.comparisons) + len(_BATCHES) + len(scaling.SHAPES) * len(self.sizes))


def prepare(robot: SpaceRobot, largest: int | None = None, generate_from: Path | None = None) -> Plan:
    """Choose points, up to `largest` at once, and compare the results of both ways.

    With `generate_from`, the robot's URDF file, Γ_e⁻¹ of up to three points is compared with generated C as well.
    Γ_e is left out where the rows of the points depend on each other, since Pinocchio's way has no inverse then.

    Raises
    ------
    OspaceError
        The robot has fewer moving links than `largest`, or none; joints of it mimic others; or the two ways do not give
        the same numbers.
    """
    if robot.free is not None:
        raise OspaceError(
            f"joints of robot '{robot.name}' mimic others, and Pinocchio's fast algorithms know none of these: "
            f"compare them as independent joints (--free-mimic)"
        )
    movable = robot.model.njoints - 2
    most = min(largest or POINTS[-1], movable)
    if movable == 0 or (largest is not None and largest > movable):
        raise OspaceError(f"robot '{robot.name}' has {movable} moving links to put points on, not {largest or 1}")
    counts = sorted({count for count in POINTS if count <= most} | {most})
    rng = np.random.default_rng(0)
    drawn = [random_state(robot, rng) for _ in range(STATES)]
    states = [(np.array(state.q), np.array(state.v)) for state in drawn]
    comparisons = []
    for make in pinocchio_baseline.COMPARISONS:
        for count in counts:
            points = pinocchio_baseline.spread_points(robot, count)
            independent = operational_space(drawn[0], points).rank == 6 * count
            if make is pinocchio_baseline.read_only_input and count != counts[0]:
                continue  # what is given does not grow with the points
            if independent or make not in pinocchio_baseline.INVERTING:
                comparison = make(robot, points)
                comparison.check(states)
                comparisons.append((count, comparison))
    for count in counts:
        if generate_from is not None and count <= GENERATED_POINTS:
            comparison = codegen.inverse_inertia(robot, pinocchio_baseline.spread_points(robot, count), generate_from)
            comparison.check(states)
            comparisons.append((count, comparison))
    return Plan(robot, states, tuple(comparisons))


def run(plan: Plan, *, seconds: float, tick: Tick) -> Benchmark:
    """Measure all of the plan, `seconds` for each row, shared by the two ways; `tick` is called after every turn."""
    rows = []
    for count, comparison in plan.comparisons:
        times = window_times((comparison.ours, comparison.theirs), plan.states, seconds=seconds, tick=tick)
        rows.append(Row(comparison.quantity, count, comparison.called, Ratio.of(times)))
    batch = [_batch(plan, *each, seconds, tick) for each in _BATCHES]
    grown = [scaling.measure(shape, seconds=seconds, sizes=plan.sizes, tick=tick) for shape in scaling.SHAPES]
    return Benchmark(
        machine(), plan.robot.name, plan.robot.nv, STATES, WINDOWS, tuple(rows), tuple(batch), tuple(grown)
    )


_WHOLE, _LOWER = "inertia_inverse", "inertia_inverse_packed"
_BATCHES = (
    (_WHOLE, 40_960, None, True),
    (_WHOLE, 40_960, None, False),
    (_LOWER, 40_960, None, False),
    *((_WHOLE, N, 1, False) for N in (8, 64, 512, 8192)),
)
"""Output, states, threads (None: all), and whether the arrays of the results are new at each call."""


def _batch(plan: Plan, output: str, N: int, threads: int | None, fresh: bool, seconds: float, tick: Tick) -> BatchRow:
    """Time one call for many states against a loop over few of them."""
    robot, count = plan.robot, min(BATCH_POINTS, plan.robot.model.njoints - 2)
    points = pinocchio_baseline.spread_points(robot, count)
    Q = np.array([plan.states[k % STATES][0] for k in range(N)])
    written = operational_space_batch(robot, points, Q, None, (output,), threads=threads)
    out = None if fresh else {output: getattr(written, output)}

    def ours(q: Floats, v: Floats) -> None:
        operational_space_batch(robot, points, Q, None, (output,), out, threads)

    loop = pinocchio_baseline.Pinocchio(robot, points).delassus

    def theirs(q: Floats, v: Floats) -> None:
        for state, velocity in plan.states:
            loop(state, velocity)

    times = window_times((ours, theirs), plan.states[:1], seconds=seconds, tick=tick) / (N, STATES)
    name = f"{'whole' if output == _WHOLE else 'lower rows'}, {'new arrays' if fresh else 'out='}"
    return BatchRow(name, N, threads or os.cpu_count() or 1, count, Ratio.of(times))


def machine() -> dict[str, Any]:
    """Return what the times were measured on."""
    return {
        "processor": _processor(),
        "processors": os.cpu_count(),
        "lanes": simd.widest(),
        "python": platform.python_version(),
        **{module.__name__: module.__version__ for module in (ospace, pin, numba, llvmlite, np)},
        "linear_algebra_threads": os.environ.get("OPENBLAS_NUM_THREADS", "not set"),
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()

"""Operational-space dynamics of many states at once: one state in each lane of the processor, chunks over its cores."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
import pinocchio as pin
from scipy.spatial.transform import Rotation

from ospace.checks import check_kind, checked_names, real_numbers
from ospace.dynamics.evaluator import BITS, OperationalSpaceEvaluator
from ospace.dynamics.generalized_jacobian import base_generalized_jacobian, centre_of_mass
from ospace.dynamics.workspace import layout_of, wanted_of
from ospace.exceptions import OspaceError
from ospace.kernels import batch as kernel
from ospace.kernels import evaluation, singular_values, workspace
from ospace.kernels.jit import simd
from ospace.kernels.tree import Floats
from ospace.model.points import OperationalPoint, points_of, rows_of
from ospace.model.robot import SpaceRobot
from ospace.model.state import State
from ospace.results import Result

CHUNK = 512
_BITS = {name: bits for name, bits in BITS.items() if name not in ("jacobian", "generalized_bias")}
_BITS |= {
    "inertia_inverse_packed": BITS["inertia_inverse"],
    "base_generalized_jacobian": evaluation.FLOATING_BASE,
    "singular_values": BITS["generalized_jacobian"],
    "smallest_singular_value": BITS["generalized_jacobian"],
    "centre_of_mass": evaluation.FLOATING_BASE,
    "placement": 0,
}
_OF_JACOBIAN = ("singular_values", "smallest_singular_value")
QUANTITIES = tuple(_BITS)
_NOTHING = {
    "inertia_inverse": np.empty((0, 0, 0)),
    "inertia_inverse_packed": np.empty((0, 0)),
    "inertia": np.empty((0, 0, 0)),
    "bias_acceleration": np.empty((0, 0)),
    "bias_force": np.empty((0, 0)),
    "generalized_jacobian": np.empty((0, 0, 0)),
    "generalized_inertia": np.empty((0, 0, 0)),
    "momentum": np.empty((0, 0)),
    "base_generalized_jacobian": np.empty((0, 0, 0)),
    "centre_of_mass": np.empty((0, 0)),
    "placement": np.empty((0, 0, 0)),
}


@dataclass(frozen=True)
class OperationalSpaceBatch(Result):
    """Results of many states, leading axis N; None where a quantity was not asked for.

    Rows of a state that cannot be computed hold zeros, and its number stands in `bad`.

    Attributes
    ----------
    inertia_inverse, inertia : (N, r, r)
        Γ_e⁻¹ and Γ_e.
    inertia_inverse_packed : (N, r (r + 1)/2)
        Lower rows of Γ_e⁻¹, one after the other.
    bias_acceleration, bias_force : (N, r)
        μ and μ_e.
    generalized_jacobian : (N, r, n)
        J_m*.
    generalized_inertia : (N, n, n)
        H_m*.
    base_generalized_jacobian : (N, 6, n)
        J_b*.
    singular_values : (N, min(r, n))
        Of J_m*, the largest first, each to 1e-12 of the largest.
    smallest_singular_value : (N,)
        σ_min of J_m*, the last of these: zero at a dynamic singularity, and where there is none.
    placement : (N, p, 7)
        Position (m) and quaternion x, y, z, w of each point in the inertial frame.
    centre_of_mass : (N, 3)
        Of the robot, in the inertial frame; m.
    momentum : (N, 6)
        M_0.
    bad : (k,) int array
        States with numbers that are not finite, a quaternion far from unit length, or a joint without inertia.
    """

    inertia_inverse: Floats | None = None
    inertia_inverse_packed: Floats | None = None
    inertia: Floats | None = None
    bias_acceleration: Floats | None = None
    bias_force: Floats | None = None
    generalized_jacobian: Floats | None = None
    generalized_inertia: Floats | None = None
    base_generalized_jacobian: Floats | None = None
    singular_values: Floats | None = None
    smallest_singular_value: Floats | None = None
    placement: Floats | None = None
    centre_of_mass: Floats | None = None
    momentum: Floats | None = None
    bad: npt.NDArray[np.int64] = field(default_factory=lambda: np.empty(0, dtype=np.int64))


def operational_space_batch(
    robot: SpaceRobot,
    points: OperationalPoint | Sequence[OperationalPoint],
    Q: npt.ArrayLike,
    V: npt.ArrayLike | None = None,
    quantities: Sequence[str] = ("inertia_inverse",),
    out: Mapping[str, Floats] | None = None,
    threads: int | None = None,
) -> OperationalSpaceBatch:
    """Compute operational-space quantities of many states.

    Parameters
    ----------
    robot : SpaceRobot
    points : OperationalPoint or sequence of them
        r rows in the order given.
    Q, V : (N, nq), (N, nv)
        Configurations and velocities as of `SpaceRobot.state`; velocities are zero without `V`.
    quantities : sequence of str
        Attributes of the result to compute.
    out : mapping of str to array, optional
        Arrays to write to, of the shapes above, double precision; a `numpy.memmap` keeps results that exceed memory
        on disk.
    threads : int, optional
        At most so many; else ``OSPACE_NUM_THREADS`` or ``OMP_NUM_THREADS``, else the number of processors.

    Returns
    -------
    OperationalSpaceBatch

    Raises
    ------
    OspaceError
        No point or another robot's, an unknown quantity, or arrays of the wrong shape. A bad state is no error: it is
        in `bad`, and does not touch the others.

    Notes
    -----
    Beyond the results, memory does not grow with N. States that the lanes cannot take, such as those with dependent
    rows, are computed one by one, by `OperationalSpaceEvaluator`.
    """
    check_kind(robot, SpaceRobot, "read it with SpaceRobot.from_urdf(path)")
    given = points_of(robot, points)
    quantities = checked_names(quantities, QUANTITIES, "quantity")
    if out is not None and not isinstance(out, Mapping):
        raise OspaceError("out must be a mapping of quantities to arrays")
    for name in checked_names(out or (), QUANTITIES, "quantity"):
        if name not in quantities:
            raise OspaceError(f"out has '{name}', which is not among the quantities to compute")
    Q = _states(Q, robot.nq, "Q", robot.name)
    V = np.broadcast_to(np.zeros(robot.nv), (len(Q), robot.nv)) if V is None else _states(V, robot.nv, "V", robot.name)
    if len(V) != len(Q):
        raise OspaceError(f"Q has {len(Q)} states and V has {len(V)}: give one velocity for each configuration")
    results = _arrays(robot, given, len(Q), quantities, out or {})
    lanes = simd.widest()
    work = _Work(robot, given, Q, V, results, lanes, kernel.BY_WIDTH[lanes], singular_values.BY_WIDTH[lanes])
    _over_threads(work, len(Q), _threads(threads))
    return OperationalSpaceBatch(**results, bad=np.flatnonzero(work.status != evaluation.OK))


def interpreted_batch(
    robot: SpaceRobot, points: Sequence[OperationalPoint], Q: Floats, V: Floats
) -> OperationalSpaceBatch:
    """Compute all quantities of a few states by the kernels of the batch, two states at a time and without a compiler.

    To check the batch takes a fraction of a second so, and several to compile it. The arguments are those of
    `operational_space_batch`. Where the lanes call a state bad, it is: no evaluator computes it after all, which would
    hide a mistake of theirs.
    """
    results = _arrays(robot, points, len(Q), QUANTITIES, {})
    retried = (evaluation.DEPENDENT, evaluation.FAR)
    by = _evaluate_2_interpreted, _singular_values_2_interpreted
    work = _Work(robot, tuple(points), Q, V, results, 2, *by, retried)
    _over_threads(work, len(Q), 1)
    return OperationalSpaceBatch(**results, bad=np.flatnonzero(work.status != evaluation.OK))


@np.errstate(all="ignore")  # as compiled: what is not finite is in the status
def _evaluate_2_interpreted(Q: Floats, V: Floats, memory: Floats, out: kernel.Results) -> None:
    """Run the text of the kernel that `evaluate_2` compiles."""
    kernel.evaluate_lanes(Q, V, memory, simd.zeros(2), 2, out)


def _singular_values_2_interpreted(A: Floats, memory: Floats, out: Floats) -> None:
    """Run the text of the kernel that `singular_values_2` compiles."""
    singular_values.singular_values(A, memory, simd.zeros(2), 2, out)


def _states(given: npt.ArrayLike, columns: int, name: str, robot: str) -> Floats:
    try:
        states = real_numbers(given)
    except (TypeError, ValueError):
        raise OspaceError(f"{name} is not an array of real numbers") from None
    if states.ndim != 2 or states.shape[1] != columns:
        raise OspaceError(f"{name} has shape {states.shape}; robot '{robot}' needs (N, {columns})")
    return states


def _arrays(
    robot: SpaceRobot, given: Sequence[OperationalPoint], N: int, quantities: Sequence[str], out: Mapping[str, Floats]
) -> dict[str, Floats]:
    """Return an array for each quantity, of `out` where it is given."""
    r, points = len(rows_of(given)), len(given)
    shapes: dict[str, tuple[int, ...]] = {
        "inertia_inverse": (N, r, r),
        "inertia_inverse_packed": (N, r * (r + 1) // 2),
        "inertia": (N, r, r),
        "bias_acceleration": (N, r),
        "bias_force": (N, r),
        "generalized_jacobian": (N, r, robot.n_joints),
        "generalized_inertia": (N, robot.n_joints, robot.n_joints),
        "base_generalized_jacobian": (N, 6, robot.n_joints),
        "singular_values": (N, min(r, robot.n_joints)),
        "smallest_singular_value": (N,),
        "placement": (N, points, 7),
        "centre_of_mass": (N, 3),
        "momentum": (N, 6),
    }
    results = {}
    for name in quantities:
        array = out[name] if name in out else np.zeros(shapes[name])
        fits = isinstance(array, np.ndarray) and array.shape == shapes[name] and array.dtype == np.float64
        if not fits or not (array.flags.c_contiguous and array.flags.writeable and array.flags.aligned):
            raise OspaceError(f"out['{name}'] must be a writable C-contiguous float64 array of shape {shapes[name]}")
        results[name] = array
    return results


def _threads(given: int | None) -> int:
    if given is not None:
        if not isinstance(given, int | np.integer) or given < 1:
            raise OspaceError(f"threads is {given!r}: give a whole number from 1 on")
        return int(given)
    for name in ("OSPACE_NUM_THREADS", "OMP_NUM_THREADS"):
        first = os.environ.get(name, "").partition(",")[0].strip()  # OpenMP takes a list, one for each level
        if first.isdecimal() and int(first) > 0:
            return int(first)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _over_threads(work: _Work, N: int, threads: int) -> None:
    """Run all chunks; stop soon after Ctrl-C or an error."""
    chunks = iter([slice(first, min(first + CHUNK, N)) for first in range(0, N, CHUNK)])
    stop = threading.Event()
    lock = threading.Lock()

    def consume() -> None:
        try:
            worker = _Worker(work)
            while not stop.is_set():
                with lock:
                    chunk = next(chunks, None)
                if chunk is None:
                    return
                worker.run(chunk)
        except BaseException:
            stop.set()
            raise

    _Worker(work).run(slice(0, 0))  # compiles on the thread that Ctrl-C meets
    threads = min(threads, -(-N // CHUNK))
    if threads <= 1:
        consume()
        return
    with ThreadPoolExecutor(threads) as pool:
        running = [pool.submit(consume) for _ in range(threads)]
        try:
            for one in running:
                one.result()
        finally:
            stop.set()


class _Work:
    """Arguments of every thread, and the status of every state."""

    def __init__(
        self,
        robot: SpaceRobot,
        points: tuple[OperationalPoint, ...],
        Q: Floats,
        V: Floats,
        results: Mapping[str, Floats],
        lanes: int,
        evaluate: Callable[..., None],
        take_singular_values: Callable[..., None],
        retried: tuple[int, ...] = (
            evaluation.BAD_INPUT,
            evaluation.SINGULAR,
            evaluation.DEPENDENT,
            evaluation.FAR,
        ),
    ) -> None:
        self.robot, self.points, self.Q, self.V, self.results = robot, points, Q, V, results
        self.rows = rows_of(points)
        self.status = np.full(len(Q), evaluation.BAD_INPUT, dtype=np.int64)
        self.lanes, self.evaluate, self.retried = lanes, evaluate, retried
        self.take_singular_values = take_singular_values
        self.layout = layout_of(robot, points)
        self.turns = [robot.link_axes[point.joint].T @ point.placement.rotation for point in points]
        for name in results:
            self.layout.want[0] |= _BITS[name]
        self.layout.want[0] = wanted_of(robot, int(self.layout.want[0]))


class _Worker:
    """One thread's memory."""

    def __init__(self, work: _Work) -> None:
        self.work = work
        self.memory = None
        if work.robot.own_kinematics:
            self.memory = workspace.lay_out(work.layout, work.robot.nq, work.lanes)
        self.Q, self.V = np.empty((CHUNK, work.robot.nq)), np.empty((CHUNK, work.robot.nv))
        rows = CHUNK if any(name in work.results for name in _OF_JACOBIAN) else 0
        self.jacobian = np.empty((rows, len(work.rows), work.robot.n_joints))
        self.values = np.empty((rows, min(self.jacobian.shape[1:])))
        length = singular_values.memory_length(*self.jacobian.shape[1:], work.lanes)
        self.singular_memory = np.empty(length if self.values.size else 0)
        self.placed = np.zeros((CHUNK if "placement" in work.results else 0, len(work.points), 12))

    def run(self, chunk: slice) -> None:
        """Compute one chunk, in place."""
        work, count = self.work, chunk.stop - chunk.start
        if self.memory is not None:
            parts = {name: self._part(name, chunk) for name in _NOTHING}
            out = kernel.Results(**parts, status=work.status[chunk])
            self.Q[:count], self.V[:count] = work.Q[chunk], work.V[chunk]
            work.evaluate(self.Q[:count], self.V[:count], self.memory, out)
            self._place(chunk)
        again = np.isin(work.status[chunk], work.retried) if self.memory is not None else np.ones(count, dtype=bool)
        for s in chunk.start + np.flatnonzero(again):
            work.status[s] = self._alone(int(s), chunk)
        if len(self.jacobian):
            self._take_singular_values(chunk)

    def _take_singular_values(self, chunk: slice) -> None:
        work, values = self.work, self.values[: chunk.stop - chunk.start]
        if self.values.shape[1]:
            work.take_singular_values(self._part("generalized_jacobian", chunk), self.singular_memory, values)
        if "singular_values" in work.results:
            work.results["singular_values"][chunk] = values
        if "smallest_singular_value" in work.results:
            work.results["smallest_singular_value"][chunk] = values[:, -1] if values.shape[1] else 0.0

    def _place(self, chunk: slice) -> None:
        """Turn what the lanes know of places, about the base and of links, into places of points and mass centre."""
        work, origin = self.work, self.work.Q[chunk, :3]
        if "centre_of_mass" in work.results:
            work.results["centre_of_mass"][chunk] += origin
        if "placement" in work.results and chunk.stop > chunk.start:
            placed, to = self._part("placement", chunk), work.results["placement"][chunk]
            to[:, :, :3] = placed[:, :, :3] + origin[:, None]
            for e, turn in enumerate(work.turns):
                axes = placed[:, e, 3:].reshape(-1, 3, 3).transpose(0, 2, 1)
                good = work.status[chunk] != evaluation.BAD_INPUT
                to[good, e, 3:] = Rotation.from_matrix(axes[good] @ turn).as_quat()

    def _part(self, name: str, chunk: slice) -> Floats:
        """Return the rows of a result that belong to `chunk`; none where it is not wanted."""
        if name == "placement" and len(self.placed):
            return self.placed[: chunk.stop - chunk.start]
        if name in self.work.results:
            return self.work.results[name][chunk]
        if name == "generalized_jacobian" and len(self.jacobian):
            return self.jacobian[: chunk.stop - chunk.start]
        return _NOTHING[name]

    @cached_property
    def _evaluator(self) -> OperationalSpaceEvaluator:
        wanted = [name for name in self.work.results if name in BITS]
        return OperationalSpaceEvaluator(self.work.robot, self.work.points, wanted)

    def _alone(self, s: int, chunk: slice) -> int:
        """Compute state `s` by itself: any joint type, dependent rows; zeros where it cannot be computed."""
        work = self.work
        try:
            one = self._evaluator.update(work.Q[s].copy(), work.V[s].copy())
            for name, result in work.results.items():
                if name in BITS:
                    result[s] = getattr(one, name)
            if len(self.jacobian):
                self._part("generalized_jacobian", chunk)[s - chunk.start] = one.generalized_jacobian
            self._place_alone(s)
            if "inertia_inverse_packed" in work.results:
                work.results["inertia_inverse_packed"][s] = one.inertia_inverse[np.tril_indices(len(work.rows))]
        except OspaceError:
            for result in work.results.values():
                result[s] = 0.0
            if len(self.jacobian):
                self._part("generalized_jacobian", chunk)[s - chunk.start] = 0.0
            return evaluation.BAD_INPUT
        return evaluation.OK

    def _place_alone(self, s: int) -> None:
        """Write what only a state knows: its placements, mass centre and J_b*."""
        work, state = self.work, State(self.work.robot, self.work.Q[s], self.work.V[s])
        if "placement" in work.results:
            poses = [pin.SE3ToXYZQUAT(state.placement(point)) for point in work.points]
            work.results["placement"][s] = poses
        if "centre_of_mass" in work.results:
            work.results["centre_of_mass"][s] = centre_of_mass(state)
        if "base_generalized_jacobian" in work.results:
            work.results["base_generalized_jacobian"][s] = base_generalized_jacobian(state)

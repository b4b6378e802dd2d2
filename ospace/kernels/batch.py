"""Operational-space dynamics of many states: `evaluation` with one state in each lane."""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.evaluation import (
    MOBILITY,
    composite_bodies,
    coupled_operational_space,
    operational_space,
    place_both,
    status,
)
from ospace.kernels.jit.compile import Number, entry_for_threads, inlined
from ospace.kernels.jit.simd import zeros
from ospace.kernels.kinematics import follower_coordinate
from ospace.kernels.tree import CONTINUOUS, Floats, Ints, Joints, Nodes
from ospace.kernels.workspace import UNIT, Wide, open_index, open_robot, open_table, open_work, place_of

_Q, _VELOCITY, _DIAGNOSTICS = place_of("q"), place_of("velocity"), place_of("diagnostics")
_INERTIA_INVERSE, _INERTIA = place_of("inertia_inverse"), place_of("inertia")
_BIAS_ACCELERATION, _BIAS_FORCE = place_of("bias_acceleration"), place_of("bias_force")
_GENERALIZED_JACOBIAN, _GENERALIZED_INERTIA = place_of("generalized_jacobian"), place_of("generalized_inertia")
_MOMENTUM, _J_B_STAR, _MASS_CENTRE = place_of("momentum"), place_of("J_b_star"), place_of("mass_centre")
_PLACE, _R = place_of("place"), place_of("R")


class Results(NamedTuple):
    """Arrays for the results of many states: leading N; no rows where a result is not wanted."""

    inertia_inverse: Floats
    inertia_inverse_packed: Floats
    inertia: Floats
    bias_acceleration: Floats
    bias_force: Floats
    generalized_jacobian: Floats
    generalized_inertia: Floats
    momentum: Floats
    base_generalized_jacobian: Floats
    centre_of_mass: Floats
    """About the base."""
    placement: Floats
    """(N, p, 12) position about the base, then the axes of the link by columns."""
    status: Ints


@inlined
def gather(states: Floats, first: int, memory: Floats, start: int, lanes: int) -> None:
    """Put the states from row `first` on into the lanes; the last one into all that are left over."""
    for lane in range(lanes):
        state = min(first + lane, states.shape[0] - 1)
        for k in range(states.shape[1]):
            memory[start + k * lanes + lane] = states[state, k]


@inlined
def gather_followers(joints: Joints, memory: Floats, start: int, lanes: int) -> None:
    """Write the coordinates of the followers behind those of q in each lane."""
    for f in range(joints.followers.size):
        k = start + joints.first[joints.leaders[f]] * lanes
        pair = joints.kind[joints.leaders[f]] == CONTINUOUS
        for lane in range(lanes):
            y = memory[k + lanes + lane] if pair else 0.0
            to = start + joints.first[joints.followers[f]] * lanes + lane
            memory[to] = follower_coordinate(joints, f, memory[k + lane], y)


@inlined
def scatter(memory: Floats, at: Ints, k: int, lanes: int, out: Floats, first: int) -> None:
    """Write table `k` of each lane to the rows of `out`, (N, …), from row `first` on."""
    start, count = at[3 * k], at[3 * k + 1] * at[3 * k + 2]
    flat = out.reshape(out.shape[0], count) if out.shape[0] > 0 else out.reshape(0, 0)
    for lane in range(min(lanes, out.shape[0] - first)):
        for j in range(count):
            flat[first + lane, j] = memory[start + j * lanes + lane]


@inlined
def scatter_packed(memory: Floats, at: Ints, k: int, lanes: int, out: Floats, first: int) -> None:
    """Write the lower rows of a symmetric table of each lane to the rows of `out`."""
    start, rows = at[3 * k], at[3 * k + 1]
    for lane in range(min(lanes, out.shape[0] - first)):
        count = 0
        for i in range(rows):
            for j in range(i + 1):
                out[first + lane, count] = memory[start + (i * rows + j) * lanes + lane]
                count += 1


@inlined
def scatter_columns(memory: Floats, at: Ints, k: int, lanes: int, out: Floats, first: int) -> None:
    """Write the rows of table `k` but the first, of each lane, as the columns of `out`, (N, 6, n)."""
    start = at[3 * k]
    for lane in range(min(lanes, out.shape[0] - first)):
        for j in range(out.shape[2]):
            for c in range(6):
                out[first + lane, c, j] = memory[start + ((j + 1) * 6 + c) * lanes + lane]


@inlined
def scatter_placements(nodes: Nodes, memory: Floats, at: Ints, lanes: int, out: Floats, first: int) -> None:
    """Write where the points are in each lane, and the axes of their links, to `out`, (N, p, 12)."""
    for lane in range(min(lanes, out.shape[0] - first)):
        for n in range(1, nodes.parent.size):
            if nodes.point[n] >= 0:
                place, R = at[3 * _PLACE] + 3 * n * lanes, at[3 * _R] + 9 * nodes.link[n] * lanes
                for c in range(3):
                    out[first + lane, nodes.point[n], c] = memory[place + c * lanes + lane]
                for c in range(9):
                    out[first + lane, nodes.point[n], 3 + c] = memory[R + c * lanes + lane]


@inlined
def evaluate_lanes(Q: Floats, V: Floats, memory: Floats, number: Number, lanes: int, out: Results) -> None:
    """Evaluate all states of `Q` and `V`, `lanes` at a time."""
    robot, w, at = open_robot(memory), open_work(memory, number), open_index(memory)
    wide = Wide(w.q, w.sine, w.cosine, w.scratch, open_table(memory, at, UNIT, 0.0))
    diagnostics = at[3 * _DIAGNOSTICS]
    for first in range(0, Q.shape[0], lanes):
        gather(Q, first, memory, at[3 * _Q], lanes)
        gather(V, first, memory, at[3 * _VELOCITY], lanes)
        gather_followers(robot.joints, memory, at[3 * _Q], lanes)
        place_both(robot, w, wide)
        operational_space(robot, w, wide)
        composite_bodies(robot, w)
        if robot.joints.followers.size > 0 and robot.want[0] & MOBILITY:
            coupled_operational_space(robot, w, wide)
        scatter(memory, at, _INERTIA_INVERSE, lanes, out.inertia_inverse, first)
        scatter_packed(memory, at, _INERTIA_INVERSE, lanes, out.inertia_inverse_packed, first)
        scatter(memory, at, _INERTIA, lanes, out.inertia, first)
        scatter(memory, at, _BIAS_ACCELERATION, lanes, out.bias_acceleration, first)
        scatter(memory, at, _BIAS_FORCE, lanes, out.bias_force, first)
        scatter(memory, at, _GENERALIZED_JACOBIAN, lanes, out.generalized_jacobian, first)
        scatter(memory, at, _GENERALIZED_INERTIA, lanes, out.generalized_inertia, first)
        scatter(memory, at, _MOMENTUM, lanes, out.momentum, first)
        scatter(memory, at, _MASS_CENTRE, lanes, out.centre_of_mass, first)
        scatter_columns(memory, at, _J_B_STAR, lanes, out.base_generalized_jacobian, first)
        scatter_placements(robot.nodes, memory, at, lanes, out.placement, first)
        for lane in range(min(lanes, Q.shape[0] - first)):
            d = diagnostics + lane
            out.status[first + lane] = status(
                (memory[d], memory[d + lanes], memory[d + 2 * lanes], memory[d + 3 * lanes])
                + (memory[d + 4 * lanes], memory[d + 5 * lanes], memory[d + 6 * lanes])
            )


@entry_for_threads
def evaluate_8(Q: Floats, V: Floats, memory: Floats, out: Results) -> None:
    """Evaluate many states, eight at a time."""
    evaluate_lanes(Q, V, memory, zeros(8), 8, out)


@entry_for_threads
def evaluate_4(Q: Floats, V: Floats, memory: Floats, out: Results) -> None:
    """Evaluate many states, four at a time."""
    evaluate_lanes(Q, V, memory, zeros(4), 4, out)


@entry_for_threads
def evaluate_2(Q: Floats, V: Floats, memory: Floats, out: Results) -> None:
    """Evaluate many states, two at a time."""
    evaluate_lanes(Q, V, memory, zeros(2), 2, out)


BY_WIDTH = {2: evaluate_2, 4: evaluate_4, 8: evaluate_8}

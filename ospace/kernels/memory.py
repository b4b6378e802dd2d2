"""One flat array that holds a robot, its points and all work on one state, or on one in each lane.

A call from Python takes some 50 ns for each array that it is given, so there is but one. It begins with where each
table begins, its rows and columns; then come the lists of whole numbers, the constants, and the tables of `Work`.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ospace.kernels.kinematics import Joints
from ospace.kernels.lanes import Number, Table, inlined
from ospace.kernels.propagated import Nodes
from ospace.kernels.simd import part, table, whole_numbers, zeros
from ospace.kernels.tables import Floats, Ints

WIDE = 8
"""Numbers in which rows of matrices are worked on where lanes hold no states."""


class Robot(NamedTuple):
    """All that is constant."""

    joints: Joints
    nodes: Nodes
    rows: Ints
    """Rows taken, out of the 6p of all points."""
    want: Ints
    """(1,) what is to be computed."""


class Work(NamedTuple):
    """All tables of one state."""

    q: Table
    sine: Table
    cosine: Table
    velocity: Table
    R: Table
    r: Table
    S: Table
    I: Table
    v: Table
    a: Table
    p: Table
    share: Table
    place: Table
    K: Table
    L: Table
    y: Table
    G: Table
    all_rows: Table
    acceleration: Table
    inertia_inverse: Table
    inertia: Table
    bias_acceleration: Table
    bias_force: Table
    IC: Table
    F: Table
    J_b_star: Table
    base_inverse: Table
    """(1, 21): (I_0^C)⁻¹."""
    J_m_star: Table
    """(n, 6p): the columns of J_m* as rows."""
    generalized_inertia: Table
    generalized_bias: Table
    base_drift: Table
    """(1, 6): ẍ_b while no joint accelerates and nothing acts."""
    drift: Table
    """(p, 6): ẍ_e then."""
    momentum: Table
    columns: Table
    """(nv, 6p): the columns of J_e as rows."""
    jacobian: Table
    generalized_jacobian: Table
    scratch: Table
    scale: Table
    health: Table
    """(1, 6): zero, or not a number where the input is not finite; how far quaternions are from unit length; the
    smallest share of inertia; the smallest pivot of Γ_e⁻¹; zero, or not a number where Γ_e or μ_e, or another result,
    is not finite."""


class Wide(NamedTuple):
    """What is done on whole rows, in numbers as wide as may be."""

    q: Table
    sine: Table
    cosine: Table
    scratch: Table
    unit: Table


_PARENT, _KIND, _FIRST, _UP, _LINK, _POINT, _UNTIL, _OF_LINK, _ROWS, _WANT = range(10)
_A, _B, _COM, _INERTIA, _MASS, _OFFSET, UNIT = range(10, 17)
_CONSTANTS, _WORK = _A, UNIT + 1
TABLES = _WORK + len(Work._fields)


def place_of(name: str) -> int:
    """Return the number of the table of work called `name`."""
    return _WORK + Work._fields.index(name)


_Q, _SINE, _COSINE, _SCRATCH = place_of("q"), place_of("sine"), place_of("cosine"), place_of("scratch")


@inlined
def padded(length: Any) -> Any:
    """Return the least number of doubles not below `length` that fills whole numbers of `WIDE`."""
    return -(-length // WIDE) * WIDE


def work_shapes(links: int, nodes: int, points: int, rows: int, nq: int, lanes: int) -> Work:
    """Return rows and columns of every table of work."""
    nv, even = links + 5, rows + rows % 2
    return Work(
        q=(nq, 1),
        sine=(nq, 1),
        cosine=(nq, 1),
        velocity=(nv, 1),
        R=(links, 9),
        r=(links, 3),
        S=(links, 6),
        I=(links, 21),
        v=(links, 6),
        a=(links, 6),
        p=(links, 6),
        share=(links, 1),
        place=(nodes, 3),
        K=(nodes, 36),
        L=(nodes, 21),
        y=(nodes, 6),
        G=(nodes * (nodes + 1) // 2, 36),
        all_rows=(6 * points, 6 * points),
        acceleration=(points, 6),
        inertia_inverse=(rows, rows),
        inertia=(rows, rows),
        bias_acceleration=(rows, 1),
        bias_force=(rows, 1),
        IC=(links, 21),
        F=(links, 6),
        J_b_star=(links, 6),
        base_inverse=(1, 21),
        J_m_star=(links - 1, 6 * points),
        generalized_inertia=(links - 1, links - 1),
        generalized_bias=(links - 1, 1),
        base_drift=(1, 6),
        drift=(points, 6),
        momentum=(1, 6),
        columns=(nv, 6 * points),
        jacobian=(rows, nv),
        generalized_jacobian=(rows, links - 1),
        scratch=(even + 2, padded(even) if lanes == 1 else even),
        scale=(rows, 1),
        health=(1, 6),
    )


def lay_out(robot: Robot, nq: int, lanes: int = 1) -> Floats:
    """Return the array for `robot`, with room for one state in each of `lanes`."""
    joints, nodes = robot.joints, robot.nodes
    points, rows = int((nodes.point >= 0).sum()), len(robot.rows)
    even = rows + rows % 2
    lists = [joints.parent, joints.kind, joints.first, nodes.parent, nodes.link, nodes.point, nodes.until]
    lists += [nodes.of_link, robot.rows, robot.want]
    constants = [joints.A, joints.b, joints.com, joints.inertia, joints.mass, nodes.offset, np.eye(even, padded(even))]
    shapes = [(len(one), 1) for one in lists] + [one.shape for one in constants]
    shapes += work_shapes(len(joints.parent), len(nodes.parent), points, rows, nq, lanes)
    sizes = np.array(shapes, dtype=np.int64)
    lengths = sizes.prod(axis=1) * np.where(np.arange(TABLES) < _WORK, 1, lanes)
    ends = padded(3 * TABLES) + np.cumsum(padded(lengths))
    starts = ends - padded(lengths)
    memory = _aligned(int(ends[-1]))
    memory[: 3 * TABLES].view(np.int64)[:] = np.column_stack([starts, sizes]).ravel()
    for k, values in enumerate([*lists, *constants]):
        kind = np.int64 if k < _CONSTANTS else np.float64
        memory[starts[k] : starts[k] + lengths[k]].view(kind)[:] = np.ravel(values)
    return memory


def _aligned(length: int) -> Floats:
    """Return zeros that begin with a line of the cache: a vector that lies in two lines takes twice the time."""
    memory = np.zeros(length + WIDE)
    start = -(memory.ctypes.data // 8) % WIDE
    return memory[start : start + length]


def result(memory: Floats, name: str) -> Floats:
    """Look at a table of work of one state."""
    start, rows, columns = (int(k) for k in memory[: 3 * TABLES].view(np.int64)[3 * place_of(name) :][:3])
    return memory[start : start + rows * columns].reshape(rows, columns)


def wanted(memory: Floats) -> Ints:
    """Look at what is to be computed, (1,)."""
    start = int(memory[: 3 * TABLES].view(np.int64)[3 * _WANT])
    return memory[start : start + 1].view(np.int64)


@inlined
def open_table(memory: Floats, at: Ints, k: int, number: Number) -> Table:
    """Table `k`, in numbers such as `number`."""
    return table(memory, at[3 * k], at[3 * k + 1], at[3 * k + 2], number)


@inlined
def open_list(memory: Floats, at: Ints, k: int) -> Ints:
    """Table `k`, of whole numbers."""
    numbers: Ints = whole_numbers(memory, at[3 * k], at[3 * k + 1])
    return numbers


@inlined
def open_index(memory: Floats) -> Ints:
    """Where the tables are: start, rows and columns of each."""
    numbers: Ints = whole_numbers(memory, 0, 3 * TABLES)
    return numbers


@inlined
def open_robot(memory: Floats) -> Robot:
    """The constants in `memory`."""
    at = open_index(memory)
    joints = Joints(
        open_list(memory, at, _PARENT),
        open_list(memory, at, _KIND),
        open_list(memory, at, _FIRST),
        open_table(memory, at, _A, 0.0),
        open_table(memory, at, _B, 0.0),
        open_table(memory, at, _COM, 0.0),
        open_table(memory, at, _INERTIA, 0.0),
        open_table(memory, at, _MASS, 0.0),
    )
    nodes = Nodes(
        open_list(memory, at, _UP),
        open_list(memory, at, _LINK),
        open_list(memory, at, _POINT),
        open_table(memory, at, _OFFSET, 0.0),
        open_list(memory, at, _UNTIL),
        open_list(memory, at, _OF_LINK),
    )
    return Robot(joints, nodes, open_list(memory, at, _ROWS), open_list(memory, at, _WANT))


@inlined
def open_work(memory: Floats, number: Number) -> Work:
    """All tables of work in `memory`, in numbers such as `number`."""
    at = part(open_index(memory), 3 * _WORK, 3 * (TABLES - _WORK))
    return Work(
        open_table(memory, at, 0, number),
        open_table(memory, at, 1, number),
        open_table(memory, at, 2, number),
        open_table(memory, at, 3, number),
        open_table(memory, at, 4, number),
        open_table(memory, at, 5, number),
        open_table(memory, at, 6, number),
        open_table(memory, at, 7, number),
        open_table(memory, at, 8, number),
        open_table(memory, at, 9, number),
        open_table(memory, at, 10, number),
        open_table(memory, at, 11, number),
        open_table(memory, at, 12, number),
        open_table(memory, at, 13, number),
        open_table(memory, at, 14, number),
        open_table(memory, at, 15, number),
        open_table(memory, at, 16, number),
        open_table(memory, at, 17, number),
        open_table(memory, at, 18, number),
        open_table(memory, at, 19, number),
        open_table(memory, at, 20, number),
        open_table(memory, at, 21, number),
        open_table(memory, at, 22, number),
        open_table(memory, at, 23, number),
        open_table(memory, at, 24, number),
        open_table(memory, at, 25, number),
        open_table(memory, at, 26, number),
        open_table(memory, at, 27, number),
        open_table(memory, at, 28, number),
        open_table(memory, at, 29, number),
        open_table(memory, at, 30, number),
        open_table(memory, at, 31, number),
        open_table(memory, at, 32, number),
        open_table(memory, at, 33, number),
        open_table(memory, at, 34, number),
        open_table(memory, at, 35, number),
        open_table(memory, at, 36, number),
        open_table(memory, at, 37, number),
        open_table(memory, at, 38, number),
    )


@inlined
def open_wide(memory: Floats) -> Wide:
    """What is done on whole rows, of one state, in numbers of `WIDE`: each table ends where it fills such numbers."""
    at, number = open_index(memory), zeros(WIDE)
    rows = padded(at[3 * _Q + 1]) // WIDE
    columns = at[3 * _SCRATCH + 2] // WIDE
    return Wide(
        table(memory, at[3 * _Q], rows, 1, number),
        table(memory, at[3 * _SINE], rows, 1, number),
        table(memory, at[3 * _COSINE], rows, 1, number),
        table(memory, at[3 * _SCRATCH], at[3 * _SCRATCH + 1], columns, number),
        table(memory, at[3 * UNIT], at[3 * UNIT + 1], columns, number),
    )

"""The workspace: one flat array that holds a robot, its points and every table of one state, or of one in each lane.

A call from Python takes some 50 ns for each array that it is given, so there is but one. It begins with where each
table begins, its rows and columns; then come the integers and the constants of the robot, and the tables of `Work`.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from ospace.kernels.jit.compile import INLINED, Number, Table, inlined
from ospace.kernels.jit.load_store import View, build_view, table, view_int
from ospace.kernels.jit.simd import zeros
from ospace.kernels.tree import Floats, Ints, Joints, Nodes

WIDE = 8
"""Numbers in which rows of matrices are worked on where lanes hold no states."""


class Robot(NamedTuple):
    """All that is constant."""

    joints: Joints
    nodes: Nodes
    rows: Ints
    """Rows taken, out of the 6p of all points."""
    want: Ints
    """(1,) what is to be computed: bits of `ospace.kernels.evaluation`."""


class Work(NamedTuple):
    """All tables of one state: name, shape, meaning; the coordinates are those of `kinematics`.

    Sizes: nq, nv = n + 6; links; nodes, points p, rows r taken of their 6p. Where joints mimic others, there are more
    links than n + 1, and more coordinates than nq: those of the followers stand behind the others.
    """

    q: Annotated[Table, "coordinates 1"]
    sine: Annotated[Table, "coordinates 1"]
    cosine: Annotated[Table, "coordinates 1"]
    q_beside_base: Annotated[Table, "coordinates 1"]
    """The state from a frame that is centred on the base and moves along with it; rates of all links."""
    v_beside_base: Annotated[Table, "links+5 1"]
    # `LINKS`, as either way of placing them leaves them
    velocity: Annotated[Table, "nv 1"]
    """Base twist in base axes, then joint rates."""
    R: Annotated[Table, "links 9"]
    """Axes of the links, by columns."""
    r: Annotated[Table, "links 3"]
    """Origins of the links about the base."""
    d: Annotated[Table, "links 3"]
    """The same about the parent's origin."""
    S: Annotated[Table, "links 6"]
    """Joint columns."""
    I: Annotated[Table, "links 21"]
    """Inertias; of links that the kernels place themselves, only where composite bodies are wanted."""
    v: Annotated[Table, "links 6"]
    """Twists."""
    a: Annotated[Table, "links 6"]
    """Accelerations at q̈ = 0."""
    # articulated bodies and the points
    arm: Annotated[Table, "nodes 3"]
    """Points about the origin of their link."""
    place: Annotated[Table, "nodes 3"]
    """Points about the base."""
    IA: Annotated[Table, "links 21"]
    """I^A."""
    p: Annotated[Table, "links 6"]
    """p^A, or forces across the joints."""
    relative_pivot: Annotated[Table, "links 1"]
    """β over the terms that it is made of."""
    K: Annotated[Table, "nodes 36"]
    L: Annotated[Table, "nodes 21"]
    y: Annotated[Table, "nodes 6"]
    G: Annotated[Table, "pairs 36"]
    """Blocks (n, b), b ≤ n, row by row."""
    all_rows: Annotated[Table, "6p 6p"]
    """Γ_e⁻¹ before rows are taken."""
    acceleration: Annotated[Table, "points 6"]
    """ẍ_e when nothing acts."""
    inertia_inverse: Annotated[Table, "rows rows"]
    inertia: Annotated[Table, "rows rows"]
    bias_acceleration: Annotated[Table, "rows 1"]
    bias_force: Annotated[Table, "rows 1"]
    columns: Annotated[Table, "nv 6p"]
    """Columns of J_e as rows."""
    jacobian: Annotated[Table, "rows nv"]
    # composite bodies
    IC: Annotated[Table, "links 21"]
    F: Annotated[Table, "links 6"]
    """I_i^C S_i."""
    H_bm: Annotated[Table, "n+1 6"]
    """Columns of H_bm as rows, from row 1 on; so is J_b*."""
    inertia_diagonal: Annotated[Table, "nv 1"]
    """Diagonal of H."""
    mass_centre: Annotated[Table, "1 3"]
    """Centre of mass about the base."""
    base_inverse: Annotated[Table, "1 21"]
    """H_b⁻¹."""
    J_b_star: Annotated[Table, "n+1 6"]
    momentum: Annotated[Table, "1 6"]
    """M_0."""
    base_momentum_velocity: Annotated[Table, "1 6"]
    """H_b⁻¹ M_0."""
    momentum_velocity: Annotated[Table, "points 6"]
    """J_b H_b⁻¹ M_0."""
    J_m_star: Annotated[Table, "n 6p"]
    """Columns of J_m* as rows."""
    generalized_jacobian: Annotated[Table, "rows n"]
    manipulator_inertia: Annotated[Table, "n n"]
    """H_m."""
    generalized_inertia: Annotated[Table, "n n"]
    """H_m*."""
    factor: Annotated[Table, "coupled coupled"]
    """L of H_m* = L Lᵀ, lower rows; only where joints mimic others."""
    given: Annotated[Table, "nv 1"]
    """Accelerations of base and joints, for inverse dynamics."""
    accelerated: Annotated[Table, "links 6"]
    """What these add to the links' accelerations."""
    base_force: Annotated[Table, "1 6"]
    """c_b, or the wrench of inverse dynamics."""
    joint_force: Annotated[Table, "n 1"]
    """c_m, or the torques of inverse dynamics."""
    generalized_bias: Annotated[Table, "n 1"]
    """c_m*."""
    base_drift: Annotated[Table, "1 6"]
    """ẍ_b while no joint accelerates and nothing acts."""
    drift: Annotated[Table, "points 6"]
    """ẍ_e then."""
    # responses to forces at the points
    U: Annotated[Table, "links 6"]
    beta_inv: Annotated[Table, "links 1"]
    f: Annotated[Table, "links 6"]
    """Forces across the joints per unit of each force at a point."""
    response_of_link: Annotated[Table, "links 36"]
    response: Annotated[Table, "nv rows"]
    """H⁻¹ J_eᵀ."""
    base_mobility: Annotated[Table, "rows 6"]
    """H_b⁻¹ J_bᵀ, as rows."""
    floating_inertia_inverse: Annotated[Table, "rows rows"]
    """Λ⁻¹."""
    base_inertia_inverse: Annotated[Table, "rows rows"]
    """Λ_b⁻¹."""
    floating_inertia: Annotated[Table, "rows rows"]
    """Λ."""
    floating_bias: Annotated[Table, "rows 1"]
    """μ by composite bodies."""
    # inverses, and diagnostics of the state
    scratch: Annotated[Table, "even+2 wide"]
    scale: Annotated[Table, "rows 1"]
    diagnostics: Annotated[Table, "1 8"]
    """`NONFINITE_INPUT` … of `ospace.kernels.evaluation`."""


class Wide(NamedTuple):
    """Tables for operations on whole rows, in numbers as wide as possible."""

    q: Table
    sine: Table
    cosine: Table
    scratch: Table
    unit: Table


(_PARENT, _KIND, _FIRST, _BODY, _TURNING, _COLUMN, _LINK_OF, _FOLLOWERS, _LEADERS) = range(9)
(_UP, _LINK, _POINT, _LAST_DESCENDANT, _OF_LINK, _ROWS, _WANT) = range(9, 16)
(_A, _B, _FIRST_MOMENTS, _INERTIA, _MASS, _ARMATURE, _PITCH, _RATIO, _SHIFT, _AXES, _OFFSET, UNIT) = range(16, 28)
_FIRST_CONSTANT, _WORK = _A, UNIT + 1
TABLES = _WORK + len(Work._fields)
_SHAPES = {name: hint.__metadata__[0].split() for name, hint in get_type_hints(Work, include_extras=True).items()}


LINKS = ("velocity", "R", "r", "d", "S", "I", "v", "a")
"""Tables that make up a state; they lie side by side."""


def place_of(name: str) -> int:
    """Return the number of the table of work called `name`."""
    return _WORK + Work._fields.index(name)


_Q, _SINE, _COSINE, _SCRATCH = place_of("q"), place_of("sine"), place_of("cosine"), place_of("scratch")


@inlined
def padded(length: Any) -> Any:
    """Return the least number of doubles not below `length` that fills whole numbers of `WIDE`."""
    return -(-length // WIDE) * WIDE


def lay_out(robot: Robot, nq: int, lanes: int = 1) -> Floats:
    """Return the workspace of `robot`, with room for one state in each of `lanes`."""
    joints, nodes = robot.joints, robot.nodes
    links, rows, points = len(joints.parent), len(robot.rows), int((nodes.point >= 0).sum())
    even, n_nodes, n, followers = rows + rows % 2, len(nodes.parent), len(joints.link_of), len(joints.followers)
    sizes = {"nv": n + 6, "n": n, "n+1": n + 1, "coupled": n if followers else 0, "nodes": n_nodes, "points": points}
    sizes |= {"coordinates": nq + followers, "links": links, "links+5": links + 5}
    sizes |= {"pairs": n_nodes * (n_nodes + 1) // 2, "6p": 6 * points, "rows": rows, "even+2": even + 2}
    sizes |= {"wide": padded(even) if lanes == 1 else even}
    lists = [*joints[:_UP], nodes.parent, nodes.link, nodes.point]
    lists += [nodes.last_descendant, nodes.of_link, robot.rows, robot.want]
    constants = [*joints[_UP:], nodes.offset, np.eye(even, padded(even))]
    shapes: list[tuple[int, ...]] = [*((len(one), 1) for one in lists), *(one.shape for one in constants)]
    shapes += [tuple(sizes[k] if k in sizes else int(k) for k in shape) for shape in _SHAPES.values()]
    counts = np.array(shapes, dtype=np.int64)
    lengths = counts.prod(axis=1) * np.where(np.arange(TABLES) < _WORK, 1, lanes)
    ends = padded(3 * TABLES) + np.cumsum(padded(lengths))
    starts = ends - padded(lengths)
    memory = _aligned(int(ends[-1]))
    memory[: 3 * TABLES].view(np.int64)[:] = np.column_stack([starts, counts]).ravel()
    for k, values in enumerate([*lists, *constants]):
        kind = np.int64 if k < _FIRST_CONSTANT else np.float64
        memory[starts[k] : starts[k] + lengths[k]].view(kind)[:] = np.ravel(values)
    return memory


def _aligned(length: int) -> Floats:
    """Return zeros that begin with a line of the cache: a vector that lies in two lines takes twice the time."""
    memory = np.zeros(length + WIDE)
    start = -(memory.ctypes.data // 8) % WIDE
    return memory[start : start + length]


def view(memory: Floats, name: str) -> Floats:
    """Return a view of a table of one state."""
    start, rows, columns = (int(k) for k in memory[: 3 * TABLES].view(np.int64)[3 * place_of(name) :][:3])
    return memory[start : start + rows * columns].reshape(rows, columns)


def links(memory: Floats) -> Floats:
    """Return a view of the tables `velocity` to `a`, side by side: all that a state is to the recursions."""
    at = memory[: 3 * TABLES].view(np.int64)
    return memory[at[3 * place_of(LINKS[0])] : at[3 * (place_of(LINKS[-1]) + 1)]]


def view_of_links(tables: Floats, name: str, count: int, nv: int) -> Floats:
    """Return a view of the table `name` of a copy of `links`, of a robot with `count` links and `nv` velocities."""
    start = 0
    for other in LINKS:
        rows, columns = nv if other == "velocity" else count, int(_SHAPES[other][1])
        if other == name:
            break
        start += padded(rows * columns)
    return tables[start : start + rows * columns].reshape(rows, columns)


def wanted(memory: Floats) -> Ints:
    """Return a view of what is to be computed, (1,)."""
    start = int(memory[: 3 * TABLES].view(np.int64)[3 * _WANT])
    return memory[start : start + 1].view(np.int64)


@inlined
def open_table(memory: Floats, at: Ints, k: int, number: Number) -> Table:
    """Table `k`, in numbers such as `number`."""
    return table(memory, at[3 * k], at[3 * k + 1], at[3 * k + 2], number)


@inlined
def open_constants(memory: Floats, at: Ints, k: int, columns: int) -> Table:
    """Table `k` of constants, of so many columns: what the compiler knows, it need not multiply by."""
    return table(memory, at[3 * k], at[3 * k + 1], columns, 0.0)


@inlined
def open_list(memory: Floats, at: Ints, k: int) -> Ints:
    """Table `k`, of integers."""
    numbers: Ints = view_int(memory, at[3 * k], at[3 * k + 1])
    return numbers


@inlined
def open_index(memory: Floats) -> Ints:
    """Places of the tables: start, rows and columns of each."""
    numbers: Ints = view_int(memory, 0, 3 * TABLES)
    return numbers


@inlined
def open_robot(memory: Floats) -> Robot:
    """The constants in `memory`."""
    at = open_index(memory)
    joints = Joints(
        open_list(memory, at, _PARENT),
        open_list(memory, at, _KIND),
        open_list(memory, at, _FIRST),
        open_list(memory, at, _BODY),
        open_list(memory, at, _TURNING),
        open_list(memory, at, _COLUMN),
        open_list(memory, at, _LINK_OF),
        open_list(memory, at, _FOLLOWERS),
        open_list(memory, at, _LEADERS),
        open_constants(memory, at, _A, 9),
        open_constants(memory, at, _B, 3),
        open_constants(memory, at, _FIRST_MOMENTS, 3),
        open_constants(memory, at, _INERTIA, 6),
        open_constants(memory, at, _MASS, 1),
        open_constants(memory, at, _ARMATURE, 1),
        open_constants(memory, at, _PITCH, 1),
        open_constants(memory, at, _RATIO, 1),
        open_constants(memory, at, _SHIFT, 1),
        open_constants(memory, at, _AXES, 9),
    )
    nodes = Nodes(
        open_list(memory, at, _UP),
        open_list(memory, at, _LINK),
        open_list(memory, at, _POINT),
        open_list(memory, at, _LAST_DESCENDANT),
        open_list(memory, at, _OF_LINK),
        open_constants(memory, at, _OFFSET, 3),
    )
    return Robot(joints, nodes, open_list(memory, at, _ROWS), open_list(memory, at, _WANT))


def open_work(memory: Floats, number: Number) -> Work:
    """All tables of work in `memory`, in numbers such as `number`."""
    at = open_index(memory)
    return Work(*(open_table(memory, at, k, number) for k in range(_WORK, TABLES)))


@overload(open_work, strict=False, jit_options=INLINED)
def _open_work(memory: Any, number: Any) -> Any:
    return lambda memory, number: _tables_of_work(memory, open_index(memory), number)


@intrinsic
def _tables_of_work(typing: Any, memory: Any, index: Any, number: Any) -> Any:
    seen = View(number, 2)
    opened = types.NamedUniTuple(seen, len(Work._fields), Work)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        starts = cgutils.create_struct_proxy(index)(context, builder, value=args[1]).data

        def entry(k: int) -> Any:
            number = builder.load(builder.gep(starts, [context.get_constant(types.intp, k)]))
            number.set_metadata("invariant.load", builder.module.add_metadata(()))  # so it need not be kept
            return number

        def extent(k: int, columns: str) -> list[Any]:
            known = columns.isdigit()  # what the compiler knows, it need not multiply by
            return [
                entry(3 * k),
                entry(3 * k + 1),
                context.get_constant(types.intp, int(columns)) if known else entry(3 * k + 2),
            ]

        tables = [
            build_view(context, builder, memory, args[0], extent(_WORK + k, columns), seen)
            for k, (_, columns) in enumerate(_SHAPES.values())
        ]
        return context.make_tuple(builder, opened, tables)

    return opened(memory, index, number), generate


@inlined
def open_wide(memory: Floats) -> Wide:
    """Open tables for operations on whole rows of one state: each ends where it fills numbers of `WIDE`."""
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

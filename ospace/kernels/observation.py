"""View of a state for tasks and inequalities written in Python: the motion of points in the coordinates of q and v.

With v = [v_b; φ̇] and v_b = [ν_b; ω_b] in base axes, R those axes, p_e the point about the base, J_φ the columns of the
joints (29),

    ẋ_e = J v,   J = [ R  −p̃_e R  J_φ ;  0  R  J_φ ]
    ẍ_e = J v̇ + a_e,   a_e = ẍ_e(ẍ_b = 0, φ̈ = 0) + [R (ω_b × ν_b); 0]                      (44)

since the base accelerates by R (ω_b × ν_b) while v stays. All in inertial axes, at the point.
"""

from __future__ import annotations

from ospace.kernels.evaluation import (
    BAD_INPUT,
    FAR,
    FAR_ANGLE,
    FARTHEST,
    NONFINITE_INPUT,
    NORM_ERROR,
    OK,
    UNIT_LENGTH,
    load_input,
    place,
)
from ospace.kernels.jit.compile import Vec6, entry, inlined
from ospace.kernels.jit.load_store import load3, load3_at, load6, load6_at, load9, store3, store6, store9, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.points import acceleration_at, place_points, point_jacobians
from ospace.kernels.spatial import add3, cross, mat3_mul, mat3_transpose, motion_at, rotate
from ospace.kernels.tree import Floats
from ospace.kernels.workspace import open_robot, open_wide, open_work


@entry
def observe(
    q: Floats, v: Floats, memory: Floats, axes: Floats, position: Floats, rotation: Floats, motion: Floats, J: Floats
) -> int:
    """Place links and points, and write how the points move; return OK, or what is wrong.

    `axes` (p, 9) are those of each point in its link's, by columns. Positions (p, 3), rotations (p, 9) by rows, and
    Jacobians (6 p, nv) are written; to `motion` (2 p, 6), ẋ_e and a_e of each point.
    """
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    if not load_input(unowned(q), unowned(v), robot.joints, w):
        return BAD_INPUT
    place(robot, w, open_wide(here), w.IA)
    place_points(robot.nodes, w)
    point_jacobians(robot, w)
    R, base, none = load9(w.R, 0), (w.q[0, 0], w.q[1, 0], w.q[2, 0]), (0.0, 0.0, 0.0)
    velocity = rotate(R, (v[0], v[1], v[2]))
    acceleration = rotate(R, cross((v[3], v[4], v[5]), (v[0], v[1], v[2]))) + none
    for n in range(1, robot.nodes.parent.size):
        e, link = robot.nodes.point[n], robot.nodes.link[n]
        if e < 0:
            continue
        p = load3(w.place, n)
        store3(position, e, add3(base, p))
        store9(rotation, e, mat3_transpose(mat3_mul(load9(w.R, link), load9(axes, e))))
        beside = motion_at(load3(w.arm, n), load6(w.v, link))
        store6(motion, 2 * e, add3(velocity, beside[0:3]) + beside[3:6])
        store6(motion, 2 * e + 1, acceleration_at(robot.nodes, w, n, acceleration))
        for k in range(3):
            axis = load3_at(w.R, 0, 3 * k)
            write_column(J, e, k, axis + none)
            write_column(J, e, k + 3, motion_at(p, none + axis))
        for k in range(6, w.columns.shape[0]):
            write_column(J, e, k, load6_at(w.columns, k, 6 * e))
    d = w.diagnostics
    if not (d[0, NONFINITE_INPUT] == 0.0 and d[0, NORM_ERROR] <= UNIT_LENGTH):
        return BAD_INPUT
    return FAR if d[0, FARTHEST] > FAR_ANGLE else OK


@inlined
def write_column(J: Floats, e: int, k: int, column: Vec6) -> None:
    """Write column `k` of the Jacobian of point `e`."""
    J[6 * e, k], J[6 * e + 1, k], J[6 * e + 2, k] = column[0], column[1], column[2]
    J[6 * e + 3, k], J[6 * e + 4, k], J[6 * e + 5, k] = column[3], column[4], column[5]

"""Links of a state: from q and v by own kinematics, or from Pinocchio's frame data.

Everything stands in inertial axes; positions are those about the base, and each link's twist, acceleration and inertia
are at the link's own origin, seen from the frame that moves along with the base. With h the parent of i, d_i the way
from its origin to that of i, and X(d) the shift of a motion to a point d away,

    R_i = R_h A_i Rot(z, φ_i),  d_i = R_h b_i              revolute
    R_i = R_h A_i,              d_i = R_h b_i + φ_i z_i    prismatic
    r_i = r_h + d_i,   S_i = [0; z_i]  or  [z_i; 0]
    v_i = X(d_i) v_h + S_i φ̇_i,   a_i = X(d_i) a_h + v_i ×̂ S_i φ̇_i         (16), (17) while φ̈ = 0

and likewise for joints of several columns, whose S are the axes of the link. A frame of its own for each link's
inertia keeps the digits of small links at the end of long booms; what is left of the distance enters linearly.
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Mat3, Number, Quaternion, Table, Vec3, entry, inlined
from ospace.kernels.jit.load_store import (
    load3,
    load6,
    load9,
    load_translation,
    store3,
    store6,
    store9,
    store21,
    unowned,
)
from ospace.kernels.jit.simd import fence, floor, zeros
from ospace.kernels.spatial import (
    add3,
    add6,
    cross_motion,
    mat3_mul,
    motion_at,
    rigid_inertia,
    rotate,
    rotate_sym3,
    scale3,
    scale6,
    sub3,
    zero6,
)
from ospace.kernels.tree import (
    COLUMNS,
    CONTINUOUS,
    FLOATING,
    HELICAL,
    PLANAR,
    PRISMATIC,
    REVOLUTE,
    SAME_JOINT,
    SPHERICAL,
    Floats,
    Joints,
)
from ospace.kernels.workspace import Work, open_robot, open_work


@inlined
def sine_cosine(x: Number) -> tuple[Number, Number]:
    """Sine and cosine of an angle up to 1e5 rad, without a branch: reduced to ±π/4, then by polynomials."""
    k = floor(x * 0.6366197723675814 + 0.5)
    y = fence(fence(x - k * 1.5707963267341256) - k * 6.077100506303966e-11) - k * 2.0222662487959506e-21
    z = y * y
    s = y + y * z * (
        -1.66666666666666324348e-01
        + z * (8.33333333332248946124e-03
        + z * (-1.98412698298579493134e-04
        + z * (2.75573137070700676789e-06
        + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10))))
    )  # fmt: skip
    c = 1.0 - 0.5 * z + z * z * (
        4.16666666666666019037e-02
        + z * (-1.38888888888741095749e-03
        + z * (2.48015872894767294178e-05
        + z * (-2.75573143513906633035e-07
        + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11))))
    )  # fmt: skip
    half = floor(k * 0.5)
    odd = k - 2.0 * half  # quarter turns: odd ones swap sine and cosine, and the sign goes round
    sign = 1.0 - 2.0 * (half - 2.0 * floor(k * 0.25))
    return (s + odd * (c - s)) * sign, (c + odd * (s - c)) * sign * (1.0 - 2.0 * odd)


@inlined
def sines_cosines(q: Table, sine: Table, cosine: Table) -> None:
    """Of all of `q`, whatever it is: many at a time cost less than those of the angles alone."""
    for k in range(q.shape[0]):
        s, c = sine_cosine(q[k, 0])
        sine[k, 0] = s
        cosine[k, 0] = c


@inlined
def rotation(quaternion: Quaternion) -> Mat3:
    """The rotation of the unit quaternion x, y, z, w, by columns."""
    x, y, z, w = quaternion
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w))
        + (2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w))
        + (2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y))
    )


@inlined
def quaternion_in(q: Table, k: int) -> Quaternion:
    """The quaternion in `q` from row `k` on."""
    return (q[k, 0], q[k + 1, 0], q[k + 2, 0], q[k + 3, 0])


@inlined
def turned(R: Mat3, s: Number, c: Number) -> Mat3:
    """R Rot(z, φ), by sine and cosine of φ."""
    x, y = R[0:3], R[3:6]
    return add3(scale3(x, c), scale3(y, s)) + add3(scale3(y, c), scale3(x, -s)) + R[6:9]


@inlined
def place_links(joints: Joints, w: Work, I: Table) -> None:
    """Fill `R`, `r`, `d`, `S` and the inertias `I` from `w.q`, its sines and its cosines."""
    q, R = w.q, rotation(quaternion_in(w.q, 3))
    none = zero6(R)[0:3]
    store_link(joints, w, I, 0, R, none, none)
    for i in range(1, joints.parent.size):
        h, k, kind = joints.parent[i], joints.first[i], joints.kind[i]
        R = load9(w.R, h)
        if kind <= CONTINUOUS:  # by itself, as it is what most joints are
            s, c = (w.sine[k, 0], w.cosine[k, 0]) if kind == REVOLUTE else (q[k + 1, 0], q[k, 0])
            d = rotate(R, load3(joints.b, i))
            R = mat3_mul(R, turned(load9(joints.A, i), s, c))  # so it waits for the parent's R once
            store6(w.S, i, none + R[6:9])
            store_link(joints, w, I, i, R, d, add3(load3(w.r, h), d))
            continue
        d = none
        if kind != SAME_JOINT:
            d = rotate(R, load3(joints.b, i))
            R = mat3_mul(R, load9(joints.A, i))
        if kind == PRISMATIC:
            d = add3(d, scale3(R[6:9], q[k, 0]))
            store6(w.S, i, R[6:9] + none)
        elif kind == HELICAL:
            R = turned(R, w.sine[k, 0], w.cosine[k, 0])
            slope = scale3(R[6:9], joints.pitch[i, 0])
            d = add3(d, scale3(slope, q[k, 0]))
            store6(w.S, i, slope + R[6:9])
        elif kind == SPHERICAL:
            R = mat3_mul(R, rotation(quaternion_in(q, k)))
            store_axes(w.S, i, none + R)
        elif kind == PLANAR:
            d = add3(d, add3(scale3(R[0:3], q[k, 0]), scale3(R[3:6], q[k + 1, 0])))
            R = turned(R, q[k + 3, 0], q[k + 2, 0])
            store6(w.S, i, R[0:3] + none)
            store6(w.S, i + 1, R[3:6] + none)
            store6(w.S, i + 2, none + R[6:9])
        elif kind == FLOATING:
            d = add3(d, rotate(R, (q[k, 0], q[k + 1, 0], q[k + 2, 0])))
            R = mat3_mul(R, rotation(quaternion_in(q, k + 3)))
            store6(w.S, i, R[0:3] + none)
            store6(w.S, i + 1, R[3:6] + none)
            store6(w.S, i + 2, R[6:9] + none)
            store_axes(w.S, i + 3, none + R)
        store_link(joints, w, I, i, R, d, add3(load3(w.r, h), d))
    couple_columns(joints, w)


@inlined
def follower_coordinate(joints: Joints, f: int, x: float, y: float) -> float:
    """Coordinate of follower `f` of which the leader is at `x`; or at the cosine `x` and the sine `y` of an angle."""
    i, leader = joints.followers[f], joints.leaders[f]
    at = math.atan2(y, x) if joints.kind[leader] == CONTINUOUS else x
    coordinate: float = joints.ratio[i, 0] * at + joints.offset[i, 0]
    return coordinate


@inlined
def place_followers(joints: Joints, w: Work) -> None:
    """Write the coordinates of the followers behind those of q."""
    for f in range(joints.followers.size):
        k = joints.first[joints.leaders[f]]
        y = w.q[k + 1, 0] if joints.kind[joints.leaders[f]] == CONTINUOUS else 0.0
        w.q[joints.first[joints.followers[f]], 0] = follower_coordinate(joints, f, w.q[k, 0], y)


@inlined
def couple_columns(joints: Joints, w: Work) -> None:
    """Turn the columns S of followers into those of a unit rate of their leaders."""
    for f in range(joints.followers.size):
        i = joints.followers[f]
        store6(w.S, i, scale6(load6(w.S, i), joints.ratio[i, 0]))


@inlined
def store_axes(S: Table, i: int, R: tuple[*Vec3, *Mat3]) -> None:
    """Write columns about the three axes of a link to the rows of `S` from `i` on; `R` follows three zeros."""
    store6(S, i, R[0:3] + R[3:6])
    store6(S, i + 1, R[0:3] + R[6:9])
    store6(S, i + 2, R[0:3] + R[9:12])


@inlined
def store_link(joints: Joints, w: Work, I: Table, i: int, R: Mat3, d: Vec3, r: Vec3) -> None:
    """Write axes, way from the parent, position and inertia of link `i`."""
    store9(w.R, i, R)
    store3(w.d, i, d)
    store3(w.r, i, r)
    about_origin = rotate_sym3(R, load6(joints.inertia, i))
    store21(I, i, rigid_inertia(joints.mass[i, 0], rotate(R, load3(joints.first_moments, i)), about_origin))


@inlined
def move_links(joints: Joints, w: Work) -> None:
    """Fill twists `v`, and accelerations `a` while no joint accelerates, from `w.velocity`.

    `w.velocity` (nv, 1) holds the base twist in base axes, then joint rates.
    """
    omega = rotate(load9(w.R, 0), (w.velocity[3, 0], w.velocity[4, 0], w.velocity[5, 0]))
    none = zero6(omega)
    store6(w.v, 0, none[0:3] + omega)
    store6(w.a, 0, none)
    for i in range(1, joints.parent.size):
        h, kind = joints.parent[i], joints.kind[i]
        v, a = load6(w.v, h), load6(w.a, h)
        if kind != SAME_JOINT:
            d, k = load3(w.d, i), joints.column[i] + 5
            across = scale6(load6(w.S, i), w.velocity[k, 0])
            for more in range(1, COLUMNS[kind]):
                across = add6(across, scale6(load6(w.S, i + more), w.velocity[k + more, 0]))
            v = add6(motion_at(d, v), across)
            a = add6(motion_at(d, a), cross_motion(v, across))
        store6(w.v, i, v)
        store6(w.a, i, a)


@entry
def place_from_pinocchio(placements: Floats, J: Floats, a: Floats, memory: Floats) -> int:
    """Fill the links' tables in `memory` from Pinocchio's frame data, of any joint type; `velocity` stands there.

    Return zero, or one where a number is not finite.

    Parameters
    ----------
    placements : (njoints, 12) rotation by columns, then translation; inertial axes, about the base.
    J : (links + 5, 6) joint columns, likewise, of followers as of free joints; the first six rows are the base's.
    a : (njoints, 6) spatial accelerations at zero q̈, likewise.
    """
    here = unowned(memory)
    joints, w = open_robot(here).joints, open_work(here, zeros(1))
    none = (0.0, 0.0, 0.0)
    for i in range(joints.parent.size):
        h, body = joints.parent[i], joints.body[i]
        R = mat3_mul(load9(placements, body), load9(joints.axes, i))
        r = load_translation(placements, body)
        store_link(joints, w, w.I, i, R, sub3(r, load3(w.r, h)) if i > 0 else none, r)
        if i == 0:
            v = none + rotate(R, (w.velocity[3, 0], w.velocity[4, 0], w.velocity[5, 0]))
        else:
            S = scale6(motion_at(r, load6(J, i + 5)), joints.ratio[i, 0])
            store6(w.S, i, S)
            v = add6(motion_at(load3(w.d, i), load6(w.v, h)), scale6(S, w.velocity[joints.column[i] + 5, 0]))
        store6(w.v, i, v)
        store6(w.a, i, motion_at(r, load6(a, body)))
    nonfinite = 0.0
    for i in range(joints.parent.size):
        nonfinite += 0.0 * (w.r[i, 0] + w.r[i, 1] + w.r[i, 2])
        for k in range(6):
            nonfinite += 0.0 * (w.v[i, k] + w.a[i, k] + (w.S[i, k] if i > 0 else 0.0))
        for k in range(21):
            nonfinite += 0.0 * w.I[i, k]
    return 0 if nonfinite == 0.0 else 1

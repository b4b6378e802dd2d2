"""Links of a state from q and v, without Pinocchio: joints of one degree of freedom.

In inertial axes about the base, h the parent of i; the axis of joint i is the third axis of link i:

    R_i = R_h A_i Rot(z, φ_i),   r_i = r_h + R_h b_i                      revolute
    R_i = R_h A_i,               r_i = r_h + R_h b_i + φ_i z_i             prismatic
    S_i = [r_i × z_i; z_i]  or  [z_i; 0]
    v_i = v_h + S_i φ̇_i,   a_i = a_h + v_i ×̂ S_i φ̇_i                      (16), (17) while φ̈ = 0
"""

from __future__ import annotations

from typing import NamedTuple

from ospace.kernels.lanes import Number, Row, Table, inlined, load3, load6, load9, store3, store6, store9, store21
from ospace.kernels.simd import fence, floor, like
from ospace.kernels.spatial import (
    add3,
    add6,
    cross,
    cross_motion,
    mat3_mul,
    rigid_inertia,
    rotate,
    rotate_sym3,
    scale3,
    scale6,
)
from ospace.kernels.tables import Floats, Ints

REVOLUTE, CONTINUOUS, PRISMATIC = 0, 1, 2


class Joints(NamedTuple):
    """What a robot is, in frames whose third axis is the joint's; rows 0…n, row 0 the base."""

    parent: Ints
    kind: Ints
    first: Ints
    """Where the joint's part of q begins."""
    A: Floats
    """(n + 1, 9) the link's axes in its parent's at φ = 0, by columns."""
    b: Floats
    """(n + 1, 3) the link's origin in its parent's axes."""
    com: Floats
    """(n + 1, 3)."""
    inertia: Floats
    """(n + 1, 6) about the centre of mass, lower rows."""
    mass: Floats
    """(n + 1, 2) mass, and armature of the joint."""


class Frames(NamedTuple):
    """Where the links are: rows 0…n."""

    R: Table
    r: Table


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
def rotation(x: Number, y: Number, z: Number, w: Number) -> Row:
    """The rotation of a unit quaternion, by columns."""
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w))
        + (2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w))
        + (2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y))
    )


@inlined
def turned(R: Row, s: Number, c: Number) -> Row:
    """R Rot(z, φ), by sine and cosine of φ."""
    x, y = R[0:3], R[3:6]
    return add3(scale3(x, c), scale3(y, s)) + add3(scale3(y, c), scale3(x, -s)) + R[6:9]


@inlined
def place_links(joints: Joints, q: Table, sine: Table, cosine: Table, frames: Frames, S: Table, I: Table) -> None:
    """Fill frames, joint columns and inertias; `q` (nq, 1) and its sines and cosines."""
    R = rotation(q[3, 0], q[4, 0], q[5, 0], q[6, 0])
    o = like(0.0, R[0])
    store9(frames.R, 0, R)
    store3(frames.r, 0, (o, o, o))
    com = rotate(R, load3(joints.com, 0))
    store21(I, 0, rigid_inertia(com, joints.mass[0, 0], rotate_sym3(R, load6(joints.inertia, 0))))
    for i in range(1, joints.parent.size):
        h, k = joints.parent[i], joints.first[i]
        R_h = load9(frames.R, h)
        r = add3(load3(frames.r, h), rotate(R_h, load3(joints.b, i)))
        R = mat3_mul(R_h, load9(joints.A, i))
        if joints.kind[i] == PRISMATIC:
            z = R[6:9]
            r = add3(r, scale3(z, q[k, 0]))
            store6(S, i, z + (o, o, o))
        else:
            if joints.kind[i] == REVOLUTE:
                s, c = sine[k, 0], cosine[k, 0]
            else:
                s, c = q[k + 1, 0], q[k, 0]
            R = turned(R, s, c)
            z = R[6:9]
            store6(S, i, cross(r, z) + z)
        store9(frames.R, i, R)
        store3(frames.r, i, r)
        com = add3(r, rotate(R, load3(joints.com, i)))
        store21(I, i, rigid_inertia(com, joints.mass[i, 0], rotate_sym3(R, load6(joints.inertia, i))))


@inlined
def move_links(joints: Joints, velocity: Table, frames: Frames, S: Table, v: Table, a: Table) -> None:
    """Fill velocities, seen from the frame that moves along with the base, and accelerations while nothing accelerates.

    `velocity` (nv, 1): base twist in base axes, then joint rates.
    """
    omega = rotate(load9(frames.R, 0), (velocity[3, 0], velocity[4, 0], velocity[5, 0]))
    o = like(0.0, omega[0])
    store6(v, 0, (o, o, o) + omega)
    store6(a, 0, (o, o, o, o, o, o))
    for i in range(1, joints.parent.size):
        h = joints.parent[i]
        across = scale6(load6(S, i), velocity[i + 5, 0])
        moved = add6(load6(v, h), across)
        store6(v, i, moved)
        store6(a, i, add6(load6(a, h), cross_motion(moved, across)))

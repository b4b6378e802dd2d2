"""Rows of the program that keep solids of a robot away from each other and from bodies that move by themselves.

With two points x, x' of `contacts` as points of their bodies, and n the direction in which they are apart,

    d = nᵀ (x − x'),   ḋ = nᵀ (J − J') v,   d̈ = nᵀ (J − J') v̇ + nᵀ (a − a')

J, a of the points as in `points`, a the acceleration while v stays. That n turns is left out of d̈: what it adds is
never negative, since the distance is the largest over all n of what n sees. The base is eliminated as in `custom_rows`;
it falls out where both bodies are the robot's.

The clearance d_0 is kept as `joint_limits` keeps a joint from its lower limit: with y = d − d_0, the deceleration a,
the period h and the horizon T,

    d̈ ≥ min((−ceiling(y + h ḋ/2) − ḋ)/r, max(a, −ḋ/r)),   r = max(h, T/4)

Solids that are too near go apart by a at most; an approach that is too fast, as by a body that moves by itself, is
stopped by what it takes. Where points are more than the program has rows for, those take the rows that have the least
ceiling(y + h ḋ/2) + ḋ.

A round solid is not its material: what turns about the axis of a cylinder does not come nearer by it. Its points are
those of a frame that goes along with the axis z without turning about it: with e from the axis to x, and
ω_f = ω − (ω·z) z,

    v_f = v − (ω·z) z×e,   a_f = a − (α·z) z×e − (ω·z)(ω×z)×e − ω×(ω×e) + ω_f×(ω_f×e)

The nearest point of a sphere or capsule lies at its radius ρ from its core, along ∓n: it moves as the core point does.
"""

from __future__ import annotations

import math

from ospace.kernels.jit.compile import Number, Vec3, Vec6, entry, inlined
from ospace.kernels.jit.load_store import load3, load3_at, load6, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.qp.contacts import (
    DISTANCE,
    NORMAL,
    OTHER,
    POINT,
    QUICKER,
    Contacts,
    Pairs,
    Solids,
    axes_of,
    find_contacts,
    motion_of,
)
from ospace.kernels.qp.joint_limits import ceiling
from ospace.kernels.qp.tables import UNLIMITED, Program
from ospace.kernels.spatial import add3, cross, dot3, dot6, motion_at, rotate, scale3, sub3
from ospace.kernels.tasks.rows import base_response
from ospace.kernels.tasks.tables import BaseActuation
from ospace.kernels.tree import Floats, Ints
from ospace.kernels.workspace import Robot, Work, open_robot, open_work

OF_A_PAIR = 9
"""Contacts of a pair that are kept at most: the nearest points, and eight."""


@entry
def write_clearance_rows(
    memory: Floats,
    base: BaseActuation,
    clearance: float,
    a: float,
    h: float,
    horizon: float,
    solids: Solids,
    pairs: Pairs,
    contacts: Contacts,
    rows: Ints,
    first: int,
    program: Program,
    found: Ints,
) -> bool:
    """Write rows for those of the pairs `found` that are near enough to `Program.C`, from row `first` on.

    `rows` (g,) are the numbers of the pairs that rows are of, −1 for a row that bounds nothing; written. Returns
    whether they are others than before.
    """
    here = unowned(memory)
    robot, w = open_robot(here), open_work(here, zeros(1))
    base_response(w, base)
    T, count = max(h, horizon), 0
    size, r = program.f.size, max(h, 0.25 * T)
    soon = QUICKER * (h + r)
    contacts.least[:] = soon
    for k in found:
        if pairs.least[k] < pairs.reach[k]:
            start, count = count, find_contacts(w, solids, pairs, contacts, k, count)
            for c in range(start, count):
                rate = approach(w, solids, pairs.first[k], contacts.numbers, c, POINT, 1.0)
                rate += approach(w, solids, pairs.second[k], contacts.numbers, c, OTHER, -1.0)
                y = contacts.numbers[c, DISTANCE] - clearance
                contacts.rate[c], contacts.slack[c] = rate, ceiling(y + 0.5 * h * rate, a, T) + rate
            keep_tightest(contacts, start, count)
    for c in range(count):
        slack = contacts.slack[c]
        for g in range(contacts.least.size if slack < soon else 0):
            if slack < contacts.least[g]:
                contacts.least[g], slack = slack, contacts.least[g]
    g, changed = 0, False
    for c in range(count):
        if contacts.slack[c] <= contacts.least[-1] and contacts.slack[c] < soon and g < rows.size:
            changed |= rows[g] != contacts.pair[c]
            rows[g] = contacts.pair[c]
            drift = write_contact(robot, w, base, solids, pairs, contacts, c, program.C, first + g)
            program.lower[size + first + g] = min(-contacts.slack[c] / r, max(a, -contacts.rate[c] / r)) - drift
            g += 1
    for row in range(g, rows.size):
        changed |= rows[row] != -1
        rows[row] = -1
        for column in range(size):
            program.C[first + row, column] = 0.0
        program.lower[size + first + row] = -UNLIMITED
    return changed


@inlined
def keep_tightest(contacts: Contacts, start: int, end: int) -> None:
    """Leave those contacts of a pair that have the least slack, and the first one, which are the nearest points."""
    for _ in range(end - start - OF_A_PAIR):
        loosest = start + 1
        for c in range(start + 2, end):
            if contacts.slack[loosest] == math.inf or math.inf > contacts.slack[c] > contacts.slack[loosest]:
                loosest = c
        contacts.slack[loosest] = math.inf


@inlined
def approach(w: Work, solids: Solids, s: int, numbers: Floats, c: int, at: int, sign: float) -> Number:
    """Velocity along n of the point of solid `s` in contact `c`, times `sign`."""
    p, f = load3_at(numbers, c, at), scale3(load3_at(numbers, c, NORMAL), sign)
    v, _ = motion_of(w, solids, s, p)
    return dot3(f, v[0:3]) + dot3(moment_about_axis(w, solids, s, p, f), v[3:6])


@inlined
def write_contact(
    robot: Robot,
    w: Work,
    base: BaseActuation,
    solids: Solids,
    pairs: Pairs,
    contacts: Contacts,
    c: int,
    C: Floats,
    row: int,
) -> Number:
    """Write d̈ = C z + a⁰ of contact `c` to a row; return a⁰."""
    k, n, drift = contacts.pair[c], load3_at(contacts.numbers, c, NORMAL), 0.0
    for column in range(C.shape[1]):
        C[row, column] = 0.0
    floats = solids.link[pairs.first[k]] < 0 or solids.link[pairs.second[k]] < 0  # else the base moves both alike
    for side in range(2):
        s, sign = (pairs.first[k], 1.0) if side == 0 else (pairs.second[k], -1.0)
        p, f = load3_at(contacts.numbers, c, POINT if side == 0 else OTHER), scale3(n, sign)
        m = moment_about_axis(w, solids, s, p, f)
        drift += acceleration_along(w, solids, s, p, f, m)
        link = solids.link[s]
        if floats and link >= 0:
            drift += write_base_columns(w, base, f + add3(cross(p, f), m), C, row)
        while link > 0:
            S = load6(w.S, link)
            along = motion_at(sub3(p, load3(w.r, link)), S)
            C[row, robot.joints.column[link] - 1] += dot3(f, along[0:3]) + dot3(m, along[3:6])
            link = robot.joints.parent[link]
    return drift


@inlined
def moment_about_axis(w: Work, solids: Solids, s: int, p: Vec3, f: Vec3) -> Vec3:
    """−fᵀ(z×e) z: what takes the turning about its axis from the velocity of p along f."""
    if solids.disc[s] == 0.0:
        return (0.0, 0.0, 0.0)
    R, r = axes_of(w, solids, s)
    z = rotate(R, load3(solids.axis, s))
    arm = sub3(p, add3(r, rotate(R, load3(solids.centre, s))))
    return scale3(z, -dot3(f, cross(z, arm)))


@inlined
def acceleration_along(w: Work, solids: Solids, s: int, p: Vec3, f: Vec3, m: Vec3) -> Number:
    """Acceleration along f, which points into solid `s` at p, while v stays; without what turns about its axis."""
    v, a = motion_of(w, solids, s, p)
    omega = v[3:6]
    along = dot3(f, a[0:3]) + dot3(m, a[3:6])
    if solids.disc[s] == 0.0:
        e = scale3(f, -solids.rounding[s])
        return along - dot3(f, cross(omega, cross(omega, e)))
    R, r = axes_of(w, solids, s)
    z, arm = rotate(R, load3(solids.axis, s)), sub3(p, add3(r, rotate(R, load3(solids.centre, s))))
    e, spin = sub3(arm, scale3(z, dot3(arm, z))), dot3(omega, z)
    slow = sub3(omega, scale3(z, spin))
    along += dot3(f, cross(slow, cross(slow, e))) - dot3(f, cross(omega, cross(omega, e)))
    return along - spin * dot3(f, cross(cross(omega, z), e))


@inlined
def write_base_columns(w: Work, base: BaseActuation, f: Vec6, C: Floats, row: int) -> Number:
    """Add fᵀ ẍ_b to a row, and return what it is while z = 0; f at the base."""
    n = w.J_m_star.shape[0]
    for k in range(n):
        C[row, k] += dot6(f, load6(w.J_b_star, k + 1))
    for k in range(base.component.size):
        C[row, n + k] += dot6(f, load6(base.response, k))
    return dot6(f, load6(w.base_drift, 0))

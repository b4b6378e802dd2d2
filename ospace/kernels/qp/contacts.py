"""Points of solids that come near to each other: which pairs are near enough to matter, and where.

Which pairs are, is found without their distances. Between two cycles no point of a solid moves by more than
|Δc| + ρ |ΔR|_F/√2 as seen from the base, c and ρ the centre and radius of a sphere around it, or by |Δc| + ρ |Δz|
where it is round about z; summed over the cycles these are its path s. A distance that was d once is then at least
d − Δs − Δs', and no less than that of the spheres. What may be nearer than the clearance and the way of braking,
v T + v²/(2a), is looked at, v the speed at which points of the two move against each other at most.

Of each such pair the nearest points x, x' and the unit vector n from x' to x are found elsewhere. Where a solid turns,
another of its points becomes the nearest one, at a speed of its own; so further points are kept away likewise. With t a
direction across n, X and X' the points of the two solids that lie furthest along t − n and t + n, and s, s' how far
they are from x and x' along t,

    x + min(1, s'/s) (X − x)   stands opposite to   x' + min(1, s/s') (X' − x')

Of faces and edges that face each other these are the corners of what both have in common. The directions t are those of
a solid's own points beside x, for some directions around.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ospace.kernels.jit.compile import Mat3, Vec3, Vec6, entry, inlined
from ospace.kernels.jit.load_store import load3, load3_at, load6, load9, store3, store9, unowned
from ospace.kernels.jit.simd import zeros
from ospace.kernels.spatial import (
    add3,
    classical,
    cross,
    dot3,
    mat3_mul,
    mat3_transpose,
    motion_at,
    rotate,
    scale3,
    sub3,
)
from ospace.kernels.tree import Floats, Ints
from ospace.kernels.workspace import Work, open_work

QUICKER = 20.0
"""By which two bodies may speed up against each other within a cycle, m/s²: pairs are looked at before they matter."""
_SPARE = 0.01
"""And within which a pair is looked at in any case, m."""
DISTANCE, NORMAL, POINT, OTHER = 0, 1, 4, 7
"""Where they stand among the ten numbers of a pair."""
_TOUCHING = 1e-6
"""m; nearer points say nothing of a direction, and Coal's normal stands for it."""
NO_AXIS, AXIS, BALL = 0, 1, 2
"""Symmetry of solids."""
_DEEPEST = 1e6
"""m; solids do not overlap by more."""
_ACROSS = 1e-6
"""m; points nearer to another one say nothing more."""
_AROUND = 8
"""Directions across n in which further points are looked for, from either solid."""
MOST_CONTACTS = 1 + 2 * _AROUND


class Solids(NamedTuple):
    """Solids on links of the robot, and on bodies that move by themselves."""

    link: Ints
    """(s,) link that carries each; −1 − m for body m."""
    centre: Floats
    """(s, 3) of a sphere around it, in axes of the link or body; m."""
    radius: Floats
    """(s,) of that."""
    symmetry: Ints
    """(s,) `NO_AXIS`, `AXIS`, or `BALL`."""
    axis: Floats
    """(s, 3) of symmetry through the centre, in axes of the link or body; zeros without one."""
    corner: Floats
    """(c, 3) points whose hull is the core of a solid, in these axes; m."""
    first: Ints
    """(s + 1,) where those of each begin."""
    disc: Floats
    """(s,) radius of the discs around these across the axis, which make a cylinder; else 0, m."""
    rounding: Floats
    """(s,) radius of the balls around the core, which make a sphere or capsule; else 0, m."""
    body_R: Floats
    """(bodies, 9) axes of the bodies, by columns."""
    body_r: Floats
    """(bodies, 3) their origins about the base; m."""
    body_v: Floats
    """(bodies, 6) velocity of each origin as seen from the base's, and angular velocity; inertial axes."""
    body_a: Floats
    """(bodies, 6) classical acceleration of each origin, and angular acceleration, likewise."""
    place: Floats
    """(s, 3) work: centre of each as seen from the base, base axes."""
    turn: Floats
    """(s, 9) work: axes of each, or its axis of symmetry, likewise."""
    path: Floats
    """(s,) work: how far its points have gone at most, m."""
    velocity: Floats
    """(s, 3) work: of its centre as seen from the base, inertial axes, m/s."""
    swing: Floats
    """(s,) work: how fast its points go at most beside that, m/s."""


class Pairs(NamedTuple):
    """Pairs of solids that are watched."""

    first: Ints
    second: Ints
    """(p,) numbers of the solids."""
    numbers: Floats
    """(p, 10) when they were looked at last: distance, −n, both points; inertial axes, about the base; m."""
    path: Floats
    """(p,) paths of both together then; −∞ before."""
    least: Floats
    """(p,) least distance that is possible now; written."""
    reach: Floats
    """(p,) distance from which on a pair matters: the clearance and the way of braking; written."""


class Contacts(NamedTuple):
    """Points of pairs that are kept away from each other; work of `clearance`."""

    pair: Ints
    """(c,) of which pair each is."""
    numbers: Floats
    """(c, 10) distance along n, n, both points; as in `Pairs`."""
    slack: Floats
    """(c,) by how much faster the two may approach each other than they do, m/s."""
    rate: Floats
    """(c,) ḋ, m/s."""
    least: Floats
    """(g,) the smallest of these, as many as there are rows."""


@entry
def bound_distances(
    memory: Floats, solids: Solids, pairs: Pairs, clearance: float, a: float, h: float, horizon: float
) -> None:
    """Write how near each pair can be by now, for the state that was evaluated last in `memory`."""
    w = open_work(unowned(memory), zeros(1))
    to_base = mat3_transpose(load9(w.R, 0))
    for s in range(solids.link.size):
        R, r = axes_of(w, solids, s)
        p = add3(r, rotate(R, load3(solids.centre, s)))
        velocity, _ = motion_of(w, solids, s, p)
        omega = sub3(velocity[3:6], load3_at(w.v, 0, 3))
        place, turn, share = rotate(to_base, p), mat3_mul(to_base, R), 0.5
        if solids.symmetry[s] != NO_AXIS:
            along = rotate(R, load3(solids.axis, s))
            omega = sub3(omega, scale3(along, dot3(omega, along)))
            none = (0.0, 0.0, 0.0)
            turn, share = rotate(to_base, along) + none + none, 1.0
        if solids.symmetry[s] == BALL:
            omega = (0.0, 0.0, 0.0)
        moved, before, square = sub3(place, load3(solids.place, s)), load9(solids.turn, s), 0.0
        for k in range(9):
            square += (turn[k] - before[k]) * (turn[k] - before[k])
        solids.path[s] += math.sqrt(dot3(moved, moved)) + solids.radius[s] * math.sqrt(share * square)
        store3(solids.place, s, place)
        store9(solids.turn, s, turn)
        store3(solids.velocity, s, sub3(velocity[0:3], cross(load3_at(w.v, 0, 3), p)))
        solids.swing[s] = solids.radius[s] * math.sqrt(dot3(omega, omega))
    T = max(h, horizon)
    for k in range(pairs.first.size):
        i, j = pairs.first[k], pairs.second[k]
        apart = sub3(load3(solids.place, i), load3(solids.place, j))
        by_path = pairs.numbers[k, DISTANCE] - (solids.path[i] + solids.path[j] - pairs.path[k])
        pairs.least[k] = max(by_path, math.sqrt(dot3(apart, apart)) - solids.radius[i] - solids.radius[j])
        v = sub3(load3(solids.velocity, i), load3(solids.velocity, j))
        speed = math.sqrt(dot3(v, v)) + solids.swing[i] + solids.swing[j] + QUICKER * h
        pairs.reach[k] = clearance + speed * (T + speed / (2.0 * a)) + _SPARE


@entry
def take_distances(solids: Solids, pairs: Pairs, found: Ints) -> int:
    """Take the distances of the pairs `found` as known now; return the pair that may be the nearest of all.

    −1 − k where the distance of pair k is none.
    """
    for k in found:
        if not pairs.numbers[k, DISTANCE] > -_DEEPEST:
            return -1 - int(k)
        pairs.least[k] = pairs.numbers[k, DISTANCE]
        pairs.path[k] = solids.path[pairs.first[k]] + solids.path[pairs.second[k]]
    smallest = 0
    for k in range(pairs.least.size):
        if pairs.least[k] < pairs.least[smallest]:
            smallest = k
    return smallest


@inlined
def find_contacts(w: Work, solids: Solids, pairs: Pairs, contacts: Contacts, k: int, count: int) -> int:
    """Write the points of pair `k` that are kept away from each other from `count` on; return the new count."""
    x, other, n = load3_at(pairs.numbers, k, POINT), load3_at(pairs.numbers, k, OTHER), direction(pairs, k)
    count = store_contact(contacts, count, count, k, n, x, other)
    i, j, start = pairs.first[k], pairs.second[k], count - 1
    u, v = across(n)
    for side in range(2 * _AROUND):
        angle = 2.0 * math.pi / _AROUND * (side // 2)
        t = add3(scale3(u, math.cos(angle)), scale3(v, math.sin(angle)))
        if side % 2 == 0:
            X = sub3(furthest(w, solids, i, sub3(t, n), scale3(n, -1.0)), x)
        else:
            X = sub3(furthest(w, solids, j, add3(t, n), n), other)
        lateral = sub3(X, scale3(n, dot3(n, X)))
        far = math.sqrt(dot3(lateral, lateral))
        if far > _ACROSS:
            t = scale3(lateral, 1.0 / far)
            if side % 2 == 0:
                opposite = sub3(furthest(w, solids, j, add3(t, n), n), other)
            else:
                opposite = sub3(furthest(w, solids, i, sub3(t, n), scale3(n, -1.0)), x)
            beyond = dot3(t, opposite)
            if beyond > _ACROSS:
                X, opposite = scale3(X, min(1.0, beyond / far)), scale3(opposite, min(1.0, far / beyond))
                one, two = (X, opposite) if side % 2 == 0 else (opposite, X)
                count = store_contact(contacts, start, count, k, n, add3(x, one), add3(other, two))
    return count


@inlined
def store_contact(contacts: Contacts, start: int, count: int, k: int, n: Vec3, x: Vec3, other: Vec3) -> int:
    """Add a row to the table unless one from `start` on is the same; return the new count."""
    for c in range(start, count):
        one, two = sub3(load3_at(contacts.numbers, c, POINT), x), sub3(load3_at(contacts.numbers, c, OTHER), other)
        if dot3(one, one) + dot3(two, two) < _ACROSS * _ACROSS:
            return count
    contacts.pair[count] = k
    contacts.numbers[count, DISTANCE] = dot3(n, sub3(x, other))
    for i in range(3):
        contacts.numbers[count, NORMAL + i] = n[i]
        contacts.numbers[count, POINT + i], contacts.numbers[count, OTHER + i] = x[i], other[i]
    return count + 1


@inlined
def across(n: Vec3) -> tuple[Vec3, Vec3]:
    """Two directions across n and each other."""
    x, y, z = abs(n[0]), abs(n[1]), abs(n[2])
    least = (1.0, 0.0, 0.0) if x <= min(y, z) else (0.0, 1.0, 0.0) if y <= z else (0.0, 0.0, 1.0)
    u = cross(n, least)
    u = scale3(u, 1.0 / math.sqrt(dot3(u, u)))
    return u, cross(n, u)


@inlined
def furthest(w: Work, solids: Solids, s: int, along: Vec3, outward: Vec3) -> Vec3:
    """Point of solid `s` that lies furthest along a direction, but for its rounding, which is outward."""
    R, r = axes_of(w, solids, s)
    own, best, largest = rotate(mat3_transpose(R), along), 0, -math.inf
    for c in range(solids.first[s], solids.first[s + 1]):
        d = dot3(own, load3(solids.corner, c))
        if d > largest:
            best, largest = c, d
    p = load3(solids.corner, best)
    if solids.disc[s] > 0.0:
        z = load3(solids.axis, s)
        radial = sub3(own, scale3(z, dot3(own, z)))
        length = math.sqrt(dot3(radial, radial))
        if length > 0.0:
            p = add3(p, scale3(radial, solids.disc[s] / length))
    return add3(add3(r, rotate(R, p)), scale3(outward, solids.rounding[s]))


@inlined
def direction(pairs: Pairs, k: int) -> Vec3:
    """Unit vector of pair `k` from the second solid to the first."""
    d = pairs.numbers[k, DISTANCE]
    if d > _TOUCHING:
        return scale3(sub3(load3_at(pairs.numbers, k, POINT), load3_at(pairs.numbers, k, OTHER)), 1.0 / d)
    return scale3(load3_at(pairs.numbers, k, NORMAL), -1.0)


@inlined
def axes_of(w: Work, solids: Solids, s: int) -> tuple[Mat3, Vec3]:
    """Axes and origin of what carries solid `s`."""
    link = solids.link[s]
    if link >= 0:
        return load9(w.R, link), load3(w.r, link)
    return load9(solids.body_R, -1 - link), load3(solids.body_r, -1 - link)


@inlined
def motion_of(w: Work, solids: Solids, s: int, p: Vec3) -> tuple[Vec6, Vec6]:
    """Velocity of the point `p` of solid `s` as seen from the base's, and its classical acceleration while v stays."""
    link = solids.link[s]
    if link >= 0:
        arm = sub3(p, load3(w.r, link))
        v = motion_at(arm, load6(w.v, link))
        return v, classical(motion_at(arm, load6(w.a, link)), v)
    arm = sub3(p, load3(solids.body_r, -1 - link))
    v, a = load6(solids.body_v, -1 - link), load6(solids.body_a, -1 - link)
    around = cross(v[3:6], cross(v[3:6], arm))
    moved = motion_at(arm, a)
    return motion_at(arm, v), add3(moved[0:3], around) + moved[3:6]

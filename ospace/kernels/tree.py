"""The layout of a robot and its points, as kernels take it.

The recursions run over *links*. Link 0 is the base; link i hangs from ``parent[i]`` by the one-column joint i, whose
rate is ``velocity[5 + column[i]]``. A joint with k columns is k such joints with massless links between them,
eliminated one after the other, which covers every joint type that Pinocchio has. The link behind the last of them
carries the body.

A joint that mimics another, its leader, is a *follower*: at ratio · φ + offset where the leader is at φ. It shares the
leader's column, and its S is that of a unit rate of the leader. All that is linear in the joint rates is then the sum
over the links that share a column; H is Gᵀ H_free G with φ̇_free = G φ̇.

Each link has axes of its own; the third is the axis of its joint where the joint has one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

REVOLUTE, CONTINUOUS, PRISMATIC, HELICAL, SPHERICAL, PLANAR, FLOATING, SAME_JOINT, UNKNOWN = range(9)
"""Kinds of joints by their part of q: an angle; its cosine and sine; a displacement; an angle that displaces; a
quaternion; x, y, cosine and sine; position and quaternion. `SAME_JOINT`: a further column of the joint before.
`UNKNOWN`: placed by Pinocchio alone."""

COLUMNS = (1, 1, 1, 1, 3, 3, 6, 1, 1)
"""Columns of each kind."""


def path_to(parent: Ints, i: int) -> list[int]:
    """Return the links from the base, not included, out to link `i`, where `parent` holds each link's parent."""
    path = []
    while i > 0:
        path.append(i)
        i = int(parent[i])
    return path[::-1]


class Joints(NamedTuple):
    """Constants of a robot; a row for each link, row 0 the base."""

    parent: Ints
    """The link on the side of the base; always the smaller number."""
    kind: Ints
    first: Ints
    """Where the joint's part of q begins."""
    body: Ints
    """The Pinocchio joint whose frame carries the link."""
    turning: Ints
    """1 where the column is [0; z], whoever places the links."""
    column: Ints
    """1…n: the degree of freedom that moves the link; i for link i where no joint mimics another."""
    link_of: Ints
    """(n,) the link of each degree of freedom: its own or the leader's."""
    followers: Ints
    """(m,) links of the followers."""
    leaders: Ints
    """(m,) the link of the leader of each."""
    A: Floats
    """(n + 1, 9) the link's axes in its parent's where q is neutral, by columns."""
    b: Floats
    """(n + 1, 3) the link's origin in its parent's axes, likewise; m."""
    first_moments: Floats
    """(n + 1, 3) mass times centre of mass, in the link's axes; kg m."""
    inertia: Floats
    """(n + 1, 6) rotational inertia about the link's origin, likewise, lower rows; kg m²."""
    mass: Floats
    """(n + 1, 1) kg."""
    armature: Floats
    """(n + 1, 1) inertia of the drive, felt along the joint alone; kg m², or kg."""
    pitch: Floats
    """(n + 1, 1) displacement by angle of a helical joint; m/rad."""
    ratio: Floats
    """(n + 1, 1) rate of the joint per unit rate of its leader; 1 where it has none."""
    offset: Floats
    """(n + 1, 1) of followers, rad or m."""
    axes: Floats
    """(n + 1, 9) the link's axes in those of its Pinocchio joint, by columns."""


class Nodes(NamedTuple):
    """Points, and links in which the ways to several points meet; node 0 is the base, parents come first."""

    parent: Ints
    link: Ints
    point: Ints
    """Number of the point, or −1 for a junction."""
    last_descendant: Ints
    """The last node whose block with this one is wanted: for a junction, its last child."""
    of_link: Ints
    """(n + 1,) the node next below each link, itself included, with no other node between; 0 where there is none."""
    offset: Floats
    """(nodes, 3) of points: their position in the link's axes; m."""

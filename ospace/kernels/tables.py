"""The tables that kernels share.

The recursions run over *links*. Link 0 is the base; link i hangs from ``parent[i]`` by the one-column joint i,
whose rate is ``v[5 + i]``. A joint with k columns is k such joints with massless links between them: they are
eliminated one after the other, which covers every joint type that Pinocchio has.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class Links(NamedTuple):
    """What a robot is, whatever its state; rows 0…n."""

    parent: Ints
    """The link on the side of the base; always the smaller number."""
    body: Ints
    """The Pinocchio joint whose placement carries the link."""
    hinge: Ints
    """The Pinocchio joint against whose acceleration the link's own is taken: `body` again for a massless link."""
    mass: Floats
    com: Floats
    """(n + 1, 3) centre of mass, axes of the body."""
    inertia: Floats
    """(n + 1, 6) rotational inertia about the centre of mass, axes of the body, lower rows."""
    armature: Floats
    """Inertia of the drive, felt along the joint alone."""


class Tree(NamedTuple):
    """The links in one state: inertial axes, centred on the base, seen from the frame that moves along with it.

    In that frame the base has no linear velocity. All but the momentum is the same in it, and neither the distance
    from the origin nor an orbital velocity costs a digit.
    """

    S: Floats
    """(n + 1, 6) joint columns; row 0 is not used."""
    I: Floats
    """(n + 1, 21) inertias."""
    v: Floats
    """(n + 1, 6) velocities."""
    c: Floats
    """(n + 1, 6) velocity-product accelerations across the joints."""


class Points(NamedTuple):
    """Operational points on the links, whatever the state."""

    link: Ints
    body: Ints
    """The Pinocchio joint whose placement carries the point."""
    offset: Floats
    """(p, 3) place of the point, axes of the body."""
    path: Ints
    """(p, depth) the links from the base, not included, out to the point's link."""
    depth: Ints
    """How many of a row of `path` count."""


class Articulated(NamedTuple):
    """What the inward sweep leaves behind, rows 0…n."""

    I: Floats
    """(n + 1, 21) articulated-body inertias I^A."""
    p: Floats
    """(n + 1, 6) articulated bias forces p^A."""
    U: Floats
    """(n + 1, 6) U_i = I_i^A S_i."""
    beta_inv: Floats
    """1/β_i, β_i = S_iᵀ U_i."""
    u: Floats
    """S_iᵀ (p_i^A + I_i^A c_i)."""

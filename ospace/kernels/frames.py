"""Links of one state from Pinocchio's frame data.

In inertial axes about the base, h the parent of i:

    v_i = v_h + S_i φ̇_i                     (16)
    c_i = a_i − a_h at φ̈ = 0                (17)
    I_i = X I_{c_i} Xᵀ                       §4.2.1
"""

from __future__ import annotations

from ospace.kernels.lanes import entry, inlined, load3, load6, load9, load_translation, store6, store21
from ospace.kernels.spatial import add3, add6, rigid_inertia, rotate, rotate_sym3, scale6, sub6
from ospace.kernels.tables import Floats, Links, Tree


@inlined
def inertia_of(links: Links, placements: Floats, i: int) -> tuple[float, ...]:
    """Inertia of link `i` about the base."""
    R = load9(placements, links.body[i])
    c = add3(load_translation(placements, links.body[i]), rotate(R, load3(links.com, i)))
    return rigid_inertia(c, links.mass[i], rotate_sym3(R, load6(links.inertia, i)))


@entry
def place(links: Links, placements: Floats, J: Floats, a: Floats, v: Floats, tree: Tree) -> None:
    """Fill `tree`.

    Parameters
    ----------
    placements : (n_bodies, 12) rotation by columns, then translation; inertial axes, about the base.
    J : (nv, 6) joint columns, likewise; the first six rows are the base's.
    a : (n_bodies, 6) spatial accelerations at zero q̈, likewise.
    v : (nv,) base twist in base axes, then joint rates.
    """
    R = load9(placements, links.body[0])
    omega = rotate(R, (v[3], v[4], v[5]))
    still = (0.0 * omega[0], 0.0 * omega[1], 0.0 * omega[2])
    store21(tree.I, 0, inertia_of(links, placements, 0))
    store6(tree.v, 0, still + omega)
    store6(tree.c, 0, still + still)
    store6(tree.S, 0, still + still)
    for i in range(1, links.parent.size):
        S = load6(J, i + 5)
        store6(tree.S, i, S)
        store21(tree.I, i, inertia_of(links, placements, i))
        store6(tree.v, i, add6(load6(tree.v, links.parent[i]), scale6(S, v[i + 5])))
        store6(tree.c, i, sub6(load6(a, links.body[i]), load6(a, links.hinge[i])))

"""Parts of the inward sweep (38), (42) of articulated bodies."""

from __future__ import annotations

from ospace.kernels.lanes import Number, Row, inlined
from ospace.kernels.simd import size
from ospace.kernels.spatial import scale6, sub6, sym6_outer, sym6_sub


@inlined
def inertia_across(I: Row, U: Row, beta_inv: Number) -> Row:
    """I L = I − U Uᵀ/β: what is felt of the inertia I beyond the joint."""
    return sym6_sub(I, sym6_outer(U, scale6(U, beta_inv)))


@inlined
def force_across(p: Row, U: Row, u: Number, beta_inv: Number) -> Row:
    """Return p − U u/β: what is felt of the force p beyond the joint, u = Sᵀ p."""
    return sub6(p, scale6(U, u * beta_inv))


NO_INERTIA = 1e-13
"""A joint whose share of inertia is smaller moves nothing: so near rounding, all that would follow is noise."""


@inlined
def inertia_share(I: Row, S: Row, beta: Number) -> Number:
    """β over the terms that it is made of, Σ S_k² I_kk: where it falls to rounding, the joint has no inertia left."""
    terms = (
        S[0] * S[0] * size(I[0]) + S[1] * S[1] * size(I[2]) + S[2] * S[2] * size(I[5])
        + S[3] * S[3] * size(I[9]) + S[4] * S[4] * size(I[14]) + S[5] * S[5] * size(I[20])
    )  # fmt: skip
    return beta / (terms + 1e-300)  # no terms, no inertia

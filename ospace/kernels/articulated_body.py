"""The articulated-body step: a link is eliminated, and its parent feels what is left of it beyond the joint.

U_i = I_i^A S_i,   β_i = S_iᵀ U_i
I_i^A L_i = I_i^A − U_i U_iᵀ/β_i                                           (38)
L_iᵀ p_i^A = p_i^A − U_i S_iᵀ p_i^A/β_i                                    (42)
"""

from __future__ import annotations

from ospace.kernels.jit.compile import Number, Sym6, Vec6, inlined
from ospace.kernels.jit.simd import absolute
from ospace.kernels.spatial import scale6, sub6, sym6_outer, sym6_sub

NO_INERTIA = 1e-13
"""Relative pivot below which a joint moves nothing: the result is dominated by round-off."""


@inlined
def inertia_across(I: Sym6, U: Vec6, beta_inv: Number) -> Sym6:
    """I L = I − U Uᵀ/β: the inertia felt beyond the joint."""
    return sym6_sub(I, sym6_outer(U, scale6(U, beta_inv)))


@inlined
def force_across(p: Vec6, U: Vec6, u: Number, beta_inv: Number) -> Vec6:
    """Return p − U u/β: the force felt beyond the joint, u = Sᵀ p."""
    return sub6(p, scale6(U, u * beta_inv))


@inlined
def relative_pivot(beta: Number, terms: Number) -> Number:
    """β over the terms that it is made of: where it falls to rounding, the joint has no inertia left."""
    return beta / (terms + 1e-300)  # no terms, no inertia


@inlined
def pivot_terms(I: Sym6, S: Vec6) -> Number:
    """Return |S|² times the traces of the link's inertia."""
    linear = S[0] * S[0] + S[1] * S[1] + S[2] * S[2]
    angular = S[3] * S[3] + S[4] * S[4] + S[5] * S[5]
    return linear * (absolute(I[0]) + absolute(I[2]) + absolute(I[5])) + angular * trace_angular(I)


@inlined
def trace_angular(I: Sym6) -> Number:
    """The same where S = [0; z] is of unit length."""
    return absolute(I[9]) + absolute(I[14]) + absolute(I[20])

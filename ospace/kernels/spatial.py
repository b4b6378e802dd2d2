"""Spatial algebra on tuples of numbers, whose types are declared in `ospace.kernels.jit.compile`.

All quantities of a state stand in inertial axes, so that the paper's ᵢʰX between links is a shift of the origin alone:
`motion_at`, `force_from`, `inertia_from`.
"""

from __future__ import annotations

from ospace.kernels.jit.compile import Mat3, Mat6, Number, Row, Sym3, Sym6, Vec3, Vec6, inlined
from ospace.kernels.jit.simd import full_like, maximum, minimum

# -- three-dimensional ---------------------------------------------------------------------------------------


@inlined
def add3(a: Vec3, b: Vec3) -> Vec3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@inlined
def sub3(a: Vec3, b: Vec3) -> Vec3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@inlined
def scale3(a: Vec3, k: Number) -> Vec3:
    return (a[0] * k, a[1] * k, a[2] * k)


@inlined
def dot3(a: Vec3, b: Vec3) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a: Vec3, b: Vec3) -> Vec3:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def rotate(R: Mat3, a: Vec3) -> Vec3:
    """R a."""
    return add3(add3(scale3(R[0:3], a[0]), scale3(R[3:6], a[1])), scale3(R[6:9], a[2]))


@inlined
def rotate_sym3(R: Mat3, I: Sym3) -> Sym3:
    """R I Rᵀ."""
    x = rotate(R, (I[0], I[1], I[3]))  # the columns of R I
    y = rotate(R, (I[1], I[2], I[4]))
    z = rotate(R, (I[3], I[4], I[5]))
    return sym3_of_product(x + y + z, R)


@inlined
def sym3_of_product(A: Mat3, B: Mat3) -> Sym3:
    """A Bᵀ, where it is symmetric."""
    return (
        A[0] * B[0] + A[3] * B[3] + A[6] * B[6],
        A[1] * B[0] + A[4] * B[3] + A[7] * B[6],
        A[1] * B[1] + A[4] * B[4] + A[7] * B[7],
        A[2] * B[0] + A[5] * B[3] + A[8] * B[6],
        A[2] * B[1] + A[5] * B[4] + A[8] * B[7],
        A[2] * B[2] + A[5] * B[5] + A[8] * B[8],
    )


@inlined
def sym3_to_mat(a: Sym3) -> Mat3:
    return (a[0], a[1], a[3], a[1], a[2], a[4], a[3], a[4], a[5])


@inlined
def sym3_factor(a: Sym3) -> Row:
    """L D Lᵀ = a, as l_10, l_20, l_21, the three numbers of D⁻¹, and the smallest of D."""
    i0 = 1.0 / a[0]
    l10, l20 = a[1] * i0, a[3] * i0
    d1 = a[2] - l10 * a[1]
    i1 = 1.0 / d1
    u = a[4] - l20 * a[1]
    l21 = u * i1
    d2 = a[5] - l20 * a[3] - l21 * u
    return (l10, l20, l21, i0, i1, 1.0 / d2, minimum(minimum(a[0], d1), d2))


@inlined
def sym3_of_factor(f: Row) -> Sym3:
    """Return L⁻ᵀ D⁻¹ L⁻¹."""
    n, x = f[0] * f[2] - f[1], f[2] * f[5]
    y = n * f[5]
    return (f[3] + f[0] * f[0] * f[4] + n * y, -f[0] * f[4] - n * x, f[4] + f[2] * x, y, -x, f[5])


@inlined
def sym3_inverse(a: Sym3) -> Sym3:
    return sym3_of_factor(sym3_factor(a))


@inlined
def sym3_sub(a: Sym3, b: Sym3) -> Sym3:
    return add3(a[0:3], scale3(b[0:3], -1.0)) + add3(a[3:6], scale3(b[3:6], -1.0))


# -- motions and forces --------------------------------------------------------------------------------------


@inlined
def add6(a: Vec6, b: Vec6) -> Vec6:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5])


@inlined
def sub6(a: Vec6, b: Vec6) -> Vec6:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3], a[4] - b[4], a[5] - b[5])


@inlined
def scale6(a: Vec6, k: Number) -> Vec6:
    return (a[0] * k, a[1] * k, a[2] * k, a[3] * k, a[4] * k, a[5] * k)


@inlined
def dot6(a: Vec6, b: Vec6) -> Number:
    return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])


@inlined
def zero6(a: Row) -> Vec6:
    """Six zeros, of the kind of number that `a` holds."""
    o = full_like(0.0, a[0])
    return (o, o, o, o, o, o)


@inlined
def zero21(number: Number) -> Sym6:
    """Zeros for a symmetric 6×6, of the kind of `number`."""
    none = zero6((number,))
    return none + none + none + none[0:3]


@inlined
def linear(a: Vec6) -> Vec3:
    return a[0:3]


@inlined
def angular(a: Vec6) -> Vec3:
    return a[3:6]


@inlined
def cross_motion(v: Vec6, m: Vec6) -> Vec6:
    """Return v ×̂ m for a motion m: [ω̃ ṽ; 0 ω̃] m."""
    return add3(cross(angular(v), linear(m)), cross(linear(v), angular(m))) + cross(angular(v), angular(m))


@inlined
def cross_force(v: Vec6, f: Vec6) -> Vec6:
    """Return v ×̂ f for a momentum or force f: [ω̃ 0; ṽ ω̃] f (the dual of the operator on motions)."""
    return cross(angular(v), linear(f)) + add3(cross(linear(v), linear(f)), cross(angular(v), angular(f)))


@inlined
def body_force(I: Sym6, v: Vec6, a: Vec6) -> Vec6:
    """I a + v ×̂ I v: the net force on a body of inertia I (19)."""
    return add6(sym6_mul(I, a), cross_force(v, sym6_mul(I, v)))


@inlined
def motion_at(p: Vec3, v: Vec6) -> Vec6:
    """The motion v, given at the origin, at the point p: ᵉXᵀ v = [v + ω × p; ω]."""
    return add3(linear(v), cross(angular(v), p)) + angular(v)


@inlined
def force_from(p: Vec3, f: Vec6) -> Vec6:
    """The force f, given at the point p, at the origin: X f = [f; n + p × f]."""
    return linear(f) + add3(angular(f), cross(p, linear(f)))


@inlined
def classical(a: Vec6, v: Vec6) -> Vec6:
    """ẍ = a − [v × ω; 0]: the conventional acceleration of the point at which a and v are given."""
    return add3(linear(a), cross(angular(v), linear(v))) + angular(a)


# -- symmetric 6×6 -------------------------------------------------------------------------------------------


@inlined
def rigid_inertia(m: Number, h: Vec3, I: Sym3) -> Sym6:
    """Inertia of a mass m with first moments h = m c and rotational inertia I, about the origin: [m −h̃; h̃ I]."""
    o = full_like(0.0, h[0])
    m = m + o
    return (
        (m, o, m, o, o, m) + (o, -h[2], h[1], I[0]) + (h[2], o, -h[0], I[1], I[2]) + (-h[1], h[0], o, I[3], I[4], I[5])
    )


@inlined
def mass_centre(I: Sym6) -> Vec3:
    """Centre of mass of the inertia I about the origin: its first moments over its mass."""
    return scale3((I[16], I[8], I[10]), 1.0 / I[0])


@inlined
def diagonal(A: Sym6) -> Vec6:
    return (A[0], A[2], A[5], A[9], A[14], A[20])


@inlined
def inertia_from(p: Vec3, I: Sym6) -> Sym6:
    """The inertia I = [M Hᵀ; H J], given at the point p, at the origin: X I Xᵀ = [M ·; H + p̃ M  J + p̃ Hᵀ + (…)ᵀ]."""
    x, y, z = p
    H = (
        (I[6] + y * I[3] - z * I[1], I[7] + y * I[4] - z * I[2], I[8] + y * I[5] - z * I[4])
        + (I[10] + z * I[0] - x * I[3], I[11] + z * I[1] - x * I[4], I[12] + z * I[3] - x * I[5])
        + (I[15] + x * I[1] - y * I[0], I[16] + x * I[2] - y * I[1], I[17] + x * I[4] - y * I[3])
    )
    return (
        I[0:6]
        + H[0:3]
        + (I[9] + (y * I[8] - z * I[7]) + (y * H[2] - z * H[1]),)
        + H[3:6]
        + (
            I[13] + (z * I[6] - x * I[8]) + (y * H[5] - z * H[4]),
            I[14] + (z * I[10] - x * I[12]) + (z * H[3] - x * H[5]),
        )
        + H[6:9]
        + (
            I[18] + (x * I[7] - y * I[6]) + (y * H[8] - z * H[7]),
            I[19] + (x * I[11] - y * I[10]) + (z * H[6] - x * H[8]),
            I[20] + (x * I[16] - y * I[15]) + (x * H[7] - y * H[6]),
        )
    )


@inlined
def sym6_mul(A: Sym6, s: Vec6) -> Vec6:
    """A s."""
    return (
        (A[0] * s[0] + A[1] * s[1] + A[3] * s[2]) + (A[6] * s[3] + A[10] * s[4] + A[15] * s[5]),
        (A[1] * s[0] + A[2] * s[1] + A[4] * s[2]) + (A[7] * s[3] + A[11] * s[4] + A[16] * s[5]),
        (A[3] * s[0] + A[4] * s[1] + A[5] * s[2]) + (A[8] * s[3] + A[12] * s[4] + A[17] * s[5]),
        (A[6] * s[0] + A[7] * s[1] + A[8] * s[2]) + (A[9] * s[3] + A[13] * s[4] + A[18] * s[5]),
        (A[10] * s[0] + A[11] * s[1] + A[12] * s[2]) + (A[13] * s[3] + A[14] * s[4] + A[19] * s[5]),
        (A[15] * s[0] + A[16] * s[1] + A[17] * s[2]) + (A[18] * s[3] + A[19] * s[4] + A[20] * s[5]),
    )


@inlined
def sym6_mul_angular(A: Sym6, s: Vec3) -> Vec6:
    """A [0; s]."""
    return (
        (A[6] * s[0] + A[10] * s[1] + A[15] * s[2], A[7] * s[0] + A[11] * s[1] + A[16] * s[2])
        + (A[8] * s[0] + A[12] * s[1] + A[17] * s[2], A[9] * s[0] + A[13] * s[1] + A[18] * s[2])
        + (A[13] * s[0] + A[14] * s[1] + A[19] * s[2], A[18] * s[0] + A[19] * s[1] + A[20] * s[2])
    )


@inlined
def sym6_add(A: Sym6, B: Sym6) -> Sym6:
    return (
        add6(A[0:6], B[0:6]) + add6(A[6:12], B[6:12]) + add6(A[12:18], B[12:18])
        + (A[18] + B[18], A[19] + B[19], A[20] + B[20])
    )  # fmt: skip


@inlined
def sym6_sub(A: Sym6, B: Sym6) -> Sym6:
    return (
        sub6(A[0:6], B[0:6]) + sub6(A[6:12], B[6:12]) + sub6(A[12:18], B[12:18])
        + (A[18] - B[18], A[19] - B[19], A[20] - B[20])
    )  # fmt: skip


@inlined
def sym6_outer(u: Vec6, w: Vec6) -> Sym6:
    """Return u wᵀ, where w is a multiple of u."""
    return (
        (u[0] * w[0],)
        + (u[1] * w[0], u[1] * w[1])
        + (u[2] * w[0], u[2] * w[1], u[2] * w[2])
        + (u[3] * w[0], u[3] * w[1], u[3] * w[2], u[3] * w[3])
        + (u[4] * w[0], u[4] * w[1], u[4] * w[2], u[4] * w[3], u[4] * w[4])
        + (u[5] * w[0], u[5] * w[1], u[5] * w[2], u[5] * w[3], u[5] * w[4], u[5] * w[5])
    )


@inlined
def sym6_to_mat(A: Sym6) -> Mat6:
    return (
        (A[0], A[1], A[3], A[6], A[10], A[15])
        + (A[1], A[2], A[4], A[7], A[11], A[16])
        + (A[3], A[4], A[5], A[8], A[12], A[17])
        + (A[6], A[7], A[8], A[9], A[13], A[18])
        + (A[10], A[11], A[12], A[13], A[14], A[19])
        + (A[15], A[16], A[17], A[18], A[19], A[20])
    )


@inlined
def sym6_inverse_and_pivot(A: Sym6) -> tuple[Sym6, Number]:
    """A⁻¹ by blocks [M Hᵀ; H J], and 1/max_k A_kk A⁻¹_kk, the smallest pivot that any order of rows meets.

    The pivot is that of A at unit diagonal; it is not above zero where a pivot met on the way is not: A is singular
    then as far as digits tell. M = L D Lᵀ: by cofactors two light directions beside a heavy one would lose all digits.
    """
    m = sym3_factor(A[0:6])
    w0, h1, h2 = (A[6], A[10], A[15]), (A[7], A[11], A[16]), (A[8], A[12], A[17])
    w1 = sub3(h1, scale3(w0, m[0]))
    w2 = sub3(sub3(h2, scale3(w0, m[1])), scale3(w1, m[2]))
    t2 = scale3(w2, m[5])
    t1 = sub3(scale3(w1, m[4]), scale3(t2, m[2]))
    t0 = sub3(sub3(scale3(w0, m[3]), scale3(t1, m[0])), scale3(t2, m[1]))
    V = scale3(w0, m[3]) + scale3(w1, m[4]) + t2
    return inverse_of_blocks(A, sym3_of_factor(m), m[6], w0 + w1 + w2, V, t0 + t1 + t2)


@inlined
def inertia_inverse_and_pivot(I: Sym6) -> tuple[Sym6, Number]:
    """The same of the inertia of a rigid body, whose M is its mass: the Schur complement is about its mass centre."""
    k, o = 1.0 / I[0], full_like(0.0, I[0])
    H = (I[6], I[10], I[15], I[7], I[11], I[16], I[8], I[12], I[17])
    T = scale3(H[0:3], k) + scale3(H[3:6], k) + scale3(H[6:9], k)
    return inverse_of_blocks(I, (k, o, k, o, o, k), I[0], H, T, T)


@inlined
def inverse_of_blocks(A: Sym6, M_inv: Sym3, least: Number, W: Mat3, V: Mat3, T: Mat3) -> tuple[Sym6, Number]:
    """Finish with C = J − V Wᵀ and T = H M⁻¹; `least` is the smallest pivot of M."""
    c = sym3_factor(sym3_sub((A[9], A[13], A[14], A[18], A[19], A[20]), sym3_of_product(V, W)))
    C = sym3_of_factor(c)
    Q = mat3_mul(sym3_to_mat(C), T)
    N = sym3_of_product(mat3_transpose(T), mat3_transpose(Q))
    B = add3(M_inv[0:3], N[0:3]) + add3(M_inv[3:6], N[3:6])
    inverse = (
        B + (-Q[0], -Q[3], -Q[6], C[0]) + (-Q[1], -Q[4], -Q[7], C[1], C[2]) + (-Q[2], -Q[5], -Q[8], C[3], C[4], C[5])
    )
    along = maximum(maximum(A[0] * B[0], A[2] * B[2]), A[5] * B[5])
    about = maximum(maximum(A[9] * C[0], A[14] * C[2]), A[20] * C[5])
    return inverse, minimum(1.0 / maximum(along, about), 1e300 * minimum(least, c[6]))


@inlined
def mat3_mul(A: Mat3, B: Mat3) -> Mat3:
    return rotate(A, B[0:3]) + rotate(A, B[3:6]) + rotate(A, B[6:9])


@inlined
def mat3_transpose(A: Mat3) -> Mat3:
    return (A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8])


@inlined
def unit36(like_these: Row) -> Mat6:
    """The unit matrix, of the kind of number that `like_these` holds."""
    o, i = full_like(0.0, like_these[0]), full_like(1.0, like_these[0])
    return (
        (i, o, o, o, o, o) + (o, i, o, o, o, o) + (o, o, i, o, o, o)
        + (o, o, o, i, o, o) + (o, o, o, o, i, o) + (o, o, o, o, o, i)
    )  # fmt: skip


# -- full 6×6 ------------------------------------------------------------------------------------------------


@inlined
def mat6_mul(K: Mat6, s: Vec6) -> Vec6:
    """K s."""
    return (
        (dot6(K[0:6], s), dot6(K[6:12], s), dot6(K[12:18], s))
        + (dot6(K[18:24], s), dot6(K[24:30], s), dot6(K[30:36], s))
    )  # fmt: skip


@inlined
def mul_mat6(s: Vec6, K: Mat6) -> Vec6:
    """sᵀ K."""
    return add6(
        add6(add6(scale6(K[0:6], s[0]), scale6(K[6:12], s[1])), add6(scale6(K[12:18], s[2]), scale6(K[18:24], s[3]))),
        add6(scale6(K[24:30], s[4]), scale6(K[30:36], s[5])),
    )


@inlined
def mat6_add_outer(K: Mat6, u: Vec6, w: Vec6) -> Mat6:
    """K + u wᵀ."""
    return (
        add6(K[0:6], scale6(w, u[0])) + add6(K[6:12], scale6(w, u[1])) + add6(K[12:18], scale6(w, u[2]))
        + add6(K[18:24], scale6(w, u[3])) + add6(K[24:30], scale6(w, u[4])) + add6(K[30:36], scale6(w, u[5]))
    )  # fmt: skip


@inlined
def mat6_add(A: Mat6, B: Mat6) -> Mat6:
    return (
        add6(A[0:6], B[0:6]) + add6(A[6:12], B[6:12]) + add6(A[12:18], B[12:18])
        + add6(A[18:24], B[18:24]) + add6(A[24:30], B[24:30]) + add6(A[30:36], B[30:36])
    )  # fmt: skip


@inlined
def mat6_product(A: Mat6, B: Mat6) -> Mat6:
    """A B."""
    return (
        mul_mat6(A[0:6], B) + mul_mat6(A[6:12], B) + mul_mat6(A[12:18], B)
        + mul_mat6(A[18:24], B) + mul_mat6(A[24:30], B) + mul_mat6(A[30:36], B)
    )  # fmt: skip


@inlined
def mat6_transpose(K: Mat6) -> Mat6:
    return (
        (K[0], K[6], K[12], K[18], K[24], K[30])
        + (K[1], K[7], K[13], K[19], K[25], K[31])
        + (K[2], K[8], K[14], K[20], K[26], K[32])
        + (K[3], K[9], K[15], K[21], K[27], K[33])
        + (K[4], K[10], K[16], K[22], K[28], K[34])
        + (K[5], K[11], K[17], K[23], K[29], K[35])
    )


@inlined
def motions_at(p: Vec3, K: Mat6) -> Mat6:
    """ᵉXᵀ K: the six motions in the columns of K, given at the base, at the point p."""
    return (
        add6(K[0:6], sub6(scale6(K[24:30], p[2]), scale6(K[30:36], p[1])))
        + add6(K[6:12], sub6(scale6(K[30:36], p[0]), scale6(K[18:24], p[2])))
        + add6(K[12:18], sub6(scale6(K[18:24], p[1]), scale6(K[24:30], p[0])))
        + K[18:36]
    )


@inlined
def forces_from(p: Vec3, K: Mat6) -> Mat6:
    """X K: the six forces in the columns of K, given at the point p, at the base: [f; n + p × f]."""
    return (
        K[0:18]
        + add6(K[18:24], sub6(scale6(K[12:18], p[1]), scale6(K[6:12], p[2])))
        + add6(K[24:30], sub6(scale6(K[0:6], p[2]), scale6(K[12:18], p[0])))
        + add6(K[30:36], sub6(scale6(K[6:12], p[0]), scale6(K[0:6], p[1])))
    )

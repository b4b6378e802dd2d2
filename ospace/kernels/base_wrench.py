"""Forces that are held in inertial axes, on a base whose velocity stands in base axes.

With the base quaternion (x, y, z, w) of q[3:7], R = R_WB and the wrench [f; n] at the base-link frame's origin p,

    τ[:6] = [Rᵀ f; Rᵀ n],        d/dt [momentum; angular momentum about the origin] = [f; p × f + n].
"""

from __future__ import annotations

from ospace.kernels.jit.compile import Vec3, entry, inlined
from ospace.kernels.spatial import add3, cross, scale3
from ospace.kernels.tree import Floats


@inlined
def to_base_axes(q: Floats, a: Vec3) -> Vec3:
    """Rᵀ a = a − 2 w (e × a) + 2 e × (e × a), e the vector part."""
    e = (q[3], q[4], q[5])
    ea = cross(e, a)
    return add3(a, add3(scale3(ea, -2.0 * q[6]), scale3(cross(e, ea), 2.0)))


@entry
def push_base(q: Floats, wrenches: Floats, tau: Floats, rate: Floats) -> None:
    """Turn `wrenches` (2, 6), thrusters and then wheels, into the base rows of `tau`; the thrusters' into `rate` (6,).

    Wheels store what they give: theirs is no external wrench.
    """
    f = (wrenches[0, 0], wrenches[0, 1], wrenches[0, 2])
    n = (wrenches[0, 3], wrenches[0, 4], wrenches[0, 5])
    force = to_base_axes(q, f)
    torque = to_base_axes(q, add3(n, (wrenches[1, 3], wrenches[1, 4], wrenches[1, 5])))
    about_origin = add3(cross((q[0], q[1], q[2]), f), n)
    for i in range(3):
        tau[i] = force[i]
        tau[3 + i] = torque[i]
        rate[i] = f[i]
        rate[3 + i] = about_origin[i]


@entry
def add_velocity(Q: Floats, velocity: Floats, V: Floats) -> None:
    """Add `velocity` (3,), inertial axes, to the base velocity of every row of `V` (N, nv) at `Q` (N, nq)."""
    for k in range(len(Q)):
        seen = to_base_axes(Q[k], (velocity[0], velocity[1], velocity[2]))
        for i in range(3):
            V[k, i] += seen[i]


@entry
def push_point(T: Floats, p: Floats, F: Floats, on_joint: Floats, rate: Floats) -> None:
    """Add the wrench `F` (6,), inertial axes, to `on_joint` (6,), in the joint's frame, and to `rate` (6,).

    It acts at `p`, seen from the joint's frame, which stands at `T` (4, 4).
    """
    for i in range(3):
        on_joint[i] += T[0, i] * F[0] + T[1, i] * F[1] + T[2, i] * F[2]
        on_joint[3 + i] += T[0, i] * F[3] + T[1, i] * F[4] + T[2, i] * F[5]
        rate[i] += F[i]
        rate[3 + i] += F[3 + i]
    f = (
        T[0, 0] * F[0] + T[1, 0] * F[1] + T[2, 0] * F[2],
        T[0, 1] * F[0] + T[1, 1] * F[1] + T[2, 1] * F[2],
        T[0, 2] * F[0] + T[1, 2] * F[1] + T[2, 2] * F[2],
    )
    r = (
        T[0, 0] * p[0] + T[0, 1] * p[1] + T[0, 2] * p[2] + T[0, 3],
        T[1, 0] * p[0] + T[1, 1] * p[1] + T[1, 2] * p[2] + T[1, 3],
        T[2, 0] * p[0] + T[2, 1] * p[1] + T[2, 2] * p[2] + T[2, 3],
    )
    about_joint = cross((p[0], p[1], p[2]), f)
    about_origin = cross(r, (F[0], F[1], F[2]))
    for i in range(3):
        on_joint[3 + i] += about_joint[i]
        rate[3 + i] += about_origin[i]

"""The dynamics to 50 digits, by sums over bodies: revolute, continuous and prismatic joints on a free base.

H = Σ J_cᵀ m J_c + J_ωᵀ I J_ω,  c likewise of accelerations at q̈ = 0; Γ_e⁻¹ = J_e H⁻¹ J_eᵀ and μ = J_e H⁻¹ c − J̇_e ẋ,
in the paper's coordinates. The doubles of the model, q and v are taken as they are; no recursion over inertias.
"""

from __future__ import annotations

from typing import NamedTuple

import mpmath as mp
import numpy as np

DIGITS = 50
_exact = np.vectorize(mp.mpf, otypes=[object])


class Exact(NamedTuple):
    """Rounded to doubles at the end."""

    inertia_inverse: np.ndarray
    bias_acceleration: np.ndarray
    response: np.ndarray
    manipulator_inertia: np.ndarray


class Body(NamedTuple):
    """Orientation, Jacobians (3, nv), angular velocity, and accelerations at zero q̈, at the joint's origin."""

    R: np.ndarray
    J_v: np.ndarray
    J_w: np.ndarray
    omega: np.ndarray
    a: np.ndarray
    alpha: np.ndarray

    def at(self, place):
        """Jacobian and acceleration of the point of the body that `place`, in inertial axes, leads to."""
        J = self.J_v - _skew(place).dot(self.J_w)
        turning = _cross(self.omega, _cross(self.omega, place))
        return J, self.a + _cross(self.alpha, place) + turning


def exact(state, points):
    """Γ_e⁻¹, μ, H⁻¹ J_eᵀ and H_m of `points`, all six rows each, to the last digit of a double."""
    with mp.workdps(DIGITS):
        bodies = _bodies(state)
        model, nv = state.robot.model, state.robot.nv
        H, c = _zeros(nv, nv), _zeros(nv)
        for j, body in bodies.items():
            inertia = model.inertias[j]
            mass, I = mp.mpf(inertia.mass), body.R.dot(_exact(inertia.inertia)).dot(body.R.T)
            J_c, a_c = body.at(body.R.dot(_exact(inertia.lever)))
            H += J_c.T.dot(J_c) * mass + body.J_w.T.dot(I).dot(body.J_w)
            moment = I.dot(body.alpha) + _cross(body.omega, I.dot(body.omega))
            c += J_c.T.dot(a_c) * mass + body.J_w.T.dot(moment)
        H[range(6, nv), range(6, nv)] += _exact(model.armature[6:])
        rows, drift = [], []
        for point in points:
            body = bodies[point.joint]
            J, a = body.at(body.R.dot(_exact(point.placement.translation)))
            rows += [J, body.J_w]
            drift += [a, body.alpha]
        J_e, drift = np.vstack(rows), np.concatenate(drift)
        solved = _solve(H, np.column_stack([J_e.T, c]))
        response, free = solved[:, :-1], solved[:, -1]
        found = J_e.dot(response), J_e.dot(free) - drift, response, H[6:, 6:]
        return Exact(*(quantity.astype(float) for quantity in found))


def _bodies(state):
    model, v, nv = state.robot.model, _exact(state.v), state.robot.nv
    R = _rotation(_exact(state.q[3:7]))
    base = Body(R, _zeros(3, nv), _zeros(3, nv), R.dot(v[3:6]), _zeros(3), _zeros(3))
    base.J_v[:, :3] = base.J_w[:, 3:6] = _exact(np.eye(3))  # of the paper's ẋ_b, in inertial axes
    bodies = {1: base}
    for j in range(2, model.njoints):
        i, k, parent = model.idx_vs[j], model.idx_qs[j], bodies[model.parents[j]]
        data = model.joints[j].createData()
        model.joints[j].calc(data, state.q)
        S = _exact(np.ravel(data.S))
        R = parent.R.dot(_orthogonal(_exact(model.jointPlacements[j].rotation)))
        place = parent.R.dot(_exact(model.jointPlacements[j].translation))
        J_v, a = parent.at(place)
        J_w, omega, alpha = parent.J_w, parent.omega, parent.alpha
        if any(S[3:]):
            n = S[3:] / mp.sqrt(S[3:].dot(S[3:]))
            angle = mp.mpf(state.q[k]) if model.nqs[j] == 1 else mp.atan2(state.q[k + 1], state.q[k])
            axis, J_w = R.dot(n), J_w.copy()
            J_w[:, i] = axis
            R = R.dot(_exact(np.eye(3)) + _skew(n) * mp.sin(angle) + _skew(n).dot(_skew(n)) * (1 - mp.cos(angle)))
            alpha = alpha + _cross(omega, axis) * v[i]
            omega = omega + axis * v[i]
        else:
            axis = R.dot(S[:3] / mp.sqrt(S[:3].dot(S[:3])))
            J_v, a = parent.at(place + axis * mp.mpf(state.q[k]))
            J_v[:, i] = axis
            a = a + 2 * _cross(omega, axis) * v[i]
        bodies[j] = Body(R, J_v, J_w, omega, a, alpha)
    return bodies


def _zeros(*shape):
    return np.zeros(shape, dtype=object) + mp.mpf(0)


def _cross(a, b):
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def _skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]]) + mp.mpf(0)


def _rotation(quaternion):
    x, y, z, w = quaternion / mp.sqrt(quaternion.dot(quaternion))
    n = np.array([x, y, z])
    return _exact(np.eye(3)) + 2 * w * _skew(n) + 2 * _skew(n).dot(_skew(n))


def _orthogonal(R):
    """The rotation next to R: Newton's steps double the digits."""
    for _ in range(3):
        R = (3 * R - R.dot(R.T).dot(R)) / 2
    return R


def _solve(A, B):
    """A⁻¹ B of a positive definite A, which needs no pivoting."""
    A, B = A.copy(), B.copy()
    for k in range(len(A)):
        for i in range(k + 1, len(A)):
            factor = A[i, k] / A[k, k]
            A[i, k:] -= factor * A[k, k:]
            B[i] -= factor * B[k]
    for k in reversed(range(len(A))):
        B[k] = (B[k] - A[k, k + 1 :].dot(B[k + 1 :])) / A[k, k]
    return B

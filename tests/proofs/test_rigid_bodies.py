"""One body and two: tumbling by Jacobi's elliptic functions, the fastest stop of a spin, and what a grasp loses."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pinocchio as pin
import pytest
from proven import row
from scipy.special import ellipj, ellipk

import ospace
from ospace import analysis
from ospace.simulation import Actuation, grasp, rigid_body

I_1, I_2, I_3 = MOMENTS = np.array([300.0, 220.0, 120.0])
OMEGA = np.array([0.02, 0.0, 0.08])
TORQUE = 0.5
h = MOMENTS * OMEGA
L, TWICE_ENERGY = np.linalg.norm(h), MOMENTS @ OMEGA**2

# Landau and Lifshitz, Mechanics, §37, with L² < 2 E I_2: the body circles the axis of its smallest moment
RATE = math.sqrt((I_2 - I_3) * (I_1 * TWICE_ENERGY - L**2) / (I_1 * I_2 * I_3))
M = (I_1 - I_2) * (L**2 - TWICE_ENERGY * I_3) / ((I_2 - I_3) * (I_1 * TWICE_ENERGY - L**2))
PERIOD = 4.0 * ellipk(M) / RATE


def omega(time):
    """Angular velocity in body axes at an array of times."""
    sn, cn, dn, _ = ellipj(RATE * time, M)
    middle = math.sqrt((L**2 - TWICE_ENERGY * I_3) / (I_2 * (I_2 - I_3)))
    return np.column_stack([OMEGA[0] * cn, -middle * sn, OMEGA[2] * dn])


def precession():
    """The turn about the angular momentum within a period, by Legendre's integral of the third kind; rad."""
    import mpmath

    spun = (I_3 * OMEGA[2]) ** 2
    third = mpmath.ellippi(-spun * M / (L**2 - spun), M)
    return L / I_3 * (PERIOD + (TWICE_ENERGY * I_3 - L**2) / (L**2 - spun) * 4.0 / RATE * float(third))


@pytest.fixture(scope="module")
def body():
    return rigid_body(800.0, MOMENTS)


@pytest.fixture(scope="module")
def tumbled(body):
    """A period in simulation, in 32 parts of equal length."""
    v = np.r_[np.zeros(3), OMEGA]
    return ospace.simulate(body, body.neutral(), v, duration=PERIOD, step=PERIOD / 32, tolerance=1e-14)


def test_a_free_body_tumbles_by_elliptic_functions(tumbled):
    row("tumbling: ω in sn, cn, dn over a period, rad/s").within(np.abs(tumbled.v[:, 3:] - omega(tumbled.time)).max())


def test_the_period_of_tumbling(body, tumbled):
    """When the middle component of ω passes zero again."""
    middle = tumbled.v[-1, 4]
    alpha = np.linalg.inv(np.diag(MOMENTS)) @ np.cross(h, OMEGA)
    row("period of tumbling, s").equals(tumbled.time[-1] - middle / alpha[1])


def test_the_attitude_after_a_period(tumbled):
    turned = pin.XYZQUATToSE3(tumbled.q[-1]).rotation @ pin.XYZQUATToSE3(tumbled.q[0]).rotation.T
    vector = pin.log3(turned)
    angle = math.degrees(vector @ h / L) % 360.0
    row("turn about the angular momentum within a period, deg").equals(angle)
    assert angle == pytest.approx(math.degrees(precession()) % 360.0, abs=1e-8)
    np.testing.assert_allclose(np.cross(vector, h / L), np.zeros(3), atol=1e-10)


def test_the_integrator_of_base_motion_tumbles_alike(body, tumbled):
    times = tumbled.time
    poses = analysis.base_motion(body, np.zeros((len(times), 0)), np.r_[np.zeros(3), h], time=times)
    apart = [np.linalg.norm(pin.log3(pin.Quaternion(*_wxyz(a)).matrix().T @ pin.Quaternion(*_wxyz(b)).matrix()))
             for a, b in zip(poses, tumbled.q, strict=True)]  # fmt: skip
    row("attitude by `base_motion` and by `simulate`, rad").within(max(apart))


def _wxyz(pose):
    return pose[6], pose[3], pose[4], pose[5]


@pytest.mark.parametrize("integrator", ["rk4", "symplectic"])
def test_fixed_steps_converge_at_their_order(body, integrator):
    """Errors after a tenth of a period fall by 2⁴ or 2² as steps are halved."""
    v, duration = np.r_[np.zeros(3), OMEGA], PERIOD / 10.0
    exact = omega(np.array([duration]))[0]
    errors = []
    for steps in (20, 40):
        run = ospace.simulate(body, body.neutral(), v, duration=duration, step=duration / steps, integrator=integrator)
        errors.append(np.linalg.norm(run.v[-1, 3:] - exact))
    row(f"order of the integrator `{integrator}`").equals(math.log2(errors[0] / errors[1]))


def test_a_spin_stops_in_the_shortest_time(body):
    """Torque of a bounded size against h: by Athans, Falb and Lacoss no other stops it before ‖h‖/τ."""

    def law(time, q, v):
        momentum = ospace.momentum(body.state(q, v))[3:]
        return Actuation(np.zeros(0), np.r_[np.zeros(3), -TORQUE * momentum / np.linalg.norm(momentum)])

    v, duration = np.r_[np.zeros(3), OMEGA], L / TORQUE
    run = ospace.simulate(body, body.neutral(), v, law, duration=duration, step=duration / 400, tolerance=1e-13)
    left = [np.linalg.norm(ospace.momentum(body.state(q, v))[3:]) for q, v in zip(run.q, run.v, strict=True)]
    row("shortest time to stop the spin, s").equals(run.time[200] + left[200] / TORQUE)
    row("momentum left then, N m s").within(left[-1])


def test_a_grasp_loses_what_two_bodies_lose_that_become_one():
    """Momentum is kept: the loss in exact fractions, from ½ Σ(m v² + ω I ω) before and after."""
    bus = rigid_body(800.0, MOMENTS, name="bus", frames={"port": pin.SE3(np.eye(3), np.array([1.0, 0.0, 0.0]))})
    visitor = rigid_body(
        200.0, (30.0, 20.0, 25.0), name="visitor", frames={"probe": pin.SE3(np.eye(3), np.array([-0.5, 0.0, 0.0]))}
    )
    first = bus.state(bus.neutral(), np.r_[0.0, 0.0, 0.0, OMEGA])
    q = visitor.neutral()
    q[0] = 1.5
    second = visitor.state(q, [-0.05, 0.01, 0.02, 0.0, 0.03, -0.01])
    one = grasp(first, bus.point("port"), second, visitor.point("probe"))
    row("energy lost as two bodies become one, J").equals(one.energy_lost)
    assert one.energy_lost == pytest.approx(float(_loss()), rel=1e-13)


def _loss():
    """In fractions: masses 800 and 200 kg, 1.5 m apart along x, so that the reduced mass is 160 kg."""
    f = Fraction
    I_a, I_b = [f(300), f(220), f(120)], [f(30), f(20), f(25)]
    w_a, w_b = [f(2, 100), f(0), f(8, 100)], [f(0), f(3, 100), f(-1, 100)]
    v = [f(-5, 100), f(1, 100), f(2, 100)]  # of the second, from the first
    reduced, x = f(800 * 200, 1000), f(3, 2)
    moment = [I_a[k] * w_a[k] + I_b[k] * w_b[k] for k in range(3)]
    moment[1] -= reduced * x * v[2]  # x̂ × v = (0, −v_z, v_y)
    moment[2] += reduced * x * v[1]
    whole = [I_a[k] + I_b[k] + (reduced * x * x if k else 0) for k in range(3)]
    before = reduced * sum(u * u for u in v) + sum(I_a[k] * w_a[k] ** 2 + I_b[k] * w_b[k] ** 2 for k in range(3))
    return (before - sum(moment[k] ** 2 / whole[k] for k in range(3))) / 2

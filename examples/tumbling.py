"""
How a target tumbles
====================

A free body of three different moments of inertia in simulation, and by Jacobi's elliptic functions (dots). Its angular
velocity, seen from the body, repeats.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.special import ellipj, ellipk

import ospace
from ospace.simulation import rigid_body

I_1, I_2, I_3 = moments = np.array([300.0, 220.0, 120.0])
omega = np.array([0.02, 0.0, 0.08])
squared, twice_energy = ((moments * omega) ** 2).sum(), (moments * omega**2).sum()
rate = np.sqrt((I_2 - I_3) * (I_1 * twice_energy - squared) / (I_1 * I_2 * I_3))
m = (I_1 - I_2) * (squared - twice_energy * I_3) / ((I_2 - I_3) * (I_1 * twice_energy - squared))
period = 4.0 * ellipk(m) / rate
body = rigid_body(800.0, moments)
run = ospace.simulate(body, body.neutral(), np.r_[0.0, 0.0, 0.0, omega], duration=period, step=period / 2000)
sn, cn, dn, _ = ellipj(rate * run.time, m)
middle = np.sqrt((squared - twice_energy * I_3) / (I_2 * (I_2 - I_3)))
exact = np.column_stack([omega[0] * cn, -middle * sn, omega[2] * dn])
print(f"period: {period:.5f} s")
print(f"about the middle axis up to: {np.degrees(middle):.4f} deg/s")
print(f"simulation off by: {np.abs(run.v[:, 3:] - exact).max():.1e} rad/s")
print(f"after a period off by: {np.abs(run.v[-1, 3:] - omega).max():.1e} rad/s")
_, axes = plt.subplots(layout="constrained")
axes.plot(run.time, np.degrees(run.v[:, 3:]), label=["x", "y", "z"])
axes.plot(run.time[::100], np.degrees(exact[::100]), "k.", markersize=4)
axes.set(xlabel="time, s", ylabel="angular velocity in body axes, deg/s")
axes.legend()
plt.show()

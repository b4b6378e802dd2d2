"""
Wheels that hold the base while the arm reaches
===============================================

What reaction wheels have to store and to give while joints go from one configuration to another: h = K v, whatever the
controller. Twice the time needs half the momentum and a quarter of the torque.
"""

import matplotlib.pyplot as plt
import numpy as np

import ospace
from ospace import analysis

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
first = np.array([0.0, 0.8, 0.0, -1.2, 0.0, 0.6, 0.0])
way = np.array([1.2, -0.6, 0.4, 0.5, 0.0, -0.4, 0.6])
s = np.linspace(0.0, 1.0, 401)
gone, rate = 10.0 * s**3 - 15.0 * s**4 + 6.0 * s**5, 30.0 * s**2 * (1.0 - s) ** 2  # minimum jerk
home = robot.configuration()[:7]
figure, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
for duration in (20.0, 40.0):
    states = [robot.state(np.r_[home, first + part * way]) for part in gone]
    velocities = rate[:, None] * way / duration
    h = np.array([analysis.wheel_momentum(state) @ v for state, v in zip(states, velocities, strict=True)])
    torque = np.gradient(h, s * duration, axis=0)
    print(f"momentum within {duration:.0f} s: {np.abs(h).max():.3f} N m s about one axis")
    print(f"torque within {duration:.0f} s: {np.abs(torque).max():.4f} N m about one axis")
    above.plot(s * duration, np.linalg.norm(h, axis=1), label=f"within {duration:.0f} s")
    below.plot(s * duration, np.linalg.norm(torque, axis=1))
above.set_ylabel("momentum of the wheels, N m s")
below.set(xlabel="time, s", ylabel="torque of the wheels, N m")
above.legend()
plt.show()

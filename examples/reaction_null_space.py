"""
Arms that move while the base stands still
==========================================

Joint rates in the reaction null space leave the base's attitude alone: 18 joints swing as asked, then projected.
"""

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import ospace
from ospace import analysis

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
start, times = robot.configuration(), np.linspace(0.0, 8.0, 321)
wish = np.random.default_rng(0).uniform(-0.3, 0.3, robot.n_joints)  # rad/s


def swing(projected):
    """Joint angles (321, 18), and the base's turn since the start in deg."""

    def rates(time, phi):
        projector = analysis.reaction_null_space(robot.state(np.r_[start[:7], phi])).projector
        return (projector @ wish if projected else wish) * np.sin(np.pi * time / 4.0)

    path = solve_ivp(rates, times[[0, -1]], start[7:], "DOP853", times, rtol=1e-11, atol=1e-12).y.T
    poses = analysis.base_motion(robot, path)
    return path, np.degrees([analysis.base_turn(poses[[0, k]]) for k in range(len(poses))])


_, (above, below) = plt.subplots(2, 1, sharex=True, layout="constrained")
for name in ("as asked", "projected"):
    path, turn = swing(name == "projected")
    print(f"{name}, joints move by: {np.degrees(np.ptp(path, axis=0).max()):.1f} deg")
    print(f"{name}, base turns by: {turn.max():.2g} deg")
    above.semilogy(times[1:], np.maximum(turn[1:], 1e-14), label=name)
below.plot(times, np.degrees(path))
above.set_ylabel("turn of the base, deg")
above.legend()
below.set(xlabel="time, s", ylabel="joints, projected, deg")
plt.show()

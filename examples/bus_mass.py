"""
How heavy a bus an arm needs
============================

An arm of six joints is put on cubes of other masses. The lighter the cube, the more it turns as the arm unfolds.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import ospace
from ospace import analysis

LINK = """<link name="link_{0}"><inertial><origin xyz="0.2 0 0"/><mass value="5"/>
  <inertia ixx="0.02" iyy="0.08" izz="0.08" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="joint_{0}" type="revolute"><parent link="link_{1}"/><child link="link_{0}"/>
  <origin xyz="0.4 0 0"/><axis xyz="0 {2} {3}"/><limit lower="-3" upper="3" effort="50" velocity="1"/></joint>"""
arm = LINK.format(0) + "".join(LINK.format(k) + JOINT.format(k, k - 1, k % 2, 1 - k % 2) for k in range(1, 7))
masses, turns = np.geomspace(50.0, 2000.0, 9), []
with TemporaryDirectory() as folder:
    (Path(folder) / "arm.urdf").write_text(f"<robot name='arm'>{arm}</robot>")
    for mass in masses:
        part = ospace.Part(Path(folder) / "arm.urdf", at=(0.5, 0.0, 0.0))
        whole = ospace.compose(f"box:1x1x1m,{mass:.3f}kg", part, out=Path(folder) / "servicer.urdf")
        robot = ospace.SpaceRobot.from_urdf(Path(folder) / "servicer.urdf")
        folded = np.array([1.2, 0.8, -1.2, 0.8, 1.2, -0.8])
        turns.append(np.degrees(analysis.base_turn(analysis.base_motion(robot, [folded, np.zeros(6)]))))
        print(f"bus of {mass:.0f} kg: {whole.total_mass:.0f} kg together, turns by {turns[-1]:.2f} deg")
_, axes = plt.subplots(layout="constrained")
axes.semilogx(masses, turns, "o-")
axes.set(ylim=(0.0, None), xlabel="mass of the bus, kg", ylabel="turn of the bus, deg")
axes.grid(which="both")
plt.show()

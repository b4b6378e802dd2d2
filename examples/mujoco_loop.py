"""
The same loop in MuJoCo
=======================

A controller moves MuJoCo's robot, whose dynamics share no code with ospace, and the same robot in ospace's simulation.
"""

import matplotlib.pyplot as plt
import mujoco
import numpy as np
import pinocchio as pin

import ospace
from ospace.control import MinimumJerk, PoseTask

robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_7dof"))
hand = robot.point("end_effector")
start = robot.state(robot.configuration({"joint_2": 0.8, "joint_4": -1.2, "joint_6": 0.6}))
here = start.placement(hand)
way = MinimumJerk(here, pin.SE3(here.rotation, here.translation + [0.0, 0.3, 0.0]), 0.0, 4.0)
tasks = [PoseTask(name="hand", point=hand, reference=way, stiffness=100.0)]
run = ospace.simulate(robot, start.q, start.v, ospace.Controller(robot, tasks), duration=5.0)

AFLOAT = """<link name="world"/><joint name="free" type="floating"><parent link="world"/><child link="base"/></joint>
<mujoco><compiler fusestatic="false" balanceinertia="false"/></mujoco></robot>"""
urdf = ospace.models.path("chaser_7dof").read_text()
model = mujoco.MjModel.from_xml_string(urdf.replace("</robot>", AFLOAT))
model.opt.gravity[:], model.opt.timestep, model.opt.integrator = 0.0, 1e-3, mujoco.mjtIntegrator.mjINT_RK4
data, controller, path = mujoco.MjData(model), ospace.Controller(robot, tasks), []
data.qpos[:] = np.r_[start.q[:3], start.q[6], start.q[3:6], start.q[7:]]  # w comes first
for time in run.time:
    q = np.r_[data.qpos[:3], data.qpos[4:7], data.qpos[3], data.qpos[7:]]
    path.append(q)
    v = np.r_[robot.base_pose(q).rotation.T @ data.qvel[:3], data.qvel[3:]]  # linear, inertial axes; angular, base axes
    data.qfrc_applied[6:] = controller.update(time, q, v).torque
    mujoco.mj_step(model, data)
apart = np.abs(np.array(path) - run.q)
print(f"steps: {len(path) - 1}\njoints move by: {np.degrees(np.ptp(run.q[:, 7:], axis=0).max()):.1f} deg")
print(f"joints apart by: {apart[:, 7:].max():.1e} rad\nbase apart by: {apart[:, :3].max():.1e} m")
_, axes = plt.subplots(layout="constrained")
axes.plot(run.time, np.degrees(path - run.q[0])[:, 7:])
axes.plot(run.time[::250], np.degrees(run.q - run.q[0])[::250, 7:], "k.")
axes.set(xlabel="time, s", ylabel="joints in MuJoCo, and in ospace (dots), deg")
plt.show()

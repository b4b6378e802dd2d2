"""Commands of a controller: states and tasks to try it with, and what the robot does under them, by Pinocchio."""

import numpy as np
import pinocchio as pin
import qpsolvers

from ospace.control import (
    BaseAttitudeTask,
    Constant,
    DampingTask,
    JointLimits,
    OrientationTask,
    PoseTask,
    PostureTask,
)
from ospace.control.solvers import OWN
from ospace.validation.sampling import random_state

KEPT = ("nominal", "falling short")
"""All limits are kept; references may be far."""


def state(robot, seed, speed=0.3):
    drawn = random_state(robot, np.random.default_rng(seed))
    return drawn.q.copy(), speed * drawn.v


def paper_tasks(robot, hand, head):
    return [
        PoseTask(name="hand", point=hand),
        OrientationTask(name="head", point=head),
        BaseAttitudeTask(name="base", robot=robot),
        PostureTask(name="posture"),
    ]


def forces(robot, q, command):
    """The generalized forces of a command, as Pinocchio takes them."""
    R = robot.base_pose(q).rotation
    wrench = command.base_wrench.copy()
    wrench[3:] += command.wheel_torque
    return np.concatenate([R.T @ wrench[:3], R.T @ wrench[3:], command.torque])


def accelerations(robot, q, v, command):
    return pin.aba(robot.model, robot.model.createData(), q, v, forces(robot, q, command))


NO_LIMITS = {"torque": np.inf, "lower": -np.inf, "upper": np.inf, "velocity": np.inf, "acceleration": np.inf}


def unlimited(robot, **known):
    return JointLimits(**{name: np.full(robot.n_joints, value) for name, value in {**NO_LIMITS, **known}.items()})


def leveled_states(robot, point, count):
    """Tasks of two levels and one without, limits and states of which many stand on limits."""
    rng = np.random.default_rng(11)
    lower, upper = robot.model.lowerPositionLimit[7:], robot.model.upperPositionLimit[7:]
    for k in range(count):
        q, v = robot.configuration(), (0.3 if k % 2 else 0.02) * rng.normal(size=robot.nv)
        q[7:] = rng.uniform(np.maximum(lower, -2.5), np.minimum(upper, 2.5))
        small = pin.SE3(pin.exp3(0.2 * rng.normal(size=3)), 0.1 * rng.normal(size=3))
        goal = Constant(robot.state(q, v).placement(point) * small)
        turn = Constant(pin.SE3(pin.exp3(rng.normal(size=3)), np.zeros(3)))
        tasks = [
            PoseTask(name="hand", point=point, stiffness=100.0, level=0, reference=goal),
            BaseAttitudeTask(name="base", robot=robot, stiffness=50.0, level=1, reference=turn),
            DampingTask(name="rest", stiffness=1.0),
        ]
        yield tasks, q, v


SOLVERS = sorted({*OWN, *qpsolvers.available_solvers} - {"daqp", "ecos"})

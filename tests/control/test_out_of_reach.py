"""Out of reach and through singularities: the arm stretches and rests, and what can be followed is followed."""

import arms
import numpy as np
import pinocchio as pin
import pytest

import ospace
from ospace.control import (
    BaseAttitudeTask,
    Constant,
    Controller,
    DampingTask,
    Function,
    JointLimits,
    OrientationTask,
    PoseTask,
)
from ospace.simulation import simulate

BENT = np.radians([0.0, 20.0, 80.0, -50.0, 10.0, 40.0])


def at(robot, joints):
    q = robot.configuration()
    q[7:] = joints
    return q


def drifting(pose, velocity):
    """A pose that moves off at constant velocity."""
    velocity = np.array([*velocity, 0.0, 0.0, 0.0])
    return Function(lambda t: (pin.SE3(pose.rotation, pose.translation + velocity[:3] * t), velocity, np.zeros(6)))


def rest(weight=1e-3):
    return DampingTask(name="rest", stiffness=1.0, weight=weight)


def follow(robot, q, reference, duration, frame="tool", others=(), level=None, **settings):
    """Trajectory and the hand's errors."""
    hand = PoseTask(
        name="hand", point=robot.point(frame), stiffness=100.0, weight=10.0, level=level, reference=reference
    )
    run, errors = Controller(robot, [hand, *others], **settings), []

    def law(time, q, v):
        command = run.update(time, q, v)
        errors.append(command.errors["hand"])
        return command

    return simulate(robot, q, np.zeros(robot.nv), law, duration=duration), np.array(errors)


def reversals(rates):
    """How often a rate changes its sign, rates of some mrad/s aside; the most of any joint."""
    moving = [column[np.abs(column) > 5e-3] for column in rates.T]
    return max(int((np.diff(np.sign(column)) != 0).sum()) for column in moving)


def torque_step(run, since):
    """Largest change of a torque from one cycle to the next, N m."""
    return np.abs(np.diff(run.torque[run.time >= since], axis=0)).max()


@pytest.mark.parametrize("level", [None, 0])
@pytest.mark.parametrize("velocity", [(0.2, 0.0, 0.05), (0.0, 0.15, 0.15)])
def test_an_arm_whose_target_leaves_its_reach_stretches_and_rests(velocity, level):
    robot = arms.arm()
    q = at(robot, BENT)
    target = drifting(robot.state(q).placement(robot.point("tool")), velocity)
    run, errors = follow(robot, q, target, 10.0, others=[rest()], level=level)
    assert run.certificate().passed
    assert reversals(run.v[run.time >= 4.0, 6:]) <= 4
    assert torque_step(run, since=6.0) < 0.1
    q = run.q[-1]
    shoulder = robot.base_pose(q).act(np.array([0.0, 0.0, 0.6]))
    tool = robot.state(q).placement(robot.point("tool")).translation
    assert np.linalg.norm(tool - shoulder) > 1.05  # of 1.13; the orientation takes the rest
    assert abs(q[7 + arms.ELBOW]) < 0.06
    assert np.linalg.norm(errors[-1, :3]) > 0.9


@pytest.mark.parametrize("level", [None, 0])
def test_on_the_way_out_torques_do_not_jump(level):
    """The elbow is at its velocity limit when the arm is straight, and nothing below a strict level slows it."""
    robot = arms.arm()
    q = at(robot, BENT)
    target = drifting(robot.state(q).placement(robot.point("tool")), (0.0, 0.0, 0.1))
    run, _ = follow(robot, q, target, 3.3, others=[rest()], level=level)
    assert abs(run.q[-1, 7 + arms.ELBOW]) < 0.1
    assert torque_step(run, since=0.1) < 5.0


def test_a_damping_far_above_the_singularity_is_a_switch():
    robot = arms.arm()
    q = at(robot, BENT)
    target = drifting(robot.state(q).placement(robot.point("tool")), (0.0, 0.0, 0.1))
    run, _ = follow(robot, q, target, 3.3, level=0, damping=1e-2)
    assert torque_step(run, since=0.1) > 10.0


def test_without_the_damping_it_swings_at_full_torque():
    """What a trust radius that is never left brings back."""
    robot = arms.arm()
    q = at(robot, BENT)
    target = drifting(robot.state(q).placement(robot.point("tool")), (0.2, 0.0, 0.05))
    run, _ = follow(robot, q, target, 8.0, others=[rest()], trust_radius=1e6)
    assert reversals(run.v[run.time >= 4.0, 6:]) > 50
    assert torque_step(run, since=6.0) > 50.0


def test_a_step_that_is_out_of_reach_ends_at_rest():
    robot = arms.arm()
    q = at(robot, BENT)
    goal = robot.state(q).placement(robot.point("tool"))
    goal.translation += np.array([2.0, 1.0, 2.0])
    run, _ = follow(robot, q, Constant(goal), 8.0)
    assert np.abs(run.v[-1, 6:]).max() < 5e-3
    assert torque_step(run, since=5.0) < 0.01
    assert run.certificate().passed


def test_a_robot_of_many_joints_rests_too():
    """Where joints at their limits and tasks against each other make the singularity, and not the hand's rows."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    q = robot.configuration()
    others = [
        OrientationTask(name="head", point=robot.point("head")),
        BaseAttitudeTask(name="base", robot=robot),
        rest(),
    ]
    target = drifting(robot.state(q).placement(robot.point("right_hand")), (0.1, -0.2, 0.05))
    run, _ = follow(robot, q, target, 10.0, "right_hand", others)
    assert reversals(run.v[run.time >= 6.0, 6:]) <= 4
    assert run.certificate().passed


PASSAGES = {
    "kinematic": (300.0, [0.1, 0.7, -0.5, 0.4, 0.9, 0.2], [0.3, 0.9, 0.5, 0.6, 1.1, 0.5]),
    "wrist": (300.0, [0.1, 0.4, 1.2, 0.4, -0.5, 0.2], [0.3, 0.6, 1.0, 0.7, 0.5, 0.5]),
    "dynamic": (40.0, [0.0, 1.19, -1.25, -2.05, -1.55, -1.23], [0.0, 1.76, -1.99, -2.18, -1.82, -1.06]),
}


@pytest.mark.parametrize("kind", PASSAGES)
def test_singularities_are_passed(kind):
    mass, start, end = PASSAGES[kind]
    robot = arms.arm(mass, mass / 10.0 if kind == "dynamic" else 50.0)
    way = [np.add(start, s * np.subtract(end, start)) for s in np.linspace(0.0, 1.0, 41)]
    floating = [arms.smallest_singular_value(robot, joints) for joints in way]
    assert floating[0] * floating[-1] < 0.0
    if kind == "dynamic":
        assert min(abs(arms.smallest_singular_value(robot, joints, floating=False)) for joints in way) > 0.1
    q, reference = arms.way_of_the_hand(robot, start, end, 4.0)
    for level, weight, most in ((None, 1e-4, 0.3e-3), (0, 1e-3, 0.02e-3)):
        run, errors = follow(robot, q, reference, 4.0, others=[rest(weight)], level=level)
        assert np.linalg.norm(errors[:, :3], axis=1).max() < most
        assert np.linalg.norm(errors[:, 3:], axis=1).max() < 1e-3
        assert np.abs(run.v[:, 6 + arms.ELBOW]).max() > 0.1 * abs(end[arms.ELBOW] - start[arms.ELBOW])
        assert np.abs(run.q[-1, 7:] - end).max() < 0.05  # through, and not turned back


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("nearness", [0.0, 0.5, 0.9])
def test_the_objective_is_the_one_that_is_written(seed, nearness):
    """H = Aᵀ W A + ε + D and f = −Aᵀ W b + D_s d φ̇, from the rows and ê = e + ė d/k by their definition."""
    robot, rng = arms.arm(), np.random.default_rng(seed)
    q, v = at(robot, rng.uniform(-1.5, 1.5, 6)), 0.2 * rng.normal(size=robot.nv)
    goal = robot.state(q).placement(robot.point("tool"))
    goal.translation += (0.05, 0.3, 3.0, 0.0)[seed] * rng.normal(size=3)
    task = PoseTask(name="hand", point=robot.point("tool"), stiffness=9.0, damping_ratio=0.7, weight=4.0)
    A = Controller(robot, [task]).update(0.0, q, v).generalized_jacobian
    pivot = (np.diag(np.linalg.qr(A.T)[1]) ** 2 / np.sum(A**2, axis=1)).min()
    singular = 0.9 * pivot if nearness == 0.0 else pivot / (1.0 - nearness)
    run = Controller(robot, [task, rest()], singular=singular, damping=0.02, trust_radius=0.7, regularization=1e-5)
    run.follow("hand", Constant(goal))
    command = run.update(0.0, q, v)
    assert ("hand" in command.near_singularity) == (nearness > 0.0)
    state = robot.state(q, v)
    velocity = ospace.operational_space(state, robot.point("tool")).jacobian @ np.r_[state.base_twist, v[6:]]
    b, error = run._rows.b[:6], command.errors["hand"] - 2.0 * 0.7 * 3.0 / 9.0 * velocity
    whole = np.sum(A**2) / 6.0
    s = min(1.0, error @ error / (0.7**2 * whole))
    slowed = 4.0 * s * (np.sum(A**2, axis=0) + 0.03 * whole)
    still = 4.0 * 0.02 * nearness**2 * whole
    H = 4.0 * A.T @ A + np.diag(slowed + still + 1e-5 + 1e-3)
    f = -4.0 * A.T @ b + slowed * 2.0 * 0.7 * 3.0 * v[6:] + 1e-3 * 2.0 * v[6:]
    np.testing.assert_allclose(run._program.H, H, rtol=0, atol=1e-9 * np.abs(H).max())
    np.testing.assert_allclose(run._program.f, f, rtol=0, atol=1e-9 * np.abs(f).max())


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf, "far"])
def test_a_trust_radius_is_a_length(bad):
    robot = arms.arm()
    with pytest.raises(ospace.OspaceError, match="trust_radius"):
        Controller(robot, [rest()], trust_radius=bad, limits=JointLimits.of(robot))

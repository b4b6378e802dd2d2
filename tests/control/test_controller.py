"""The controller: what it asks for is what the robot does, limits hold, and nothing fails in silence."""

import itertools

import numpy as np
import pinocchio as pin
import pytest
import qpsolvers
from hypothesis import given, settings
from hypothesis import strategies as st

import ospace
from ospace.control import (
    Base,
    BaseAttitudeTask,
    CentreOfMassTask,
    Completion,
    Constant,
    Controller,
    DampingTask,
    Function,
    JointLimits,
    LookAtTask,
    MinimumJerk,
    MomentumTask,
    OrientationTask,
    PoseTask,
    PositionTask,
    PostureTask,
    RelativePoseTask,
)
from ospace.control.base import MODES
from ospace.dynamics.joint_friction import FRICTION_VELOCITY
from ospace.validation.sampling import random_state


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture(scope="module")
def hand(chaser):
    return chaser.point("right_hand")


@pytest.fixture(scope="module")
def head(chaser):
    return chaser.point("head", offset=pin.SE3(pin.exp3(np.array([0.3, -0.2, 0.5])), np.array([0.1, 0.2, -0.1])))


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


@pytest.mark.parametrize("base", MODES)
@pytest.mark.parametrize("seed", range(3))
def test_the_robot_accelerates_as_the_command_says(chaser, hand, head, base, seed):
    q, v = state(chaser, seed)
    tasks = paper_tasks(chaser, hand, head)
    tasks += [CentreOfMassTask(name="centre")] if base in ("flying", "thrusters") else []
    tasks += [MomentumTask(name="momentum")] if base != "floating" else []
    command = Controller(chaser, tasks, base=base, limits=unlimited(chaser)).update(0.0, q, v)
    a = accelerations(chaser, q, v, command)
    np.testing.assert_allclose(a[6:], command.joint_acceleration, rtol=0, atol=1e-8 * np.abs(a).max())
    R, omega = chaser.base_pose(q).rotation, v[3:6]
    classical = np.concatenate([R @ (a[:3] + np.cross(omega, v[:3])), R @ a[3:6]])
    np.testing.assert_allclose(classical, command.base_acceleration, rtol=0, atol=1e-8 * np.abs(a).max())
    used = (
        np.abs(command.base_wrench[:3]).max(),
        np.abs(command.base_wrench[3:]).max(),
        np.abs(command.wheel_torque).max(),
    )
    assert [x > 0.0 for x in used] == {
        "floating": [False, False, False],
        "flying": [True, True, False],
        "thrusters": [True, False, False],
        "wheels": [False, False, True],
    }[base]


def turned(pose, small):
    return pin.SE3(pin.exp3(small[3:]) @ pose.rotation, pose.translation + small[:3])


def one_task(kind, robot, hand, head, poses, rng):
    """A task whose reference moves and is a little off, so that its error is small and its rate is not."""
    small, rate, curve = rng.normal(scale=1e-4, size=6), rng.normal(size=6) * 0.3, rng.normal(size=6) * 0.3

    def motion(pose):
        def at(time):
            moved = rate * time + 0.5 * curve * time**2
            start = turned(pose, small)
            return (
                pin.SE3(pin.exp3(moved[3:]) @ start.rotation, start.translation + moved[:3]),
                rate + curve * time,
                curve,
            )

        return at

    own = {"name": "task", "stiffness": 9.0, "damping_ratio": 0.7}
    if kind == "pose":
        return PoseTask(point=hand, reference=Function(motion(poses["hand"])), **own)
    if kind == "position":
        return PositionTask(
            point=head, axes=(True, False, True, True, True, True), reference=Function(motion(poses["head"])), **own
        )
    if kind == "base":
        return BaseAttitudeTask(robot=robot, reference=Function(motion(poses["base"])), **own)
    if kind == "look at":
        axis = poses["head"].rotation.T @ (poses["hand"].translation - poses["head"].translation)
        return LookAtTask(point=head, axis=tuple(axis), reference=Function(motion(poses["hand"])), **own)
    if kind == "relative":
        return RelativePoseTask(
            point=hand, seen_from=head, reference=Function(motion(poses["head"].actInv(poses["hand"]))), **own
        )
    return CentreOfMassTask(reference=Function(motion(poses["centre"])), **own)


def error_of(robot, kind, task, time, q, hand, head):
    """The error of a task by its definition, from Pinocchio's frames alone."""
    pose, _, _ = task.reference.motion(time)
    now = robot.state(q)
    T_hand, T_head = now.placement(hand), now.placement(head)
    if kind == "centre of mass":
        return pose.translation - pin.centerOfMass(robot.model, robot.model.createData(), q)
    if kind == "look at":
        sight = pose.translation - T_head.translation
        d, n = sight / np.linalg.norm(sight), T_head.rotation @ np.asarray(task.axis)
        n /= np.linalg.norm(n)
        return np.cross(n, d)
    if kind == "relative":
        T = T_head.actInv(T_hand)
        return np.concatenate([pose.translation - T.translation, pin.log3(pose.rotation @ T.rotation.T)])
    T = {"pose": T_hand, "position": T_head, "base": now.T_WB}[kind]
    error = np.concatenate([pose.translation - T.translation, pin.log3(pose.rotation @ T.rotation.T)])
    return error[task.rows(robot)]


@pytest.mark.parametrize("kind", ["pose", "position", "base", "look at", "relative", "centre of mass"])
@pytest.mark.parametrize("seed", range(3))
def test_errors_fall_as_those_of_a_damped_spring(chaser, hand, head, kind, seed):
    """ë + d ė + k e = 0 along the motion that the command makes, by differences of the errors by their definition."""
    rng = np.random.default_rng(seed)
    q, v = state(chaser, seed)
    now = chaser.state(q, v)
    centre = pin.centerOfMass(chaser.model, chaser.model.createData(), q)
    poses = {"hand": now.placement(hand), "head": now.placement(head), "base": now.T_WB}
    poses["centre"] = pin.SE3(np.eye(3), centre.copy())
    task = one_task(kind, chaser, hand, head, poses, rng)
    run = Controller(chaser, [task], base="flying", limits=unlimited(chaser), regularization=1e-10)
    command = run.update(0.0, q, v)
    a, h, errors = accelerations(chaser, q, v, command), 1e-3, []
    for time in (-h, 0.0, h):
        q_t = pin.integrate(chaser.model, q, v * time + 0.5 * a * time**2)
        errors.append(error_of(chaser, kind, task, time, q_t, hand, head))
    rate, curve = (errors[2] - errors[0]) / (2.0 * h), (errors[2] - 2.0 * errors[1] + errors[0]) / h**2
    left = curve + 2.0 * 0.7 * 3.0 * rate + 9.0 * errors[1]
    if kind == "look at":  # along the line of sight there is no error, and nothing is asked
        d = poses["hand"].translation - poses["head"].translation
        left -= d * (left @ d) / (d @ d)
    assert np.abs(rate).max() > 1e-2
    assert np.abs(left).max() < 5e-3 * np.abs(np.concatenate([curve, 4.2 * rate])).max()
    told = command.errors["task"]
    assert np.linalg.norm(told) == pytest.approx(np.linalg.norm(errors[1]), rel=1e-3)


def test_joint_tasks(chaser):
    q, v = state(chaser, 5)
    names = chaser.joint_names[:3]
    run = Controller(
        chaser,
        [PostureTask(name="posture", posture=dict.fromkeys(names, 0.3), stiffness=4.0, weight=1.0)],
        limits=unlimited(chaser),
        regularization=1e-12,
    )
    command = run.update(0.0, q, v)
    np.testing.assert_allclose(command.joint_acceleration[:3], 4.0 * (0.3 - q[7:10]) - 4.0 * v[6:9], atol=1e-8)
    run = Controller(chaser, [DampingTask(name="rest", weight=1.0)], limits=unlimited(chaser), regularization=1e-12)
    np.testing.assert_allclose(run.update(0.0, q, v).joint_acceleration, -10.0 * v[6:], atol=1e-7)


@pytest.mark.parametrize("base", ["flying", "wheels"])
def test_momentum_is_dumped_by_the_base(chaser, base):
    q, v = state(chaser, 6)
    axes = "all" if base == "flying" else "angular"
    tasks = [MomentumTask(name="dump", axes=axes, stiffness=0.25), DampingTask(name="rest")]
    run = Controller(chaser, tasks, base=base, limits=unlimited(chaser), regularization=1e-9)
    momentum, data, centre = [], chaser.model.createData(), []
    h = 1e-4
    for _ in range(2):
        command = run.update(0.0, q, v)
        momentum.append(pin.computeCentroidalMomentum(chaser.model, data, q, v).vector.copy())
        a = accelerations(chaser, q, v, command)
        q, v = pin.integrate(chaser.model, q, (v + 0.5 * h * a) * h), v + h * a
        centre.append(command)
    rate = (momentum[1] - momentum[0]) / h
    rows = slice(0, 6) if base == "flying" else slice(3, 6)
    expected = -0.5 * momentum[0][rows]
    np.testing.assert_allclose(rate[rows], expected, rtol=0, atol=2e-3 * np.abs(expected).max())


def test_wheels_keep_within_their_momentum(chaser):
    q, v = chaser.configuration(), np.zeros(24)
    goal = Constant(pin.SE3(pin.exp3(np.array([0.0, 0.0, 1.0])), np.zeros(3)))
    base = Base(torque=50.0, wheels=True, wheel_momentum=2.0)
    run = Controller(
        chaser, [BaseAttitudeTask(name="turn", robot=chaser, reference=goal), DampingTask(name="rest")], base=base
    )
    largest = 0.0
    assert {f"base torque z, {side}" for side in ("lower", "upper")} & {*run.update(0.0, q, v).active_limits}
    for k in range(2000):
        command = run.update(k * 1e-3, q, v)
        a = accelerations(chaser, q, v, command)
        v = v + 1e-3 * a
        q = pin.integrate(chaser.model, q, v * 1e-3)
        largest = max(largest, np.abs(chaser.base_pose(q).rotation.T @ run.wheel_momentum).max())
    assert 1.9 < largest < 2.0 + 1e-3
    assert {f"base torque z: wheel momentum, {side}" for side in ("lower", "upper")} & {*command.active_limits}


# -- limits ------------------------------------------------------------------------------------------------------


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 3.0), st.sampled_from(sorted(MODES)))
def test_no_state_and_no_target_breaks_it(chaser, hand, head, seed, share, base):
    rng = np.random.default_rng(seed)
    q, v = state(chaser, seed, speed=rng.choice([0.0, 1.0, 10.0]))
    q[7:] = rng.uniform(-4.0, 4.0, 18)  # beyond the limits too
    far = pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(scale=rng.choice([0.3, 3.0, 1e6]), size=3))
    tasks = paper_tasks(chaser, hand, head)
    limits = JointLimits.of(chaser, share=share, acceleration=rng.choice([np.inf, 5.0]))
    run = Controller(chaser, tasks, base=base, limits=limits)
    run.follow("hand", Constant(far))
    command = run.update(0.0, q, v)
    if seed % 2:
        run.follow("hand", Constant(far))
        command = run.update(1e-3, q, v)
    assert np.isfinite(command.torque).all()
    assert (np.abs(command.torque) <= limits.torque * (1.0 + 1e-8)).all()
    outside = chaser.outside_limits(q)
    assert command.status == ("outside limits" if outside else "softened" if command.softened else "nominal")
    assert command.outside == pytest.approx(outside)
    assert all(name in command.explanation for name in (*command.softened, *outside))


@pytest.mark.parametrize("name", ["planar_2r", "ets_vii", "chaser_7dof", "chaser_24dof"])
@pytest.mark.parametrize("leveled", [False, True])
def test_every_status_is_true_and_explained(name, leveled):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    point, rng = robot.point(robot.leaf_links[-1]), np.random.default_rng(0)
    for seed in range(40):
        drawn = random_state(robot, np.random.default_rng(seed))
        limits = JointLimits.of(robot, share=rng.choice([1.0, 0.05]), acceleration=rng.choice([np.inf, 5.0]))
        goal = Constant(pin.SE3(pin.exp3(rng.normal(size=3)), drawn.q[:3] + rng.normal(scale=3.0, size=3)))
        tasks = [PoseTask(name="hand", point=point, reference=goal, level=0 if leveled else None)]
        tasks += [BaseAttitudeTask(name="base", robot=robot, level=1 if leveled else None), PostureTask(name="posture")]
        run = Controller(robot, tasks, limits=limits, base=sorted(MODES)[seed % 4])
        command = run.update(0.0, drawn.q.copy(), rng.choice([0.0, 0.1, 1.0, 10.0]) * drawn.v)
        assert command.status in ("nominal", "softened"), (seed, command)
        assert (np.abs(command.torque) <= limits.torque * (1.0 + 1e-8)).all()
        lower, upper, value, _ = command._bounds
        excess = np.maximum(value - upper, lower - value) / np.maximum(1.0, np.abs(value))
        if command.status == "nominal":
            moving = excess[: -robot.n_joints]  # torques are cut to their limits
            assert moving.max() <= 1.1e-6, (seed, moving.argmax(), excess.argmax())
        else:
            assert command.softened, (seed, command)
            assert excess[: robot.n_joints].max() > 1e-7


def test_a_level_that_repeats_another_takes_nothing_from_those_below(chaser, hand, head):
    q, v = state(chaser, 8)
    far = Constant(pin.SE3.Identity())
    below = [OrientationTask(name="head", point=head, reference=far), PostureTask(name="posture", weight=1.0)]
    first = PoseTask(name="hand", point=hand, reference=far, level=0)
    again = PoseTask(name="again", point=hand, reference=far, level=1)
    alone, repeated = (
        Controller(chaser, tasks, limits=unlimited(chaser)).update(0.0, q, v)
        for tasks in ([first, *below], [first, again, *below])
    )
    np.testing.assert_allclose(
        repeated.joint_acceleration, alone.joint_acceleration, atol=1e-6 * np.abs(alone.joint_acceleration).max()
    )


def test_what_a_task_does_not_take_does_not_weigh(chaser):
    """The place of an orientation's reference is of no account, however far away."""
    q, v = chaser.configuration(), np.zeros(24)
    R = pin.exp3(np.array([0.2, 0.0, 0.0]))
    answers = []
    for away in (0.0, 7e6):
        goal = Constant(pin.SE3(R, np.full(3, away)))
        run = Controller(chaser, BaseAttitudeTask(name="base", robot=chaser, reference=goal), base="flying")
        answers.append(run.update(0.0, q, v).base_acceleration[3:])
    np.testing.assert_allclose(answers[1], answers[0], atol=1e-9)
    np.testing.assert_allclose(answers[0], [5.0, 0.0, 0.0], atol=1e-2)


def test_a_momentum_follows_its_rate(chaser):
    q, v = chaser.configuration(), np.zeros(24)
    rate = np.array([0.0, 0.0, 0.0, 1.0, 2.0, 3.0])
    task = MomentumTask(name="x", reference=Function(lambda time: (pin.SE3.Identity(), np.zeros(6), rate)))
    command = Controller(chaser, [task, DampingTask(name="rest")], base="flying", limits=unlimited(chaser)).update(
        0.0, q, v
    )
    centre = pin.centerOfMass(chaser.model, chaser.model.createData(), q)
    moment = command.base_wrench[3:] - np.cross(centre, command.base_wrench[:3])
    np.testing.assert_allclose(moment, rate[3:], atol=1e-4)


def test_limits_hold_in_motion_and_are_named(chaser, hand):
    robot, q, v = chaser, chaser.configuration(), np.zeros(24)
    limits = JointLimits.of(robot, acceleration=2.0)
    start = robot.state(q, v).placement(hand)
    far = Constant(pin.SE3(start.rotation, start.translation + [3.0, 2.0, -1.0]))
    run = Controller(
        robot, [PositionTask(name="reach", point=hand, reference=far), DampingTask(name="rest")], limits=limits
    )
    told, highest = set(), np.zeros(18)
    for k in range(6000):
        command = run.update(k * 1e-3, q, v)
        assert command.status == "nominal"
        told.update(command.active_limits)
        a = accelerations(robot, q, v, command)
        q = pin.integrate(robot.model, q, 1e-3 * (v + 0.5e-3 * a))
        v = v + 1e-3 * a
        highest = np.maximum(highest, np.abs(v[6:]))
        assert (q[7:] <= limits.upper + 1e-6).all()
        assert (q[7:] >= limits.lower - 1e-6).all()
    assert (highest <= limits.velocity * (1.0 + 1e-6)).all()
    for kind in ("position", "velocity", "acceleration"):
        assert any(f": {kind}, " in name for name in told), (kind, told)
    assert all(name.split(":")[0] in robot.joint_names for name in told)


@pytest.mark.parametrize("outside", [0.05, 0.5])
def test_joints_outside_their_limits_come_back(chaser, outside):
    limits = JointLimits.of(chaser, acceleration=3.0)
    q, v = chaser.configuration(), np.zeros(24)
    bounded = np.flatnonzero(np.isfinite(limits.upper))
    q[7 + bounded] = limits.upper[bounded] + outside
    run = Controller(chaser, [DampingTask(name="rest")], limits=limits)
    for k in range(4000):
        command = run.update(k * 1e-3, q, v)
        beyond = chaser.outside_limits(q)
        assert (command.status == "outside limits") == (max(beyond.values(), default=0.0) > 1e-6)
        v = v + 1e-3 * accelerations(chaser, q, v, command)
        q = pin.integrate(chaser.model, q, 1e-3 * v)
    assert command.status == "nominal"
    assert (q[7 + bounded] <= limits.upper[bounded] + 1e-6).all()


def test_torque_limits_stand_above_motion_limits(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    v[6:] = 1.4  # with next to no torque, nothing keeps joints from passing their velocity limits
    limits = JointLimits.of(chaser, share=1e-3)
    command = Controller(chaser, [PoseTask(name="hand", point=hand)], limits=limits).update(0.0, q, v)
    assert command.status == "softened"
    assert command.softened
    assert (np.abs(command.torque) <= limits.torque * (1.0 + 1e-8)).all()
    assert any("torque" in name for name in command.active_limits)


@pytest.mark.parametrize("share", [1.0, 0.02])
def test_a_solver_that_fails_ends_in_a_damped_stop(chaser, hand, share):
    limits = JointLimits.of(chaser, share=share)
    run = Controller(chaser, [PoseTask(name="hand", point=hand)], limits=limits)
    run._solve = lambda program: None
    for seed in range(20):
        q, v = state(chaser, seed, speed=1.0)
        command = run.update(0.0, q, v)
        assert command.status == "stopped"
        assert "braked" in command.explanation
        assert (np.abs(command.torque) <= limits.torque).all()
        assert (command.torque * v[6:] <= 1e-10).all()
        a = accelerations(chaser, q, v, command)
        np.testing.assert_allclose(a[6:], command.joint_acceleration, rtol=0, atol=1e-8 * np.abs(a).max())


# -- priorities and solvers --------------------------------------------------------------------------------------


def test_a_strict_level_costs_those_above_nothing(chaser, hand, head):
    q, v = state(chaser, 8)
    first = {"name": "hand", "point": hand, "reference": Constant(chaser.state(q, v).placement(hand))}
    rest = [
        OrientationTask(name="head", point=head, level=1, reference=Constant(pin.SE3.Identity())),
        BaseAttitudeTask(name="base", robot=chaser, level=2, reference=Constant(pin.SE3.Identity())),
        PoseTask(name="left", point=chaser.point("left_hand"), reference=Constant(pin.SE3.Identity())),
    ]
    alone = Controller(chaser, [PoseTask(**first, level=0)], limits=unlimited(chaser)).update(0.0, q, v)
    together = Controller(chaser, [PoseTask(**first, level=0), *rest], limits=unlimited(chaser)).update(0.0, q, v)
    for command in (alone, together):
        assert np.abs(command.residuals["hand"]).max() < 1e-4
    difference = together.residuals["hand"] - alone.residuals["hand"]
    assert np.abs(difference).max() < 1e-8
    assert np.abs(together.residuals["head"]).max() < 1e-2
    tasks = [PoseTask(**first), *(type(task)(**{**vars(task), "level": None}) for task in rest)]
    weighted = Controller(chaser, tasks, limits=unlimited(chaser)).update(0.0, q, v)
    assert np.abs(weighted.residuals["hand"]).max() > 1e-2


def test_levels_keep_limits(chaser, hand, head):
    q, v = state(chaser, 9)
    limits = JointLimits.of(chaser, share=0.05, acceleration=5.0)
    tasks = [
        PoseTask(name="hand", point=hand, level=0, reference=Constant(pin.SE3.Identity())),
        OrientationTask(name="head", point=head, level=1, reference=Constant(pin.SE3.Identity())),
        PostureTask(name="posture", weight=1.0),
    ]
    command = Controller(chaser, tasks, limits=limits).update(0.0, q, 0.1 * v)
    assert command.status == "nominal"
    assert (np.abs(command.torque) <= limits.torque * (1 + 1e-8)).all()
    assert (np.abs(command.joint_acceleration) <= 5.0 + 1e-4).all()


def test_the_solvers_that_are_compared_are_many():
    assert set(qpsolvers.available_solvers) >= {"daqp", "proxqp", "quadprog", "clarabel", "highs", "osqp", "piqp"}


def test_a_solver_that_is_too_rough_is_refused(chaser, hand):
    with pytest.raises(ospace.OspaceError, match="'ecos'"):
        Controller(chaser, [PoseTask(name="hand", point=hand)], solver="ecos")


SOLVERS = sorted({*qpsolvers.available_solvers} - {"daqp", "ecos"})


@pytest.mark.parametrize("solver", SOLVERS)
def test_all_solvers_give_the_same(chaser, hand, head, solver):
    limits = JointLimits.of(chaser, share=0.2, acceleration=5.0)
    tasks = paper_tasks(chaser, hand, head)
    runs = [Controller(chaser, tasks, limits=limits, solver=name, base="flying") for name in ("daqp", solver)]
    for seed in range(10):
        q, v = state(chaser, seed)
        for run in runs:
            run.follow("hand", Constant(pin.SE3.Identity()))
        one, other = (run.update(0.0, q, v) for run in runs)
        for name in ("joint_acceleration", "torque", "base_wrench"):
            value, reference = getattr(other, name), getattr(one, name)
            np.testing.assert_allclose(value, reference, rtol=0, atol=1e-6 * max(1.0, np.abs(reference).max()))


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


SLOW = {"highs": 20, "osqp": 5, "scs": 5}


@pytest.mark.parametrize("solver", SOLVERS)
def test_all_solvers_give_the_same_by_levels(chaser, hand, solver):
    limits = JointLimits.of(chaser, share=0.3)
    for tasks, q, v in leveled_states(chaser, hand, SLOW.get(solver, 100)):
        one, other = (
            Controller(chaser, tasks, limits=limits, solver=name).update(0.0, q, v) for name in ("daqp", solver)
        )
        assert one.status == other.status == "nominal", (one.explanation, other.explanation)
        assert not other.dropped
        np.testing.assert_allclose(other.torque, one.torque, rtol=0, atol=1e-4 * (1.0 + np.abs(one.torque).max()))


@pytest.mark.parametrize("name", ["planar_2r", "ets_vii", "chaser_7dof", "chaser_24dof"])
@pytest.mark.parametrize("solver", ["daqp", "proxqp"])
def test_no_level_is_dropped_and_levels_are_those_of_quadprog(name, solver):
    """In states of which many need softened limits, and in which solvers alone fail."""
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    point, rng = robot.point(robot.leaf_links[-1]), np.random.default_rng(5)
    for seed in range(40):
        drawn = random_state(robot, np.random.default_rng(seed))
        limits = JointLimits.of(robot, share=rng.choice([1.0, 0.05]), acceleration=rng.choice([np.inf, 5.0]))
        goal = Constant(pin.SE3(pin.exp3(rng.normal(size=3)), drawn.q[:3] + rng.normal(scale=3.0, size=3)))
        tasks = [PoseTask(name="hand", point=point, reference=goal, level=0)]
        tasks += [BaseAttitudeTask(name="base", robot=robot, level=1), PostureTask(name="posture")]
        v = rng.choice([0.0, 0.1, 1.0]) * drawn.v
        one, other = (
            Controller(robot, tasks, limits=limits, base=sorted(MODES)[seed % 4], solver=kind).update(0.0, drawn.q, v)
            for kind in (solver, "quadprog")
        )
        assert one.status == other.status != "degraded"
        if one.status == "nominal":
            atol = 1e-3 * (1.0 + np.abs(other.torque).max())
            np.testing.assert_allclose(one.torque, other.torque, rtol=0, atol=atol)


@pytest.mark.parametrize("level", [1, None])
def test_a_level_without_a_solution_is_named(chaser, hand, level):
    tasks, q, v = next(leveled_states(chaser, hand, 1))
    run = Controller(chaser, tasks, limits=JointLimits.of(chaser, share=0.3))
    whole = run.update(0.0, q, v)
    solve, calls, failing = run._solve, itertools.count(), 1 if level == 1 else 2
    run._solve = lambda program: None if next(calls) == failing else solve(program)
    command = run.update(0.0, q, v)
    name = "base" if level == 1 else "rest"
    assert command.status == "degraded"
    assert command.dropped == {level: (name,)}
    assert ("level 1" if level == 1 else "without a level") in command.explanation
    assert f"'{name}'" in command.explanation
    np.testing.assert_allclose(command.residuals["hand"], whole.residuals["hand"], rtol=0, atol=1e-4)
    assert (np.abs(command.torque) <= run.limits.torque).all()


def test_near_a_singularity_it_damps(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    reference = Constant(pin.SE3(np.eye(3), np.array([5.0, 0.0, 0.0])))
    sensitive = Controller(chaser, [PoseTask(name="hand", point=hand, reference=reference)], singular=1.0 - 1e-9)
    plain = Controller(chaser, [PoseTask(name="hand", point=hand, reference=reference)])
    damped, full = sensitive.update(0.0, q, v), plain.update(0.0, q, v)
    assert damped.near_singularity == ("hand",)
    assert full.near_singularity == ()
    assert np.linalg.norm(damped.joint_acceleration) < np.linalg.norm(full.joint_acceleration)
    assert full.rank == 6
    assert full.smallest_singular_value > 0.0


# -- references and completion -----------------------------------------------------------------------------------


def test_minimum_jerk_starts_and_ends_at_rest(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    origin = chaser.state(q, v).placement(hand)
    goal = origin * pin.SE3(pin.exp3(np.array([0.4, 0.1, -0.3])), np.array([0.05, -0.1, 0.1]))
    task = PoseTask(name="hand", point=hand, reference=MinimumJerk(origin, goal, 1.0, 4.0))
    run = Controller(chaser, [task], limits=unlimited(chaser))
    for time in (0.0, 1.0):
        assert np.abs(run.update(time, q, v).errors["hand"]).max() < 1e-12
    half = run.update(3.0, q, v).errors["hand"]
    np.testing.assert_allclose(half[:3], 0.5 * (goal.translation - origin.translation), atol=1e-12)
    np.testing.assert_allclose(half[3:], 0.5 * pin.log3(goal.rotation @ origin.rotation.T), atol=1e-12)
    end = run.update(9.0, q, v).errors["hand"]
    np.testing.assert_allclose(end[3:], pin.log3(goal.rotation @ origin.rotation.T), atol=1e-12)


@pytest.mark.parametrize("angle", [1e-9, 0.5, 3.1, np.pi - 1e-7, np.pi])
def test_large_turns_are_errors_of_their_size(chaser, hand, angle):
    q, v = chaser.configuration(), np.zeros(24)
    pose = chaser.state(q, v).placement(hand)
    for axis in np.eye(3):
        goal = Constant(pin.SE3(pin.exp3(angle * axis) @ pose.rotation, pose.translation))
        run = Controller(chaser, [PoseTask(name="hand", point=hand, reference=goal)])
        error = run.update(0.0, q, v).errors["hand"]
        assert np.linalg.norm(error[3:]) == pytest.approx(angle, abs=1e-7)
        assert abs(error[3:] @ axis) == pytest.approx(angle, abs=1e-7)


def test_completion_needs_its_time(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    task = PoseTask(name="hand", point=hand, completion=Completion(position=1e-3, angle=1e-3, hold=0.2))
    run = Controller(chaser, [task])
    done = []
    for time in (0.0, 0.1, 0.19, 0.2, 0.3):
        run.update(time, q, v)
        done.append(run.completed("hand"))
    assert done == [False, False, False, True, True]
    moved = q.copy()
    moved[8] += 0.1
    run.update(0.4, moved, v)
    assert not run.completed("hand")
    run.follow("hand", MinimumJerk(run.pose(hand), run.pose(hand), 0.4, 1.0))
    for time in (0.5, 1.3, 1.4, 1.6):
        run.update(time, moved, v)
    assert run.completed("hand")
    run.follow("hand", MinimumJerk(run.pose(hand), run.pose(hand), 1.6, 1.0))
    for time in (1.6, 1.9):
        run.update(time, moved, v)
    assert not run.completed("hand")


def test_far_from_the_origin_nothing_changes(chaser, hand, head):
    q, v = state(chaser, 4)
    away = q.copy()
    away[:3] += 7e6
    here, there = (
        Controller(chaser, paper_tasks(chaser, hand, head)).update(0.0, configuration, v) for configuration in (q, away)
    )
    np.testing.assert_allclose(there.torque, here.torque, rtol=0, atol=1e-6 * np.abs(here.torque).max())


# -- joints without a drive, joints that rub ----------------------------------------------------------------------


def idle(robot, *joints):
    torque = np.full(robot.n_joints, 20.0)
    torque[list(joints)] = 0.0
    return unlimited(robot, torque=torque)


@pytest.mark.parametrize("solver", ["daqp", *SOLVERS])
@pytest.mark.parametrize("joints", [(2,), (0, 7, 17)])
def test_joints_without_a_drive_move_as_the_others_make_them(chaser, hand, head, solver, joints):
    """The least squares of the tasks over the accelerations that leave those torques zero, from Pinocchio's inertia."""
    q, v = state(chaser, 21, speed=0.05)
    near = Constant(chaser.state(q, v).placement(hand) * pin.SE3(np.eye(3), np.array([0.01, 0.0, 0.0])))
    tasks = [
        PoseTask(name="hand", point=hand, reference=near),
        OrientationTask(name="head", point=head),
        PostureTask(name="posture", weight=0.1),
    ]
    limits = unlimited(chaser, torque=np.where(np.isin(np.arange(18), joints), 0.0, np.inf))
    run = Controller(chaser, tasks, limits=limits, regularization=1e-6, solver=solver)
    command = run.update(0.0, q, v)
    assert (command.torque[list(joints)] == 0.0).all()
    assert command.status == "nominal"
    assert not any(chaser.joint_names[j] in limit for j in joints for limit in command.active_limits)
    model, data = chaser.model, chaser.model.createData()
    H = pin.crba(model, data, q)
    H = np.triu(H) + np.triu(H, 1).T
    c = pin.nonLinearEffects(model, data, q, v)
    coupling = np.linalg.solve(H[:6, :6], np.column_stack([H[:6, 6:], c[:6]]))
    reduced, bias = H[6:, 6:] - H[6:, :6] @ coupling[:, :18], c[6:] - H[6:, :6] @ coupling[:, 18]
    A, asked = [], []
    free = Controller(chaser, tasks, limits=unlimited(chaser), regularization=1e-6).update(0.0, q, v)
    for task in tasks:
        rows = slice(*np.cumsum([0, 6, 3, 18])[[tasks.index(task), tasks.index(task) + 1]])
        A.append(np.sqrt(task.weight) * free._rows[0][rows])
        asked.append(np.sqrt(task.weight) * (free._rows[0][rows] @ free.joint_acceleration - free._rows[2][rows]))
    A, asked, k = np.vstack(A), np.concatenate(asked), len(joints)
    rows = reduced[list(joints)]
    kkt = np.block([[A.T @ A + 1e-6 * np.eye(18), rows.T], [rows, np.zeros((k, k))]])
    expected = np.linalg.solve(kkt, np.concatenate([A.T @ asked, -bias[list(joints)]]))[:18]
    atol = 1e-5 * np.abs(expected).max()
    np.testing.assert_allclose(command.joint_acceleration, expected, rtol=0, atol=atol)
    a = accelerations(chaser, q, v, command)
    np.testing.assert_allclose(a[6:], command.joint_acceleration, rtol=0, atol=1e-6 * np.abs(a).max())


@pytest.mark.parametrize("leveled", [False, True])
def test_no_state_drives_a_joint_without_a_drive(chaser, hand, leveled):
    limits = JointLimits.of(chaser, acceleration=5.0)
    torque = limits.torque.copy()
    torque[[1, 9]] = 0.0
    limits = JointLimits(torque, limits.lower, limits.upper, limits.velocity, limits.acceleration)
    tasks = [
        PoseTask(name="hand", point=hand, reference=Constant(pin.SE3.Identity()), level=0 if leveled else None),
        BaseAttitudeTask(name="base", robot=chaser, level=1 if leveled else None),
        DampingTask(name="rest"),
    ]
    names = [chaser.joint_names[j] for j in (1, 9)]
    seen = set()
    for seed in range(40):
        q, v = state(chaser, seed, speed=(0.0, 0.1, 1.0)[seed % 3])
        command = Controller(chaser, tasks, limits=limits).update(0.0, q, v)
        seen.add(command.status)
        assert command.status in ("nominal", "softened"), command.explanation
        assert (command.torque[[1, 9]] == 0.0).all()
        for j, name in zip((1, 9), names, strict=True):
            rate = v[6 + j] + 1e-3 * command.joint_acceleration[j]
            passed = abs(rate) > limits.velocity[j] + 1e-7 or abs(command.joint_acceleration[j]) > 5.0 + 1e-4
            assert passed <= (name in command.softened), (seed, command.explanation)
    assert seen == {"nominal", "softened"}


def test_a_joint_of_velocity_zero_is_held(chaser, hand):
    q, v = chaser.configuration(), np.zeros(24)
    limits = JointLimits.of(chaser)
    velocity = limits.velocity.copy()
    velocity[7] = 0.0
    limits = JointLimits(limits.torque, limits.lower, limits.upper, velocity, limits.acceleration)
    run = Controller(chaser, PoseTask(name="hand", point=hand, reference=Constant(pin.SE3.Identity())), limits=limits)
    command = run.update(0.0, q, v)
    assert command.status == "nominal"
    assert abs(command.joint_acceleration[7]) < 1e-9
    assert np.abs(command.joint_acceleration).max() > 1.0


def test_limits_of_zero_are_taken_from_the_model(chaser):
    robot = ospace.SpaceRobot.from_model(chaser.model.copy())
    robot.model.effortLimit[6 + 3] = 0.0
    robot.model.velocityLimit[6 + 4] = 0.0
    robot.model.effortLimit[6 + 5] = robot.model.velocityLimit[6 + 5] = 0.0
    limits = JointLimits.of(robot, share=0.5)
    assert limits.torque[3] == 0.0
    assert limits.velocity[4] == 0.0
    assert limits.torque[5] == 0.0
    assert limits.velocity[5] == np.inf  # nothing is there to hold it still
    assert (np.delete(limits.torque, [3, 5]) > 0.0).all()


def whole_acceleration(robot, q, v, command):
    """v̇ of a command, as Pinocchio has it."""
    R, omega = robot.base_pose(q).rotation, v[3:6]
    base = command.base_acceleration
    return np.concatenate([R.T @ base[:3] - np.cross(omega, v[:3]), R.T @ base[3:], command.joint_acceleration])


@pytest.fixture(scope="module")
def rubbing(chaser):
    """Damping and friction in proportion to the inertia of each joint, as drives of that size have."""
    robot = ospace.SpaceRobot.from_model(chaser.model.copy())
    rng, model = np.random.default_rng(3), robot.model
    inertia = ospace.generalized_dynamics(chaser.state(chaser.configuration())).generalized_inertia.diagonal()
    friction = np.concatenate([np.zeros(6), rng.uniform(0.0, 5.0, 18) * inertia])
    model.damping = np.concatenate([np.zeros(6), rng.uniform(0.0, 20.0, 18) * inertia])
    model.upperDryFrictionLimit, model.lowerDryFrictionLimit = friction, -friction
    return robot


def passive(robot, v):
    friction = robot.model.upperDryFrictionLimit[6:] * np.tanh(v[6:] / FRICTION_VELOCITY)
    return -robot.model.damping[6:] * v[6:] - friction


@pytest.mark.parametrize("base", MODES)
def test_drives_make_up_for_friction(chaser, rubbing, base):
    """The same accelerations as without friction, by torques that differ by it."""
    for seed in range(5):
        q, v = state(chaser, seed)
        smooth, rough = (
            Controller(
                robot,
                paper_tasks(robot, robot.point("right_hand"), robot.point("head")),
                base=base,
                limits=unlimited(robot),
            ).update(0.0, q, v)
            for robot in (chaser, rubbing)
        )
        end = v.copy()
        end[6:] += 1e-3 * rough.joint_acceleration
        np.testing.assert_allclose(rough.torque - smooth.torque, -passive(rubbing, end), rtol=0, atol=1e-6)
        np.testing.assert_allclose(rough.joint_acceleration, smooth.joint_acceleration, rtol=0, atol=1e-7)
        tau = forces(rubbing, q, rough)
        tau[6:] += passive(rubbing, end)
        a = pin.aba(rubbing.model, rubbing.model.createData(), q, v, tau)
        np.testing.assert_allclose(a[6:], rough.joint_acceleration, rtol=0, atol=1e-8 * np.abs(a).max())


@pytest.mark.parametrize("leveled", [False, True])
def test_torque_limits_hold_with_friction(rubbing, leveled):
    limits = JointLimits.of(rubbing, share=0.1)
    hand, on = rubbing.point("right_hand"), 0
    for seed in range(20):
        q, v = state(rubbing, seed, speed=0.1)
        task = PoseTask(name="hand", point=hand, reference=Constant(pin.SE3.Identity()), level=0 if leveled else None)
        command = Controller(rubbing, [task, DampingTask(name="rest")], limits=limits).update(0.0, q, v)
        assert (np.abs(command.torque) <= limits.torque).all()
        planned = forces(rubbing, q, command)
        planned[6:] = pin.rnea(
            rubbing.model, rubbing.model.createData(), q, v, whole_acceleration(rubbing, q, v, command)
        )[6:]
        left = planned[6:] - passive(rubbing, v)
        assert (np.abs(left) <= limits.torque + 1e-5 * np.maximum(1.0, limits.torque)).all()
        on += any("torque" in name for name in command.active_limits)
    assert on > 5


def test_a_robot_that_rubs_tracks_as_well(chaser, rubbing):
    worst = {}
    for name, known, moved in (("smooth", chaser, chaser), ("rough", rubbing, rubbing), ("unknown", chaser, rubbing)):
        hand = known.point("right_hand")
        q, v = known.configuration(), np.zeros(24)
        origin = known.state(q, v).placement(hand)
        goal = origin * pin.SE3(pin.exp3(np.array([0.2, 0.1, -0.1])), np.array([0.05, -0.1, 0.1]))
        task = PoseTask(name="hand", point=hand, stiffness=100.0, reference=MinimumJerk(origin, goal, 0.0, 1.0))
        run, worst[name] = Controller(known, [task, DampingTask(name="rest")]), 0.0
        data, h, substeps = moved.model.createData(), 1e-3, 20
        for k in range(1000):
            command = run.update(k * h, q, v)
            worst[name] = max(worst[name], np.abs(command.errors["hand"]).max())
            for _ in range(substeps):
                tau = forces(moved, q, command)
                tau[6:] += passive(moved, v)
                v = v + h / substeps * pin.aba(moved.model, data, q, v, tau)
                q = pin.integrate(moved.model, q, v * (h / substeps))
    assert worst["rough"] < 3.0 * worst["smooth"], worst
    assert worst["rough"] < 0.05 * worst["unknown"], worst


# -- wrong use ---------------------------------------------------------------------------------------------------


def wrong(robot, hand):
    pose = {"name": "hand", "point": hand}
    other = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    return {
        "at least one": lambda: Controller(robot, []),
        "two tasks": lambda: Controller(robot, [PoseTask(**pose), PoseTask(**pose)]),
        "base mode": lambda: Controller(robot, [PoseTask(**pose)], base="flaoting"),
        "solver 'simplex'": lambda: Controller(robot, [PoseTask(**pose)], solver="simplex"),
        "period": lambda: Controller(robot, [PoseTask(**pose)], period=0.0),
        "another robot": lambda: Controller(robot, [PoseTask(name="x", point=other.point("head"))]),
        "takes none": lambda: Controller(robot, [PositionTask(name="x", point=hand, axes="angular")]),
        "stiffness": lambda: PoseTask(**pose, stiffness=-1.0),
        "level": lambda: PoseTask(**pose, level=0.5),
        "reference": lambda: PoseTask(**pose, reference=pin.SE3.Identity()),
        "no joint": lambda: Controller(robot, [PostureTask(name="x", posture={"elbow": 0.0})]),
        "axis": lambda: LookAtTask(name="x", point=hand, axis=(0.0, 0.0, 0.0)),
        "above 0": lambda: JointLimits.of(robot, acceleration=-1.0),
        "torque limits must not be below 0": lambda: unlimited(robot, torque=-1.0),
        "could not stop": lambda: unlimited(robot, acceleration=0.0),
        "no joint 'elbow'": lambda: JointLimits.of(robot, acceleration={"elbow": 1.0}),
        "base force": lambda: Base(force=-1.0),
        "wheel_momentum": lambda: Base(wheel_momentum=0.0),
        "bounds must": lambda: Completion(position=-1.0),
        "no task 'foot'": lambda: Controller(robot, [PoseTask(**pose)]).follow("foot", Constant(pin.SE3.Identity())),
        "no completion": lambda: Controller(robot, [PoseTask(**pose)]).completed("hand"),
        "duration": lambda: MinimumJerk(pin.SE3.Identity(), pin.SE3.Identity(), 0.0, 0.0),
        "always holds": Completion,
        "one number for each joint": lambda: JointLimits(np.ones(3), -np.ones(3), np.ones(3), np.ones(2), np.ones(3)),
        "of 3 joints": lambda: Controller(
            robot, [PoseTask(**pose)], limits=JointLimits(*(k * np.ones(3) for k in (1, -1, 1, 1, 1)))
        ),
        "centre of mass": lambda: Controller(robot, [CentreOfMassTask(name="x")], base="wheels"),
        "change momentum": lambda: Controller(robot, [MomentumTask(name="x")]),
        r"velocity of a reference has shape": lambda: Constant(pin.SE3.Identity(), velocity=np.zeros(3)),
        "with a rotation": lambda: Constant(pin.SE3(2.0 * np.eye(3), np.zeros(3))),
        "no such reference": lambda: Controller(robot, [DampingTask(name="x")]).follow(
            "x", Constant(pin.SE3.Identity())
        ),
        "by joint names": lambda: Controller(robot, [PostureTask(name="x")]).follow("x", Constant(pin.SE3.Identity())),
        "no cycle": lambda: Controller(robot, [PoseTask(**pose)]).pose(hand),
        "is nan": lambda: PostureTask(name="x", posture={"torso_1": np.nan}),
        "time is nan": lambda: Controller(robot, [PoseTask(**pose)]).update(
            np.nan, robot.configuration(), np.zeros(24)
        ),
        "base torque": lambda: Base(torque="much"),
    }


@pytest.mark.parametrize("words", wrong(None, None))
def test_wrong_use_is_an_error(chaser, hand, words):
    with pytest.raises(ospace.OspaceError, match=words):
        wrong(chaser, hand)[words]()


@pytest.mark.parametrize("kind", ["nan", "short", "reference"])
def test_a_state_that_is_none_is_an_error(chaser, hand, kind):
    q, v = state(chaser, 1)
    run = Controller(chaser, [PoseTask(name="hand", point=hand)])
    if kind == "nan":
        q[9] = np.nan
    elif kind == "short":
        v = v[:-1]
    else:
        run.follow("hand", Function(lambda time: (pin.SE3(np.eye(3), np.full(3, np.nan)), np.zeros(6), np.zeros(6))))
    with pytest.raises(ospace.OspaceError):
        run.update(0.0, q, v)


def test_commands_do_not_change_afterwards(chaser, hand):
    q, v = state(chaser, 2)
    run = Controller(chaser, [PoseTask(name="hand", point=hand)], base="flying")
    first = run.update(0.0, q, v)
    kept = [np.copy(x) for x in (first.torque, first.base_wrench, first.joint_acceleration, first.base_acceleration)]
    run.follow("hand", Constant(pin.SE3.Identity()))
    run.update(0.1, *state(chaser, 3))
    for one, two in itertools.zip_longest(
        kept, (first.torque, first.base_wrench, first.joint_acceleration, first.base_acceleration)
    ):
        np.testing.assert_array_equal(one, two)
    assert np.abs(first.errors["hand"]).max() < 1e-12

"""The controller: what it asks for is what the robot does, limits hold, and nothing fails in silence."""

import itertools

import numpy as np
import pinocchio as pin
import pytest
from commands import KEPT, accelerations, paper_tasks, state, unlimited
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
    PoseTask,
    PositionTask,
    PostureTask,
    RelativePoseTask,
)
from ospace.control.base import MODES
from ospace.validation.sampling import random_state


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
    free = {"limits": unlimited(chaser), "trust_radius": 1e6}  # else what is asked of the arms alone is damped
    command = Controller(chaser, [task], base="flying", regularization=1e-10, **free).update(0.0, q, v)
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


def test_posture_and_damping_accelerate_the_joints_as_they_say(chaser):
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


@settings(max_examples=150, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 3.0), st.sampled_from(sorted(MODES)))
def test_no_state_and_no_target_breaks_the_controller(chaser, hand, head, seed, share, base):
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
    assert command.status in (("outside limits",) if outside else ("softened",) if command.softened else KEPT)
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
        assert command.status in (*KEPT, "softened"), (seed, command)
        assert (np.abs(command.torque) <= limits.torque * (1.0 + 1e-8)).all()
        lower, upper, value, _ = command._bounds
        excess = np.maximum(value - upper, lower - value) / np.maximum(1.0, np.abs(value))
        if command.status in KEPT:
            moving = excess[: -robot.n_joints]  # torques are cut to their limits
            assert moving.max() <= 1.1e-6, (seed, moving.argmax(), excess.argmax())
        else:
            assert command.softened, (seed, command)
            assert excess[: robot.n_joints].max() > 1e-7


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


def test_near_a_singularity_the_controller_damps(chaser, hand):
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


def test_far_from_the_origin_commands_do_not_change(chaser, hand, head):
    q, v = state(chaser, 4)
    away = q.copy()
    away[:3] += 7e6
    here, there = (
        Controller(chaser, paper_tasks(chaser, hand, head)).update(0.0, configuration, v) for configuration in (q, away)
    )
    np.testing.assert_allclose(there.torque, here.torque, rtol=0, atol=1e-6 * np.abs(here.torque).max())


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
def test_a_controller_refuses_wrong_use(chaser, hand, words):
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

"""Clearance: distances by Coal are kept as limits of joints are, while links turn, bodies drift by and wheels spin."""

import copy
import math
import pickle

import numpy as np
import pinocchio as pin
import pytest
import solids
from commands import accelerations, unlimited

import ospace
from ospace.collision import CollisionGeometry
from ospace.collision.pairs import solver_of_links
from ospace.control import (
    BaseAttitudeTask,
    Clearance,
    Constant,
    Controller,
    DampingTask,
    MinimumJerk,
    Obstacle,
    PositionTask,
    PostureTask,
)
from ospace.exceptions import OspaceError

PERIOD, HORIZON = 1e-3, 0.04


def distances(robot, pairs, q):
    """Return the distance of each pair of links in a configuration, by Coal's own default tolerance."""
    solver, places = solver_of_links(CollisionGeometry.of(robot), pairs)
    solver.configure(q)
    return np.array([solver.distances()[place].min() for place in places])


def along(robot, command, q, v, step=2e-4):
    """Return q a step before, now and a step later, under a command, by Pinocchio's aba."""
    a = accelerations(robot, q, v, command)
    return [pin.integrate(robot.model, q, v * t + 0.5 * a * t * t) for t in (-step, 0.0, step)]


def derivatives(robot, pair, command, q, v, step=2e-4):
    """Return the distance of a pair, its rate and its second derivative, by differences."""
    before, now, after = (distances(robot, [pair], one)[0] for one in along(robot, command, q, v, step))
    return now, (after - before) / (2.0 * step), (after - 2.0 * now + before) / step**2


def demanded(y, rate, a):
    """Return the least second derivative that a limit allows: docs/control.md."""
    d = y + 0.5 * PERIOD * rate
    ceiling = math.copysign(math.sqrt((a * HORIZON) ** 2 + 2.0 * a * abs(d)) - a * HORIZON, d)
    r = HORIZON / 4.0
    return min((-ceiling - rate) / r, max(a, -rate / r))


PAIR, NAME = ("other", "tool"), "other / tool: clearance"
SPARE = 5e-4
"""What is kept beside the clearance, m: docs/control.md."""


def pushed(robot, names, place):
    """Return tasks that press a tool to a place."""
    tool = robot.point(names)
    goal = Constant(pin.SE3(np.eye(3), np.asarray(place)))
    return [PositionTask(name="tool", point=tool, reference=goal, stiffness=400.0), DampingTask(name="rest")]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("solids")


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


# -- the row of a pair -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(6))
def test_balls_come_near_as_the_limit_allows_to_the_last_term(folder, seed):
    robot = solids.arm(folder, solids.BALL, solids.BALL, name="balls")
    pair, a = PAIR, 0.3
    rng = np.random.default_rng(seed)
    joints = {"upper_joint": 0.66 - rng.uniform(0.3, 0.5), "fore_joint": rng.uniform(-0.3, -0.1)}
    q = robot.configuration(joints, T_WB=pin.SE3(pin.exp3(rng.normal(size=3)), rng.normal(size=3)))
    v = rng.normal(scale=0.08, size=robot.nv)
    d = distances(robot, [pair], q)[0]
    places = [robot.state(q, v).placement(robot.point(name)).translation for name in pair]
    clearance = Clearance(robot=robot, distance=max(d - 0.01, 0.0), deceleration=a, pairs=[pair])
    controller = Controller(robot, pushed(robot, "tool", places[0]), limits=unlimited(robot), inequalities=clearance)
    command = controller.update(0.0, q, v)
    assert f"{NAME}, lower" in command.active_limits
    d, rate, acceleration = derivatives(robot, pair, command, q, v)
    speeds = [ospace.operational_space(robot.state(q, v), robot.point(name)) for name in pair]
    R = robot.base_pose(q).rotation
    twist = np.concatenate([R @ v[:3], R @ v[3:6], v[6:]])
    relative = (speeds[0].jacobian - speeds[1].jacobian)[:3] @ twist
    n = (places[0] - places[1]) / np.linalg.norm(places[0] - places[1])
    turning = (relative @ relative - (n @ relative) ** 2) / np.linalg.norm(places[0] - places[1])
    kept = demanded(d - clearance.distance - SPARE, rate, a)
    assert acceleration == pytest.approx(kept + turning, abs=2e-3 * max(1.0, abs(kept)))


@pytest.mark.parametrize("seed", range(4))
def test_a_wheel_that_spins_counts_as_it_stands(folder, seed):
    robot = solids.arm(folder, solids.BALL, solids.WHEEL, name="wheel")
    pair, a = PAIR, 0.3
    rng = np.random.default_rng(seed)
    q, v = robot.configuration({"upper_joint": 0.35, "fore_joint": -0.2}), np.zeros(robot.nv)
    v[6:9] = rng.normal(scale=0.06, size=3)
    d = distances(robot, [pair], q)[0]
    place = robot.state(q, v).placement(robot.point("other")).translation
    clearance = Clearance(robot=robot, distance=d - 0.005, deceleration=a, pairs=[pair])
    commands = []
    for spin in (0.0, 300.0):
        v[9] = spin
        tasks = pushed(robot, "tool", place)
        controller = Controller(robot, tasks, limits=unlimited(robot), inequalities=clearance)
        commands.append(controller.update(0.0, q, v))
        assert commands[-1].active_limits == (f"{NAME}, lower",)
    d, rate, acceleration = derivatives(robot, pair, commands[1], q, v, 1e-5)
    kept = demanded(d - clearance.distance - SPARE, rate, a)
    assert kept - 0.02 < acceleration < kept + 0.3  # spinning 300 rad/s its rim has 13 500 m/s²


def test_the_rows_are_the_same_wherever_the_robot_is(chaser):
    q, v = hands_near(chaser)
    clearance = Clearance(robot=chaser, distance=0.03)
    near = Controller(chaser, hands_together(chaser, q), inequalities=clearance).update(0.0, q, v)
    assert any("clearance" in one for one in near.active_limits)
    away = q.copy()
    away[:3] += [7e6, -3e6, 1e6]
    far = Controller(chaser, hands_together(chaser, away), inequalities=clearance).update(0.0, away, v)
    assert far.nearest.links == near.nearest.links
    assert far.nearest.distance == pytest.approx(near.nearest.distance, abs=1e-12)
    np.testing.assert_allclose(far.torque, near.torque, atol=1e-4 * np.abs(near.torque).max())


# -- runs --------------------------------------------------------------------------------------------------------


def hands_together(robot, q, duration=2.5):
    """Return tasks that bring both hands to the place between them, where they would overlap."""
    state = robot.state(q)
    hands = [robot.point(f"{side}_hand") for side in ("left", "right")]
    poses = [state.placement(one) for one in hands]
    middle = 0.5 * (poses[0].translation + poses[1].translation)
    tasks = [
        PositionTask(
            name=one.frame,
            point=one,
            reference=MinimumJerk(pose, pin.SE3(pose.rotation, middle), 0.0, duration),
            stiffness=100.0,
        )
        for one, pose in zip(hands, poses, strict=True)
    ]
    return [*tasks, BaseAttitudeTask(name="base", robot=robot), PostureTask(name="posture")]


def hands_near(robot):
    """Return a state in which the hands are on their way to each other."""
    q = robot.configuration()
    run = ospace.simulate(robot, q, np.zeros(robot.nv), Controller(robot, hands_together(robot, q)), duration=1.2)
    return run.q[-1], run.v[-1]


class Told:
    """A controller that keeps its commands."""

    def __init__(self, controller):
        self.controller, self.commands = controller, []

    def update(self, time, q, v):
        self.commands.append(self.controller.update(time, q, v))
        return self.commands[-1]


def run_of(robot, q, v, controller, duration):
    told = Told(controller)
    run = ospace.simulate(robot, q, v, told, duration=duration)
    return run, told.commands


def test_hands_that_are_sent_into_each_other_stop_apart_and_rest(chaser):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    clearance = Clearance(robot=chaser, distance=0.03)
    run, commands = run_of(chaser, q, v, Controller(chaser, hands_together(chaser, q), inequalities=clearance), 5.0)
    found = np.array([distances(chaser, clearance.watched, one).min() for one in run.q[::20]])
    assert found.min() > 0.03
    assert found[-1] < 0.0306  # it is the limit that holds them
    told = np.array([command.nearest.distance for command in commands])
    np.testing.assert_allclose(told[::20], found[: len(told[::20])], atol=1e-9)
    nearest = min(commands, key=lambda command: command.nearest.distance)
    assert nearest.nearest.links == ("left_hand", "right_hand")
    assert {command.status for command in commands} <= {"nominal", "falling short"}
    steps = np.abs(np.diff(run.torque[4000:], axis=0)).max(axis=1)
    assert steps.max() < 10.0  # where another corner becomes the nearest
    assert np.percentile(steps, 90) < 0.1
    free = ospace.simulate(chaser, q, v, Controller(chaser, hands_together(chaser, q)), duration=2.5)
    assert distances(chaser, [("left_hand", "right_hand")], free.q[-1])[0] < -0.05


@pytest.mark.parametrize(("tool", "other"), [("BOX", "BOX"), ("ROD", "ROD"), ("BOX", "ROD"), ("BALL", "BOX")])
def test_solids_of_all_kinds_stay_apart_though_they_turn(folder, tool, other):
    robot = solids.arm(folder, getattr(solids, tool), getattr(solids, other), name=f"{tool}_{other}".lower())
    q = robot.configuration({"upper_joint": -0.5, "fore_joint": 0.2, "tool_joint": 0.4})
    place = robot.state(q).placement(robot.point("other")).translation
    tasks = pushed(robot, "tool", place)
    clearance = Clearance(robot=robot, distance=0.02)
    run, commands = run_of(robot, q, np.zeros(robot.nv), Controller(robot, tasks, inequalities=clearance), 4.0)
    found = np.array([distances(robot, [PAIR], one)[0] for one in run.q[::10]])
    assert 0.02 < found.min() < 0.021
    assert f"{NAME}, lower" in commands[-1].active_limits
    assert commands[-1].shortfalls[0].reason == "held back by limits"
    assert commands[-1].shortfalls[0].limits == (f"{NAME}, lower",)


def test_what_is_too_near_at_the_start_goes_apart_gently(folder):
    robot = solids.arm(folder, solids.BALL, solids.BOX, name="too_near")
    q = robot.configuration({"upper_joint": 0.4})
    start = distances(robot, [PAIR], q)[0]
    clearance = Clearance(robot=robot, distance=start + 0.05, deceleration=0.2)
    controller = Controller(robot, DampingTask(name="rest"), inequalities=clearance)
    run, commands = run_of(robot, q, np.zeros(robot.nv), controller, 3.0)
    assert commands[0].status == "outside limits"
    assert commands[0].outside == {NAME: pytest.approx(0.05, abs=1e-6)}
    assert f"{NAME}' by 0.05 m" in commands[0].explanation
    found = np.array([distances(robot, [PAIR], one)[0] for one in run.q[::10]])
    assert np.diff(found).max() < 0.01 * math.sqrt(2.0 * 0.2 * 0.05) * 1.05
    assert found[-1] > start + 0.05
    assert commands[-1].status == "nominal"


@pytest.mark.parametrize("base", ["floating", "flying"])
def test_a_body_that_drifts_by_is_avoided(folder, base):
    robot = solids.arm(folder, solids.BALL, solids.BOX, name=f"avoiding_{base}")
    debris = solids.body(folder, solids.BOX, name=f"debris_{base}")
    q = robot.configuration({"upper_joint": -0.3})
    tool = robot.state(q).placement(robot.point("tool")).translation
    speed, turn = np.array([0.0, 0.05, 0.02]), np.array([0.1, 0.3, -0.2])

    def motion(time):
        at = tool + np.array([0.0, -0.4, -0.12]) + speed * time
        R = pin.exp3(turn * time)
        return np.r_[at, pin.Quaternion(R).coeffs()], np.r_[R.T @ speed, turn]

    clearance = Clearance(robot=robot, distance=0.02, obstacles=[Obstacle(debris, motion)])
    controller = Controller(robot, PostureTask(name="posture"), base=base, inequalities=clearance)
    run, commands = run_of(robot, q, np.zeros(robot.nv), controller, 6.0)
    assert min(command.nearest.distance for command in commands) > 0.02
    near = min(commands, key=lambda command: command.nearest.distance)
    assert set(near.nearest.links) == {"tool", f"debris_{base}_body"}
    assert near.nearest.distance < 0.021
    joined = CollisionGeometry.of(robot).solids, CollisionGeometry.of(debris).solids[0]
    ball = next(solid for solid in joined[0] if solid.link == "tool")
    for k in range(0, 6000, 500):
        time, state = k * PERIOD, robot.state(run.q[k])
        q_debris, _ = motion(time)
        own = pin.GeometryModel()
        own.addGeometryObject(pin.GeometryObject("a", 0, state.placement(robot.point("tool")), ball.geometry))
        own.addGeometryObject(pin.GeometryObject("b", 0, pin.XYZQUATToSE3(q_debris), joined[1].geometry))
        own.addCollisionPair(pin.CollisionPair(0, 1))
        empty = pin.Model()
        data = own.createData()
        pin.updateGeometryPlacements(empty, empty.createData(), own, data, np.zeros(0))
        alone = pin.computeDistance(own, data, 0).min_distance
        known = commands[k].nearest
        if f"debris_{base}_body" in known.links:
            assert known.distance == pytest.approx(alone, abs=1e-6)


# -- what a controller with a clearance is -------------------------------------------------------------------------


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_goes_on_as_the_controller_would(chaser, copied):
    q, v = hands_near(chaser)
    controller = Controller(
        chaser, hands_together(chaser, q), inequalities=Clearance(robot=chaser, distance=0.03), solver="daqp"
    )
    controller.update(0.0, q, v)
    twin = copied(controller)
    first, second = controller.update(1e-3, q, v), twin.update(1e-3, q, v)
    np.testing.assert_allclose(first.torque, second.torque, rtol=1e-9, atol=1e-9)  # Coal begins its search elsewhere
    assert first.nearest.distance == pytest.approx(second.nearest.distance, abs=1e-14)
    assert first.active_limits == second.active_limits


def test_pairs_are_found_without_looking_at_all_of_them(chaser):
    clearance = Clearance(robot=chaser, distance=0.03)
    controller = Controller(chaser, DampingTask(name="rest"), inequalities=clearance)
    rng, q = np.random.default_rng(3), chaser.configuration()
    way = rng.normal(scale=0.5, size=chaser.nv)
    for k in range(400):
        v = way * math.sin(0.02 * k)
        command = controller.update(k * PERIOD, q, v)
        if k % 20 == 0:
            found = distances(chaser, clearance.watched, q)
            assert command.nearest.distance == pytest.approx(found.min(), abs=2e-6)  # EPA where they overlap
            assert command.nearest.links == clearance.watched[int(found.argmin())]
        q = pin.integrate(chaser.model, q, v * 0.01)


def test_where_rows_are_few_the_points_that_bind_have_them(chaser):
    q, v = hands_near(chaser)
    few, many = (
        Controller(chaser, hands_together(chaser, q), inequalities=Clearance(robot=chaser, distance=0.03, most=most))
        for most in (1, 100)
    )
    few, many = few.update(0.0, q, v), many.update(0.0, q, v)
    assert "left_hand / right_hand: clearance, lower" in many.active_limits
    assert many.nearest.links != ("left_hand", "right_hand")  # others are nearer, and come no nearer
    np.testing.assert_allclose(few.torque, many.torque, atol=1e-6 * np.abs(many.torque).max())


def test_a_clearance_without_anything_near_changes_nothing(chaser):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    tasks = hands_together(chaser, q)
    plain, kept = (
        Controller(chaser, tasks, inequalities=one).update(0.1, q, v)
        for one in ((), Clearance(robot=chaser, distance=0.001))
    )
    np.testing.assert_allclose(kept.torque, plain.torque, atol=1e-9)
    assert plain.nearest is None
    assert kept.status == plain.status


# -- what is refused -----------------------------------------------------------------------------------------------

WRONG = {
    "distance is -0.1": {"distance": -0.1},
    "distance is nan": {"distance": math.nan},
    "distance is True": {"distance": True},
    "deceleration is 0": {"deceleration": 0},
    "most is 0": {"most": 0},
    "link 'lefthand' is unknown; did you mean 'left_hand'?": {"ignore": [("lefthand", "right_hand")]},
    "pairs is 'left_hand'": {"pairs": "left_hand"},
    "whose distance never changes": {"pairs": [("left_hand", "left_arm_link_7")]},
    "no pair of links of robot 'chaser_24dof' is left": {"pairs": [("head", "base")], "ignore": ["head"]},
}


@pytest.mark.parametrize("words", WRONG)
def test_what_makes_no_sense_is_refused_by_name(chaser, words):
    with pytest.raises(OspaceError, match="clearance: ") as caught:
        Clearance(**{"robot": chaser, "distance": 0.03} | WRONG[words])
    assert words in str(caught.value)


def test_a_robot_of_a_model_has_no_shapes(chaser):
    with pytest.raises(OspaceError, match="has no shapes"):
        Clearance(robot=ospace.SpaceRobot.from_model(chaser.model), distance=0.03)


def test_a_controller_takes_one_clearance_of_its_own_robot(chaser):
    other = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    task, clearance = DampingTask(name="rest"), Clearance(robot=chaser, distance=0.03)
    with pytest.raises(OspaceError, match="is of robot 'chaser_24dof', another one than the controller's"):
        Controller(other, task, inequalities=clearance)
    with pytest.raises(OspaceError, match="two clearances"):
        Controller(chaser, task, inequalities=[clearance, Clearance(robot=chaser, distance=0.01, name="second")])


@pytest.mark.parametrize(
    ("motion", "words"),
    [
        (lambda time: 1 / 0, "motion of obstacle 'debris' failed: ZeroDivisionError"),
        (lambda time: (np.full(7, np.nan), np.zeros(6)), "q of obstacle 'debris'"),
        (lambda time: (np.zeros(3), np.zeros(6)), "q of obstacle 'debris'"),
    ],
)
def test_the_motion_of_an_obstacle_is_checked(folder, motion, words):
    robot = solids.arm(folder, solids.BALL, solids.BOX, name="careful")
    obstacle = Obstacle(solids.body(folder, solids.BOX), motion)
    clearance = Clearance(robot=robot, distance=0.02, obstacles=[obstacle])
    controller = Controller(robot, DampingTask(name="rest"), inequalities=clearance)
    with pytest.raises(OspaceError, match=words):
        controller.update(0.0, robot.configuration(), np.zeros(robot.nv))

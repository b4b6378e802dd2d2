"""Errors, robots and all that is made of them: pickled, deep-copied, and sent to a process of its own."""

from __future__ import annotations

import copy
import functools
import importlib
import inspect
import multiprocessing
import pickle
import pkgutil
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace import scenario
from ospace.control import (
    BaseAttitudeTask,
    Completion,
    Constant,
    Controller,
    Function,
    JointLimits,
    MinimumJerk,
    MomentumTask,
    PoseTask,
    PostureTask,
)
from ospace.simulation import grasp
from ospace.validation.sampling import random_state

COPIES = {"pickle": lambda one: pickle.loads(pickle.dumps(one)), "deepcopy": copy.deepcopy}
copied = pytest.mark.parametrize("copy_of", COPIES.values(), ids=COPIES)


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture(scope="module")
def process():
    """Return a pool of one process, started anew."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


def bits(value):
    """Return numbers, and what holds them, as bytes: equal only where every bit is."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, pin.SE3):
        return value.homogeneous.tobytes()
    if isinstance(value, dict):
        return {name: bits(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [bits(one) for one in value]
    if hasattr(value, "__dataclass_fields__"):
        return {name: bits(getattr(value, name)) for name in value.__dataclass_fields__ if name[0] != "_"}
    return value


# -- errors ------------------------------------------------------------------------------------------------------


def all_modules():
    return [
        importlib.import_module(one.name)
        for one in pkgutil.walk_packages(ospace.__path__, "ospace.")
        if not one.name.endswith("__main__")
    ]


def exceptions_of_ospace():
    found = {
        one
        for module in all_modules()
        for one in vars(module).values()
        if inspect.isclass(one) and issubclass(one, Exception) and one.__module__.startswith("ospace.")
    }
    return sorted(found, key=lambda one: one.__qualname__)


class Refusal(ospace.OspaceError):
    """An error as anyone may add one: its constructor takes anything but the message."""

    def __init__(self, part, *, value):
        super().__init__(f"{part} is {value}")
        self.part, self.value = part, value


@pytest.mark.parametrize("kind", exceptions_of_ospace(), ids=lambda one: one.__name__)
@copied
def test_every_error_survives_whatever_its_constructor_takes(kind, copy_of):
    error = kind.__new__(kind, "the message")
    vars(error).update(code="a-code", rows=3, points=("hand",), path=Path("robot.urdf"))
    error.add_note("while reading")
    again = copy_of(error)
    assert type(again) is kind
    assert (str(again), again.args, vars(again)) == (str(error), error.args, vars(error))


def test_all_errors_with_data_are_among_them():
    names = {"OspaceError", "UrdfError", "ScenarioError", "SimulationError", "UnsoundModelError"}
    assert {*names, "SingularInertiaError", "DependentRowsError"} <= {one.__name__ for one in exceptions_of_ospace()}


@copied
@pytest.mark.parametrize(
    "error",
    [
        ospace.UrdfError(Path("a.urdf"), "no such link", "unknown-link", line=3),
        ospace.ScenarioError(Path("a.toml"), [("phase[1]", "is wrong"), ("robot", "is missing")]),
        ospace.SingularInertiaError("elbow"),
        ospace.DependentRowsError(3, 6, ["hand", "hand", "head"]),
        Refusal("mass", value=-1.0),
    ],
    ids=lambda one: type(one).__name__,
)
def test_errors_keep_message_and_data(error, copy_of):
    again = copy_of(error)
    assert type(again) is type(error)
    assert (str(again), vars(again)) == (str(error), vars(error))
    assert len(vars(error)) > 0


def simulate_beyond_reason(robot):
    q = robot.configuration()
    return ospace.simulate(robot, q, np.zeros(robot.nv), lambda t, q, v: np.full(robot.n_joints, 1e300), duration=0.01)


def read(path):
    return ospace.SpaceRobot.from_urdf(path)


def refuse(robot):
    raise Refusal("mass", value=robot.total_mass)


@copied
def test_a_failed_simulation_keeps_its_trajectory(chaser, copy_of):
    with pytest.raises(ospace.SimulationError) as caught:
        simulate_beyond_reason(chaser)
    again = copy_of(caught.value)
    assert (str(again), again.time) == (str(caught.value), caught.value.time)
    assert bits(again.trajectory) == bits(caught.value.trajectory)


def test_errors_arrive_from_a_process(process, tmp_path, chaser):
    with pytest.raises(ospace.UrdfError, match="no such file") as missing:
        process.submit(read, tmp_path / "none.urdf").result()
    assert (missing.value.path, missing.value.code) == (tmp_path / "none.urdf", "no-file")

    file = tmp_path / "light.urdf"
    file.write_text('<robot name="light"><link name="base"/></robot>')
    with pytest.raises(ospace.UnsoundModelError) as unsound:
        process.submit(read, file).result()
    with pytest.raises(ospace.UnsoundModelError) as here:
        read(file)
    assert (str(unsound.value), unsound.value.findings) == (str(here.value), here.value.findings)

    with pytest.raises(ospace.SimulationError) as failed:
        process.submit(simulate_beyond_reason, chaser).result()
    assert len(failed.value.trajectory) >= 1
    with pytest.raises(Refusal) as refused:
        process.submit(refuse, chaser).result()
    assert (refused.value.part, refused.value.value) == ("mass", chaser.total_mass)
    assert process.submit(read, ospace.models.path("planar_2r")).result().nv == 8  # the pool is whole


# -- robots, points, states --------------------------------------------------------------------------------------

POINTLESS = ("momentum", "joint_space_dynamics", "generalized_dynamics")


def everything(state, points):
    """Return every public quantity of a state, bit by bit."""
    robot = state.robot
    run = ospace.OperationalSpaceEvaluator(robot, points).update(state.q.copy(), state.v.copy())
    found = {name: bits(getattr(ospace, name)(state)) for name in POINTLESS}
    found["operational_space"] = bits(ospace.operational_space(state, points))
    found["free_floating"] = bits(ospace.free_floating(state, points))
    found["generalized_jacobian"] = bits(ospace.generalized_jacobian(state, points))
    found["evaluator"] = [bits(getattr(run, name).copy()) for name in run.quantities]
    found["placements"] = [bits(state.placement(one)) for one in points]
    found["state"] = bits([state.q, state.v, state.base_twist, state.T_WB])
    return found


@functools.cache
def made(which):
    return trees.tree(which, 14) if isinstance(which, int) else read(ospace.models.path(which))


of_robots = pytest.mark.parametrize("which", ["chaser_24dof", *range(4)])  # trees have joints of every type


def sample(robot, seed=0):
    state = random_state(robot, np.random.default_rng(seed))
    points = [robot.point(name, axes="linear") for name in robot.leaf_links[:2]]
    return state, points


@of_robots
@copied
def test_copies_of_robot_state_and_points_give_the_same_bits(which, copy_of):
    robot = made(which)
    state, points = sample(robot)
    again, those = copy_of((state, points))
    assert again.robot is not robot
    assert all(one.robot is again.robot for one in those)
    assert everything(again, those) == everything(state, points)
    assert again.robot.findings == robot.findings
    assert (again.robot.name, again.robot.source) == (robot.name, robot.source)
    assert again.robot.joint_names == robot.joint_names
    assert not any(one.flags.writeable for one in (again.q, again.v))


@of_robots
def test_a_robot_sent_to_a_process_gives_the_same_bits_there(process, which):
    state, points = sample(made(which), seed=1)
    assert process.submit(everything, state, points).result() == everything(state, points)


def test_a_state_that_was_made_normal_stays_as_it_is(chaser):
    rng = np.random.default_rng(0)
    for _ in range(200):
        q = random_state(chaser, rng).q.copy()
        q[3:7] *= 1.0 + 1e-7 * rng.uniform(-1.0, 1.0)
        state = chaser.state(q)
        assert bits(pickle.loads(pickle.dumps(state)).q) == bits(state.q)


@copied
def test_every_number_of_a_model_goes_along(copy_of):
    """Bounds that are infinite, damping, friction, armature, and names with spaces and letters of other alphabets."""
    model = pin.Model(trees.tree(0, 9).model)
    rng = np.random.default_rng(0)
    kinds = [name for name in dir(model) if isinstance(getattr(model, name), np.ndarray) and name != "gravity981"]
    assert {"damping", "friction", "armature", "lowerPositionLimit", "effortLimit"} <= set(kinds)
    for name in kinds:
        numbers = rng.normal(size=getattr(model, name).shape) * 10.0 ** rng.integers(-300, 300)
        numbers[0] = -np.inf if name.startswith("lower") else np.inf
        setattr(model, name, numbers)
    armature = model.armature.copy()
    armature[:] = rng.uniform(0.1, 0.2, len(armature))
    armature[:6] = 0.0
    model.armature = armature
    model.name = "an arm of two\nlinks, Ärmchen"
    model.names[2] = "first joint, ε"
    robot = ospace.SpaceRobot.from_model(model)
    again = copy_of(robot)
    assert again.model == robot.model
    assert (again.name, again.joint_names) == (robot.name, robot.joint_names)
    for name in kinds:
        assert bits(getattr(again.model, name)) == bits(getattr(robot.model, name)), name
    assert bits(again.links.armature) == bits(robot.links.armature)


def test_scratch_memory_stays_behind(chaser):
    fresh = copy.deepcopy(chaser)
    before = len(pickle.dumps(fresh))
    fresh.state(fresh.configuration())
    fresh.rate_names, fresh.frame_names, fresh.total_mass  # noqa: B018 (kept once they are computed)
    assert len(pickle.dumps(fresh)) == before


# -- evaluators --------------------------------------------------------------------------------------------------


@of_robots
@copied
def test_a_copied_evaluator_holds_what_the_original_held(which, copy_of):
    robot = made(which)
    state, points = sample(robot)
    run = ospace.OperationalSpaceEvaluator(robot, points).update(state.q.copy(), state.v.copy())
    names = [*run.quantities, "jacobian", "generalized_jacobian", "momentum", "generalized_bias"]
    again = copy_of(run)
    held = [bits(getattr(run, name)) for name in names]
    assert [bits(getattr(again, name)) for name in names] == held
    assert again.rank == run.rank

    other = sample(robot, seed=2)[0]
    again.update(other.q.copy(), other.v.copy())
    assert [bits(getattr(run, name)) for name in names] == held  # memory of its own
    run.update(other.q.copy(), other.v.copy())
    assert [bits(getattr(again, name)) for name in names] == [bits(getattr(run, name)) for name in names]


@copied
def test_a_copied_evaluator_without_a_state_has_none(chaser, copy_of):
    again = copy_of(ospace.OperationalSpaceEvaluator(chaser, chaser.point("head")))
    with pytest.raises(ospace.OspaceError, match="update"):
        again.inertia  # noqa: B018


# -- controllers -------------------------------------------------------------------------------------------------


def swing(time):
    """Move along x, as a reference."""
    velocity, acceleration = np.zeros((2, 6))
    velocity[0], acceleration[0] = 0.01 * np.cos(time), -0.01 * np.sin(time)
    return pin.SE3(np.eye(3), np.array([0.01 * np.sin(time), 0.0, 1.5])), velocity, acceleration


def busy_controller(robot, solver):
    """A controller with a state of its own: wheels that fill, references of its first cycle, completion, levels."""
    hand, head = robot.point("right_hand"), robot.point("head")
    return Controller(
        robot,
        [
            PoseTask(name="hand", point=hand, level=1, completion=Completion(position=1.0, angle=1.0, hold=0.02)),
            PoseTask(name="head", point=head, axes="linear", reference=Function(swing)),
            BaseAttitudeTask(name="base", robot=robot),
            MomentumTask(name="dump", weight=0.1),
            PostureTask(name="posture"),
        ],
        base="wheels",
        solver=solver,
        wheel_momentum=(0.1, 0.2, 0.3),
    )


def drive(controller, start, cycles):
    """Return commands, bit by bit, on states that do not depend on them."""
    commands = []
    for k in range(start, start + cycles):
        state = random_state(controller.robot, np.random.default_rng(k))
        given = controller.update(1e-3 * k, state.q.copy(), 0.1 * state.v)
        kept = {name: bits(value) for name, value in vars(given).items() if name != "timing"}
        commands.append((kept, bits([given.errors, given.residuals]), given.active_limits))
    return commands


@pytest.mark.parametrize("solver", ["daqp", "quadprog"])  # ProxQP gives other last digits to one program twice
@pytest.mark.parametrize("begun", [0, 5])
@copied
def test_a_copied_controller_goes_on_as_the_original_would(chaser, solver, begun, copy_of):
    controller = busy_controller(chaser, solver)
    drive(controller, 0, begun)
    if begun:
        goal = pin.SE3(np.eye(3), np.array([0.5, 0.0, 1.0]))
        controller.follow("base", MinimumJerk(pin.SE3.Identity(), goal, 0.004, 0.02))
    first, second = copy_of(controller), copy_of(controller)
    assert first.robot is not chaser
    if begun:
        for one in (first, second):
            assert bits(one.pose(one.robot.point("head"))) == bits(controller.pose(chaser.point("head")))
    after = drive(controller, begun, 8)
    assert drive(first, begun, 8) == after
    assert drive(second, begun, 8) == after
    assert bits(first.wheel_momentum) == bits(controller.wheel_momentum)
    assert not np.array_equal(first.wheel_momentum, (0.1, 0.2, 0.3))
    assert first.completed("hand") == controller.completed("hand")


def test_copies_of_a_controller_do_not_share_memory(chaser):
    controller = busy_controller(chaser, "daqp")
    drive(controller, 0, 3)
    other = copy.deepcopy(controller)
    pose, wheels = bits(controller.pose(chaser.point("head"))), bits(controller.wheel_momentum)
    drive(other, 3, 3)
    other.follow("hand", Constant(pin.SE3.Identity()))
    assert (bits(controller.pose(chaser.point("head"))), bits(controller.wheel_momentum)) == (pose, wheels)


def test_a_controller_sent_to_a_process_gives_the_same_commands(process, chaser):
    controller = busy_controller(chaser, "daqp")
    drive(controller, 0, 3)
    there = process.submit(drive, controller, 3, 3).result()
    assert there == drive(controller, 3, 3)


def test_a_reference_that_no_process_could_import_is_named(chaser):
    """Python's own error names the function; a deep copy shares it."""
    task = PoseTask(name="head", point=chaser.point("head"), reference=Function(lambda time: swing(2.0 * time)))
    controller = Controller(chaser, [task])
    with pytest.raises((pickle.PicklingError, AttributeError), match="lambda"):
        pickle.dumps(controller)
    assert drive(copy.deepcopy(controller), 0, 2) == drive(controller, 0, 2)


# -- all else that is made of robots -----------------------------------------------------------------------------


@copied
def test_limits_stay_read_only(chaser, copy_of):
    limits = JointLimits.of(chaser)
    again = copy_of(limits)
    assert bits(again) == bits(limits)
    assert not any(getattr(again, name).flags.writeable for name in ("torque", "lower", "velocity"))


@copied
def test_a_grasp_is_released_alike(copy_of):
    mission = scenario.load(ospace.models.scenario("grasp"))
    chaser, target = mission.start, mission.targets["target"].start
    held = grasp(chaser, chaser.robot.point("right_hand"), target, target.robot.point(target.robot.frame_names[-1]))
    again = copy_of(held)
    assert bits([again.state.q, again.state.v, again.impulse]) == bits([held.state.q, held.state.v, held.impulse])
    let_go = [(one.q, one.v) for one in held.release(held.state.q, held.state.v)]
    assert bits([(one.q, one.v) for one in again.release(again.state.q, again.state.v)]) == bits(let_go)


def torques(run):
    return [bits(segment.trajectory) for segment in run.segments], [one.outcome for one in run.phases]


def run_until(mission, end):
    """Return what a scenario did until a time, s."""

    def stop(time):
        if time >= end:
            raise KeyboardInterrupt

    return torques(scenario.run(mission, progress=stop))


def test_a_scenario_runs_alike_in_a_process(process):
    mission = scenario.load(ospace.models.scenario("grasp"))
    assert process.submit(run_until, mission, 0.05).result() == run_until(mission, 0.05)


@copied
def test_a_run_is_copied_whole(copy_of, grasped):
    again = copy_of(grasped)
    assert torques(again) == torques(grasped)
    assert str(again.certificate) == str(grasped.certificate)
    assert again.scenario.source == grasped.scenario.source

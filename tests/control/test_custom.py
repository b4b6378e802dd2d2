"""Tasks and inequalities in Python: they do what built-in ones do, hold, and tell what is wrong."""

import copy
import pickle
import re
from dataclasses import dataclass

import custom
import numba
import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.control import (
    BaseAttitudeTask,
    Completion,
    Constant,
    Controller,
    CustomTask,
    DampingTask,
    Function,
    Inequality,
    Instant,
    JointLimits,
    PoseTask,
    PositionTask,
    PostureTask,
)
from ospace.control.base import MODES
from ospace.control.tasks import Task
from ospace.exceptions import OspaceError
from ospace.kernels.observation import observe
from ospace.kernels.qp.custom_rows import write_custom_rows
from ospace.validation.sampling import random_state

VERTICAL = [False, False, True, False, False, False]


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture(scope="module")
def hand(chaser):
    return chaser.point("right_hand")


def state(robot, seed, speed=0.3):
    drawn = random_state(robot, np.random.default_rng(seed))
    return drawn.q.copy(), speed * drawn.v


def height_of(robot, point, q, v):
    return robot.state(q, v).placement(point).translation[2]


def unlimited(n):
    return JointLimits(*([np.full(n, np.inf), np.full(n, -np.inf)] + 3 * [np.full(n, np.inf)]))


def constant(height):
    return Constant(pin.SE3(np.eye(3), np.array([0.0, 0.0, height])))


def same(command, other, digits=1e-7):
    assert command.status == other.status
    np.testing.assert_allclose(command.torque, other.torque, atol=digits * np.abs(other.torque).max())
    np.testing.assert_allclose(
        command.base_wrench, other.base_wrench, atol=digits * (1.0 + np.abs(other.base_wrench).max())
    )


# -- tasks ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("base", MODES)
@pytest.mark.parametrize("level", [None, 1])
@pytest.mark.parametrize("kind", [custom.Height, custom.HeightWithDrift])
def test_a_height_in_python_is_the_height_of_the_kernel(chaser, hand, base, level, kind):
    q, v = state(chaser, 2)
    height = height_of(chaser, hand, q, v) + 0.01
    others = [BaseAttitudeTask(name="base", robot=chaser, level=0 if level else None), PostureTask(name="posture")]
    if base != "floating":
        v[:6] *= 0.1
    own = kind(name="height", point=hand, height=height, level=level, stiffness=30.0, damping_ratio=0.7)
    built_in = PositionTask(
        name="height",
        point=hand,
        axes=VERTICAL,
        reference=constant(height),
        level=level,
        stiffness=30.0,
        damping_ratio=0.7,
    )
    command, reference = (Controller(chaser, [*others, task], base=base).update(0.0, q, v) for task in (own, built_in))
    same(command, reference)
    np.testing.assert_allclose(command.errors["height"], -reference.errors["height"], atol=1e-14)
    np.testing.assert_allclose(command.residuals["height"], reference.residuals["height"], atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_errors_fall_as_asked_on_robots_with_coupled_joints(seed):
    robot = trees.coupled(seed)
    drawn = trees.state(robot, seed)
    points = robot.point(robot.leaf_links[-1]), robot.point("base")
    task = custom.Distance(name="far", points_of_it=points, stiffness=4.0)
    limits = unlimited(robot.n_joints)
    controller = Controller(robot, task, regularization=1e-12, base="flying", limits=limits, trust_radius=1e6)
    command = controller.update(0.0, drawn.q, drawn.v)
    assert np.abs(command.residuals["far"]).max() < 1e-3
    a = np.r_[base_acceleration(robot, drawn, command), command.joint_acceleration]
    h = 1e-4
    e = [error_after(robot, task, drawn, a, t) for t in (-h, 0.0, h)]
    rate, curve = (e[2] - e[0]) / (2 * h), (e[2] - 2 * e[1] + e[0]) / h**2
    np.testing.assert_allclose(curve, -4.0 * rate - 4.0 * e[1], atol=1e-3 * (1.0 + np.abs(curve).max()))


def base_acceleration(robot, drawn, command):
    """v̇ of the base, in its axes, of ẍ_b."""
    R, a = drawn.T_WB.rotation, command.base_acceleration
    return np.r_[R.T @ a[:3] - np.cross(drawn.v[3:6], drawn.v[:3]), R.T @ a[3:]]


def error_after(robot, task, drawn, a, t):
    v = drawn.v + a * t
    at = Instant(robot, task.points)
    at.observe(t, pin.integrate(robot.model, drawn.q, 0.5 * (drawn.v + v) * t), v)
    return np.array(task.error(at))


def test_an_error_that_depends_on_time_is_followed_without_a_lag(chaser, hand):
    q, v = state(chaser, 0, speed=0.1)
    height, t = height_of(chaser, hand, q, v), 0.4

    def motion(time):
        up, rate, curve = 0.1 * np.sin(2 * time), 0.2 * np.cos(2 * time), -0.4 * np.sin(2 * time)
        T = pin.SE3(np.eye(3), np.array([0.0, 0.0, height + up]))
        return T, np.array([0, 0, rate, 0, 0, 0]), np.array([0, 0, curve, 0, 0, 0])

    own = custom.Bobbing(name="height", point=hand, height=height)
    built_in = PositionTask(name="height", point=hand, axes=VERTICAL, reference=Function(motion))
    command, reference = (Controller(chaser, task).update(t, q, v) for task in (own, built_in))
    same(command, reference)


def test_rows_of_a_task_are_taken_as_they_are(chaser):
    q, v = state(chaser, 1)
    tasks = [custom.Spin(name="spin", joint=3, acceleration=0.25), DampingTask(name="rest")]
    command = Controller(chaser, tasks).update(0.0, q, v)
    assert command.joint_acceleration[3] == pytest.approx(0.25, abs=2e-2)
    strict = Controller(chaser, [custom.Spin(name="spin", joint=3, acceleration=0.25, level=0), tasks[1]])
    assert strict.update(0.0, q, v).joint_acceleration[3] == pytest.approx(0.25, abs=1e-5)


@pytest.mark.parametrize(("unit", "bounds", "short"), [("m", None, True), ("px", None, False), ("px", 0.1, True)])
def test_a_task_in_python_that_falls_short_says_so_in_its_unit(chaser, hand, unit, bounds, short):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    kind = bent(custom.Height, unit=unit)
    completion = None if bounds is None else Completion(position=bounds)
    z = height_of(chaser, hand, q, v)
    task = kind(name="height", point=hand, height=z + 0.5, completion=completion)
    below = custom.Below(name="ceiling", point=hand, height=z)
    command = Controller(chaser, task, inequalities=below).update(0.0, q, v)
    assert command.status == ("falling short" if short else "nominal")
    assert [str(one) for one in command.shortfalls] == (
        [f"held back by limits of ceiling: height, 0.5 {unit} short"] if short else []
    )


def test_a_task_in_python_completes_and_can_be_redirected_by_no_reference(chaser, hand):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    height = height_of(chaser, hand, q, v)
    near = custom.Height(name="near", point=hand, height=height + 5e-4, completion=Completion(position=1e-3))
    far = custom.Height(name="far", point=hand, height=height + 5e-3, completion=Completion(position=1e-3))
    controller = Controller(chaser, [near, far])
    controller.update(0.0, q, v)
    assert controller.completed("near")
    assert not controller.completed("far")
    np.testing.assert_allclose(controller.pose(hand).translation[2], height)
    with pytest.raises(OspaceError, match="Height says itself what to follow"):
        controller.follow("near", constant(0.0))


# -- inequalities ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("base", ["floating", "wheels", "flying"])
@pytest.mark.parametrize("strict", [False, True])
def test_an_inequality_holds_though_a_task_is_beyond(chaser, hand, base, strict):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    height = height_of(chaser, hand, q, v)
    below = custom.Below(name="ceiling", point=hand, height=height + 0.02, deceleration=0.2)
    tasks = [
        PositionTask(
            name="hand", point=hand, reference=constant(height + 0.1), axes=VERTICAL, level=0 if strict else None
        ),
        BaseAttitudeTask(name="base", robot=chaser),
        PostureTask(name="posture"),
    ]
    statuses, worst = set(), np.inf
    controller = Controller(chaser, tasks, inequalities=below, base=base, period=5e-3)

    def law(t, q, v):
        nonlocal worst
        command = controller.update(t, q, v)
        statuses.add(command.status)
        worst = min(worst, height + 0.02 - height_of(chaser, hand, q, v))
        return command

    run = ospace.simulate(chaser, q, v, law, duration=3.0, step=5e-3, period=5e-3)
    assert worst > -1e-5
    assert height_of(chaser, hand, run.q[-1], run.v[-1]) == pytest.approx(height + 0.02, abs=1e-4)
    assert statuses == {"nominal", "falling short"}
    command = controller.update(3.0, run.q[-1], run.v[-1])
    assert "ceiling, lower" in command.active_limits
    assert [one.cause for one in command.shortfalls] == ["held back by limits of ceiling: hand"]


def test_an_inequality_rests_without_chatter_though_commands_are_late(chaser, hand):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    z = height_of(chaser, hand, q, v)
    below = custom.Below(name="ceiling", point=hand, height=z + 0.01, deceleration=0.2)
    tasks = [
        PositionTask(name="hand", point=hand, reference=constant(z + 0.05), axes=VERTICAL),
        BaseAttitudeTask(name="base", robot=chaser),
        PostureTask(name="posture"),
    ]
    controller = Controller(chaser, tasks, inequalities=below)
    run = ospace.simulate(chaser, q, v, controller, duration=2.5, delay=5e-3)
    assert np.ptp(run.torque[-500:], axis=0).max() < 0.05
    assert height_of(chaser, hand, run.q[-1], run.v[-1]) == pytest.approx(z + 0.01, abs=1e-5)


@pytest.mark.parametrize("base", ["floating", "flying"])
@pytest.mark.parametrize("way", [0.2, 0.003, -0.1])
def test_the_bound_of_an_inequality_is_that_of_the_clamp_while_all_turns(chaser, hand, base, way):
    """Where it binds, ÿ is the one with which the value is slowed down, or comes back, as the docs have it."""
    q, v = state(chaser, 5)
    h, a = 1e-3, 0.5
    z = height_of(chaser, hand, q, v)
    below = custom.Below(name="ceiling", point=hand, height=z + way, deceleration=a)
    up = PositionTask(name="up", point=hand, axes=VERTICAL, reference=constant(z + 20.0))
    limits = unlimited(chaser.n_joints)
    command = Controller(chaser, up, limits=limits, base=base, inequalities=below, limit_horizon=0.02).update(0.0, q, v)
    assert command.active_limits == ("ceiling, lower",)
    at = Instant(chaser, [hand])
    at.observe(0.0, q, v)
    acceleration = np.r_[base_acceleration(chaser, chaser.state(q, v), command), command.joint_acceleration]
    curve = -at.jacobian(hand)[2] @ acceleration - at.drift(hand)[2]
    rate = -at.velocity(hand)[2]
    d = way + 0.5 * h * rate
    T = 0.02
    ceiling = np.sign(d) * (np.sqrt((a * T) ** 2 + 2.0 * a * abs(d)) - a * T)
    assert curve == pytest.approx(min((-ceiling - rate) / (T / 4), a), abs=1e-6 * (1.0 + abs(rate) / h))


def test_below_zero_an_inequality_comes_back_and_says_so(chaser, hand):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    below = custom.Below(name="ceiling", point=hand, height=height_of(chaser, hand, q, v) - 0.01, deceleration=0.2)
    controller = Controller(
        chaser, [DampingTask(name="rest"), BaseAttitudeTask(name="base", robot=chaser)], inequalities=below
    )
    command = controller.update(0.0, q, v)
    assert command.status == "outside limits"
    assert command.outside == {"ceiling": pytest.approx(0.01)}
    assert "'ceiling' by 0.01 m" in command.explanation
    run = ospace.simulate(chaser, q, v, controller, duration=2.0, step=2e-3, period=2e-3)
    command = controller.update(2.0, run.q[-1], run.v[-1])
    assert command.outside == {}
    assert height_of(chaser, hand, run.q[-1], run.v[-1]) < below.height + 1e-6


def test_inequalities_give_way_to_torque_limits_and_are_named(chaser, hand):
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    v[6:] = np.where(np.arange(chaser.n_joints) % 2, 0.5, -0.5)
    limits = JointLimits.of(chaser, share=1e-3)
    limits = JointLimits(
        limits.torque, limits.lower, limits.upper, np.full(chaser.n_joints, np.inf), limits.acceleration
    )
    z = height_of(chaser, hand, q, v)
    below = custom.Below(name="ceiling", point=hand, height=z - 0.3, deceleration=10.0)
    command = Controller(chaser, DampingTask(name="rest"), limits=limits, inequalities=below).update(0.0, q, v)
    assert command.status == "outside limits"
    assert command.softened["ceiling"] > 1.0
    assert (np.abs(command.torque) <= limits.torque * (1 + 1e-9)).all()


def test_what_passes_an_inequality_is_no_solution(chaser, hand):
    """A solver that does not see its row is not believed."""
    q, v = chaser.configuration(), np.zeros(chaser.nv)
    z, n = height_of(chaser, hand, q, v), chaser.n_joints
    below = custom.Below(name="ceiling", point=hand, height=z)
    up = PositionTask(name="up", point=hand, axes=VERTICAL, reference=constant(z + 0.1))

    def blind(program):
        bounds = slice(0, len(program.f) + n)
        seen = program._replace(C=program.C[:n], lower=program.lower[bounds], upper=program.upper[bounds])
        return custom.daqp_by_hand(seen)

    reference = Controller(chaser, up, inequalities=below).update(0.0, q, v)
    assert reference.active_limits == ("ceiling, lower",)
    command = Controller(chaser, up, inequalities=below, solver=blind).update(0.0, q, v)  # by DAQP
    assert command.status == reference.status == "falling short"
    np.testing.assert_allclose(command.torque, reference.torque, atol=1e-7)
    controller = Controller(chaser, up, inequalities=below)
    controller._solve = blind  # as a solver of ospace that errs
    assert controller.update(0.0, q, v).status not in ("nominal", "falling short")


def test_rows_bound_accelerations_and_the_base_wrench_over_its_scale(chaser):
    q, v = state(chaser, 0, speed=0.05)
    task = [PostureTask(name="posture", weight=1.0), BaseAttitudeTask(name="base", robot=chaser)]
    for base, k in (("floating", 0), ("flying", 6)):
        free = Controller(chaser, task, base=base).update(0.0, q, v)
        moment = np.trace(chaser.model.inertias[1].inertia) / 3.0
        R = chaser.base_pose(q).rotation.T
        wrench = np.r_[R @ free.base_wrench[:3] / chaser.total_mass, R @ free.base_wrench[3:] / moment]
        total = free.joint_acceleration.sum() + (wrench.sum() if k else 0.0)
        most = total - 0.5
        held = Controller(
            chaser, task, base=base, inequalities=custom.Sum(name="sum", count=chaser.n_joints + k, most=most)
        ).update(0.0, q, v)
        wrench = np.r_[R @ held.base_wrench[:3] / chaser.total_mass, R @ held.base_wrench[3:] / moment]
        assert held.joint_acceleration.sum() + (wrench.sum() if k else 0.0) == pytest.approx(most, abs=1e-8)
        assert held.active_limits == ("sum, upper",)
        assert held.status in ("nominal", "falling short")


# -- copies ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))], ids=["copy", "pickle"])
def test_a_copy_goes_on_as_the_controller_would(chaser, hand, copied):
    q, v = state(chaser, 3, speed=0.05)
    tasks = [custom.Height(name="height", point=hand), custom.Spin(name="spin", joint=1, acceleration=0.1)]
    below = custom.Below(name="ceiling", point=hand, height=10.0)
    controller = Controller(chaser, tasks, inequalities=below, solver=custom.daqp_by_hand)
    controller.update(0.0, q, v)
    other = copied(controller)
    q[7:9] += 0.1
    np.testing.assert_array_equal(other.update(0.1, q, v).torque, controller.update(0.1, q, v).torque)


@pytest.mark.skipif(numba.config.DISABLE_JIT, reason="about compiled kernels")
def test_warm_up_compiles_the_kernels_of_python_rows(chaser, hand):
    controller = Controller(chaser, custom.Height(name="height", point=hand))
    controller.warm_up()
    codes = [len(one.overloads) for one in (observe, write_custom_rows)]
    controller.update(0.0, *state(chaser, 0))
    assert [len(one.overloads) for one in (observe, write_custom_rows)] == codes


# -- what is wrong is told -------------------------------------------------------------------------------------------


def bent(base, **methods):
    """A subclass with other methods."""
    made = type("Bent", (base,), methods)
    return made


def zero_division(self, at):
    return 1 / 0


WRONG = {
    "fails": ({"error": zero_division}, r"task 'h': Bent.zero_division failed: ZeroDivisionError: division by zero"),
    "shape": ({"error": lambda self, at: [1.0, 2.0]}, r"of shape \(2,\): it takes \(1,\), with size = 1"),
    "jacobian shape": ({"jacobian": lambda self, at: np.zeros((1, 3))}, r"of shape \(1, 3\): it takes \(1, 24\)"),
    "nan": ({"error": lambda self, at: np.nan}, r"task 'h': .* element \[0\] is nan: give finite numbers"),
    "inf in J": ({"jacobian": lambda self, at: np.full(24, np.inf)}, r"element \[0, 0\] is inf"),
    "nan in rate": ({"rate": lambda self, at: np.nan}, r"element \[0\] is nan"),
    "nan in drift": ({"drift": lambda self, at: np.nan}, r"element \[0\] is nan"),
    "text": ({"error": lambda self, at: "high"}, r"returned 'high': give an array of real numbers"),
    "complex": ({"error": lambda self, at: 1j}, r"returned 1j: give an array of real numbers"),
    "nothing": ({"error": lambda self, at: None}, r"returned None: give an array of real numbers"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_a_class_returns_is_checked(chaser, hand, case):
    methods, message = WRONG[case]
    controller = Controller(chaser, bent(custom.Height, **methods)(name="h", point=hand))
    with pytest.raises(OspaceError, match=message):
        controller.update(0.0, *state(chaser, 0))


def test_after_an_error_the_controller_goes_on(chaser, hand):
    q, v = state(chaser, 0)

    def error(self, at):
        return np.nan if at.time == 0.0 else custom.Height.error(self, at)

    controller = Controller(chaser, bent(custom.Height, error=error)(name="h", point=hand))
    with pytest.raises(OspaceError, match="nan"):
        controller.update(0.0, q, v)
    same(controller.update(1.0, q, v), Controller(chaser, custom.Height(name="h", point=hand)).update(1.0, q, v))


@pytest.mark.parametrize(
    ("returned", "message"),
    [
        (np.zeros(3), r"give a matrix and a vector"),
        ((np.zeros((2, 3)), [1.0]), r"Bent.equations returned a matrix of shape \(2, 3\): it takes \(1, 18\)"),
        ((np.zeros((1, 18)), [1.0, 2.0]), r"returned a vector of shape \(2,\): it takes \(1,\)"),
        ((np.full((1, 18), np.nan), [1.0]), r"not finite"),
        ((np.ones((1, 18)), [np.inf]), r"not finite"),
    ],
)
def test_rows_are_checked(chaser, returned, message):
    def equations(self, at):
        return returned

    task = bent(custom.Spin, equations=equations)(name="spin", joint=0, acceleration=0.0)
    with pytest.raises(OspaceError, match="task 'spin': .*" + message):
        Controller(chaser, task).update(0.0, *state(chaser, 0))


@dataclass(frozen=True, kw_only=True, eq=False)
class PixelTask(Task):
    """Of a kind that no kernel knows."""

    kind = 99

    def rows(self, robot):
        return [0, 1]


def test_unknown_kinds_are_refused(chaser, hand):
    with pytest.raises(OspaceError, match=r"task 'pixel' of class PixelTask is of kind 99.*subclass of CustomTask"):
        Controller(chaser, PixelTask(name="pixel"))
    with pytest.raises(OspaceError, match=r"tasks are those of ospace.control"):
        Controller(chaser, ["hand"])
    with pytest.raises(OspaceError, match=r"has rows \[6\]: give components 0 to 5"):
        Controller(chaser, bent(PoseTask, rows=lambda self, robot: [6])(name="six", point=hand))
    with pytest.raises(OspaceError, match="is about 0 points: its kernel takes 1"):
        Controller(chaser, bent(PoseTask, points=())(name="none", point=hand))
    with pytest.raises(OspaceError, match=r"is no inequality: write a subclass"):
        Controller(chaser, DampingTask(name="rest"), inequalities=["plane"])
    with pytest.raises(OspaceError, match="two tasks or inequalities are called 'a'"):
        Controller(chaser, DampingTask(name="a"), inequalities=custom.Below(name="a", point=hand, height=1.0))
    with pytest.raises(OspaceError, match=r"deceleration is 0.0: give a finite number above 0"):
        custom.Below(name="a", point=hand, height=1.0, deceleration=0.0)


@pytest.mark.parametrize("limits", [{}, {"plane": 1}, 3.0])
def test_limits_that_are_none_are_refused(chaser, limits):
    with pytest.raises(OspaceError, match=re.escape(f"{limits!r} is not a JointLimits")):
        Controller(chaser, DampingTask(name="rest"), limits=limits)


def test_another_robots_point_is_refused(chaser):
    other = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    below = custom.Below(name="a", point=other.point("end_effector"), height=1.0)
    with pytest.raises(OspaceError, match=r"belongs to another robot"):
        Controller(chaser, DampingTask(name="rest"), inequalities=below)


def test_abstract_classes_are_not_made():
    for kind in (CustomTask, Inequality):
        with pytest.raises(TypeError, match="jacobian"):
            kind(name="a")


# -- solvers ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("level", [None, 0])
def test_a_function_is_a_solver(chaser, hand, level):
    q, v = state(chaser, 4)
    tasks = [PoseTask(name="hand", point=hand, level=level), BaseAttitudeTask(name="base", robot=chaser)]
    programs = []

    def solver(program):
        programs.append(program.f.shape)
        return custom.daqp_by_hand(program)

    command, reference = (Controller(chaser, tasks, solver=one).update(0.0, q, v) for one in (solver, "daqp"))
    np.testing.assert_array_equal(command.torque, reference.torque)
    assert len(programs) == (1 if level is None else 2)


@pytest.mark.parametrize(
    ("solver", "message"),
    [
        (lambda program: np.zeros(3), "returned .*: give 18 finite numbers"),
        (lambda program: np.full(18, np.nan), "give 18 finite numbers"),
        (lambda program: "z", "give 18 finite numbers"),
        (lambda program: 1 / 0, "solver '<lambda>' failed: ZeroDivisionError"),
    ],
)
def test_what_a_solver_returns_is_checked(chaser, solver, message):
    with pytest.raises(OspaceError, match=message):
        Controller(chaser, DampingTask(name="rest"), solver=solver).update(0.0, *state(chaser, 0))


def test_a_solver_that_finds_nothing_or_passes_bounds_leads_to_no_torque_beyond_limits(chaser, hand):
    q, v = state(chaser, 0)
    task, limits = DampingTask(name="rest"), JointLimits.of(chaser)
    found = Controller(chaser, task, solver=lambda program: None).update(0.0, q, v)
    same(found, Controller(chaser, task).update(0.0, q, v))  # by DAQP
    wild = Controller(chaser, task, solver=lambda program: np.full(len(program.f), 1e3))
    same(wild.update(0.0, q, v), found)
    wild._solve = lambda program: np.full(len(program.f), 1e3)
    assert (np.abs(wild.update(0.0, q, v).torque) <= limits.torque).all()
    with pytest.raises(OspaceError, match="solver 3: give a name, or a function"):
        Controller(chaser, task, solver=3)

"""States: what they refuse, that they are alone, and that results do not depend on where the robot is or drifts."""

from __future__ import annotations

import dataclasses
import threading

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace
from ospace.model import pinocchio_pass
from ospace.model.state import QUATERNION_TOLERANCE

TYPES = ("revolute about any axis", "continuous", "continuous about any axis", "prismatic", "planar", "floating")
ORBIT = np.array([6.9e6, -1.1e6, 2.2e5])  # about 7e6 m from the origin
ORBITAL = np.array([-1.2e3, 7.4e3, -3.0e2])  # about 7.5 km/s
METHODS = ("forward", "inverted", "dense")


@pytest.fixture(scope="module")
def robot():
    return trees.tree(5, 10, TYPES)


@pytest.fixture(scope="module", params=[5, 6], ids="tree_{}".format)
def any_tree(request):
    return trees.tree(request.param, 14)


@pytest.fixture
def q(robot):
    return np.array(trees.state(robot, 1).q)


def arrays_of_state(state):
    return {
        "q": state.q,
        "v": state.v,
        "base_twist": state.base_twist,
        "links": state.links,
    }


def results(state, points=None):
    """Every array that the public functions give for a state."""
    points = points or [state.robot.point(name) for name in state.robot.leaf_links]
    found = {"momentum": ospace.momentum(state)}
    parts = {
        "joint_space": ospace.joint_space_dynamics(state),
        "generalized": ospace.generalized_dynamics(state),
        "jacobian": ospace.generalized_jacobian(state, points),
        "free_floating": ospace.free_floating(state, points),
        "fast": ospace.operational_space(state, points),
        "forward": ospace.operational_space(state, points, "forward"),
        "dense": ospace.operational_space(state, points, "dense"),
        "inverted": ospace.operational_space(state, points[0], "inverted"),
    }
    for part, result in parts.items():
        names = [field.name for field in dataclasses.fields(result) if not field.name.startswith("_")]
        for name in [*names, *(["response"] if hasattr(type(result), "response") else [])]:
            found[f"{part}.{name}"] = np.asarray(getattr(result, name))
    return found


def assert_same(ours, theirs, leave_out=()):
    assert ours.keys() == theirs.keys()
    for name in ours.keys() - set(leave_out):
        np.testing.assert_array_equal(ours[name], theirs[name], err_msg=name)


# -- what is refused ---------------------------------------------------------------------------------------------


def shapes(size):
    return [
        np.zeros(size - 1),
        np.zeros(size + 1),
        np.zeros((size, 1)),
        np.zeros((1, size)),
        [],
        0.0,
        [[0.0], [0.0, 1.0]],
        ["one"] * size,
        "zero",
        [1j] * size,
        {"base": 0.0},
        [None] * size,
        object(),
    ]


@pytest.mark.parametrize("case", range(len(shapes(7))))
def test_a_wrong_q_is_refused(robot, case):
    with pytest.raises(ospace.OspaceError, match="q"):
        robot.state(shapes(robot.nq)[case])


@pytest.mark.parametrize("case", range(len(shapes(7))))
def test_a_wrong_v_is_refused(robot, q, case):
    with pytest.raises(ospace.OspaceError, match="v"):
        robot.state(q, shapes(robot.nv)[case])


def test_the_message_tells_the_right_length(robot, q):
    with pytest.raises(ospace.OspaceError, match=rf"q has shape \(3,\).*\({robot.nq},\)"):
        robot.state([1.0, 2.0, 3.0])
    with pytest.raises(ospace.OspaceError, match=rf"v has shape \({robot.nq},\).*\({robot.nv},\)"):
        robot.state(q, q)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("place", [0, 4, 8, -1])
@pytest.mark.parametrize("whose", ["q", "v"])
def test_numbers_that_are_not_finite_are_refused_by_index(robot, q, whose, place, value):
    both = {"q": q, "v": np.zeros(robot.nv)}
    both[whose][place] = value
    index = place % len(both[whose])
    with pytest.raises(ospace.OspaceError, match=rf"{whose}\[{index}\] is -?{'nan' if value != value else 'inf'}"):
        robot.state(**both)


@pytest.mark.parametrize("exponent", [100, 160, 307])
@pytest.mark.parametrize(("whose", "place"), [("q", "joint_3"), ("q", 0), ("v", 1), ("v", 4), ("v", 7), ("v", 9)])
def test_numbers_too_large_to_compute_with_leave_no_nan(robot, whose, place, exponent):
    both = {"q": robot.configuration(), "v": np.ones(robot.nv)}
    if place == "joint_3":  # prismatic
        place = robot.model.idx_qs[robot.model.getJointId(place)]
    both[whose][place] = 10.0**exponent
    try:
        found = results(robot.state(**both))
    except ospace.OspaceError:
        return
    assert all(np.isfinite(array).all() for array in found.values())


# -- unit length -------------------------------------------------------------------------------------------------

ATTITUDES = [(0.0, 0.0, 0.0, 1.0), (0.5, 0.5, -0.5, 0.5), (0.6, 0.0, 0.0, -0.8)]


@pytest.mark.parametrize("attitude", ATTITUDES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_length_of_the_base_quaternion_may_be_off_by_the_tolerance(robot, q, attitude, sign):
    q[3:7] = (1.0 + 0.9 * sign * QUATERNION_TOLERANCE) * np.array(attitude)
    state = robot.state(q)
    np.testing.assert_allclose(state.q[3:7], attitude, atol=1e-15)
    np.testing.assert_allclose(state.T_WB.rotation @ state.T_WB.rotation.T, np.eye(3), atol=1e-15)


@pytest.mark.parametrize("attitude", ATTITUDES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_length_of_the_base_quaternion_may_not_be_off_by_more(robot, q, attitude, sign):
    q[3:7] = (1.0 + 1.5 * sign * QUATERNION_TOLERANCE) * np.array(attitude)
    with pytest.raises(ospace.OspaceError, match=r"base quaternion q\[3:7\] is not of unit length"):
        robot.state(q)


@pytest.mark.parametrize("attitude", [np.zeros(4), np.full(4, 1e-200), np.full(4, 1e200), np.full(4, 7.0)])
def test_what_is_no_attitude_at_all_is_refused(robot, q, attitude):
    q[3:7] = attitude
    with pytest.raises(ospace.OspaceError, match="base quaternion"):
        robot.state(q)


TURNING = ["joint_1", "joint_2", "joint_4", "joint_5"]  # two continuous ones, a planar and a floating one


def rotation_part(robot, name):
    j = robot.model.getJointId(name)
    stop = robot.model.idx_qs[j] + robot.model.nqs[j]
    return slice(stop - (4 if robot.model.nqs[j] == 7 else 2), stop)


@pytest.mark.parametrize("name", TURNING)
@pytest.mark.parametrize("factor", [0.0, 0.5, 1.0 + 1e-5])
def test_the_length_of_a_joint_s_rotation_is_checked_by_name(robot, q, name, factor):
    q[rotation_part(robot, name)] *= factor
    with pytest.raises(ospace.OspaceError, match=f"'{name}' is not of unit length"):
        robot.state(q)


@pytest.mark.parametrize("name", TURNING)
def test_the_length_of_a_joint_s_rotation_may_be_off_by_the_tolerance(robot, q, name):
    part = rotation_part(robot, name)
    rounded = q.copy()
    rounded[part] *= 1.0 + 0.9 * QUATERNION_TOLERANCE
    state = robot.state(rounded)
    np.testing.assert_allclose(state.q, q, atol=1e-15)
    np.testing.assert_allclose(np.linalg.norm(state.q[part]), 1.0, rtol=1e-15)


def test_zeros_are_no_configuration(robot):
    with pytest.raises(ospace.OspaceError, match="base quaternion"):
        robot.state(np.zeros(robot.nq))


def test_lists_and_integers_are_numbers_too(robot):
    q = robot.configuration()
    state = robot.state([int(one) for one in q], [0] * robot.nv)
    np.testing.assert_array_equal(state.q, q)


# -- alone -------------------------------------------------------------------------------------------------------


def test_all_arrays_are_read_only(robot):
    for name, array in arrays_of_state(trees.state(robot, 2)).items():
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
        assert not array.flags.writeable, name


def test_velocity_is_zero_without_one(robot, q):
    state = robot.state(q)
    assert not state.v.any()
    assert not ospace.momentum(state).any()
    assert not ospace.joint_space_dynamics(state).manipulator_bias.any()


def test_a_state_keeps_copies(robot, q):
    v = np.ones(robot.nv)
    state = robot.state(q, v)
    before = {name: array.copy() for name, array in arrays_of_state(state).items()}
    q[:], v[:] = 0.0, 2.0
    assert_same(arrays_of_state(state), before)


def test_states_of_one_robot_are_independent(robot):
    """Results of a state are the same before and after others of the same robot are made and used."""
    first = trees.state(robot, 3)
    before = {**arrays_of_state(first), **results(first)}
    before = {name: array.copy() for name, array in before.items()}
    for seed in range(4, 7):
        assert not np.allclose(
            results(trees.state(robot, seed, far=True))["forward.inertia"], before["forward.inertia"]
        )
    assert_same({**arrays_of_state(first), **results(first)}, before)


def test_results_do_not_share_memory_with_later_ones(robot):
    early = results(trees.state(robot, 3))
    kept = {name: array.copy() for name, array in early.items()}
    for seed in range(4, 7):
        results(trees.state(robot, seed))
    assert_same(early, kept)


def test_threads_get_what_each_gets_alone(robot):
    seeds = [range(60), range(60, 120)]
    alone = {seed: results(trees.state(robot, seed)) for part in seeds for seed in part}
    together, failures, start = {}, [], threading.Barrier(len(seeds))

    def work(part):
        try:
            start.wait(timeout=10)
            for seed in part:
                together[seed] = results(trees.state(robot, seed))
        except Exception as error:
            failures.append(error)

    threads = [threading.Thread(target=work, args=(part,)) for part in seeds]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60)
    assert failures == []
    assert together.keys() == alone.keys()
    for seed, found in together.items():
        assert_same(found, alone[seed])


def test_a_state_may_go_to_another_thread(robot):
    state = trees.state(robot, 1)
    here, there = results(state), {}
    thread = threading.Thread(target=lambda: there.update(results(state)))
    thread.start()
    thread.join(timeout=60)
    assert_same(there, here)


@pytest.mark.parametrize("broken", ["strides", "no interface"])
def test_without_views_into_pinocchio_s_memory_states_are_the_same(monkeypatch, broken):
    fast = trees.tree(7, 14)
    assert fast.scratch.zero_copy

    def no_views(first_two, owner, numbers):
        raise {"strides": ValueError, "no interface": AttributeError}[broken]("made for the test")

    monkeypatch.setattr(pinocchio_pass, "_view", no_views)
    plain = trees.tree(7, 14)
    assert not plain.scratch.zero_copy
    for seed in range(3):
        ours, theirs = trees.state(plain, seed), trees.state(fast, seed)
        assert_same(arrays_of_state(ours), arrays_of_state(theirs))
        assert_same(results(ours), results(theirs))


def test_views_that_show_wrong_numbers_are_not_taken(monkeypatch):
    """The self-test finds a layout that is shifted by one number."""
    robot, honest = trees.tree(7, 4), pinocchio_pass._view
    monkeypatch.setattr(pinocchio_pass, "_view", lambda *given: np.roll(honest(*given), 1))
    assert not robot.scratch.zero_copy


# -- where, and how fast -----------------------------------------------------------------------------------------


def moved(state, by=0.0, velocity=0.0):
    """The same state elsewhere, and drifting along in inertial axes."""
    q, v = state.q.copy(), state.v.copy()
    q[:3] = by
    v[:3] = state.T_WB.rotation.T @ (np.zeros(3) + velocity)
    return state.robot.state(q, v)


def test_results_far_away_are_those_at_the_origin_to_the_bit(any_tree):
    state = trees.state(any_tree, 1)
    far = state.q.copy()
    far[:3] = ORBIT
    near = state.q.copy()
    near[:3] = 0.0
    assert_same(results(any_tree.state(far, state.v)), results(any_tree.state(near, state.v)))


@pytest.mark.parametrize("name", ["planar_2r", "chaser_24dof", "target"])
def test_models_far_away_are_those_at_the_origin_to_the_bit(name):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    state = trees.state(robot, 1)
    near, far = moved(state, 0.0, 1.0), moved(state, ORBIT, 1.0)
    assert_same(results(far), results(near))
    np.testing.assert_array_equal(far.T_WB.translation, ORBIT)


def test_poses_of_points_follow_the_base(any_tree):
    near, far = moved(trees.state(any_tree, 1)), moved(trees.state(any_tree, 1), ORBIT)
    for name in any_tree.leaf_links:
        here, there = near.placement(any_tree.point(name)), far.placement(any_tree.point(name))
        np.testing.assert_array_equal(there.rotation, here.rotation)
        np.testing.assert_allclose(there.translation, here.translation + ORBIT, rtol=1e-15)
        about_base = far.placement_about_base(any_tree.point(name))
        np.testing.assert_array_equal(about_base.homogeneous, here.homogeneous)


@pytest.mark.parametrize("seed", range(3))
def test_nothing_but_momentum_feels_a_drift(any_tree, seed):
    """Galilean invariance: at 7.5 km/s inertias, Jacobians and biases are those of the robot that does not drift."""
    state = trees.state(any_tree, seed)
    at_rest, drifting = results(moved(state)), results(moved(state, ORBIT, ORBITAL))
    felt = {"momentum", "jacobian.momentum_velocity", "jacobian.base_momentum_velocity"}
    assert any(np.abs(at_rest[name]).max() > 0.1 for name in at_rest if "bias" in name)
    for name in at_rest.keys() - felt:
        scale = np.abs(at_rest[name]).max(initial=1.0)
        np.testing.assert_allclose(drifting[name], at_rest[name], rtol=0.0, atol=1e-12 * scale, err_msg=name)


@pytest.mark.parametrize("seed", range(3))
def test_momentum_at_orbital_speed(any_tree, seed):
    """M_0 = [Σ m_i v_i; Σ I_i ω_i + r_i × m_i v_i] about the base, and what the drift adds is [m v; m r_c × v]."""
    state = trees.state(any_tree, seed)
    drifting = moved(state, ORBIT, ORBITAL)
    model, data = any_tree.model, any_tree.model.createData()
    pin.forwardKinematics(model, data, moved(state).q, drifting.v)
    expected = sum(data.oMi[j].act(model.inertias[j] * data.v[j]).vector for j in range(1, model.njoints))
    np.testing.assert_allclose(ospace.momentum(drifting), expected, rtol=0.0, atol=1e-13 * np.abs(expected).max())

    at_rest = ospace.momentum(moved(state))
    mass = any_tree.total_mass
    H_b = ospace.joint_space_dynamics(state).base_inertia
    moment = np.array([H_b[5, 1], H_b[3, 2], H_b[4, 0]])  # m r_c
    gained = np.r_[mass * ORBITAL, np.cross(moment, ORBITAL)]
    np.testing.assert_allclose(ospace.momentum(drifting) - at_rest, gained, rtol=0.0, atol=1e-13 * np.abs(gained).max())


@pytest.mark.parametrize("seed", range(2))
def test_generalized_velocities_at_orbital_speed(any_tree, seed):
    """ẋ_b = J_b* φ̇ + H_b⁻¹ M_0 (2) and ẋ_e = J_m* φ̇ + J_b H_b⁻¹ M_0 (4) hold to the digits that 7.5 km/s leaves."""
    state = moved(trees.state(any_tree, seed), ORBIT, ORBITAL)
    points = [any_tree.point(name) for name in any_tree.leaf_links]
    J = ospace.generalized_jacobian(state, points)
    rates, atol = state.v[6:], 1e-12 * np.linalg.norm(ORBITAL)
    base = J.base_generalized_jacobian @ rates + J.base_momentum_velocity
    np.testing.assert_allclose(base, state.base_twist, rtol=0.0, atol=atol)
    J_e = ospace.operational_space(state, points).jacobian
    velocity = J.generalized_jacobian @ rates + J.momentum_velocity
    np.testing.assert_allclose(velocity, J_e @ np.r_[state.base_twist, rates], rtol=0.0, atol=atol)


def test_unit_length_within_a_joint_composed_of_others():
    """Four coordinates of three rates are no quaternion: two angles, a cosine and a sine."""
    model = pin.Model()
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    joint = pin.JointModelComposite(3)
    for one in (pin.JointModelRX(), pin.JointModelRY(), pin.JointModelRUBZ()):
        joint.addJoint(one, pin.SE3.Identity())
    wrist = model.addJoint(base, joint, pin.SE3.Identity(), "wrist")
    for body in (base, wrist):
        model.appendBodyToJoint(body, pin.Inertia.Random(), pin.SE3.Identity())
    robot = ospace.SpaceRobot.from_model(model)
    q = pin.neutral(model)
    q[7:9] = 0.4, 2.0
    assert robot.state(q).q[7:].tolist() == [0.4, 2.0, 1.0, 0.0]
    q[9] = 1.1
    with pytest.raises(ospace.OspaceError, match="'wrist' is not of unit length"):
        robot.state(q)

"""Operational points: names, axes, offsets, and that every result has the rows that were asked for, in that order."""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
import pytest
import trees

import ospace

METHODS = ("forward", "inverted", "dense")
SEEDS = range(2)
INERTIAL = (
    '<inertial><origin xyz="0.1 0 0.05"/><mass value="2"/>'
    '<inertia ixx="1" iyy="1.2" izz="0.9" ixy="0" ixz="0" iyz="0"/></inertial>'
)
SHIFT = pin.SE3(pin.exp3(np.array([0.4, -1.1, 0.3])), np.array([0.2, -0.5, 0.7]))


@pytest.fixture(scope="module")
def chaser():
    return ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))


@pytest.fixture(params=SEEDS)
def state(chaser, request):
    return trees.state(chaser, request.param)


@pytest.fixture(scope="module", params=SEEDS, ids="tree_{}".format)
def moving_tree(request):
    return trees.state(trees.tree(request.param, 14), request.param)


def load(folder, *joints):
    """A robot of links `base`, `one`, `two` and joints (name, child, parent, xyz, type)."""
    text = "".join(f'<link name="{name}">{INERTIAL}</link>' for name in ("base", "one", "two"))
    for name, child, parent, xyz, kind in joints:
        text += (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{xyz}"/><axis xyz="{"0 0 1" if kind == "planar" else "0 1 0"}"/></joint>'
        )
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="made">{text}</robot>')
    return ospace.SpaceRobot.from_urdf(file)


def all_rows(state, points, method):
    """What has one row per row of the points, as (r, ·), by its name."""
    result = ospace.operational_space(state, points, method)
    J = ospace.generalized_jacobian(state, points)
    floating = ospace.free_floating(state, points)
    return {
        "jacobian": result.jacobian,
        "response": result.response.T,
        "bias_acceleration": result.bias_acceleration[:, None],
        "generalized_jacobian": J.generalized_jacobian,
        "momentum_velocity": J.momentum_velocity[:, None],
        "floating.bias_acceleration": floating.bias_acceleration[:, None],
        "floating.torque_map": floating.torque_map,
        "floating.generalized_jacobian": floating.generalized_jacobian,
    }


def all_blocks(state, points, method):
    """What is (r, r) and taken by rows and columns, by its name."""
    floating = ospace.free_floating(state, points)
    return {
        "inertia_inverse": ospace.operational_space(state, points, method).inertia_inverse,
        "floating_inertia_inverse": floating.floating_inertia_inverse,
        "base_inertia_inverse": floating.base_inertia_inverse,
    }


def assert_close(ours, theirs, message="", digits=12):
    atol = 10.0**-digits * np.abs(theirs).max(initial=1.0)
    np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=atol, err_msg=message)


# -- names -------------------------------------------------------------------------------------------------------


def test_unknown_frame_names_the_nearest(chaser):
    with pytest.raises(ospace.OspaceError, match=r"no frame 'righthand'; did you mean .*'right_hand'"):
        chaser.point("righthand")


def test_a_frame_like_no_other_lists_what_there_is():
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path("planar_2r"))
    with pytest.raises(ospace.OspaceError, match=r"known: .*base.*link_1"):
        robot.point("zzzzzz")


@pytest.mark.parametrize("frame", ["", "universe", 3, None, ("right_hand",), "Right_Hand", "right_hand "])
def test_what_is_no_frame_of_the_robot_is_refused(chaser, frame):
    with pytest.raises(ospace.OspaceError, match="no frame"):
        chaser.point(frame)


def test_every_frame_can_carry_a_point(chaser):
    state = trees.state(chaser, 0)
    data = chaser.model.createData()
    pin.framesForwardKinematics(chaser.model, data, state.q)
    assert len(chaser.frame_names) > chaser.n_joints
    for name in chaser.frame_names:
        T_WE = data.oMf[chaser.model.getFrameId(name)]
        np.testing.assert_allclose(state.placement(chaser.point(name)).homogeneous, T_WE.homogeneous, atol=1e-12)


def test_a_link_and_a_joint_of_one_name_in_different_places_are_ambiguous(tmp_path):
    robot = load(tmp_path, ("two", "one", "base", "1 0 0", "continuous"), ("k", "two", "one", "1 0 0", "continuous"))
    with pytest.raises(ospace.OspaceError, match=r"'two'.*ambiguous.*different places"):
        robot.point("two")
    assert robot.point("one").frame == "one"


def test_ambiguity_is_about_places_on_one_link_too(tmp_path):
    robot = load(tmp_path, ("two", "one", "base", "1 0 0", "fixed"), ("k", "two", "base", "0 1 0", "fixed"))
    with pytest.raises(ospace.OspaceError, match="ambiguous"):
        robot.point("two")


@pytest.mark.parametrize("kind", ["continuous", "fixed", "planar"])
def test_a_link_and_the_joint_it_hangs_from_may_share_a_name(tmp_path, kind):
    robot = load(tmp_path, ("one", "one", "base", "0.3 0 0", kind), ("k", "two", "one", "1 0 0", "continuous"))
    state = robot.state(robot.configuration())
    np.testing.assert_allclose(state.placement(robot.point("one")).translation, [0.3, 0.0, 0.0], atol=1e-15)


def test_names_of_links_that_are_fixed_are_kept(tmp_path):
    robot = load(tmp_path, ("j", "one", "base", "1 0 0", "continuous"), ("k", "two", "one", "0 0.5 0", "fixed"))
    state = trees.state(robot, 0)
    weld = pin.SE3(np.eye(3), np.array([0.0, 0.5, 0.0]))
    at_two, by_hand = (
        ospace.operational_space(state, point) for point in (robot.point("two"), robot.point("one", offset=weld))
    )
    np.testing.assert_allclose(at_two.inertia, by_hand.inertia, atol=1e-13)


# -- axes --------------------------------------------------------------------------------------------------------

LINEAR = (True, True, True, False, False, False)
MIXED = (True, False, False, False, True, True)


@pytest.mark.parametrize(
    ("axes", "taken"),
    [
        ("all", (True,) * 6),
        ("linear", LINEAR),
        ("angular", tuple(not one for one in LINEAR)),
        (MIXED, MIXED),
        (list(MIXED), MIXED),
        ([int(one) for one in MIXED], MIXED),
        (np.array(MIXED), MIXED),
        (np.array(MIXED, dtype=float), MIXED),
        ((False, False, False, False, False, True), (False, False, False, False, False, True)),
    ],
)
def test_axes_of_a_point_in_all_forms(chaser, axes, taken):
    point = chaser.point("head", axes=axes)
    assert point.axes == taken
    assert point.n_rows == sum(taken)
    names = [f"head.{name}" for name in ("x", "y", "z", "rx", "ry", "rz")]
    assert point.row_names == [name for name, one in zip(names, taken, strict=True) if one]


@pytest.mark.parametrize(
    "axes",
    [
        "xyz",
        "ALL",
        "",
        None,
        True,
        3,
        (True,) * 5,
        (True,) * 7,
        (False,) * 6,
        (0, 1, 2, 0, 0, 0),
        (-1, 1, 1, 0, 0, 0),
        (1.0, 0.5, 0.0, 0.0, 0.0, 0.0),
        [MIXED],
        [[True], [True, False]],
        ["x", "y", "z", "rx", "ry", "rz"],
        ["1", "0", "0", "0", "0", "0"],
        (np.nan,) * 6,
        (None,) * 6,
        {"linear": True},
    ],
    ids=repr,
)
def test_wrong_axes_are_refused(chaser, axes):
    with pytest.raises(ospace.OspaceError, match="axes"):
        chaser.point("head", axes=axes)


# -- offset ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "offset", [np.eye(4), [0.0, 0.0, 1.0], (0.0,) * 7, "up", 1.0, pin.Motion.Zero()], ids=lambda one: type(one).__name__
)
def test_an_offset_of_the_wrong_type_is_refused(chaser, offset):
    with pytest.raises(ospace.OspaceError, match=r"(?s)offset.*pin\.SE3"):
        chaser.point("head", offset=offset)


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("part", ["translation", "rotation"])
def test_an_offset_that_is_not_finite_is_refused(chaser, part, value):
    R, p = np.eye(3), np.zeros(3)
    (p if part == "translation" else R)[...] = value
    with pytest.raises(ospace.OspaceError, match=r"'head' is not finite"):
        chaser.point("head", offset=pin.SE3(R, p))


def test_a_point_does_not_follow_its_offset(chaser):
    offset = pin.SE3(SHIFT)
    point = chaser.point("head", offset=offset)
    state = trees.state(chaser, 0)
    before = state.placement(point).translation.copy()
    offset.translation = np.full(3, 9.0)
    np.testing.assert_array_equal(state.placement(point).translation, before)


@pytest.mark.parametrize("frame", ["right_hand", "base", "left_arm_4"])
@pytest.mark.parametrize("method", METHODS)
def test_an_offset_is_a_shift_by_hand(chaser, state, frame, method):
    """ẋ_p = X ẋ_e with X = [1 −[r]×; 0 1] and r the arm in inertial axes; nothing but r counts of the offset."""
    frame = next(name for name in chaser.frame_names if name.startswith(frame))
    plain, shifted = chaser.point(frame), chaser.point(frame, offset=SHIFT)
    arm = state.placement(shifted).translation - state.placement(plain).translation
    np.testing.assert_allclose(arm, state.placement(plain).rotation @ SHIFT.translation, atol=1e-14)
    X = np.eye(6)
    X[:3, 3:] = -pin.skew(arm)
    here, there = (ospace.operational_space(state, point, method) for point in (plain, shifted))
    assert_close(there.jacobian, X @ here.jacobian)
    assert_close(there.response, here.response @ X.T)
    assert_close(there.inertia_inverse, X @ here.inertia_inverse @ X.T)
    X_inv = np.linalg.inv(X)
    assert_close(there.inertia, X_inv.T @ here.inertia @ X_inv, digits=9)  # Γ_e⁻¹ has a condition of 1e3
    omega = (here.jacobian @ np.r_[state.base_twist, state.v[6:]])[3:]
    centripetal = np.r_[np.cross(omega, np.cross(omega, arm)), np.zeros(3)]
    assert_close(there.bias_acceleration, X @ here.bias_acceleration - centripetal)
    assert_close(there.bias_force, there.inertia @ (X @ here.bias_acceleration - centripetal), digits=9)


# -- sets of points ----------------------------------------------------------------------------------------------

FUNCTIONS = {
    **{method: functools.partial(ospace.operational_space, method=method) for method in METHODS},
    "generalized_jacobian": ospace.generalized_jacobian,
    "free_floating": ospace.free_floating,
}
of_each_function = pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS)


@of_each_function
def test_no_point_is_refused(chaser, function):
    with pytest.raises(ospace.OspaceError, match="no operational point"):
        function(trees.state(chaser, 0), [])


@of_each_function
@pytest.mark.parametrize(
    "given", ["right_hand", ["right_hand"], [None], [3], None, 3, [["right_hand"]], {"right_hand": 1}], ids=repr
)
def test_what_is_no_point_is_refused(chaser, function, given):
    with pytest.raises(ospace.OspaceError, match=r"no operational point|robot\.point"):
        function(trees.state(chaser, 0), given)


@of_each_function
def test_points_of_another_robot_are_refused(chaser, function):
    twin = ospace.SpaceRobot.from_urdf(ospace.models.path("chaser_24dof"))
    with pytest.raises(ospace.OspaceError, match="'head' belongs to another robot"):
        function(trees.state(chaser, 0), twin.point("head"))


def test_the_inverted_chain_takes_one_point(chaser):
    points = [chaser.point("head"), chaser.point("right_hand")]
    with pytest.raises(ospace.OspaceError, match=r"one point, got 2.*forward"):
        ospace.operational_space(trees.state(chaser, 0), points, "inverted")


@pytest.mark.parametrize("method", ["Forward", "", None, 1])
def test_unknown_methods_are_refused(chaser, method):
    with pytest.raises(ospace.OspaceError, match=r"method.*forward, inverted, dense"):
        ospace.operational_space(trees.state(chaser, 0), chaser.point("head"), method)


@of_each_function
def test_one_point_may_come_without_a_list(chaser, function):
    state, point = trees.state(chaser, 0), chaser.point("head")
    for alone, listed in zip(
        vars(function(state, point)).values(), vars(function(state, (point,))).values(), strict=True
    ):
        np.testing.assert_array_equal(alone, listed)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "axes",
    ["linear", "angular", MIXED, (False, True, False, False, False, False), (True, True, True, True, True, False)],
)
def test_rows_of_a_point_are_those_of_the_full_one(moving_tree, axes, method):
    robot = moving_tree.robot
    for name in (robot.leaf_links[-1], "base", "link_5"):
        full, part = robot.point(name, offset=SHIFT), robot.point(name, axes, SHIFT)
        taken = np.flatnonzero(part.axes)
        whole = all_rows(moving_tree, full, method)
        for what, rows in all_rows(moving_tree, part, method).items():
            assert_close(rows, whole[what][taken], what)
        whole = all_blocks(moving_tree, full, method)
        for what, block in all_blocks(moving_tree, part, method).items():
            assert_close(block, whole[what][np.ix_(taken, taken)], what)


@pytest.mark.parametrize("method", ["forward", "dense"])
def test_rows_of_several_points_come_in_the_order_given(moving_tree, method):
    robot = moving_tree.robot
    names = ["link_9", "base", "link_3", robot.leaf_links[0]]
    axes = ["angular", "linear", MIXED, "all"]
    full = [robot.point(name) for name in names]
    part = [robot.point(name, axes=one) for name, one in zip(names, axes, strict=True)]
    for order in ([0, 1, 2, 3], [3, 1, 0, 2]):
        taken = np.concatenate([6 * k + np.flatnonzero(part[k].axes) for k in order])
        given = [part[k] for k in order]
        whole = all_rows(moving_tree, full, method)
        for what, rows in all_rows(moving_tree, given, method).items():
            assert_close(rows, whole[what][taken], what)
        whole = all_blocks(moving_tree, full, method)
        for what, block in all_blocks(moving_tree, given, method).items():
            assert_close(block, whole[what][np.ix_(taken, taken)], what)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("axes", ["linear", MIXED])
def test_inertia_and_bias_force_are_those_of_the_rows_taken(moving_tree, axes, method):
    """Γ_e is the inverse of the rows' own Γ_e⁻¹, not a part of the full Γ_e; μ_e = Γ_e μ (10)."""
    robot = moving_tree.robot
    result = ospace.operational_space(moving_tree, robot.point("link_8", axes=axes), method)
    rows = len(result.inertia)
    assert result.rank == rows
    np.testing.assert_allclose(result.inertia @ result.inertia_inverse, np.eye(rows), atol=1e-10)
    assert_close(result.bias_force, result.inertia @ result.bias_acceleration)
    full = ospace.operational_space(moving_tree, robot.point("link_8"), method)
    taken = np.flatnonzero(robot.point("link_8", axes=axes).axes)
    assert not np.allclose(result.inertia, full.inertia[np.ix_(taken, taken)])


@pytest.mark.parametrize("method", ["forward", "dense"])
def test_several_points_on_one_link(moving_tree, method):
    """They move as one body: J_2 = X J_1, the rank is 6, and three points' worth of places still gives no more."""
    robot = moving_tree.robot
    there = pin.SE3(np.eye(3), np.array([-0.3, 0.1, 0.4]))
    points = [robot.point("link_7"), robot.point("link_7", offset=SHIFT), robot.point("link_7", offset=there)]
    result = ospace.operational_space(moving_tree, points, method)
    alone = ospace.operational_space(moving_tree, points[0], method)
    shifts = np.vstack([np.eye(6)] * 3)
    for k, point in enumerate(points):
        arm = moving_tree.placement(point).translation - moving_tree.placement(points[0]).translation
        shifts[6 * k : 6 * k + 3, 3:] = -pin.skew(arm)
    assert result.rank == 6
    assert_close(result.jacobian, shifts @ alone.jacobian)
    assert_close(result.inertia_inverse, shifts @ alone.inertia_inverse @ shifts.T)
    pseudo = np.linalg.pinv(shifts)
    inertia = pseudo.T @ alone.inertia @ pseudo
    np.testing.assert_allclose(result.inertia, inertia, rtol=0.0, atol=1e-9 * np.abs(inertia).max())
    with pytest.raises(ospace.DependentRowsError, match="'link_7'") as caught:
        ospace.operational_space(moving_tree, points, method, strict=True)
    assert (caught.value.rank, caught.value.rows, caught.value.points) == (6, 18, ("link_7",))


def test_a_point_given_twice_is_dependent(chaser):
    point = chaser.point("head", axes="linear")
    result = ospace.operational_space(trees.state(chaser, 0), [point, point])
    assert result.rank == 3
    np.testing.assert_allclose(result.inertia_inverse, np.tile(result.inertia_inverse[:3, :3], (2, 2)), atol=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_the_base_as_a_point(moving_tree, method):
    """J_e = [1 0], so Γ_e = H_b − H_bm H_m⁻¹ H_bmᵀ and, with ẍ_b = −μ, Γ_e μ = c_b − H_bm H_m⁻¹ c_m."""
    terms = ospace.joint_space_dynamics(moving_tree)
    result = ospace.operational_space(moving_tree, moving_tree.robot.point("base"), method)
    np.testing.assert_allclose(result.jacobian, np.eye(6, moving_tree.robot.nv), atol=1e-15)
    share = np.linalg.solve(terms.manipulator_inertia, terms.coupling_inertia.T).T
    inertia = terms.base_inertia - share @ terms.coupling_inertia.T
    np.testing.assert_allclose(result.inertia, inertia, rtol=0.0, atol=1e-11 * np.abs(inertia).max())
    force = terms.base_bias - share @ terms.manipulator_bias
    np.testing.assert_allclose(result.bias_force, force, rtol=0.0, atol=1e-10 * np.abs(force).max())


def test_joint_torques_alone_do_not_move_a_locked_share_of_the_base(moving_tree):
    """At the base Λ_b⁻¹ = H_b⁻¹ and J_m* = J_b*."""
    point = moving_tree.robot.point("base")
    floating = ospace.free_floating(moving_tree, point)
    H_b = ospace.joint_space_dynamics(moving_tree).base_inertia
    np.testing.assert_allclose(floating.base_inertia_inverse @ H_b, np.eye(6), atol=1e-12)
    J = ospace.generalized_jacobian(moving_tree, point)
    assert_close(J.generalized_jacobian, J.base_generalized_jacobian)
    assert_close(J.momentum_velocity, J.base_momentum_velocity)

"""What a robot is: counts and mass as the file says, refusals, and configurations by joint name."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pinocchio as pin
import pytest
import trees
from hypothesis import given, settings
from hypothesis import strategies as st

import ospace
from ospace.model import joint_positions

NQ = {"revolute": 1, "continuous": 2, "prismatic": 1, "planar": 4, "floating": 7, "fixed": 0}
NV = {"revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6, "fixed": 0}
AXES = {"x": (1.0, 0.0, 0.0), "minus_y": (0.0, -1.0, 0.0), "z": (0.0, 0.0, 1.0), "oblique": (1.0, -2.0, 0.5)}
INERTIAL = '<inertial><mass value="{}"/><inertia ixx="1" iyy="1.2" izz="0.9" ixy="0" ixz="0" iyz="0"/></inertial>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
ORIGIN_XYZ, ORIGIN_RPY = (0.3, -0.1, 0.2), (0.4, 0.5, -0.6)


def link(name, mass=2.0):
    return f'<link name="{name}">{INERTIAL.format(mass)}</link>'


def joint(name, kind, child, parent="base", axis=(0.0, 0.0, 1.0), more=""):
    numbers, xyz, rpy = (" ".join(map(str, three)) for three in (axis, ORIGIN_XYZ, ORIGIN_RPY))
    limit = LIMIT if kind in ("revolute", "prismatic") else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{numbers}"/>{limit}{more}</joint>'
    )


def load(folder, *parts):
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="made">{"".join(parts)}</robot>')
    return ospace.SpaceRobot.from_urdf(file)


# -- from a file -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ospace.models.names())
def test_model_is_what_its_file_says(name):
    robot = ospace.SpaceRobot.from_urdf(ospace.models.path(name))
    file = ElementTree.parse(ospace.models.path(name)).getroot()
    kinds = [one.get("type") for one in file.iterfind("joint")]
    assert robot.name == file.get("name")
    assert robot.nq == 7 + sum(NQ[kind] for kind in kinds)
    assert robot.nv == 6 + sum(NV[kind] for kind in kinds)
    assert robot.n_joints == robot.nv - 6
    assert sorted(robot.joint_names) == sorted(
        one.get("name") for one in file.iterfind("joint") if one.get("type") != "fixed"
    )
    masses = [float(mass.get("value")) for mass in file.iterfind("link/inertial/mass")]
    assert robot.total_mass == pytest.approx(sum(masses), rel=1e-14)
    assert {one.get("name") for one in file.iterfind("link")} <= set(robot.frame_names)
    assert robot.findings == ()


@pytest.mark.parametrize("name", ospace.models.names())
def test_leaf_links_are_no_joints_parent(name):
    robot = ospace.SpaceRobot.from_urdf(str(ospace.models.path(name)))
    file = ElementTree.parse(ospace.models.path(name)).getroot()
    parents = {one.get("link") for one in file.iterfind("joint/parent")}
    assert set(robot.leaf_links) == {one.get("name") for one in file.iterfind("link")} - parents


def test_unknown_model_names_the_nearest():
    with pytest.raises(ospace.OspaceError, match="chaser_24dof"):
        ospace.models.path("chaser24dof")


def test_gravity_is_zero_and_the_given_model_stays_as_it_was():
    model = two_branches(("a", 1))
    before = model.gravity.linear.copy()
    robot = ospace.SpaceRobot.from_model(model)
    assert np.any(before)
    assert not robot.model.gravity.vector.any()
    np.testing.assert_array_equal(model.gravity.linear, before)


def test_later_changes_to_the_given_model_do_not_reach_the_robot():
    model = two_branches(("a", 1))
    robot = ospace.SpaceRobot.from_model(model)
    mass = robot.total_mass
    model.inertias[1] = pin.Inertia(1e3, np.zeros(3), np.eye(3))
    state = robot.state(robot.configuration())
    assert np.trace(ospace.joint_space_dynamics(state).base_inertia[:3, :3]) == pytest.approx(3.0 * mass)


@pytest.mark.parametrize("name", ["root_joint", "root_joint_", "universe"])
def test_a_joint_may_bear_a_name_that_pinocchio_uses_itself(tmp_path, name):
    robot = load(tmp_path, link("base"), link("arm"), joint(name, "revolute", "arm"))
    assert robot.joint_names == [name]
    assert robot.joint_positions(robot.configuration({name: 0.7})) == {name: 0.7}
    np.testing.assert_array_equal(robot.configuration({name: 0.7})[:7], [0, 0, 0, 0, 0, 0, 1])


@pytest.mark.parametrize("name", ["root_joint", "universe"])
def test_a_link_may_bear_a_name_that_pinocchio_uses_itself(tmp_path, name):
    robot = load(tmp_path, link("base"), link(name), joint("hinge", "revolute", name))
    state = robot.state(robot.configuration())
    np.testing.assert_allclose(state.placement(robot.point(name)).translation, ORIGIN_XYZ, atol=1e-15)


def test_a_robot_without_joints(tmp_path):
    robot = load(tmp_path, link("base", 3.5))
    assert (robot.nq, robot.nv, robot.n_joints, robot.total_mass) == (7, 6, 0, 3.5)
    assert robot.joint_names == []
    assert robot.leaf_links == ["base"]
    q = robot.configuration()
    assert robot.joint_positions(q) == {}
    state = robot.state(q, np.arange(1.0, 7.0))
    H_b = ospace.joint_space_dynamics(state).base_inertia
    np.testing.assert_allclose(H_b, np.diag([3.5, 3.5, 3.5, 1.0, 1.2, 0.9]), atol=1e-15)
    for method in ("forward", "inverted", "dense"):
        result = ospace.operational_space(state, robot.point("base"), method)
        np.testing.assert_allclose(result.inertia, H_b, atol=1e-14)
    assert ospace.generalized_dynamics(state).generalized_inertia.shape == (0, 0)
    floating = ospace.free_floating(state, robot.point("base"))
    assert floating.rank == 0
    assert not floating.floating_inertia.any()
    assert floating.torque_map.shape == (6, 0)


# -- from a Pinocchio model --------------------------------------------------------------------------------------


def two_branches(*joints, root=None):
    """A model whose joints are given as (name, parent number)."""
    model = pin.Model()
    model.name = "made"
    model.addJoint(0, root or pin.JointModelFreeFlyer(), pin.SE3.Identity(), "floating_base")
    for name, parent in joints:
        model.addJoint(parent, pin.JointModelRY(), pin.SE3(pin.exp3(np.ones(3)), np.ones(3)), name)
    rng = np.random.default_rng(1)
    for j in range(1, model.njoints):
        model.appendBodyToJoint(j, trees.inertia(rng, 2.0), pin.SE3.Identity())
    return model


def with_inertia(j, mass=1.0, lever=(0.0, 0.0, 0.0), tensor=(1.0, 1.0, 1.0)):
    """A chain with joint j's inertia replaced; set part by part, as Pinocchio's constructor refuses some."""
    model = two_branches(("a", 1), ("b", 2))
    inertia = pin.Inertia.Zero()
    inertia.mass, inertia.lever, inertia.inertia = mass, np.array(lever), np.diag(tensor)
    model.inertias[j] = inertia
    return model


@pytest.mark.parametrize(
    "model",
    [
        pin.Model(),
        two_branches(("a", 1), root=pin.JointModelRX()),
        two_branches(("a", 1), ("b", 0)),
        two_branches(("a", 1), root=pin.JointModelPlanar()),
    ],
    ids=["no joint at all", "fixed base", "two roots", "planar base"],
)
def test_a_model_without_one_free_flyer_is_refused(model):
    with pytest.raises(ospace.OspaceError, match="free-flying base"):
        ospace.SpaceRobot.from_model(model)


def test_subtrees_out_of_order_are_refused_because_crba_is_wrong_on_them():
    model = two_branches(("a", 1), ("b", 1), ("below_a", 2))
    data = model.createData()
    rng = np.random.default_rng(2)
    q = pin.integrate(model, pin.neutral(model), rng.normal(size=model.nv))
    model.gravity = pin.Motion.Zero()
    still = np.zeros(model.nv)
    columns = [pin.rnea(model, data, q, still, unit).copy() for unit in np.eye(model.nv)]
    wrong = np.abs(np.triu(pin.crba(model, data, q)) - np.triu(np.array(columns).T)).max()
    assert wrong > 0.1  # should a later Pinocchio get this right, the refusal can go
    with pytest.raises(ospace.OspaceError, match=r"'below_a' is out of order.*'a'"):
        ospace.SpaceRobot.from_model(model)


def test_the_same_subtrees_in_order_are_accepted():
    assert ospace.SpaceRobot.from_model(two_branches(("a", 1), ("below_a", 2), ("b", 1))).n_joints == 3


NAN, INF, NOTHING = np.nan, np.inf, (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("model", "code", "subject"),
    [
        (with_inertia(1, mass=0.0, tensor=NOTHING), "massless-base", "floating_base"),
        (with_inertia(3, mass=0.0, tensor=NOTHING), "massless-subtree", "'b'"),
        (with_inertia(2, mass=-1.0), "negative-mass", "'a'"),
        (with_inertia(1, mass=-1.0), "negative-mass", "floating_base"),
        (with_inertia(2, tensor=(1.0, -0.1, 1.0)), "inertia-indefinite", "'a'"),
        (with_inertia(2, mass=NAN), "inertia-not-finite", "'a'"),
        (with_inertia(2, lever=(0.0, INF, 0.0)), "inertia-not-finite", "'a'"),
        (with_inertia(1, lever=(0.0, 0.0, NAN)), "inertia-not-finite", "floating_base"),
    ],
)
def test_unsound_inertias_are_refused(model, code, subject):
    with pytest.raises(ospace.UnsoundModelError) as caught:
        ospace.SpaceRobot.from_model(model)
    findings = [finding for finding in caught.value.findings if finding.code == code]
    assert [finding.severity for finding in findings] == ["error"]
    assert subject in findings[0].subject
    assert subject in str(caught.value)
    assert findings[0].remedy in str(caught.value)


def test_a_massless_link_between_links_with_mass_is_sound():
    robot = ospace.SpaceRobot.from_model(with_inertia(2, mass=0.0, tensor=NOTHING))
    state = trees.state(robot, 3)
    H = ospace.joint_space_dynamics(state).manipulator_inertia
    assert np.linalg.eigvalsh(H)[0] > 1e-3


# -- configurations by joint name --------------------------------------------------------------------------------

ONE_DOF = [(kind, axis) for kind in ("revolute", "continuous", "prismatic") for axis in AXES]


@pytest.fixture(scope="module")
def all_types(tmp_path_factory):
    """A robot with every joint type that Pinocchio reads from a URDF, all hanging from the base, and a fixed link."""
    parts = [link("base", 10.0), link("welded"), joint("weld", "fixed", "welded")]
    for kind, axis in ONE_DOF:
        parts += [link(f"link_{kind}_{axis}"), joint(f"{kind}_{axis}", kind, f"link_{kind}_{axis}", axis=AXES[axis])]
    for kind in ("planar", "floating"):
        parts += [link(f"link_{kind}"), joint(kind, kind, f"link_{kind}")]
    return load(tmp_path_factory.mktemp("all_types"), *parts)


repeatable = settings(derandomize=True, deadline=None, max_examples=30)
numbers = st.floats(-20.0, 20.0, allow_subnormal=False)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)
poses = st.builds(lambda turn, at: pin.SE3(pin.exp3(0.15 * turn), at), vectors, vectors)
ORIGIN = pin.SE3(pin.rpy.rpyToMatrix(*ORIGIN_RPY), np.array(ORIGIN_XYZ))


def test_random_trees_have_every_joint_type(all_types):
    assert all_types.nv == 6 + len(ONE_DOF) + 3 + 6
    assert all_types.nq == 7 + len(ONE_DOF) + len(AXES) + 4 + 7
    assert "weld" not in all_types.joint_names


@pytest.mark.parametrize(("kind", "axis"), ONE_DOF)
@repeatable
@given(value=numbers, T_WB=poses)
def test_joints_of_one_coordinate_take_angles_and_displacements(all_types, kind, axis, value, T_WB):
    """The value put in comes back, and moves the link along the axis by that much and nothing else."""
    name = f"{kind}_{axis}"
    q = all_types.configuration({name: value}, T_WB)
    positions = all_types.joint_positions(q)
    if kind == "continuous":
        assert abs(positions[name]) <= np.pi
        assert np.remainder(positions[name] - value + np.pi, 2.0 * np.pi) - np.pi == pytest.approx(0.0, abs=1e-13)
    else:
        assert positions[name] == value
    assert all_types.base_pose(q).isApprox(T_WB, 1e-12)

    along = np.array(AXES[axis]) / np.linalg.norm(AXES[axis])
    moved = pin.SE3(np.eye(3), value * along) if kind == "prismatic" else pin.SE3(pin.exp3(value * along), np.zeros(3))
    T_WE = all_types.state(q).placement(all_types.point(f"link_{name}"))
    np.testing.assert_allclose(T_WE.homogeneous, (T_WB * ORIGIN * moved).homogeneous, atol=1e-12)


@repeatable
@given(x=numbers, y=numbers, angle=st.floats(-3.1, 3.1))
def test_a_planar_joint_takes_a_place_and_an_angle(all_types, x, y, angle):
    q = all_types.configuration({"planar": (x, y, angle)})
    np.testing.assert_allclose(all_types.joint_positions(q)["planar"], [x, y, angle], atol=1e-14)
    expected = ORIGIN * pin.SE3(pin.exp3(np.array([0.0, 0.0, angle])), np.array([x, y, 0.0]))
    T_WE = all_types.state(q).placement(all_types.point("link_planar"))
    np.testing.assert_allclose(T_WE.homogeneous, expected.homogeneous, atol=1e-12)


@repeatable
@given(pose=poses)
def test_a_floating_joint_takes_a_pose(all_types, pose):
    q = all_types.configuration({"floating": pose})
    assert all_types.joint_positions(q)["floating"].isApprox(pose, 1e-12)
    T_WE = all_types.state(q).placement(all_types.point("link_floating"))
    np.testing.assert_allclose(T_WE.homogeneous, (ORIGIN * pose).homogeneous, atol=1e-12)


@repeatable
@given(data=st.data())
def test_all_joints_at_once_come_back_each_in_its_place(all_types, data):
    wanted = {f"{kind}_{axis}": data.draw(st.floats(-3.1, 3.1)) for kind, axis in ONE_DOF}
    wanted["planar"] = np.array(data.draw(st.tuples(numbers, numbers, st.floats(-3.1, 3.1))))
    found = all_types.joint_positions(all_types.configuration(wanted))
    for name, value in wanted.items():
        np.testing.assert_allclose(found[name], value, atol=1e-13, err_msg=name)
    assert found["floating"].isIdentity()


@pytest.mark.parametrize("seed", range(3))
def test_random_trees_of_all_joint_types(seed):
    """`configuration(joint_positions(q), base_pose(q))` is q, also for types that no URDF has."""
    robot = trees.tree(seed, 16)
    q = trees.state(robot, seed).q
    again = robot.configuration(robot.joint_positions(q), robot.base_pose(q))
    for j in range(1, robot.model.njoints):
        part = slice(robot.model.idx_qs[j], robot.model.idx_qs[j] + robot.model.nqs[j])
        sign = np.sign(again[part][-1] * q[part][-1]) if robot.model.nqs[j] == 7 else 1.0  # q and −q are one attitude
        turn = slice(3, 7)
        if robot.model.nqs[j] == 7:
            np.testing.assert_allclose(sign * again[part][turn], q[part][turn], atol=1e-12)
        else:
            np.testing.assert_allclose(again[part], q[part], atol=1e-12)


def test_a_configuration_without_arguments_is_zero(all_types):
    np.testing.assert_array_equal(all_types.configuration(), pin.neutral(all_types.model))


def test_unknown_joint_names_the_nearest(all_types):
    with pytest.raises(ospace.OspaceError, match=r"no joint 'revolute_zz'.*did you mean.*'revolute_z'"):
        all_types.configuration({"revolute_zz": 1.0})


@pytest.mark.parametrize("name", ["weld", "root_joint", "universe", "base", "", 3, None])
def test_what_is_no_joint_of_the_robot_is_unknown(all_types, name):
    with pytest.raises(ospace.OspaceError, match="no joint"):
        all_types.configuration({name: 1.0})


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("revolute_z", (1.0, 2.0)),
        ("revolute_z", []),
        ("revolute_z", pin.SE3.Identity()),
        ("revolute_z", "a quarter"),
        ("revolute_z", 1j),
        ("revolute_z", None),
        ("revolute_z", [[1.0], [2.0, 3.0]]),
        ("revolute_z", np.nan),
        ("revolute_z", -np.inf),
        ("continuous_oblique", (0.0, 1.0)),
        ("continuous_oblique", np.inf),
        ("prismatic_x", {"x": 1.0}),
        ("planar", 1.0),
        ("planar", (1.0, 2.0, 1.0, 0.0)),
        ("planar", (1.0, 2.0, np.nan)),
        ("planar", pin.SE3.Identity()),
        ("floating", 1.0),
        ("floating", np.eye(4)),
        ("floating", pin.SE3(np.eye(3), np.array([0.0, np.nan, 0.0]))),
        ("floating", pin.SE3(np.eye(3) * np.nan, np.zeros(3))),
    ],
)
def test_values_of_the_wrong_kind_are_refused_by_joint(all_types, name, value):
    with pytest.raises(ospace.OspaceError, match=name):
        all_types.configuration({name: value})


@pytest.mark.parametrize(
    "T_WB",
    [
        np.eye(4),
        "identity",
        [0.0] * 7,
        pin.SE3(np.eye(3), np.array([np.nan, 0.0, 0.0])),
        pin.SE3(np.eye(3) * np.nan, np.zeros(3)),
        pin.SE3(np.eye(3), np.array([0.0, 0.0, np.inf])),
    ],
    ids=["matrix", "text", "numbers", "NaN place", "NaN attitude", "infinite"],
)
def test_wrong_base_poses_are_refused(all_types, T_WB):
    with pytest.raises(ospace.OspaceError, match="T_WB"):
        all_types.configuration(T_WB=T_WB)


@pytest.mark.parametrize("joints", [["revolute_z"], 1.0, "revolute_z"])
def test_joints_that_are_no_mapping_are_refused(all_types, joints):
    with pytest.raises(ospace.OspaceError, match="joints"):
        all_types.configuration(joints)


@pytest.mark.parametrize("read", ["joint_positions", "base_pose", "outside_limits"])
@pytest.mark.parametrize("q", [[1.0], np.full(7, np.nan), "q", None])
def test_reading_back_checks_q(all_types, read, q):
    with pytest.raises(ospace.OspaceError, match="q"):
        getattr(all_types, read)(q)


# -- limits ------------------------------------------------------------------------------------------------------

RANGES = {
    "about zero": (-1.0, 2.0, 0.0),
    "from zero": (0.0, 2.0, 0.0),
    "above": (0.5, 2.5, 1.5),
    "below": (-3.0, -0.07, -1.535),
    "above, without end": (0.25, 1e9, 0.25),
    "below, without end": (-1e9, -0.25, -0.25),
    "one position": (0.3, 0.3, 0.3),
    "reversed": (1.0, -1.0, 0.0),
}


def within(folder, kind, lower, upper):
    limited = LIMIT.replace('"-1"', f'"{lower!r}"').replace('upper="1"', f'upper="{upper!r}"')
    return load(folder, link("base"), link("arm"), joint("hinge", kind, "arm").replace(LIMIT, limited))


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize("name", RANGES)
def test_neutral_is_inside_the_limits_and_zero_where_they_allow_it(tmp_path, kind, name):
    lower, upper, wanted = RANGES[name]
    robot = within(tmp_path, kind, lower, upper)
    assert robot.joint_positions(robot.neutral())["hinge"] == pytest.approx(wanted)
    assert robot.outside_limits(robot.neutral()) == {}
    assert robot.base_pose(robot.neutral()).isIdentity()


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_outside_limits_tells_the_distance_to_the_limit_that_is_passed(tmp_path, kind):
    robot = within(tmp_path, kind, -0.5, 2.0)
    for value, excess in ((2.25, 0.25), (-0.6, 0.1), (7.0, 5.0)):
        assert robot.outside_limits(robot.configuration({"hinge": value})) == {"hinge": pytest.approx(excess)}
    for value in (-0.5, 2.0, 2.0 + 1e-10, -0.5 - 1e-10, 0.0):
        assert robot.outside_limits(robot.configuration({"hinge": value})) == {}


def test_joints_that_nothing_limits_are_never_outside(all_types):
    far = dict.fromkeys((name for name in all_types.joint_names if name.startswith("continuous")), 3.0)
    far |= {name: (50.0, -50.0, 3.0) for name in all_types.joint_names if name.startswith("planar")}
    far |= {name: pin.SE3.Random() for name in all_types.joint_names if name.startswith("floating")}
    assert far
    assert all_types.outside_limits(all_types.configuration(far)) == {}


@pytest.mark.parametrize("seed", range(3))
def test_limits_of_all_joint_types_are_kept_apart(seed):
    """Each joint is pushed beyond a limit alone, along the coordinates that Pinocchio bounds and that add up."""
    robot = trees.tree(seed, 14)
    model = robot.model
    pushed = 0
    for j in range(2, model.njoints):
        for k in range(model.idx_qs[j], model.idx_qs[j] + model.nqs[j]):
            if model.nqs[j] == model.nvs[j] or (
                model.joints[j].shortname() == "JointModelPlanar" and k < model.idx_qs[j] + 2
            ):
                model.lowerPositionLimit[k], model.upperPositionLimit[k] = 0.5, 0.75
                q = robot.neutral()
                assert robot.outside_limits(q) == {}
                assert pin.isNormalized(model, q)
                q[k] = 1.0
                assert robot.outside_limits(q) == {model.names[j]: 0.25}
                pushed += 1
    assert pushed > 8


def test_limits_are_those_the_model_has_now(tmp_path):
    robot = within(tmp_path, "revolute", -1.0, 1.0)
    q = robot.configuration({"hinge": 0.9})
    assert robot.outside_limits(q) == {}
    robot.model.upperPositionLimit[7] = 0.8
    assert robot.outside_limits(q) == {"hinge": pytest.approx(0.1)}


def test_excess_is_written_in_the_unit_of_the_joint(tmp_path):
    turning, sliding = (within(tmp_path, kind, -1.0, 1.0).model for kind in ("revolute", "prismatic"))
    assert joint_positions.excess_text(turning, {"hinge": np.deg2rad(4.0)}) == "'hinge' by 0.0698 rad (4 deg)"
    assert joint_positions.excess_text(sliding, {"hinge": 0.02}) == "'hinge' by 0.02 m"


def test_many_configurations_are_those_built_one_by_one():
    robot = trees.tree(2, 4, ("revolute", "continuous", "prismatic", "planar"))
    rng, T_WB = np.random.default_rng(0), pin.SE3.Random()
    revolute, continuous, prismatic, _ = robot.joint_names
    values = {revolute: rng.normal(size=7), continuous: rng.normal(size=7), prismatic: 0.3}
    Q = robot.configurations(values, T_WB)
    for k in range(7):
        row = {revolute: values[revolute][k], continuous: values[continuous][k], prismatic: 0.3}
        np.testing.assert_allclose(Q[k], robot.configuration(row, T_WB), atol=1e-15)
    assert robot.configurations({}).shape == (1, robot.nq)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ({"joint_9": [0.1]}, "no joint 'joint_9'"),
        ({"joint_3": [0.1]}, "'joint_3' has 3 degrees of freedom"),
        ({"joint_0": [0.1, 0.2], "joint_2": [0.1]}, "arrays of one length"),
        ({"joint_0": [[0.1]]}, "arrays of one length"),
        ({"joint_0": [np.nan]}, "positions of joint 'joint_0'"),
        ([0.1], "give a mapping"),
    ],
)
def test_configurations_that_make_no_sense_are_refused(joints, message):
    robot = trees.tree(2, 4, ("revolute", "continuous", "prismatic", "planar"))
    with pytest.raises(ospace.OspaceError, match=message):
        robot.configurations(joints)

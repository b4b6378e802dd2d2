"""A scene refuses what it cannot show, and shows something for whatever it takes."""

import base64
import gzip
import html
import json
import os
import re
import struct
from types import SimpleNamespace
from xml.sax import saxutils

import numpy as np
import pinocchio as pin
import pytest
import trees
import umsgpack

from ospace import SpaceRobot, models
from ospace.exceptions import OspaceError
from ospace.visual import Scene
from ospace.visual.animation import ERROR
from ospace.visual.overlays import align_axes
from ospace.visual.scene import LAYERS, SHOWN

BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
BOX = '<visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual>'


@pytest.fixture(scope="module")
def robot():
    return SpaceRobot.from_urdf(models.path("planar_2r"))


def commands(scene):
    """Return the commands of the page as it is written."""
    found = re.search(r'<script type="application/json" id="scene-data">(.*?)</script>', scene.html(), re.DOTALL)
    packed, kept = gzip.decompress(base64.b64decode(json.loads(found[1])["commands"])), []
    while packed:
        (length,) = struct.unpack("<I", packed[:4])
        kept.append(umsgpack.unpackb(packed[4 : 4 + length]))
        packed = packed[4 + length :]
    return kept


def objects(scene):
    return [one["path"] for one in commands(scene) if one["type"] == "set_object"]


def transforms(scene):
    return {
        one["path"]: np.array(one["matrix"]).reshape(4, 4).T
        for one in commands(scene)
        if one["type"] == "set_transform"
    }


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"show": ["robots"]}, r"layer 'robots' is unknown; did you mean 'robot'"),
        ({"show": "robot"}, r"layer 'r' is unknown"),
        ({"show": [""]}, r"layer '' is unknown"),
        ({"background": "white"}, r"background 'white': choose from space, paper"),
    ],
)
def test_a_scene_refuses_what_it_cannot_show(robot, options, words):
    with pytest.raises(OspaceError, match=words):
        Scene(robot, **options)


def test_points_of_another_robot_are_refused_by_a_scene(robot):
    other = SpaceRobot.from_urdf(models.path("chaser_7dof"))
    with pytest.raises(OspaceError, match="robot"):
        Scene(robot, [other.point(other.leaf_links[0])])


@pytest.mark.parametrize(
    ("q", "v"),
    [
        (np.zeros(3), None),
        (np.r_[np.zeros(7), 0.0, 0.0], None),  # no quaternion
        ([0, 0, 0, 0, 0, 0, 1, np.nan, 0], None),
        ([0, 0, 0, 0, 0, 0, 1, 0, 0], np.zeros(3)),
        ([0, 0, 0, 0, 0, 0, 1, 0, 0], np.full(8, np.inf)),
        ("home", None),
    ],
)
def test_what_is_no_state_of_the_robot_is_refused(robot, q, v):
    scene = Scene(robot)
    before = commands(scene)
    with pytest.raises(OspaceError):
        scene.display(q, v)
    assert commands(scene) == before


def test_configurations_of_other_robots_are_refused(robot):
    scene = Scene(robot)
    target = SpaceRobot.from_urdf(models.path("target"))
    with pytest.raises(OspaceError, match="1 configurations of others: there are 0"):
        scene.display(robot.configuration(), others=[target.configuration()])
    scene.add(target)
    with pytest.raises(OspaceError):
        scene.display(robot.configuration(), others=[robot.configuration()])
    q = target.configuration(T_WB=pin.SE3(np.eye(3), np.array([1.0, 2.0, 3.0])))
    scene.display(robot.configuration(), others=[q])
    np.testing.assert_allclose(transforms(scene)[f"/robots/1 {target.name}/base"][:3, 3], [1.0, 2.0, 3.0], atol=1e-12)
    scene.display(robot.configuration({"joint_1": 0.1}))  # without it, it stays
    np.testing.assert_allclose(transforms(scene)[f"/robots/1 {target.name}/base"][:3, 3], [1.0, 2.0, 3.0], atol=1e-12)


def test_where_the_base_is_first_is_where_it_is_seen_from(robot):
    scene = Scene(robot)
    q = robot.configuration(T_WB=pin.SE3(pin.exp3(np.array([0.1, 0.2, 0.3])), np.array([7e6, 1.0, 2.0])))
    scene.display(q)
    np.testing.assert_array_equal(scene.frame.origin, q[:3])
    base = transforms(scene)["/robots/0 planar_2r/base"]
    np.testing.assert_allclose(base[:3, :3], pin.exp3(np.array([0.1, 0.2, 0.3])), atol=1e-12)
    np.testing.assert_array_equal(base[:3, 3], 0.0)
    q[0] += 0.5
    scene.display(q)
    np.testing.assert_array_equal(transforms(scene)["/robots/0 planar_2r/base"][:3, 3], [0.5, 0.0, 0.0])
    assert q[0] == 7e6 + 0.5  # what is the caller's stays


def test_a_scene_has_its_layers(robot):
    content = Scene(robot).content()
    assert [layer.name for layer in content.layers] == list(LAYERS)
    assert {layer.name for layer in content.layers if layer.shown} == set(SHOWN)
    assert {layer.name for layer in Scene(robot, show=[]).content().layers if layer.shown} == set()
    paths = [path for layer in content.layers for path in layer.paths]
    assert len(paths) == len(set(paths))
    above = [path for path in paths if not any(one.startswith(f"{path}/") for one in objects(Scene(robot)))]
    assert above == []  # every one has something to show


def test_at_most_eight_points_by_default():
    robot = trees.tree(2, 30, branching=0.9)
    assert len(robot.leaf_links) > 8
    assert sum(label.layer == "points" for label in Scene(robot).content().labels) == 8
    assert sum(label.layer == "points" for label in Scene(robot, []).content().labels) == 0


def test_the_same_scene_is_the_same_but_for_names_of_objects(robot):
    one, other = ([(c["type"], c["path"]) for c in commands(Scene(robot)) if "path" in c] for _ in range(2))
    assert one == other


def test_a_missing_mesh_is_reported_and_stands_as_a_box(tmp_path):
    file = tmp_path / "robot.urdf"
    mesh = '<visual><geometry><mesh filename="nowhere.stl"/></geometry></visual>'
    broken = '<visual><geometry><mesh filename="broken.stl"/></geometry></visual>'
    file.write_text(
        f'<robot name="r"><link name="base">{BODY}{mesh}</link><link name="arm">{BODY}{broken}{BOX}</link>'
        '<joint name="j" type="continuous"><parent link="base"/><child link="arm"/></joint></robot>'
    )
    (tmp_path / "broken.stl").write_bytes(b"solid broken\nfacet")
    scene = Scene(SpaceRobot.from_urdf(file))
    assert [(finding.code, finding.subject) for finding in scene.findings] == [
        ("mesh-missing", "link 'base'"),
        ("mesh-unreadable", "link 'arm'"),
    ]
    shown = objects(scene)
    assert "/robots/0 r/base/robot/link base/inertia box" in shown
    assert "/robots/0 r/joint j/robot/link arm/inertia box" in shown
    assert "/robots/0 r/joint j/robot/link arm/visual 1" in shown
    page = scene.html()
    assert "nowhere.stl" in page
    assert str(scene.findings[0]) in page.replace("&#39;", "'")


@pytest.mark.parametrize("address", ["../../secret.stl", "file://{}/secret.stl", "{}/secret.stl"])
def test_a_mesh_outside_is_not_opened(tmp_path, address):
    file = tmp_path / "robot" / "urdf" / "robot.urdf"
    file.parent.mkdir(parents=True)
    (tmp_path / "secret.stl").write_bytes(b"\x00" * 84)
    mesh = f'<visual><geometry><mesh filename="{address.format(tmp_path)}"/></geometry></visual>'
    file.write_text(f'<robot name="r"><link name="base">{BODY}{mesh}</link></robot>')
    assert [finding.code for finding in Scene(SpaceRobot.from_urdf(file)).findings] == ["mesh-outside"]


@pytest.mark.parametrize("name", ["a/b", "__proto__", "constructor", "<b>", "<object>", "a//", "/", "%2F", "..", "ü"])
def test_points_with_any_name_are_shown(tmp_path, name):
    """Each is one node by itself, below the one that it belongs to."""
    file, quoted = tmp_path / "odd.urdf", saxutils.quoteattr(name)
    file.write_text(
        f"<robot name={quoted}><link name='base'>{BODY}{BOX}</link><link name={quoted}>{BODY}{BOX}</link>"
        f"<joint name={quoted} type='continuous'><parent link='base'/><child link={quoted}/></joint></robot>",
        encoding="utf-8",
    )
    robot = SpaceRobot.from_urdf(file)
    scene = Scene(robot, [robot.point(name)])
    mine = [path for path in objects(scene) if path.startswith("/robots/") and "/visual 0" in path]
    assert len(mine) == 2
    assert {path.count("/") for path in mine} == {6}
    assert not any("<object>" in path for path in mine)
    page = scene.html()
    assert f"<h1>{name}</h1>" in page or name not in page.split("<main>")[0]
    assert scene.content().labels[0].text == name


def test_a_robot_without_a_description_is_drawn_by_its_inertias():
    """Made from a Pinocchio model: boxes of its inertias stand for its links."""
    robot = trees.tree(5, 6)
    scene = Scene(robot)
    assert scene.findings == []
    shown = objects(scene)
    assert sum("inertia box" in path for path in shown) == 7
    assert sum("/inertia/link" in path for path in shown) == 7
    assert "collision" not in [layer.name for layer in scene.content().layers]
    scene.display(trees.state(robot, 1).q)


def test_links_without_mass_and_single_bodies_are_drawn():
    """A base alone, and bodies without mass: nothing to draw is no mistake."""
    model = pin.Model()
    model.name = "alone"
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia.FromBox(2.0, 0.1, 0.2, 0.3), pin.SE3.Identity())
    model.addBodyFrame("base", root, pin.SE3.Identity(), 0)
    robot = SpaceRobot.from_model(model)
    scene = Scene(robot)
    boxes = [path for path in objects(scene) if "inertia box" in path]
    assert boxes == ["/robots/0 alone/base/robot/link root_joint/inertia box"]
    scene.display(robot.configuration(), np.r_[1.0, np.zeros(5)])


def test_a_box_of_the_same_inertia_stands_for_a_body():
    """What stands for a link is as large as the uniform box of its mass and moments."""
    model = pin.Model()
    model.name = "box"
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(root, pin.Inertia.FromBox(3.0, 0.2, 0.4, 0.6), pin.SE3.Identity())
    model.addBodyFrame("base", root, pin.SE3.Identity(), 0)
    made = next(
        one["object"]["geometries"][0]
        for one in commands(Scene(SpaceRobot.from_model(model)))
        if one["type"] == "set_object" and "inertia box" in one["path"]
    )
    assert sorted([made["width"], made["height"], made["depth"]]) == pytest.approx([0.2, 0.4, 0.6])


def test_a_page_allows_no_connection_and_is_sandboxed_in_a_notebook(robot, tmp_path):
    scene = Scene(robot)
    file = scene.save_html(tmp_path / "scene.html")
    page = file.read_text(encoding="utf-8")
    assert page == scene.html()
    head = page.split("<script")[0]
    assert "default-src 'none'" in head
    assert "connect-src 'none'" in html.unescape(head)
    assert scene._repr_html_().startswith("<iframe srcdoc=")
    assert 'sandbox="allow-scripts"' in scene._repr_html_()


def test_an_unknown_name_of_the_visual_package_is_an_attribute_error():
    import ospace.visual

    with pytest.raises(AttributeError, match="no attribute 'Scenery'"):
        _ = ospace.visual.Scenery


def motion_of(robot, **changed):
    time = np.array([0.0, 0.5, 1.0])
    q = np.tile(robot.configuration(), (3, 1))
    return SimpleNamespace(**({"time": time, "q": q, "v": np.zeros((3, robot.nv))} | changed))


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("time", [0.0, 1.0], "the motion is not of"),
        ("time", [0.0, 0.5, 0.5], "time does not increase at record 2, 0.5 s"),
        ("time", [1.0, 0.5, 0.0], "time does not increase at record 1"),
        ("time", [0.0, 0.5, np.inf], "time is not finite in record 2"),
        ("time", "now", "give an object with arrays"),
        ("q", np.full((3, 9), np.nan), "q is not finite in record 0"),
        ("q", np.zeros((3, 9)), "is not of unit length"),
        ("q", np.zeros((3, 8)), "the motion is not of"),
        ("v", np.full((3, 8), np.inf), "v is not finite in record 0"),
        ("v", np.zeros(3), "the motion is not of"),
    ],
)
def test_an_invalid_motion_is_refused(robot, name, value, words):
    scene = Scene(robot)
    before = list(scene.meshcat_scene.commands())
    with pytest.raises(OspaceError, match=words):
        scene.animate(motion_of(robot, **{name: value}))
    assert list(scene.meshcat_scene.commands()) == before  # nothing is half done


def test_a_missing_motion_is_refused(robot):
    with pytest.raises(OspaceError, match="give an object with arrays time, q and v"):
        Scene(robot).animate(np.zeros((3, 9)))
    with pytest.raises(OspaceError, match="has 1 record: it takes two to move"):
        Scene(robot).animate(SimpleNamespace(time=[0.0], q=[robot.configuration()], v=np.zeros((1, robot.nv))))
    with pytest.raises(OspaceError, match="one motion for each of the 1 robots"):
        Scene(robot).animate()


def test_an_animation_lasts_as_long_as_its_motion(robot):
    scene = Scene(robot)
    scene.animate(motion_of(robot, time=np.arange(3.0)))
    assert scene.duration == 2.0
    assert scene.error <= 2.0 * ERROR


def test_a_displayed_state_replaces_the_animation(robot):
    scene = Scene(robot)
    scene.animate(motion_of(robot))
    assert scene.duration == 1.0
    scene.display(robot.configuration({"joint_1": 0.3}))
    assert (scene.duration, scene.error) == (0.0, 0.0)
    assert [one["animations"] for one in commands(scene) if one["type"] == "set_animation"] == [[]]


def test_collision_shapes_are_shown_where_there_are_no_others(tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text(f'<robot name="r"><link name="base">{BODY}{BOX.replace("visual", "collision")}</link></robot>')
    shown = {layer.name for layer in Scene(SpaceRobot.from_urdf(file)).content().layers if layer.shown}
    assert "collision" in shown


def test_a_mesh_that_changes_is_read_again(tmp_path):
    file, mesh = tmp_path / "robot.urdf", tmp_path / "shape.obj"
    visual = '<visual><geometry><mesh filename="shape.obj"/></geometry></visual>'
    file.write_text(f'<robot name="r"><link name="base">{BODY}{visual}</link></robot>')
    robot = SpaceRobot.from_urdf(file)
    for width in (1.0, 3.0):
        mesh.write_text(f"v 0 0 0\nv {width} 0 0\nv 0 1 0\nf 1 2 3\n")
        os.utime(mesh, ns=(0, int(width)))
        scene = Scene(robot)
        assert np.ptp(scene._robots[0].corners(robot.configuration())[:, 0]) == pytest.approx(width)


def test_arrows_of_momentum_have_one_scale_for_a_motion(robot):
    """The largest is as long as all, whenever it comes, and the legend says how long."""
    scene = Scene(robot)
    time = np.linspace(0.0, 1.0, 21)
    v = np.zeros((21, robot.nv))
    v[:, 6] = time
    scene.animate(SimpleNamespace(time=time, q=np.tile(robot.configuration(), (21, 1)), v=v))
    momentum = next(one for one in scene._overlays if one.name == "momentum")
    lengths = []
    for rate in (0.25, 0.5, 1.0):
        state = robot.state(robot.configuration(), [0.0] * 6 + [rate, 0.0])
        places = dict(momentum.place(state))
        lengths.append(np.linalg.norm(places["/quantities/angular whole"][:3, 2]))
        assert lengths[-1] * float(re.search(r"angular, (\S+) kg", momentum.legend)[1]) == pytest.approx(
            np.linalg.norm(about_mass_centre(state)), rel=0.05
        )
    np.testing.assert_allclose(lengths, np.array([0.25, 0.5, 1.0]) * momentum._length, rtol=1e-9)


def about_mass_centre(state):
    data = state.robot.model.createData()
    return pin.computeCentroidalMomentum(state.robot.model, data, state.q, state.v).angular


def test_ellipsoids_turn_no_further_than_they_must():
    """Whatever order and signs the axes of an ellipsoid come with."""
    rng = np.random.default_rng(4)
    places = []
    for t in np.linspace(0.0, 2.0, 200):
        axes = pin.exp3(np.array([0.3, 0.5, -0.2]) * t) * [3.0, 2.0, 1.0]
        axes = axes[:, rng.permutation(3)] * rng.choice([-1.0, 1.0], 3)
        places.append(np.block([[axes * np.sign(np.linalg.det(axes)), np.zeros((3, 1))], [np.zeros(3), 1.0]]))
    found = align_axes(places)
    for before, after, given in zip(found, found[1:], places[1:], strict=False):
        turns = [one[:3, :3] / np.linalg.norm(one[:3, :3], axis=0) for one in (before, after)]
        assert np.linalg.norm(pin.log3(turns[0].T @ turns[1])) < 0.01
        np.testing.assert_allclose(after @ after.T, given @ given.T, atol=1e-12)  # the same ellipsoid

"""What `ospace.compose` takes out of a part, and where the rest stands: stands, hands, worlds, floating joints."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree
from urdf.corpus.parts import AXIS, LIMIT, inertial, joint, link, robot

import ospace
from ospace import OspaceError, Part, UrdfError, compose
from ospace.urdf import reader

BUS = "box:1x1x1m,100kg"
STAND = (
    link("table"),
    link("lamp"),
    link("base"),
    link("arm"),
    link("hand"),
    joint("screw", "fixed", "table", "lamp", ""),
    joint("bolt", "fixed", "table", "base", "", "0 0 0.8"),
    joint("hinge", "revolute", "base", "arm"),
    joint("wrist", "revolute", "arm", "hand"),
)
OTHERS = (
    '<gazebo reference="table"/><gazebo reference="hand"/><gazebo reference="wrist"/><gazebo/>'
    '<transmission name="t"><joint name="wrist"/></transmission>'
    '<ros2_control name="c"><joint name="hinge"/><joint name="wrist"/></ros2_control>'
)


@pytest.fixture
def file(tmp_path):
    def write(*parts, name="arm.urdf"):
        (tmp_path / name).write_text(robot(*parts))
        return tmp_path / name

    return write


def tree(composition):
    return etree.fromstring(composition.content)


def names(composition, tag="link"):
    return tree(composition).xpath(f"{tag}/@name")


def place(composition, link):
    """Placement of a link in the base's frame, joints at zero, as Pinocchio has it."""
    model = pin.buildModelFromXML(composition.content.decode())
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    return data.oMf[model.getFrameId(link, pin.FrameType.BODY)]


def test_a_hand_goes_with_what_other_programs_have_for_it(file):
    composed = compose(Part(file(*STAND, OTHERS), remove=("hand",)))
    assert names(composed) == ["table", "lamp", "base", "arm"]
    assert names(composed, "joint") == ["screw", "bolt", "hinge"]
    assert tree(composed).xpath("gazebo/@reference") == ["table"]
    assert len(tree(composed).findall("gazebo")) == 2
    assert tree(composed).find("transmission") is None
    assert tree(composed).xpath("ros2_control/joint/@name") == ["hinge"]
    assert composed.parts[0].removed == ("hand",)


def test_a_link_goes_with_all_that_it_carries(file):
    composed = compose(Part(file(*STAND), remove=("base",)))
    assert names(composed) == ["table", "lamp"]
    assert composed.parts[0].removed == ("base", "arm", "hand")


ZEROS = inertial(mass="0", moments=("0", "0", "0"), origin="0 0 0")


@pytest.mark.parametrize("world", [None, "", ZEROS])
def test_a_stand_goes_with_what_is_fixed_to_it_and_the_arm_stands_where_it_is_put(file, world):
    ground = () if world is None else (link("world", world), joint("ground", "fixed", "world", "table", ""))
    composed = compose(BUS, Part(file(*ground, *STAND), remove="table", at=(0.1, 0.2, 0.3), prefix="l_"))
    assert names(composed) == ["bus", "l_base", "l_arm", "l_hand"]
    assert set(composed.parts[1].removed) == {"table", "lamp"} | ({"world"} if ground else set())
    np.testing.assert_allclose(place(composed, "l_base").translation, [0.1, 0.2, 0.3], atol=1e-15)


def test_a_floor_with_mass_below_a_stand_is_removed_first(file):
    floor = (link("floor"), joint("ground", "fixed", "floor", "table", ""))
    composed = compose(BUS, Part(file(*floor, *STAND), remove=("floor", "table")))
    assert names(composed) == ["bus", "base", "arm", "hand"]


@pytest.mark.parametrize(
    ("parts", "remove", "words"),
    [
        (STAND, "tabel", "arm.urdf: there is no link 'tabel' to remove; did you mean 'table'"),
        (STAND[1:2], "lamp", "without link 'lamp' there would be nothing"),
        ((link("base"), link("arm"), joint("hinge")), "base", "link 'base' carries the moving joint 'hinge'"),
        (
            (
                *map(link, "tabcd"),
                *(joint(end, "fixed", "t", end, "") for end in "ab"),
                joint("3", "revolute", "a", "c"),
                joint("4", "revolute", "b", "d"),
            ),
            "t",
            "without link 't' there would be the parts 'a', 'b'",
        ),
        (
            (*STAND, link("thumb"), joint("grip", "revolute", "arm", "thumb", AXIS + LIMIT + '<mimic joint="wrist"/>')),
            "hand",
            "joint 'grip' mimics 'wrist', which would be removed",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_removed_is_refused_by_name(file, parts, remove, words):
    with pytest.raises(OspaceError, match=words):
        compose(BUS, Part(file(*parts), remove=(remove,)))


# -- the world -----------------------------------------------------------------------------------------------------

ARM = (link("base"), link("arm"), joint("hinge"))
AT, RPY = (0.5, -0.2, 0.1), (0.3, -1.2, 2.0)


def on_world(origin='<origin xyz="0.1 0 0.2" rpy="0.4 0.5 -0.6"/>', kind="fixed", more=""):
    ends = f'<parent link="world"/><child link="base"/>{origin}{more}'
    return (link("world", ""), f'<joint name="ground" type="{kind}">{ends}</joint>', *ARM)


@pytest.mark.parametrize("origin", ['<origin xyz="0.1 0 0.2" rpy="0.4 0.5 -0.6"/>', '<origin xyz="0 0 1"/>', ""])
@pytest.mark.parametrize("rpy", [RPY, (0.0, np.pi / 2, 0.3), (0.0, 0.0, 0.0)])
def test_an_arm_stands_on_the_bus_as_it_stood_on_its_world(file, origin, rpy):
    plain = file(*on_world(origin))
    composed = compose(BUS, Part(plain, at=AT, rpy=rpy, prefix="l_"))
    assert names(composed) == ["bus", "l_base", "l_arm"]
    assert names(composed, "joint") == ["l_ground", "l_hinge"]
    expected = pin.SE3(pin.rpy.rpyToMatrix(*rpy), np.array(AT)) * place_in_world(plain, "arm")
    np.testing.assert_allclose(place(composed, "l_arm").homogeneous, expected.homogeneous, atol=1e-14)


def place_in_world(path, name):
    model = pin.buildModelFromUrdf(str(path))
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    return data.oMf[model.getFrameId(name, pin.FrameType.BODY)]


def test_a_rail_on_the_world_becomes_a_rail_on_the_bus(file):
    rail = file(*on_world(kind="prismatic", more=AXIS + LIMIT))
    composed = compose(BUS, Part(rail, at=AT, rpy=RPY))
    joint = tree(composed).find("joint[@name='ground']")
    assert (joint.get("type"), joint.find("parent").get("link")) == ("prismatic", "bus")
    expected = pin.SE3(pin.rpy.rpyToMatrix(*RPY), np.array(AT)) * place_in_world(rail, "arm")
    np.testing.assert_allclose(place(composed, "arm").homogeneous, expected.homogeneous, atol=1e-14)


@pytest.mark.parametrize("root", ["world", "odom"])
def test_an_arm_that_floats_in_its_file_is_fixed_to_the_bus(file, root):
    parts = [text.replace("world", root) for text in on_world(kind="floating")]
    composed = compose(BUS, Part(file(*parts), at=AT, rpy=RPY, prefix="l_"))
    assert names(composed) == ["bus", "l_base", "l_arm"]
    assert [finding.code for finding in composed.findings if finding.severity != "info"] == []
    expected = pin.SE3(pin.rpy.rpyToMatrix(*RPY), np.array(AT))
    np.testing.assert_allclose(place(composed, "l_base").homogeneous, expected.homogeneous, atol=1e-15)
    assert composed.parts[1].removed == (root,)


def test_a_world_with_shapes_or_mass_stays(file):
    for content in ('<visual><geometry><box size="9 9 1"/></geometry></visual>', None):
        parts = (link("world", content), *on_world()[1:])
        assert "l_world" in names(compose(BUS, Part(file(*parts), prefix="l_")))


@pytest.mark.parametrize("kind", ["fixed", "floating"])
def test_arms_stand_on_the_base_of_a_bus_that_has_a_world(file, tmp_path, kind):
    bus = file(*on_world(kind=kind), name="bus.urdf")
    arm = file(link("foot"), link("lever"), joint("knee", "revolute", "foot", "lever"))
    out = tmp_path / "out.urdf"
    composed = compose(bus, Part(arm, at=AT), out=out)
    assert composed.base == "base"
    mount = tree(composed).find("joint[@name='foot_mount']")
    assert mount.find("parent").get("link") == "base"
    assert {finding.severity for finding in composed.findings} <= {"info"}
    assert ospace.SpaceRobot.from_urdf(out).joint_names == ["knee", "hinge"]


# -- what is no tree, or no one robot ------------------------------------------------------------------------------

TWO = (
    link("world", ""),
    *map(link, "ab"),
    *(joint(f"to_{name}", "floating", "world", name, "") for name in "ab"),
)


def test_of_two_free_bodies_one_must_be_removed(file):
    with pytest.raises(UrdfError, match=r"arm.urdf: .*holds 2 free bodies, 'a', 'b'"):
        compose(BUS, file(*TWO))
    composed = compose(BUS, Part(file(*TWO), remove="b", at=(1, 0, 0)))
    assert names(composed) == ["bus", "a"]
    assert names(composed, "joint") == ["a_mount"]


@pytest.mark.parametrize("prefix", ["", "l_"])
def test_a_loop_is_kept_in_the_file_and_reported_of_its_part(file, prefix):
    loop = file(*ARM, link("rod"), joint("a", "revolute", "base", "rod"), joint("b", "revolute", "arm", "rod"))
    composed = compose(BUS, Part(loop, prefix=prefix))
    assert f"{prefix}b" in names(composed, "joint")
    (finding,) = [one for one in composed.findings if one.severity == "warning"]
    assert finding.code == reader.read(loop).findings[0].code
    assert composed.part_of(finding) is composed.parts[1]
    gone = compose(BUS, Part(loop, prefix=prefix, remove="rod"))
    assert names(gone, "joint") == [f"{prefix}hinge", f"{prefix}base_mount"]


def test_a_loop_through_the_world_goes_through_the_bus(file):
    loop = file(*on_world(), joint("strut", "revolute", "world", "arm"))
    composed = compose(BUS, Part(loop, at=AT, rpy=RPY))
    ends = {one.get("name"): one.find("parent").get("link") for one in tree(composed).iterfind("joint")}
    assert ends == {"ground": "bus", "hinge": "base", "strut": "bus"}
    assert [one.severity for one in composed.findings if one.severity != "info"] == ["warning"]

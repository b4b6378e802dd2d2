"""Names, meshes, materials and comments of parts in the file that `ospace.compose` writes."""

from __future__ import annotations

import os

import pytest
from lxml import etree
from urdf.corpus.parts import AXIS, BOX, LIMIT, inertial, joint, link, robot

import ospace
from ospace import OspaceError, Part, compose

FOREIGN = """
<transmission name="drive"><type>hinge</type><joint name="hinge"><hardwareInterface>hinge</hardwareInterface></joint>
  <actuator name="motor"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>
<gazebo reference="arm"><material>Gazebo/Grey</material><plugin name="arm" filename="arm">
  <bodyName> arm </bodyName><joints>hinge, 7</joints><count>7</count><list>hinge arm elsewhere</list></plugin></gazebo>
<group name="both"><chain base_link="base" tip_link="arm"/><joint name="7"/></group>
<group_state name="home" group="both"><joint name="hinge" value="7"/></group_state>
<disable_collisions link1="base" link2="arm" reason="Adjacent"/>
<ros2_control name="system" type="system"><joint name="hinge"><command_interface name="hinge"/></joint>
  <sensor name="force"><param name="frame_id">arm</param></sensor></ros2_control>
"""
MIMIC = joint("7", "continuous", "arm", "finger", AXIS + '<mimic joint="hinge" multiplier="2"/>')
ARM = robot(link("base"), link("arm"), link("finger"), joint(), MIMIC, FOREIGN)


@pytest.fixture
def file(tmp_path):
    """Write a file into a folder of its own."""

    def write(content, name="arm.urdf", folder="parts"):
        path = tmp_path / folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(content)
        return path

    return write


def tree(composition):
    return etree.fromstring(composition.content)


def test_a_prefix_reaches_every_name_of_the_robot_and_no_other_word(file):
    composed = tree(compose("box:1x1x1m,100kg", Part(file(ARM), prefix="l_")))
    assert composed.xpath("link/@name") == ["bus", "l_base", "l_arm", "l_finger"]
    assert composed.xpath("joint/@name") == ["l_hinge", "l_7", "l_base_mount"]
    assert composed.xpath("joint/*/@link") == ["l_base", "l_arm", "l_arm", "l_finger", "bus", "l_base"]
    assert composed.xpath("joint/mimic/@joint") == ["l_hinge"]
    drive = composed.find("transmission")
    assert drive.get("name") == "l_drive"
    assert drive.find("joint").get("name") == "l_hinge"
    assert drive.find("actuator").get("name") == "l_motor"
    assert (drive.findtext("type"), drive.findtext("joint/hardwareInterface")) == ("hinge", "hinge")
    gazebo = composed.find("gazebo")
    assert gazebo.get("reference") == "l_arm"
    assert gazebo.findtext("material") == "Gazebo/Grey"
    assert dict(gazebo.find("plugin").attrib) == {"name": "arm", "filename": "arm"}
    assert gazebo.findtext("plugin/bodyName") == " l_arm "
    assert gazebo.findtext("plugin/joints") == "hinge, 7"  # 7 may as well be a number
    assert gazebo.findtext("plugin/count") == "7"
    assert gazebo.findtext("plugin/list") == "hinge arm elsewhere"
    assert dict(composed.find("group/chain").attrib) == {"base_link": "l_base", "tip_link": "l_arm"}
    assert composed.find("group/joint").get("name") == "l_7"
    assert dict(composed.find("group_state").attrib) == {"name": "l_home", "group": "l_both"}
    assert dict(composed.find("group_state/joint").attrib) == {"name": "l_hinge", "value": "7"}
    assert dict(composed.find("disable_collisions").attrib) == {
        "link1": "l_base", "link2": "l_arm", "reason": "Adjacent"}  # fmt: skip
    control = composed.find("ros2_control")
    assert dict(control.attrib) == {"name": "l_system", "type": "system"}
    assert control.find("joint/command_interface").get("name") == "hinge"
    assert control.find("sensor").get("name") == "l_force"
    assert control.findtext("sensor/param") == "l_arm"


def test_a_list_of_names_is_prefixed_one_by_one(file):
    plugin = "<gazebo><plugin><joints>hinge, arm\n base</joints></plugin></gazebo>"
    composed = tree(compose(Part(file(robot(link("base"), link("arm"), joint(), plugin)), prefix="a-")))
    assert composed.findtext("gazebo/plugin/joints") == "a-hinge, a-arm\n a-base"


def test_without_a_prefix_nothing_changes_but_where_it_stands(file):
    plain = file(ARM)
    composed = tree(compose(plain))
    original = etree.parse(plain).getroot()
    texts = [
        [etree.tostring(one, with_tail=False) for one in root if isinstance(one.tag, str)]
        for root in (composed, original)
    ]
    assert texts[0] == texts[1]


def test_comments_unknown_elements_and_digits_of_a_part_are_kept(file):
    before = "<!-- Licence: mine -->\n"
    inside = '<!-- measured --><odd xmlns:x="urn:x" x:key="1.50"><x:deep/></odd>'
    content = robot(
        link("base", inertial(mass="2.500")),
        "<!-- inside -->",
        link("arm", more=inside),
        joint(more=f"{AXIS}{LIMIT}<?keep me?>"),
    )
    arm = file(content.replace("<robot", f"{before}<robot") + "<!-- behind -->\n")
    text = compose("box:1x1x1m,100kg", Part(arm, prefix="l_")).content.decode()
    for kept in ("<!-- Licence: mine -->", "<!-- measured -->", "<!-- inside -->", "<!-- behind -->", 'value="2.500"',
                 '<odd xmlns:x="urn:x" x:key="1.50"><x:deep/></odd>', "<?keep me?>"):  # fmt: skip
        assert kept in text


def test_a_comment_says_where_each_part_comes_from(file):
    arm = file(ARM, name="a--b-.urdf")
    composed = compose("box:1x1x1m,100kg", Part(arm, at=(1, 0, 0), prefix="l_"))
    comments = [one.text.strip() for one in tree(composed) if isinstance(one, etree._Comment)]
    assert comments[0] == "'bus' of box:1x1x1m,100kg"
    assert comments[1] == f"'made' of {arm.parent}/a- -b-.urdf; prefix l_; on bus at 1 0 0 m, rpy 0 0 0 rad"


@pytest.mark.parametrize(("first", "second"), [(("a_", "a_")), (("", ""))])
def test_a_clash_names_both_parts_and_the_prefix(file, first, second):
    one, two = file(ARM, "one.urdf"), file(ARM, "two.urdf")
    with pytest.raises(OspaceError) as error:
        compose("box:1x1x1m,100kg", Part(one, prefix=first), Part(two, prefix=second))
    for word in ("one.urdf", "two.urdf", "and 9 more names", "prefix='two_'", f"link '{first}base' is in both"):
        assert word in str(error.value)


def test_transmissions_of_one_name_clash_too(file):
    drive = '<transmission name="drive"/>'
    with pytest.raises(OspaceError, match="transmission 'drive' is in both"):
        compose(file(robot(link("a"), drive), "a.urdf"), file(robot(link("b"), drive), "b.urdf"))


# -- materials ---------------------------------------------------------------------------------------------------


def painted(name, rgba, own=""):
    material = f'<material name="grey"><color rgba="{rgba}"/></material>' if rgba else ""
    visual = BOX.format("visual").replace("</visual>", f'<material name="grey">{own}</material></visual>')
    return robot(material, link(name, more=visual))


def colours(composition, tmp_path):
    """The colour of each link as ospace reads it."""
    out = tmp_path / "painted.urdf"
    out.write_bytes(composition.content)
    links = ospace.urdf.reader.read(out).description.links
    return {one.name: one.shapes[0].colour for one in links if one.shapes}


@pytest.mark.parametrize("prefix", ["", "l_"])
def test_materials_of_one_name_keep_their_own_colours(file, tmp_path, prefix):
    dark, light = file(painted("dark", "0 0 0 1"), "d.urdf"), file(painted("light", "1 1 1 1"), "l.urdf")
    none = file(painted("none", ""), "n.urdf")
    composed = compose(dark, Part(light, prefix=prefix), Part(none, prefix="n_"), none)
    seen = colours(composed, tmp_path)
    assert seen == {"dark": (0, 0, 0, 1), f"{prefix}light": (1, 1, 1, 1), "n_none": None, "none": None}


def test_a_material_that_two_parts_share_is_defined_once(file, tmp_path):
    one, two = file(painted("one", "1 0 0 1"), "1.urdf"), file(painted("two", "1 0 0 1"), "2.urdf")
    composed = compose(one, two)
    assert tree(composed).xpath("material/@name") == ["grey"]
    assert set(colours(composed, tmp_path).values()) == {(1, 0, 0, 1)}


# -- meshes ------------------------------------------------------------------------------------------------------

FACET = b"solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"


def meshed(filename):
    return robot(link("body", more=f'<visual><geometry><mesh filename="{filename}"/></geometry></visual>'))


@pytest.mark.parametrize("out", ["robot.urdf", "parts/robot.urdf", "out/robot.urdf"])
@pytest.mark.parametrize("scheme", ["", "file://", "file:///"])
def test_a_mesh_beside_a_part_is_found_from_the_composed_file(file, tmp_path, monkeypatch, out, scheme):
    root = f"{tmp_path}/parts/"[1:] if scheme.endswith("///") else ""
    part = file(meshed(f"{scheme}{root}meshes/a.stl"))
    (tmp_path / "parts/meshes").mkdir()
    (tmp_path / "parts/meshes/a.stl").write_bytes(FACET)
    (tmp_path / "out").mkdir()
    monkeypatch.chdir(tmp_path)
    composed = compose("box:1x1x1m,9kg", os.path.relpath(part), out=out, package_dirs=[tmp_path])
    name = tree(composed).find(".//mesh").get("filename")
    assert not os.path.isabs(name)
    assert os.path.samefile(tmp_path / os.path.dirname(out) / name, tmp_path / "parts/meshes/a.stl")
    assert not [finding for finding in composed.findings if finding.code.startswith("mesh")]


def test_a_mesh_is_found_through_a_folder_that_is_a_link(file, tmp_path):
    part = file(meshed("a.stl"))
    (tmp_path / "parts/a.stl").write_bytes(FACET)
    (tmp_path / "deep/er").mkdir(parents=True)
    (tmp_path / "here").symlink_to(tmp_path / "deep/er")
    composed = compose(part, out=tmp_path / "here/robot.urdf")
    name = tree(composed).find(".//mesh").get("filename")
    assert (tmp_path / "here" / name).read_bytes() == FACET


@pytest.mark.parametrize("name", ["package://arm/a.stl", "model://arm/a.stl", "http://x.y/a.stl", ""])
def test_names_of_meshes_that_are_no_paths_stay(file, name):
    assert tree(compose(Part(file(meshed(name)), prefix="l_"))).find(".//mesh").get("filename") == name


# -- versions ----------------------------------------------------------------------------------------------------


def turned(name, version, attribute='quat_xyzw="0 0 1 0"'):
    content = robot(link(name), link(f"{name}_tip"), joint(f"{name}_joint", "fixed", name, f"{name}_tip", ""))
    content = content.replace("<robot", f'<robot version="{version}"') if version else content
    return content.replace('xyz="0.3 0 0"', f'xyz="0.3 0 0" {attribute}')


def test_quaternions_of_a_newer_part_hold_in_the_composed_file(file):
    old, new = file(turned("old", "", ""), "old.urdf"), file(turned("new", "1.1"), "new.urdf")
    composed = compose(old, new)
    assert tree(composed).get("version") == "1.1"
    assert "quaternion-ignored" not in {finding.code for finding in composed.findings}


def test_a_quaternion_that_was_not_used_must_not_come_into_use(file):
    old, new = file(turned("old", ""), "old.urdf"), file(turned("new", "1.2"), "new.urdf")
    with pytest.raises(OspaceError, match=r"old.urdf: has quat_xyzw, which its version of URDF does not use"):
        compose(old, new)


@pytest.mark.parametrize(
    ("name", "shown"), [("o\x1b", r"o\x1b"), ("o\udcff", r"o\udcff"), ("o--p", "o--p"), ("ö", "ö")]
)
def test_the_name_of_any_file_names_the_robot(file, tmp_path, name, shown):
    out = tmp_path / f"{name}.urdf"
    assert tree(ospace.compose(file(ARM), out=out)).get("name") == shown
    assert ospace.SpaceRobot.from_urdf(out).name == shown


def test_a_mesh_that_xml_cannot_name_is_refused(file, tmp_path):
    shape = '<visual><geometry><mesh filename="m.stl"/></geometry></visual>'
    arm = file(robot(link("base", None, shape)), folder="parts\x1b")
    with pytest.raises(ospace.OspaceError, match=r"parts\\x1b/m\.stl: XML cannot hold this name: rename"):
        ospace.compose(arm, out=tmp_path / "out.urdf")


@pytest.mark.parametrize("prefix", ["\x1b", "a b", "\ud800", None, 1])
def test_a_prefix_that_no_name_can_have_is_refused(prefix):
    with pytest.raises(ospace.OspaceError, match="give a word"):
        ospace.Part("arm.urdf", prefix=prefix)

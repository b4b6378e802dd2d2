"""What `ospace.compose` takes and writes: whole or not at all, over no part; arguments that make no sense are named."""

from __future__ import annotations

import pytest
from urdf.corpus.parts import ARM, joint, link, robot

import ospace
from ospace import OspaceError, Part, UrdfError, compose

BUS = "box:1x1x1m,100kg"


@pytest.fixture
def arm(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM)
    return tmp_path / "arm.urdf"


def test_the_composed_file_is_the_robot_that_was_reported(arm, tmp_path):
    out = tmp_path / "servicer.urdf"
    composed = compose(BUS, Part(arm, prefix="l_"), payloads=[("l_arm", "1kg"), ("l_arm", "box:1x1x1m,2kg")], out=out)
    assert out.read_bytes() == composed.content
    robot = ospace.SpaceRobot.from_urdf(out)
    assert robot.name == "servicer"
    assert robot.findings == composed.findings
    assert [part.links for part in composed.parts] == [("bus",), ("l_base", "l_arm"), ("payload",), ("payload_2",)]
    assert [part.moving for part in composed.parts] == [0, 1, 0, 0]
    assert [part.mass for part in composed.parts] == [100.0, 4.0, 1.0, 2.0]


def test_without_a_file_nothing_is_written(arm, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    compose(BUS, arm)
    assert [one.name for one in tmp_path.iterdir()] == ["arm.urdf"]


@pytest.mark.parametrize("link", [False, True])
def test_no_part_is_written_over(arm, tmp_path, link):
    out = tmp_path / "link.urdf" if link else arm
    if link:
        out.symlink_to(arm)
    with pytest.raises(OspaceError, match="is read as a part: give another name to write to"):
        compose(BUS, arm, out=out)
    assert arm.read_text() == ARM


def test_an_older_result_stays_where_the_new_one_fails(arm, tmp_path):
    out = tmp_path / "out.urdf"
    out.write_text("older")
    for parts in ((arm, arm), (Part(arm, on="nowhere"),), (tmp_path / "none.urdf",)):
        with pytest.raises(OspaceError):
            compose(BUS, *parts, out=out)
        assert out.read_text() == "older"
    compose(BUS, arm, out=out)
    assert out.read_text() != "older"
    assert sorted(one.name for one in tmp_path.iterdir()) == ["arm.urdf", "out.urdf"]


def test_a_folder_that_is_not_there_is_named(arm, tmp_path):
    with pytest.raises(OspaceError, match=r"none/out.urdf: cannot be written: No such file"):
        compose(BUS, arm, out=tmp_path / "none/out.urdf")


def test_findings_name_the_part_they_are_about(tmp_path, arm):
    odd = tmp_path / "odd.urdf"
    wheel = joint("wheel", "continuous", "a", "rim", '<axis xyz="0 0 0"/>')
    odd.write_text(robot('<loop_joint name="loop"/>', link("a"), link("rim", "<inertial/>"), wheel))
    composed = compose(BUS, arm, Part(odd, prefix="o_"))
    about = {finding.code: composed.part_of(finding) for finding in composed.findings}
    assert {"axis-zero", "inertial-unreadable", "dynamics-not-used"} <= about.keys()
    for code in ("axis-zero", "inertial-unreadable", "dynamics-not-used"):
        assert about[code] is composed.parts[2], code
    assert composed.parts[2].label == "o_"
    assert composed.parts[1].label == "arm.urdf"


def test_a_part_that_cannot_be_read_is_refused_by_its_name(tmp_path, arm):
    broken = tmp_path / "broken.urdf"
    broken.write_text(robot(link("a"), link("b")))
    with pytest.raises(UrdfError, match=r"broken.urdf: line \d+: has 2 root links"):
        compose(BUS, arm, broken)


def test_a_link_to_mount_on_is_one_of_the_parts_before(arm):
    with pytest.raises(OspaceError, match=r"arm.urdf: there is no link 'r_am' to put it on .* did you mean 'r_arm'"):
        compose(BUS, Part(arm, prefix="r_"), Part(arm, prefix="l_", on="r_am"))
    compose(BUS, Part(arm, prefix="r_"), Part(arm, prefix="l_", on="r_arm"))
    with pytest.raises(OspaceError, match="no link 'payload_2'"):
        compose(BUS, payloads=[("payload_2", "1kg"), ("bus", "1kg")])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Part(None), "source None: give the path of a URDF, or a body"),
        (lambda: Part(""), "source '': give the path of a URDF"),
        (lambda: Part("a", at=(1, 2)), r"at of a has shape \(2,\)"),
        (lambda: Part("a", rpy=(1, 2, float("nan"))), r"rpy of a\[2\] is nan"),
        (lambda: Part("a", prefix="left arm"), "prefix 'left arm': give a word"),
        (lambda: Part("a", prefix="<"), "prefix '<': give a word"),
        (lambda: Part("a", prefix=None), "prefix None: give a word"),
        (lambda: compose(BUS, 5), "source 5: give the path"),
        (lambda: compose(Part(BUS, on="x")), "is the first part, which stands on nothing"),
        (lambda: compose(Part(BUS, at=(1, 0, 0))), "is the first part, which stands on nothing"),
        (lambda: compose(BUS, payloads={"bus": "1kg"}), r"payload 'bus': give a link and a body, as \('hand'"),
        (lambda: compose(BUS, payloads=[("bus", 1)]), r"payload \('bus', 1\): give a link and a body"),
        (lambda: compose(BUS, payloads=[("bus", "1")]), "'1' is not a number with a unit"),
    ],
)
def test_arguments_that_make_no_sense_are_named(make, words):
    with pytest.raises(OspaceError, match=words):
        make()


def test_limits_hold_for_each_part_and_for_the_whole(arm):
    with pytest.raises(UrdfError, match=r"arm.urdf: .*limits=Limits.links=N."):
        compose(BUS, arm, limits=ospace.Limits(links=1))
    with pytest.raises(UrdfError, match=r"composed.urdf: .*limits=Limits.links=N."):
        compose(BUS, arm, limits=ospace.Limits(links=2))
    compose(BUS, arm, limits=ospace.Limits(links=3))


def test_a_xacro_is_a_part_with_its_arguments_and_what_xacro_warned_of(tmp_path):
    xacro = tmp_path / "arm.urdf.xacro"
    head = '<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="1"/>'
    none = '<xacro:include filename="hand*.xacro"/>'
    base = '<link name="base"><!-- kept --><inertial><mass value="$(arg mass)"/>'
    tensor = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
    xacro.write_text(f"{head}{none}{base}{tensor}</robot>")
    composed = compose(BUS, Part(xacro, prefix="x_", xacro_args={"mass": "7"}))
    assert composed.parts[1].mass == 7.0
    assert b"<!-- kept -->" in composed.content
    warnings = [finding for finding in composed.findings if finding.code == "xacro-warning"]
    assert [composed.part_of(finding) for finding in warnings] == [composed.parts[1]]
    xacro.write_text(f"{head}<xacro:none/></robot>")
    with pytest.raises(UrdfError, match=r"arm.urdf.xacro: line 1"):
        compose(BUS, xacro)


@pytest.mark.parametrize("content", ["\n" + ARM, ARM.replace("<robot", '<robot xmlns="urn:x"')])
def test_files_as_they_come_are_parts(tmp_path, arm, content):
    (tmp_path / "odd.urdf").write_text(content)
    composed = compose(BUS, Part(tmp_path / "odd.urdf", prefix="o_"))
    assert composed.parts[1].links == ("o_base", "o_arm")
    assert not [finding for finding in composed.findings if finding.severity != "info"]
    assert not [
        one for one in compose(tmp_path / "odd.urdf", Part(arm, prefix="a_")).findings if one.severity != "info"
    ]


def test_a_part_in_another_encoding_is_written_in_utf_8(tmp_path):
    declared = ARM.replace('version="1.0"', 'version="1.0" encoding="ISO-8859-1"').replace('"arm"', '"ärm"')
    (tmp_path / "latin.urdf").write_bytes(declared.encode("latin-1"))
    composed = compose(BUS, Part(tmp_path / "latin.urdf", prefix="ö_"))
    assert composed.parts[1].links == ("ö_base", "ö_ärm")
    assert 'name="ö_ärm"' in composed.content.decode("utf-8")
